//! Description of a five-axis machine: two rotary axes, three perpendicular linear axes, and the tool's direction.
//!
//! The kinematic chain is part - rotary axes of the table - X, Y, Z - rotary axes of the head - tool. It covers every
//! structure in which no linear axis is carried by a rotary one (RRTTT, RTTTR, TTTRR, whichever side moves along X, Y
//! and Z).

use core::fmt;

use super::vector::{TURN_DEG, Vector, angle_deg, cross, length, unit};

/// Rotary axes closer to parallel than this are rejected.
const PARALLEL_DEG: f64 = 0.1;
/// Largest number of turns that the range of a rotary axis may span; an axis that turns further must be declared
/// endless.
pub const TURNS_MAX: u32 = 16;
/// Tolerance of range ends, for rounding.
const RANGE_SLACK: f64 = 1e-9;

/// Name of a rotary axis (ISO 841): the linear axis parallel to which it turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Letter {
    /// About X.
    A,
    /// About Y.
    B,
    /// About Z.
    C,
}

/// Name of a linear or rotary axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxisName {
    /// A linear axis: 0 for X, 1 for Y, 2 for Z.
    Linear(usize),
    /// A rotary axis.
    Rotary(Letter),
}

/// Object that a rotary axis carries: the part or the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carries {
    /// The part: an axis of the table.
    Part,
    /// The tool: an axis of the head.
    Tool,
}

/// A rotary axis of a machine: direction, place, range and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotaryAxis {
    /// Letter of the axis in the program.
    pub letter: Letter,
    /// Whether it belongs to the table or to the head.
    pub carries: Carries,
    /// Unit vector of the axis in the machine frame, with all axes at zero. At a growing position the tool turns
    /// relative to the part about it by the right-hand rule, also if the axis carries the part.
    pub direction: Vector,
    /// A point on the axis, with all axes at zero: for an axis of the table in the machine frame, for an axis of the
    /// head relative to the gauge point (reference point of the spindle).
    pub point_mm: Vector,
    /// Smallest and largest position; `None` for an endless axis.
    pub range_deg: Option<[f64; 2]>,
    /// Least increment of the position.
    pub resolution_deg: f64,
    /// Maximum speed, degrees per minute; `None` if unknown.
    pub speed_deg_per_min: Option<f64>,
}

/// A linear axis of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearAxis {
    /// Smallest and largest position of the spindle's gauge point; `None`: unknown, not checked.
    pub range_mm: Option<[f64; 2]>,
    /// Least increment of the position.
    pub resolution_mm: f64,
    /// Maximum speed; `None` if unknown.
    pub speed_mm_per_min: Option<f64>,
}

/// Kinematics of a five-axis machine: two rotary axes, three linear axes, and their limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    rotary: [RotaryAxis; 2],
    linear: [LinearAxis; 3],
    tool: Vector,
}

/// Reason why a description of a machine is rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineError {
    /// A direction has no length, or a value is not a finite number.
    NoDirection,
    /// The two rotary axes, or the second rotary axis and the tool, are so nearly parallel that the tool cannot reach
    /// all directions around it.
    Parallel {
        /// Angle between the two lines, degrees.
        angle_deg: f64,
    },
    /// An axis that carries the tool is listed before one that carries the part; the order is from the part to the
    /// tool.
    Order,
    /// Both rotary axes have the same letter.
    SameLetter(Letter),
    /// The upper end of a range is below its lower end.
    Range(AxisName),
    /// A range of more than [`TURNS_MAX`] turns.
    TooWide(Letter),
    /// A resolution or a speed is not above zero.
    NotPositive(AxisName),
}

impl Letter {
    /// In the order of a program's words.
    pub const ALL: [Letter; 3] = [Letter::A, Letter::B, Letter::C];
}

impl Machine {
    /// A machine with two rotary axes, in the order from the part to the tool; the linear axes X, Y, Z; and the
    /// direction from the tool's tip to its holder with all axes at zero.
    ///
    /// # Errors
    /// The rotary axes are parallel, their order is wrong, or a value is invalid.
    pub fn new(rotary: [RotaryAxis; 2], linear: [LinearAxis; 3], tool: Vector) -> Result<Self, MachineError> {
        let direction = |v: Vector| unit(v).ok_or(MachineError::NoDirection);
        let [mut first, mut second] = rotary;
        (first.direction, second.direction) = (direction(first.direction)?, direction(second.direction)?);
        let tool = direction(tool)?;
        if first.carries == Carries::Tool && second.carries == Carries::Part {
            return Err(MachineError::Order);
        }
        if first.letter == second.letter {
            return Err(MachineError::SameLetter(first.letter));
        }
        for (one, other) in [(first.direction, second.direction), (second.direction, tool)] {
            if libm::asin(length(cross(one, other)).min(1.0)).to_degrees() < PARALLEL_DEG {
                return Err(MachineError::Parallel { angle_deg: angle_deg(one, other) });
            }
        }
        [first, second].iter().try_for_each(check_rotary)?;
        linear.iter().enumerate().try_for_each(|(at, axis)| check_linear(AxisName::Linear(at), axis))?;
        Ok(Machine { rotary: [first, second], linear, tool })
    }

