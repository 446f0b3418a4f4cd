//! Variables of macro programs: local, common and system variables.
//!
//! | number | what |
//! |---|---|
//! | #0 | vacant, always |
//! | #1-#33 | local, one set for each macro call |
//! | #100-#199, #500-#999 | common |
//! | #3000, #3006 | alarm and stop with a message |
//! | #3001, #3002 | milliseconds and hours since they were set |
//! | #3003, #3004 | disable single block, and feed hold, override, exact stop |
//! | #3011, #3012 | date and time of day |
//! | #4001-#4130 | codes in effect |
//! | #5001-#5006 | end of the last block, in the work coordinate system |
//! | #5021-#5026 | the same in machine coordinates |
//! | #5041-#5046 | the same in the work coordinate system plus the tool length |
//!
//! The variables of offsets are in [`super::offsets`].

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use super::codes::Codes;
use super::offsets;
use arcfeed_nc::alarm::{Cause, NotModelled};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_nc::modal::{Modal, Pose};
use arcfeed_nc::settings::Tables;
use arcfeed_units::{LengthUnit, MICRODEG_PER_DEG, MicroDeg, Micros, Nm, US_PER_MS, US_PER_S};

/// Largest offset: eight digits.
const OFFSET_MAX: f64 = 99_999_999.0;
/// Common variables: #100 to #199, then #500 to #999.
const COMMON: usize = 600;
const S_PER_MIN: u64 = 60;
const S_PER_HOUR: u64 = 3_600;
const HOURS_PER_DAY: u64 = 24;
/// Alarms that #3000 can raise.
const USER_ALARM_MAX: f64 = 200.0;

/// Value of a macro variable; `None` is a vacant variable (without a value).
pub type Value = Option<f64>;

/// The variables of one macro call, #1 first.
pub type Locals = [Value; 33];

/// State of the control while a statement is executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Context {
    /// Unit of lengths in force (G20 or G21).
    pub unit: LengthUnit,
    /// End of the last block in program coordinates.
    pub end: Pose,
    /// End of the last block in machine coordinates.
    pub machine: Pose,
    /// End of the last block in program coordinates plus the tool length.
    pub lengthened: Pose,
    /// Time since power-on.
    pub now: Micros,
    /// Whether the program has stated the position of the tool, so that its variables can be read.
    pub is_position_known: bool,
    /// Date at power-on as one number, year, month, day: 20040229. Power-on counts as midnight.
    pub date: u32,
}

impl Context {
    /// Context of this modal state and time; machine and program coordinates are assumed to be equal on the path.
    pub fn new(modal: &Modal, now: Micros) -> Self {
        let Modal { unit, program, position, .. } = *modal;
        Context {
            unit,
            end: program,
            machine: position,
            lengthened: program,
            now,
            is_position_known: true,
            date: 20_000_101,
        }
    }

    /// Context before the next line of a [`Reader`](arcfeed_nc::reader::Reader), with its modal state and machine position.
    pub fn with_length(modal: &Modal, machine: Pose, now: Micros) -> Self {
        let lengthened = modal.program.plus(machine.minus(modal.position));
        Context { machine, lengthened, ..Context::new(modal, now) }
    }
}

/// Effect, besides the new value, of setting a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// No side effect.
    Kept,
    /// #3000: the program raises the alarm with this number.
    Alarm(u16),
    /// #3006: the control stops with a message.
    Stop,
    /// #3003, #3004: the control ignores other functions than before.
    Ignore,
    /// An offset changes.
    Offset,
}

/// Functions of the control that the program has switched off by #3003 and #3004, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ignored {
    /// #3003. Bit 0: single block. Bit 1: waiting for the end of auxiliary functions.
    pub stops: u8,
    /// #3004. Bit 0: feed hold. Bit 1: feed override. Bit 2: exact stop.
    pub feed: u8,
}

/// Treatment of values that do not follow from program and settings: those that the control has from before the
/// program, and those of its clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutsideValues {
    /// They are vacant, zero, or those of the simulated control.
    #[default]
    Assumed,
    /// Reading one is refused, so that the run follows from program and settings alone.
    Refused {
        /// Whether the stored offsets are those of the control, so that reading them is allowed.
        offsets_known: bool,
    },
}

/// System variables that cannot be read any more, because their values depend on whether the blocks with a `/` so far
/// were executed or skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum SwitchedValues {
    /// No variables: there was no such block.
    #[default]
    None,
    /// #4113 and #4114, the last M and N.
    Functions,
    /// All variables of codes, positions and offsets.
    All,
}

