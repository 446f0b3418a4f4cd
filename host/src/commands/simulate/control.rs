//! Simulated control of a job, from the job and the machine file.

use arcfeed_control::code::TapeCode as Code;
use arcfeed_control::drives::limits::{AXES, AxisLimits, DriveLimits};
use arcfeed_control::drives::servo::{AxisServo, Servo};
use arcfeed_control::drives::spindle::SpindleDrive;
use arcfeed_control::line::{LineSettings, SenderParity};
use arcfeed_control::tape::TapeSettings;
use arcfeed_control::{ControlSettings, Preset, Switches};
use arcfeed_kinematics::machine::Letter;

use crate::job::{ControlKind, JobFile, Parity, SerialSettings, TapeCode};
use crate::machine_file::MachineFile;
use crate::machine_file::drives::{Drive, Drives, Loops, SpindleRamps};

/// Settings of the simulated control, from the job's control and serial line.
pub fn control_settings(file: &JobFile) -> ControlSettings {
    let preset = match file.control {
        ControlKind::Fanuc16i => Preset::Fanuc16i,
        ControlKind::Fanuc0i => Preset::Fanuc0i,
        ControlKind::Fanuc31i => Preset::Fanuc31i,
    };
    let settings = preset.settings(file.job.unit);
    // Bit n of the reader is bit n - 1 of the panel.
    let switches = Switches { block_delete: file.nc.delete_switches >> 1, ..settings.switches };
    let (sender, code) = framing(&file.serial);
    let code = file.dnc.code.map_or(code, |code| Some(tape_code(code)));
    let line = LineSettings {
        baudrate: file.serial.baudrate,
        bits_per_char: file.serial.bits_per_char(),
        sender,
        tape: TapeSettings { code, tv_check: file.dnc.tv_check, ..settings.line.tape },
        ..settings.line
    };
    let (nc, tables, arc_clamp) = (file.nc, file.tables, file.job.machine.arc_clamp);
    let drives = file.machine.as_ref().and_then(drive_limits);
    let servo = file.machine.as_ref().and_then(|machine| machine.servo).map(|loops| {
        let Loops { gain_per_s, feed_forward_ratio, in_position_mm } = loops;
        Servo { axes: [AxisServo { gain_per_s, feed_forward_ratio, in_position_mm }; AXES] }
    });
    let spindle = file.machine.as_ref().and_then(|machine| machine.spindle).map(spindle_drive);
    ControlSettings { nc, tables, line, arc_clamp, switches, drives, servo, spindle, ..settings }
}

/// Spindle drive from its ramps alone: nothing loads it here, so its speed does not droop.
fn spindle_drive(ramps: SpindleRamps) -> SpindleDrive {
    let SpindleRamps { run_up_rev_per_min_s, run_down_rev_per_min_s, arrival_ratio, waits } = ramps;
    SpindleDrive {
        run_up_rev_per_min_s,
        run_down_rev_per_min_s,
        droop_ratio: 0.0,
        droop_s: 0.0,
        arrival_ratio,
        waits_for_arrival: waits,
    }
}

/// Limits of a machine's drives, axis by axis. A rotary axis that the machine lacks has those of its first one.
fn drive_limits(file: &MachineFile) -> Option<DriveLimits> {
    let Drives { linear, rotary, tolerance } = file.drives?;
    let limits = |drive: &Drive| AxisLimits {
        speed_mm_per_s: drive.speed_mm_per_s,
        acceleration_mm_per_s2: drive.acceleration_mm_per_s2,
        jerk_mm_per_s3: drive.jerk_mm_per_s3,
    };
    let of = |letter: Letter| usize::from(file.machine.rotary()[1].letter == letter);
    let [a, b, c] = Letter::ALL.map(|letter| limits(&rotary[of(letter)]));
    let [x, y, z] = linear.each_ref().map(limits);
    Some(DriveLimits {
        axes: [x, y, z, a, b, c],
        tolerance_mm: tolerance.linear_mm,
        tolerance_deg: tolerance.rotary_deg,
    })
}

/// Code of the simulated control that corresponds to the character code which the sender produces.
pub fn tape_code(code: TapeCode) -> Code {
    match code {
        TapeCode::Iso => Code::Iso,
        TapeCode::Eia => Code::Eia,
        TapeCode::Ascii => Code::Ascii,
    }
}

/// Parity that the job's line adds to a byte, and the code of a control on such a line: with seven bits and a parity
/// bit ISO or EIA, otherwise ASCII.
fn framing(serial: &SerialSettings) -> (SenderParity, Option<Code>) {
    match (serial.bytesize, serial.parity) {
        (7, Parity::Even) => (SenderParity::Even, None),
        (7, Parity::Odd) => (SenderParity::Odd, None),
        _ => (SenderParity::None, Some(Code::Ascii)),
    }
}
