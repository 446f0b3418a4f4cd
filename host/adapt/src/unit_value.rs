//! Numbers with a unit in text, such as `11 kW`.

use crate::toml_values::is_possible;

/// Units of power: the name and its watts.
pub const POWER: &[(&str, f64)] = &[("kW", 1e3), ("W", 1.0)];
/// Units of torque: the name and its newton metres.
pub const TORQUE: &[(&str, f64)] = &[("Nm", 1.0), ("N m", 1.0)];

/// Units of force: the name and its newtons.
pub const FORCE: &[(&str, f64)] = &[("N", 1.0), ("kN", 1e3)];
/// Units of time: the name and its seconds.
pub const TIME: &[(&str, f64)] = &[("s", 1.0), ("min", 60.0)];

/// Value in the base unit of a text that is a number followed by one of these units; `None` if it is not.
pub fn with_unit(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let text = text.trim();
    let value = |(unit, factor): &(&str, f64)| {
        let number: f64 = text.strip_suffix(unit)?.trim().parse().ok()?;
        Some(number * factor)
    };
    units.iter().find_map(value).filter(|value| is_possible(*value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_may_stand_apart_from_its_number_and_may_not_be_missing() {
        let values = ["11 kW", "11kW", "750W", " 2.5 W "].map(|text| with_unit(text, POWER));
        assert_eq!(values, [Some(11e3), Some(11e3), Some(750.0), Some(2.5)]);
        assert_eq!(["800N", "0.8 kN"].map(|text| with_unit(text, FORCE)), [Some(800.0); 2]);
        assert_eq!(["40 Nm", "40 N m"].map(|text| with_unit(text, TORQUE)), [Some(40.0); 2]);
        assert_eq!(["11", "kW", "11 hp", "inf W", ""].map(|text| with_unit(text, POWER)), [None; 5]);
    }
}
