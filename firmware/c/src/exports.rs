//! Functions that C calls. This file has the crate's only `unsafe`: it makes references of the caller's pointers, after
//! it has checked them.
//!
//! ```text
//! memory    Block: magic, own address, number of slots, Controller     slots for moves
//! ```
//! A controller is at an address only if magic and address are there: memory that was never created, was copied or
//! discarded has none. It cannot be checked that a pointer that is neither null nor misaligned leads to memory of the
//! stated size; this is the caller's part, as in every C interface.
#![allow(unsafe_code, reason = "pointers of C, checked here; no other file of the crate has any")]

use core::mem::{align_of, size_of};
use core::ptr;
use core::slice;

use arcfeed_units::{MICRODEG_PER_DEG, NM_PER_MM};

use crate::controller::{Controller, no_controller};
use crate::moves::{LineMove, Slots};
use crate::status::ArcfeedStatus;
use crate::values::{
    ARCFEED_ALIGNMENT, ARCFEED_CONTROLLER_SIZE, ARCFEED_MOVE_SIZE, ArcfeedAdaptiveInput, ArcfeedAdaptiveOutput,
    ArcfeedInput, ArcfeedMove, ArcfeedOutput,
};

/// A feed controller in the caller's memory; used only through pointers.
#[repr(C)]
pub struct ArcfeedController {
    _opaque: [u8; 0],
}

/// Mark of a controller.
const MAGIC: u64 = 0x4152_4346_4545_4443;

#[repr(C)]
struct Block {
    magic: u64,
    address: usize,
    slots: usize,
    controller: Controller,
}

type Slot = Option<LineMove>;

const SLOTS_OFFSET: usize = size_of::<Block>().next_multiple_of(align_of::<Slot>());

const _: () = assert!(SLOTS_OFFSET <= ARCFEED_CONTROLLER_SIZE && size_of::<Slot>() <= ARCFEED_MOVE_SIZE);
const _: () = assert!(align_of::<Block>() <= ARCFEED_ALIGNMENT && align_of::<Slot>() <= ARCFEED_ALIGNMENT);

#[cfg(feature = "static-library")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn arcfeed_a_panic_can_be_reached() -> !;
    }
    // SAFETY: never linked, hence never called.
    unsafe { arcfeed_a_panic_can_be_reached() }
}

/// Creates a controller without parameters in `memory`, which must stay where it is, aligned to `ARCFEED_ALIGNMENT`.
/// Every `ARCFEED_MOVE_SIZE` beyond `ARCFEED_CONTROLLER_SIZE` is room for a move.
///
/// # Safety
/// `memory` has `size` bytes that only the functions of this interface use; `controller` is writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_create(
    memory: *mut core::ffi::c_void,
    size: usize,
    controller: *mut *mut ArcfeedController,
) -> ArcfeedStatus {
    let block = memory.cast::<Block>();
    if block.is_null() || controller.is_null() {
        return ArcfeedStatus::Null;
    }
    if !memory.addr().is_multiple_of(ARCFEED_ALIGNMENT) || !controller.is_aligned() {
        return ArcfeedStatus::Alignment;
    }
    let Some(room) = size.checked_sub(ARCFEED_CONTROLLER_SIZE) else { return ArcfeedStatus::Size };
    let slots = room / ARCFEED_MOVE_SIZE;
    // SAFETY: not null, aligned, and the caller has `size` bytes there, enough for the block.
    if unsafe { is_created(block) } {
        return ArcfeedStatus::Exists;
    }
    let Ok(created) = Controller::new() else { return ArcfeedStatus::Value };
    // SAFETY: as above; the slots follow the block within `size`, as a move takes `ARCFEED_MOVE_SIZE` at most.
    unsafe {
        let first = memory.byte_add(SLOTS_OFFSET).cast::<Slot>();
        for slot in 0..slots {
            first.add(slot).write(None);
        }
        block.write(Block { magic: MAGIC, address: block.addr(), slots, controller: created });
        controller.write(block.cast());
    }
    ArcfeedStatus::Ok
}

/// Ends a controller; its memory may be used for anything else.
///
/// # Safety
/// `controller` is null, or leads to `ARCFEED_CONTROLLER_SIZE` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_discard(controller: *mut ArcfeedController) -> ArcfeedStatus {
    // SAFETY: as required of the caller; nothing needs to be dropped.
    unsafe {
        with(controller, |_, _| ArcfeedStatus::Ok).map(|_| {
            ptr::addr_of_mut!((*controller.cast::<Block>()).magic).write(0);
            ArcfeedStatus::Ok
        })
    }
    .unwrap_or_else(|status| status)
}