    /// The two rotary axes, in the order from the part to the tool.
    pub fn rotary(&self) -> &[RotaryAxis; 2] {
        &self.rotary
    }

    /// The linear axes X, Y, Z.
    pub fn linear(&self) -> &[LinearAxis; 3] {
        &self.linear
    }

    /// The same machine with other maximum speeds, mm/min and degrees per minute; a speed that is not above zero
    /// counts as unknown.
    #[must_use]
    pub fn with_speeds(mut self, linear: [Option<f64>; 3], rotary: [Option<f64>; 2]) -> Self {
        let known = |speed: Option<f64>| speed.filter(|speed| *speed > 0.0 && speed.is_finite());
        for (axis, speed) in self.linear.iter_mut().zip(linear) {
            axis.speed_mm_per_min = known(speed);
        }
        for (axis, speed) in self.rotary.iter_mut().zip(rotary) {
            axis.speed_deg_per_min = known(speed);
        }
        self
    }

    /// Unit vector from the tool's tip to its holder, with all axes at zero.
    pub fn tool(&self) -> Vector {
        self.tool
    }
}

impl RotaryAxis {
    /// Whether a position lies in the range.
    pub fn allows(&self, position_deg: f64) -> bool {
        within(self.range_deg, position_deg)
    }

    /// The position nearest to `near_deg` that differs from `position_deg` by whole turns, whatever the axis' range.
    pub fn nearest_turn(position_deg: f64, near_deg: f64) -> f64 {
        position_deg + TURN_DEG * libm::round((near_deg - position_deg) / TURN_DEG)
    }

    /// The position within the range nearest to `near_deg` that differs from `position_deg` by whole turns; `None` if
    /// there is none.
    pub fn nearest_in_range(&self, position_deg: f64, near_deg: f64) -> Option<f64> {
        let Some([least, greatest]) = self.range_deg else {
            return Some(Self::nearest_turn(position_deg, near_deg));
        };
        let wanted = Self::nearest_turn(position_deg, near_deg);
        let lowest = position_deg + TURN_DEG * libm::ceil((least - RANGE_SLACK - position_deg) / TURN_DEG);
        let highest = position_deg + TURN_DEG * libm::floor((greatest + RANGE_SLACK - position_deg) / TURN_DEG);
        (lowest <= highest).then(|| wanted.clamp(lowest, highest))
    }
}

impl LinearAxis {
    /// Whether a position lies in the range.
    pub fn allows(&self, position_mm: f64) -> bool {
        within(self.range_mm, position_mm)
    }
}

fn within(range: Option<[f64; 2]>, position: f64) -> bool {
    range.is_none_or(|[least, greatest]| position >= least - RANGE_SLACK && position <= greatest + RANGE_SLACK)
}

fn check_rotary(axis: &RotaryAxis) -> Result<(), MachineError> {
    let name = AxisName::Rotary(axis.letter);
    if axis.point_mm.iter().any(|coordinate| !coordinate.is_finite()) {
        return Err(MachineError::NoDirection);
    }
    if axis.range_deg.is_some_and(|[least, greatest]| greatest - least > f64::from(TURNS_MAX) * TURN_DEG) {
        return Err(MachineError::TooWide(axis.letter));
    }
    check(name, axis.range_deg, [Some(axis.resolution_deg), axis.speed_deg_per_min])
}

fn check_linear(name: AxisName, axis: &LinearAxis) -> Result<(), MachineError> {
    check(name, axis.range_mm, [Some(axis.resolution_mm), axis.speed_mm_per_min])
}

fn check(name: AxisName, range: Option<[f64; 2]>, positive: [Option<f64>; 2]) -> Result<(), MachineError> {
    if range.is_some_and(|[least, greatest]| !(least <= greatest && least.is_finite() && greatest.is_finite())) {
        return Err(MachineError::Range(name));
    }
    if positive.into_iter().flatten().any(|value| !(value > 0.0 && value.is_finite())) {
        return Err(MachineError::NotPositive(name));
    }
    Ok(())
}

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

impl fmt::Display for AxisName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisName::Linear(at) => f.write_str(["X", "Y", "Z"].get(*at).copied().unwrap_or("?")),
            AxisName::Rotary(letter) => write!(f, "{letter}"),
        }
    }
}

impl fmt::Display for MachineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MachineError::NoDirection => f.write_str("a direction has no length, or a value is no number"),
            MachineError::Parallel { angle_deg } => write!(
                f,
                "at {angle_deg:.3} degrees the rotary axes, or the second one and the tool, are parallel and reach no directions"
            ),
            MachineError::Order => {
                f.write_str("rotary axes stand in the order from the part to the tool: table before head")
            }
            MachineError::SameLetter(letter) => write!(f, "both rotary axes are called {letter}"),
            MachineError::Range(axis) => write!(f, "the range of {axis} ends below its beginning"),
            MachineError::TooWide(letter) => write!(
                f,
                "the range of {letter} is wider than {TURNS_MAX} turns; leave it out, then the axis turns for ever"
            ),
            MachineError::NotPositive(axis) => write!(f, "resolution and speed of {axis} must be above zero"),
        }
    }
}

impl core::error::Error for MachineError {}
