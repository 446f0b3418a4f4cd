//! The machines of the examples, and paths to run on them.

use arcfeed::machine_file::MachineFile;
use arcfeed_kinematics::forward::{Setup, ToolPose};
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::Vector;
use arcfeed_tests::root;

/// The files of host/adapt/machines.
pub const FILES: [&str; 3] = ["mikron-ucp710", "ferrari-rtttr", "mitsui-seiki-hu80a-5x"];

/// A part and a tool somewhere.
pub const SETUP: Setup = Setup { part_zero_mm: [31.0, -17.5, 83.25], tool_length_mm: 112.4 };

/// A machine of the examples.
pub fn machine(file: &str) -> Machine {
    let path = root().join("host/adapt/machines").join(file).with_extension("toml");
    MachineFile::load(&path).expect("an example machine").machine
}

/// The same with another range of the first rotary axis.
pub fn with_first_range(machine: &Machine, range_deg: Option<[f64; 2]>) -> Machine {
    let [mut first, second] = *machine.rotary();
    first.range_deg = range_deg;
    Machine::new([first, second], *machine.linear(), machine.tool()).expect("still a machine")
}

/// A unit vector at an angle from +Z, at an azimuth from +X.
pub fn direction(tilt_deg: f64, azimuth_deg: f64) -> Vector {
    let (sin_tilt, cos_tilt) = libm::sincos(tilt_deg.to_radians());
    let (sin, cos) = libm::sincos(azimuth_deg.to_radians());
    [sin_tilt * cos, sin_tilt * sin, cos_tilt]
}

/// A pose with its tip on a line along X.
pub fn pose(x_mm: f64, axis: Vector) -> ToolPose {
    ToolPose { tip_mm: [x_mm, 5.0, 60.0], axis }
}

/// Rotation of the first and the second axis along a path.
pub fn travels(course: &[[f64; 2]]) -> [f64; 2] {
    let turned = |axis: usize| course.windows(2).map(|pair| (pair[1][axis] - pair[0][axis]).abs()).sum();
    [turned(0), turned(1)]
}