/// Puts the parameters of a page of flash in force (written by `arcfeed parameters`) and deletes all moves.
///
/// # Safety
/// As of `arcfeed_discard`; `page` has `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_load_page(
    controller: *mut ArcfeedController,
    page: *const u8,
    length: usize,
) -> ArcfeedStatus {
    // SAFETY: as required of the caller.
    let page = match unsafe { bytes(page, length) } {
        Ok(page) => page,
        Err(status) => return status,
    };
    // SAFETY: as required of the caller.
    let done = unsafe { with(controller, |controller, _| controller.load_page(page)) };
    result(done.flatten())
}

/// Adds a move, whose line must be after that of the last one; the first line of a file is 1.
///
/// # Safety
/// As of `arcfeed_discard`; `added` is null or leads to a move.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_add_move(
    controller: *mut ArcfeedController,
    line: u32,
    added: *const ArcfeedMove,
) -> ArcfeedStatus {
    // SAFETY: as required of the caller.
    let added = match unsafe { value(added) } {
        Ok(added) => added,
        Err(status) => return status,
    };
    // SAFETY: as required of the caller.
    let done = unsafe { with(controller, |controller, slots| controller.add_move(slots, line, &added)) };
    result(done.flatten())
}

/// Deletes parameters and moves; the bytes of a prepared program follow.
///
/// # Safety
/// As of `arcfeed_discard`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_begin_program(controller: *mut ArcfeedController) -> ArcfeedStatus {
    // SAFETY: as required of the caller.
    let done = unsafe { with(controller, |controller, _| controller.begin_program()) };
    result(done.flatten())
}

/// Reads the next bytes of a prepared program, in parts of any length. `ARCFEED_STATUS_OK` after the last one: only then
/// is the program in force.
///
/// # Safety
/// As of `arcfeed_discard`; `bytes` has `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_load_program(
    controller: *mut ArcfeedController,
    bytes: *const u8,
    length: usize,
) -> ArcfeedStatus {
    // SAFETY: as required of the caller.
    let part = match unsafe { self::bytes(bytes, length) } {
        Ok(part) => part,
        Err(status) => return status,
    };
    // SAFETY: as required of the caller.
    let read = unsafe { with(controller, |controller, slots| controller.load_program(slots, part)) };
    match read.flatten() {
        Ok(true) => ArcfeedStatus::Ok,
        Ok(false) => ArcfeedStatus::Incomplete,
        Err(status) => status,
    }
}

/// Number of moves in force; 0 without parameters, with an incomplete program, and without a controller.
///
/// # Safety
/// As of `arcfeed_discard`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_moves(controller: *mut ArcfeedController) -> usize {
    let count = |controller: &mut Controller, _: &mut Slots| {
        if controller.is_ready() { controller.moves() } else { 0 }
    };
    // SAFETY: as required of the caller.
    unsafe { with(controller, count) }.unwrap_or(0)
}

/// Runs one tick. `output` is written in any case in which it can be; without a controller it is 0 % and faulted.
///
/// # Safety
/// As of `arcfeed_discard`; `input` and `output` are null or lead to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_tick(
    controller: *mut ArcfeedController,
    input: *const ArcfeedInput,
    output: *mut ArcfeedOutput,
) -> ArcfeedStatus {
    #[cfg(feature = "prove-the-gate")]
    core::hint::black_box([1, 2, 3].get(core::hint::black_box(4_usize)).unwrap_or_else(|| unreachable!()));
    // SAFETY: as required of the caller.
    unsafe {
        let ticked =
            value(input).and_then(|input| with(controller, |controller, slots| controller.tick(slots, &input)));
        let (values, status) = match ticked {
            Ok((values, true)) => (values, ArcfeedStatus::Ok),
            Ok((values, false)) => (values, ArcfeedStatus::Input),
            Err(status) => (no_controller(), status),
        };
        write(output, values, status)
    }
}

/// Combines the override of the last tick with that of a control whose override input only reduces (LinuxCNC's adaptive
/// feed). Call it after each tick or never.
///
/// # Safety
/// As of `arcfeed_tick`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn arcfeed_adaptive_feed(
    controller: *mut ArcfeedController,
    input: *const ArcfeedAdaptiveInput,
    output: *mut ArcfeedAdaptiveOutput,
) -> ArcfeedStatus {
    // SAFETY: as required of the caller.
    unsafe {
        let combined =
            value(input).and_then(|input| with(controller, |controller, _| controller.adaptive_feed(&input)));
        let stopped = ArcfeedAdaptiveOutput { adaptive_feed_ratio: 0.0, dial_percent: 0, feed_inhibit: 1 };
        let (values, status) = combined.map_or_else(|status| (stopped, status), |values| (values, ArcfeedStatus::Ok));
        write(output, values, status)
    }
}