/// All variables of a program with macros: local, common and system variables.
#[derive(Clone, Debug)]
pub struct Variables {
    /// #1 to #33 of the running macro.
    pub locals: Locals,
    /// State of the control that system variables show.
    pub context: Context,
    /// G codes and other words in force (#4001 to #4130).
    pub codes: Codes,
    /// Functions that the program has switched off by #3003 and #3004.
    pub ignored: Ignored,
    /// Offsets of the control.
    pub tables: Box<Tables>,
    /// Treatment of values from outside the program.
    pub outside: OutsideValues,
    /// System variables that cannot be read, because their values depend on a block-delete switch.
    pub switched: SwitchedValues,
    common: Vec<Value>,
    /// Common variables that the program has set.
    assigned: Vec<bool>,
    /// Times at which #3001 and #3002 were zero, in their own units.
    timers: [f64; 2],
}

impl Variables {
    /// Variables with all local and common ones vacant.
    pub fn new(context: Context) -> Self {
        Variables {
            locals: [None; 33],
            context,
            codes: Codes::new(context.unit),
            ignored: Ignored::default(),
            tables: Box::default(),
            outside: OutsideValues::Assumed,
            switched: SwitchedValues::None,
            common: vec![None; COMMON],
            assigned: vec![false; COMMON],
            timers: [0.0; 2],
        }
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// PS0115 if there is no variable of this number; not modelled if the control has it but its value is unknown
    /// here, or comes from outside the program and that is refused.
    pub fn read(&self, number: u32) -> Result<Value, Cause> {
        if self.is_outside(number) {
            return Err(Cause::NotModelled(NotModelled::OutsideValue(number)));
        }
        let known = match number {
            0 => return Ok(None),
            1..=33 => return Ok(self.locals.get(number as usize - 1).copied().flatten()),
            3_001 => Some(self.timer(0)),
            3_002 => Some(self.timer(1)),
            3_003 => Some(f64::from(self.ignored.stops)),
            3_004 => Some(f64::from(self.ignored.feed)),
            3_011 => Some(f64::from(self.context.date)),
            3_012 => Some(self.time_of_day() as f64),
            4_001..=4_130 => return self.codes.value(number).ok_or(Cause::Macro(MacroAlarm::VariableNumber)),
            5_001..=5_006 => self.position(&self.context.end, number - 5_001),
            5_021..=5_026 => self.position(&self.context.machine, number - 5_021),
            5_041..=5_046 => self.position(&self.context.lengthened, number - 5_041),
            _ if let Some(place) = common(number) => return Ok(self.common.get(place).copied().flatten()),
            _ => offsets::read(&self.tables, number, self.context.unit),
        };
        known.map(Some).ok_or(unknown(number))
    }

    /// Sets a variable.
    ///
    /// # Errors
    /// PS0115, PS0116, or a variable of the control whose effect is not modelled.
    pub fn write(&mut self, number: u32, value: Value) -> Result<Effect, Cause> {
        let plain = value.unwrap_or(0.0);
        match number {
            1..=33 => {
                if let Some(place) = self.locals.get_mut(number as usize - 1) {
                    *place = value;
                }
            }
            3_000 if (0.0..=USER_ALARM_MAX).contains(&plain) => return Ok(Effect::Alarm(libm::round(plain) as u16)),
            3_006 => return Ok(Effect::Stop),
            3_001 | 3_002 => self.set_timer(number as usize - 3_001, plain),
            3_003 | 3_004 => return self.ignore(number, plain),
            // This includes the machine's signals to the program.
            0 | 1_000..=1_035 | 3_011 | 3_012 | 4_001..=4_130 | 5_001..=5_105 => {
                return Err(Cause::Macro(MacroAlarm::WriteProtected));
            }
            _ if let Some(place) = common(number) => {
                self.common.iter_mut().skip(place).take(1).for_each(|common| *common = value);
                self.assigned.iter_mut().skip(place).take(1).for_each(|assigned| *assigned = true);
            }
            _ => {
                offsets::read(&self.tables, number, self.context.unit).ok_or(unknown(number))?;
                let value = rounded(plain, self.context.unit).ok_or(Cause::Macro(MacroAlarm::VariableNumber))?;
                let (length, angle) = value;
                return offsets::write(&mut self.tables, number, length, angle)
                    .map(|()| Effect::Offset)
                    .ok_or(unknown(number));
            }
        }
        Ok(Effect::Kept)
    }

    fn is_outside(&self, number: u32) -> bool {
        let OutsideValues::Refused { offsets_known } = self.outside else { return false };
        match number {
            3_001 | 3_002 | 3_011 | 3_012 => true,
            4_113 | 4_114 if self.switched != SwitchedValues::None => true,
            5_001..=5_046 if !self.context.is_position_known => true,
            2_001.. if self.switched == SwitchedValues::All && !matches!(number, 3_000..=3_999) => true,
            _ if let Some(place) = common(number) => self.assigned.get(place) == Some(&false),
            _ => !offsets_known && offsets::is_offset(number),
        }
    }

    fn ignore(&mut self, number: u32, value: f64) -> Result<Effect, Cause> {
        let (place, max) = match number {
            3_003 => (&mut self.ignored.stops, 3.0),
            _ => (&mut self.ignored.feed, 7.0),
        };
        if !(0.0..=max).contains(&value) {
            return Err(Cause::Macro(MacroAlarm::VariableNumber));
        }
        *place = libm::round(value) as u8;
        Ok(Effect::Ignore)
    }

    /// Does what the control's reset key does: clears the local variables, #100 to #199, #3003 and #3004.
    pub fn reset(&mut self) {
        self.locals = [None; 33];
        self.ignored = Ignored::default();
        self.common.iter_mut().take(100).for_each(|value| *value = None);
        self.codes = Codes::new(self.context.unit);
    }

    fn elapsed(&self, timer: usize) -> f64 {
        let Micros(now) = self.context.now;
        match timer {
            0 => (now / US_PER_MS) as f64,
            _ => now as f64 / US_PER_S as f64 / S_PER_HOUR as f64,
        }
    }

    fn timer(&self, timer: usize) -> f64 {
        self.elapsed(timer) - self.timers.get(timer).copied().unwrap_or_default()
    }

    fn set_timer(&mut self, timer: usize, value: f64) {
        let zero = self.elapsed(timer) - value;
        if let Some(place) = self.timers.get_mut(timer) {
            *place = zero;
        }
    }

    /// Time of day as one number: hours, minutes, seconds.
    fn time_of_day(&self) -> u64 {
        let seconds = self.context.now.0 / US_PER_S;
        let (hours, minutes) = (seconds / S_PER_HOUR % HOURS_PER_DAY, seconds / S_PER_MIN % S_PER_MIN);
        (hours * 100 + minutes) * 100 + seconds % S_PER_MIN
    }

    /// Coordinate of an axis: X, Y, Z in the program's unit, A, B, C in degrees.
    fn position(&self, pose: &Pose, axis: u32) -> Option<f64> {
        let Pose { linear, rotary } = pose;
        let axis = axis as usize;
        let length = linear.get(axis).map(|nm| nm.0 as f64 / self.context.unit.nm() as f64);
        length.or_else(|| rotary.get(axis.checked_sub(3)?).map(|angle| angle.to_deg()))
    }
}

/// Value of an offset as a length and as an angle, rounded to the least increment; `None` if it is too large.
fn rounded(value: f64, unit: LengthUnit) -> Option<(Nm, MicroDeg)> {
    let to = |per_unit: i64, whole: i64| libm::round(value * per_unit as f64) as i64 * (whole / per_unit);
    let per_unit = match unit {
        LengthUnit::Mm => 1_000,
        LengthUnit::Inch => 10_000,
    };
    let value_fits = libm::fabs(value) <= OFFSET_MAX;
    value_fits.then(|| (Nm(to(per_unit, unit.nm())), MicroDeg(to(1_000, MICRODEG_PER_DEG))))
}

/// Index of a common variable.
fn common(number: u32) -> Option<usize> {
    match number {
        100..=199 => Some(number as usize - 100),
        500..=999 => Some(number as usize - 400),
        _ => None,
    }
}

fn unknown(number: u32) -> Cause {
    let is_of_system = matches!(number, 1_000..=1_199 | 2_000..=2_999 | 3_000..=3_999 | 4_131..=5_999 | 7_000..=7_999 | 10_000..=19_999);
    if is_of_system {
        Cause::NotModelled(NotModelled::Variable(number))
    } else {
        Cause::Macro(MacroAlarm::VariableNumber)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variables() -> Variables {
        let end = Pose {
            linear: [Nm(25_400_000), Nm(0), Nm(-12_700_000)],
            rotary: [MicroDeg(0), MicroDeg(45_500_000), MicroDeg(0)],
        };
        Variables::new(Context {
            unit: LengthUnit::Inch,
            end,
            machine: end,
            lengthened: end,
            now: Micros(3_723_004_000),
            is_position_known: true,
            date: 20_260_102,
        })
    }

    #[test]
    fn positions_are_in_the_unit_of_the_program() {
        let read = |number| variables().read(number).unwrap().unwrap();
        assert_eq!([5001, 5003, 5005, 5021, 5043].map(read), [1.0, -0.5, 45.5, 1.0, -0.5]);
    }

    #[test]
    fn timers_count_from_where_they_are_set() {
        let mut variables = variables();
        assert_eq!(variables.read(3001), Ok(Some(3_723_004.0)));
        assert_eq!((variables.read(3011), variables.read(3012)), (Ok(Some(20_260_102.0)), Ok(Some(10_203.0))));
        variables.write(3001, Some(5.0)).unwrap();
        variables.context.now = Micros(3_723_006_000);
        assert_eq!(variables.read(3001), Ok(Some(7.0)));
    }

    #[test]
    fn numbers_that_no_variable_has_are_refused() {
        let mut variables = variables();
        let alarm = |alarm| Err(Cause::Macro(alarm));
        for number in [34, 99, 200, 499, 5000 + 90_000] {
            assert_eq!(variables.read(number), alarm(MacroAlarm::VariableNumber), "#{number}");
        }
        for number in [0, 1000, 1032, 4001, 5001, 5041, 3011] {
            assert_eq!(
                variables.write(number, Some(1.0)).map(|_| None),
                alarm(MacroAlarm::WriteProtected),
                "#{number}"
            );
        }
    }

    #[test]
    fn an_offset_is_there_before_it_is_written() {
        let mut variables = variables();
        assert_eq!(variables.read(5221), Ok(Some(0.0)));
        assert_eq!(variables.write(5221, Some(2.5)), Ok(Effect::Offset));
        assert_eq!(variables.read(5221), Ok(Some(2.5)));
        // To a ten-thousandth of an inch, a thousandth of a degree.
        for (number, value, kept) in [(5221, -1.234_56, -1.234_6), (5225, 45.000_4, 45.0)] {
            assert_eq!(variables.write(number, Some(value)), Ok(Effect::Offset));
            assert_eq!(variables.read(number), Ok(Some(kept)), "#{number}");
        }
        assert_eq!(variables.write(5221, Some(1e9)), Err(Cause::Macro(MacroAlarm::VariableNumber)));
        assert_eq!(variables.read(5221), Ok(Some(-1.234_6)));
        assert_eq!(variables.read(5061), Err(Cause::NotModelled(NotModelled::Variable(5061))));
    }

    #[test]
    fn values_known_only_to_the_control_are_refused_in_strict_runs() {
        let mut variables = variables();
        variables.outside = OutsideValues::Refused { offsets_known: false };
        let refused = |number| Err(Cause::NotModelled(NotModelled::OutsideValue(number)));
        for number in [100, 500, 3001, 3012, 2001, 5221] {
            assert_eq!(variables.read(number), refused(number), "#{number}");
        }
        for number in [0, 1, 3003, 4001, 5001, 5043] {
            assert!(variables.read(number).is_ok(), "#{number}");
        }
        // A variable that the program has made vacant is known to be vacant.
        variables.write(500, None).unwrap();
        assert_eq!(variables.read(500), Ok(None));
        variables.context.is_position_known = false;
        assert_eq!(variables.read(5041), refused(5041));
        variables.outside = OutsideValues::Refused { offsets_known: true };
        assert_eq!(variables.read(5221), Ok(Some(0.0)));
    }

    #[test]
    fn switches_take_their_bits_and_no_others() {
        let mut variables = variables();
        assert_eq!(variables.write(3003, Some(1.0)), Ok(Effect::Ignore));
        assert_eq!(variables.write(3004, Some(7.0)), Ok(Effect::Ignore));
        assert_eq!(variables.ignored, Ignored { stops: 1, feed: 7 });
        assert_eq!(variables.write(3004, None), Ok(Effect::Ignore));
        assert_eq!((variables.read(3003), variables.read(3004)), (Ok(Some(1.0)), Ok(Some(0.0))));
        for (number, value) in [(3003, 4.0), (3004, 8.0), (3004, -1.0)] {
            let alarm = Err(Cause::Macro(MacroAlarm::VariableNumber));
            assert_eq!(variables.write(number, Some(value)), alarm, "#{number}={value}");
        }
    }
}
