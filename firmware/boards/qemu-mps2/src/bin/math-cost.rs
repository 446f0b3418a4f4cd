//! Cost and error of `micromath`, `libm` and `fmath` on the chip, as rows of the table in docs/real-time.md.
//!
//! For a sweep of arguments: minimum and maximum number of instructions without the overhead of the call, and the
//! largest error against `libm` in f64, absolute and relative to the exact value.
#![no_std]
#![no_main]

use core::hint::black_box;

use arcfeed_qemu_mps2::clock::InstructionCounter;
use arcfeed_qemu_mps2::leave;
use arcfeed_units::fmath;
use cortex_m_semihosting::{debug, hprintln};
use micromath::F32Ext;

/// Number of points of a sweep.
const POINTS: u16 = 2_000;

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    leave(debug::EXIT_FAILURE)
}

/// A function of one argument with its exact counterpart.
struct Row {
    name: &'static str,
    exact: fn(f64) -> f64,
    from: f32,
    to: f32,
}

impl Row {
    const fn new(name: &'static str, exact: fn(f64) -> f64, from: f32, to: f32) -> Self {
        Row { name, exact, from, to }
    }

    /// Measures an implementation, which is inlined into the sweep as in real use.
    #[inline(never)]
    fn measure(&self, counter: &InstructionCounter, by: &str, function: impl Fn(f32) -> f32) {
        let (mut least, mut most) = (u32::MAX, 0);
        let (mut absolute, mut relative) = (0.0_f64, 0.0_f64);
        let (overhead, _) = counter.of(|| black_box(black_box(1.0_f32)));
        for point in 0..=POINTS {
            let x = self.from + (self.to - self.from) * f32::from(point) / f32::from(POINTS);
            let (cost, y) = counter.of(|| black_box(function(black_box(x))));
            let cost = cost.saturating_sub(overhead);
            (least, most) = (least.min(cost), most.max(cost));
            let exact = (self.exact)(f64::from(x));
            let error = libm::fabs(f64::from(y) - exact);
            absolute = libm::fmax(absolute, error);
            if libm::fabs(exact) > 1e-3 {
                relative = libm::fmax(relative, error / libm::fabs(exact));
            }
        }
        let (name, from, to) = (self.name, self.from, self.to);
        hprintln!(
            "| {} | {}..{} | {} | {}-{} | {:.1e} | {:.1e} |",
            name,
            from,
            to,
            by,
            least,
            most,
            absolute,
            relative
        );
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    cortex_m::interrupt::disable();
    let counter = InstructionCounter::start();
    hprintln!("| function | range | by | instructions | error | relative error |\n|---|---|---|---|---|---|");
    let sqrt = Row::new("sqrt", libm::sqrt, 0.0, 1_000.0);
    sqrt.measure(&counter, "micromath", F32Ext::sqrt);
    sqrt.measure(&counter, "libm", libm::sqrtf);
    sqrt.measure(&counter, "fmath", fmath::sqrt);
    let hypot = Row::new("length (x, 3)", |x| libm::sqrt(x * x + 9.0), 0.0, 1_000.0);
    hypot.measure(&counter, "micromath", |x| F32Ext::hypot(x, 3.0));
    hypot.measure(&counter, "libm", |x| libm::hypotf(x, 3.0));
    hypot.measure(&counter, "fmath", |x| fmath::length(x, 3.0));
    let atan2 = Row::new("atan2 (x, 1)", |x| libm::atan2(x, 1.0), -10.0, 10.0);
    atan2.measure(&counter, "micromath", |x| F32Ext::atan2(x, 1.0));
    atan2.measure(&counter, "libm = fmath", |x| fmath::atan2(x, 1.0));
    let sin = Row::new("sin", libm::sin, -core::f32::consts::PI, core::f32::consts::PI);
    sin.measure(&counter, "micromath", F32Ext::sin);
    sin.measure(&counter, "libm", libm::sinf);
    let acos = Row::new("acos", libm::acos, -1.0, 1.0);
    acos.measure(&counter, "micromath", F32Ext::acos);
    acos.measure(&counter, "libm", libm::acosf);
    let inverse = Row::new("1/x", |x| 1.0 / x, 0.01, 10.0);
    inverse.measure(&counter, "micromath", F32Ext::inv);
    inverse.measure(&counter, "division", |x| 1.0 / x);
    let floor = Row::new("floor", libm::floor, -1_000.0, 1_000.0);
    floor.measure(&counter, "libm", libm::floorf);
    floor.measure(&counter, "micromath", |x| micromath::F32(x).floor().0);
    leave(debug::EXIT_SUCCESS)
}