/// Millimetres as nanometres; what is no number or too large becomes a position that a tick refuses.
#[unsafe(no_mangle)]
pub extern "C" fn arcfeed_nm(mm: f64) -> i64 {
    scaled(mm, NM_PER_MM)
}

/// Degrees as microdegrees; what is no number or too large becomes a position that a tick refuses.
#[unsafe(no_mangle)]
pub extern "C" fn arcfeed_microdeg(deg: f64) -> i64 {
    scaled(deg, MICRODEG_PER_DEG)
}

/// A number in whole parts, rounded to the nearest; the conversion saturates.
fn scaled(number: f64, parts: i64) -> i64 {
    let scaled = number * parts as f64;
    if scaled.is_nan() { i64::MAX } else { (scaled + 0.5_f64.copysign(scaled)) as i64 }
}

/// Whether there is a controller.
///
/// # Safety
/// `block` is aligned and leads to the size of a block.
unsafe fn is_created(block: *mut Block) -> bool {
    // SAFETY: as required of the caller; both are numbers, for which all bytes are valid.
    unsafe { ptr::addr_of!((*block).magic).read() == MAGIC && ptr::addr_of!((*block).address).read() == block.addr() }
}

/// Calls `done` with a controller and its slots.
///
/// # Safety
/// `controller` is null, or leads to `ARCFEED_CONTROLLER_SIZE` bytes.
unsafe fn with<T>(
    controller: *mut ArcfeedController,
    done: impl FnOnce(&mut Controller, &mut Slots) -> T,
) -> Result<T, ArcfeedStatus> {
    let block = controller.cast::<Block>();
    if block.is_null() {
        return Err(ArcfeedStatus::Null);
    }
    if !block.is_aligned() {
        return Err(ArcfeedStatus::Alignment);
    }
    // SAFETY: as required of the caller. Where magic and address are, `arcfeed_create` has written a block, and the
    // slots that it counts, behind it. The calls of a controller are not concurrent: the header says so.
    unsafe {
        if !is_created(block) {
            return Err(ArcfeedStatus::NoController);
        }
        let slots = slice::from_raw_parts_mut(block.byte_add(SLOTS_OFFSET).cast::<Slot>(), (*block).slots);
        Ok(done(&mut (*block).controller, slots))
    }
}

/// A struct of the caller.
///
/// # Safety
/// `pointer` is null, misaligned, or leads to a value of which all bytes are valid.
unsafe fn value<T: Copy>(pointer: *const T) -> Result<T, ArcfeedStatus> {
    if pointer.is_null() {
        Err(ArcfeedStatus::Null)
    } else if !pointer.is_aligned() {
        Err(ArcfeedStatus::Alignment)
    } else {
        // SAFETY: not null, aligned, and as required of the caller.
        Ok(unsafe { pointer.read() })
    }
}

/// Writes a result if there is a place for it; the status of the whole.
///
/// # Safety
/// `pointer` is null, misaligned, or leads to a place for a value.
unsafe fn write<T>(pointer: *mut T, value: T, status: ArcfeedStatus) -> ArcfeedStatus {
    if pointer.is_null() {
        return ArcfeedStatus::Null;
    }
    if !pointer.is_aligned() {
        return ArcfeedStatus::Alignment;
    }
    // SAFETY: not null, aligned, and as required of the caller.
    unsafe { pointer.write(value) };
    status
}

/// Bytes of the caller.
///
/// # Safety
/// `bytes` is null or has `length` bytes.
unsafe fn bytes<'a>(bytes: *const u8, length: usize) -> Result<&'a [u8], ArcfeedStatus> {
    if bytes.is_null() {
        return Err(ArcfeedStatus::Null);
    }
    if length > isize::MAX as usize {
        return Err(ArcfeedStatus::Size);
    }
    // SAFETY: not null, of no alignment, as required of the caller, and not longer than an object can be.
    Ok(unsafe { slice::from_raw_parts(bytes, length) })
}

fn result(done: Result<(), ArcfeedStatus>) -> ArcfeedStatus {
    done.map_or_else(|status| status, |()| ArcfeedStatus::Ok)
}

#[cfg(test)]
mod tests;
