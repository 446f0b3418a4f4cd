//! Offsets as variables: access to the tables that G10 writes.
//!
//! | number | what |
//! |---|---|
//! | #2001-#2200, #10001-#10400 | length wear of H1 on |
//! | #2201-#2400, #11001-#11400 | length of H1 on |
//! | #12001-#12400, #13001-#13400 | radius wear, radius of D1 on |
//! | #2500-#2506, #2600-, #2700-, #2800- | X, Y, Z, A of the external origin and of G54 to G59 |
//! | #5201-#5206, #5221-#5226 to #5321-#5326 | X, Y, Z, A, B, C of the external origin, of G54 to G59 |
//! | #7001-#7006 to #7941-#7946, #14001- to #14946 | the same of G54.1 P1 to P48 |
//!
//! Source: B-63534EN, system variables of tool compensation memory C and of workpiece origins. Values are in the program's
//! unit and in degrees.

use arcfeed_nc::motion::Pose;
use arcfeed_nc::settings::Tables;
use arcfeed_units::{LengthUnit, MICRODEG_PER_DEG, MicroDeg, Nm};

/// Distance of the variables of consecutive coordinate systems.
const SYSTEM_STEP: u32 = 20;
const AXES: [u8; 6] = *b"XYZABC";

enum Slot {
    /// Coordinate system (0: external origin, then G54 to G59, then G54.1 P1 on) and axis.
    System(usize, u8),
    /// Length offset: H from 0; geometry 0, wear 1.
    Length(usize, usize),
    /// Radius offset: D from 0; geometry 0, wear 1.
    Radius(usize, usize),
}

fn slot(variable: u32) -> Option<Slot> {
    let system = |first_variable: u32, first_system: usize| {
        let at = variable - first_variable;
        let letter = AXES.get((at % SYSTEM_STEP) as usize)?;
        Some(Slot::System(first_system + (at / SYSTEM_STEP) as usize, *letter))
    };
    let from = |first: u32| (variable - first) as usize;
    match variable {
        2_001..=2_200 => Some(Slot::Length(from(2_001), 1)),
        2_201..=2_400 => Some(Slot::Length(from(2_201), 0)),
        10_001..=10_400 => Some(Slot::Length(from(10_001), 1)),
        11_001..=11_400 => Some(Slot::Length(from(11_001), 0)),
        12_001..=12_400 => Some(Slot::Radius(from(12_001), 1)),
        13_001..=13_400 => Some(Slot::Radius(from(13_001), 0)),
        2_500..=2_899 if variable % 100 <= 6 => {
            let letter = AXES.get(from(2_500) / 100)?;
            Some(Slot::System(from(2_500) % 100, *letter))
        }
        5_201..=5_326 => system(5_201, 0),
        7_001..=7_946 => system(7_001, 7),
        14_001..=14_946 => system(14_001, 7),
        _ => None,
    }
}

/// Whether the variable with this number is an offset of the control.
pub fn is_offset(variable: u32) -> bool {
    slot(variable).is_some()
}

/// Whether the variable with this number is part of the external work offset, which is zero on most machines.
pub fn is_external(variable: u32) -> bool {
    matches!(slot(variable), Some(Slot::System(0, _)))
}

/// Value of the offset with this variable number, in the program's unit of length or degrees; `None` if the variable
/// is not an offset.
pub fn read(tables: &Tables, variable: u32, unit: LengthUnit) -> Option<f64> {
    let length = |nm: i64| nm as f64 / unit.nm() as f64;
    Some(match slot(variable)? {
        Slot::Length(number, place) => length(tables.lengths.get(number)?.get(place)?.0),
        Slot::Radius(number, place) => length(tables.radii.get(number)?.get(place)?.0),
        Slot::System(number, letter) => {
            let origin = match number.checked_sub(1) {
                None => &tables.external,
                Some(index) => tables.systems.get(index)?,
            };
            match letter {
                b'A'..=b'C' => origin.axis(letter) as f64 / MICRODEG_PER_DEG as f64,
                _ => length(origin.axis(letter)),
            }
        }
    })
}

/// Sets the offset with this variable number to `length`, or to `angle` if it belongs to a rotary axis; `None` if the
/// variable is not an offset.
pub fn write(tables: &mut Tables, variable: u32, length: Nm, angle: MicroDeg) -> Option<()> {
    match slot(variable)? {
        Slot::Length(number, place) => *tables.lengths.get_mut(number)?.get_mut(place)? = length,
        Slot::Radius(number, place) => *tables.radii.get_mut(number)?.get_mut(place)? = length,
        Slot::System(number, letter) => {
            let origin: &mut Pose = match number.checked_sub(1) {
                None => &mut tables.external,
                Some(index) => tables.systems.get_mut(index)?,
            };
            *origin.axis_mut(letter)? = if letter < b'X' { angle.0 } else { length.0 };
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_units::Nm;

    type Place = fn(&Tables) -> i64;

    const LENGTH: Nm = Nm(-31_356_300);
    const ANGLE: MicroDeg = MicroDeg(45_000_000);

    #[test]
    fn each_number_is_one_place_of_the_tables_and_reads_back() {
        let places: [(u32, Place); 10] = [
            (2_001, |tables| tables.lengths[0][1].0),
            (2_400, |tables| tables.lengths[199][0].0),
            (10_400, |tables| tables.lengths[399][1].0),
            (13_001, |tables| tables.radii[0][0].0),
            (2_500, |tables| tables.external.linear[0].0),
            (2_706, |tables| tables.systems[5].linear[2].0),
            (5_202, |tables| tables.external.linear[1].0),
            (5_221, |tables| tables.systems[0].linear[0].0),
            (7_001, |tables| tables.systems[6].linear[0].0),
            (14_943, |tables| tables.systems[53].linear[2].0),
        ];
        for (variable, place) in places {
            let mut tables = Tables::default();
            assert_eq!(write(&mut tables, variable, LENGTH, ANGLE), Some(()), "#{variable}");
            assert_eq!(place(&tables), LENGTH.0, "#{variable}");
            assert_eq!(read(&tables, variable, LengthUnit::Inch), Some(-1.234_5), "#{variable}");
        }
        let mut tables = Tables::default();
        assert_eq!(write(&mut tables, 5_325, LENGTH, ANGLE), Some(()));
        assert_eq!(tables.systems[5].rotary[1], ANGLE);
        assert_eq!(read(&tables, 5_325, LengthUnit::Inch), Some(45.0));
    }

    #[test]
    fn what_is_no_offset_changes_nothing() {
        let mut tables = Tables::default();
        for variable in [2_401, 2_507, 5_207, 5_327, 7_007, 7_947, 14_961, 10_401, 9_000] {
            assert_eq!(write(&mut tables, variable, LENGTH, ANGLE), None, "#{variable}");
            assert_eq!(read(&tables, variable, LengthUnit::Mm), None, "#{variable}");
        }
        assert_eq!(tables, Tables::default());
    }
}
