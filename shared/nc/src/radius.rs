//! Centre of an arc given by its radius R.
//!
//! With c the chord from start to end and R the radius, the centre lies at
//!
//! ```text
//! c/2 +- h n,    h = sqrt(4 R^2 - |c|^2) / 2,    n square to c, to its left, of length one      (1)
//! ```
//!
//! to the left of the chord for a counter-clockwise arc of up to 180 degrees, to the right for a clockwise one, on the
//! other side for R < 0. The argument of the root is computed in integers. Therefore nothing cancels near half a turn,
//! where the control's own manual warns of errors: the result is the exact centre, rounded to nanometres.
//!
//! A chord that exceeds 2 R by at most twice the tolerance of parameter 3410 is taken as half a turn about its
//! midpoint. For longer chords the published alarm lists have only the alarm for radii out of tolerance; alarm 023
//! seems to fit, but is the lathe's alarm for R < 0.
//!
//! Source: Fanuc 15i-MA operator's manual B-63324EN, 4.4; plane geometry.

use crate::alarm::Alarm;
use crate::modal::Turn;
use arcfeed_units::Nm;

/// Vector from the start of an arc to its centre; `chord` is the vector from start to end, in the two axes of the
/// plane. A chord longer than the diameter by up to twice the tolerance counts as half a turn.
///
/// # Errors
/// PS0022 for a radius of zero, PS0020 for a chord that is longer still.
pub fn center_offset(chord: [Nm; 2], radius: Nm, turn: Turn, tolerance: Nm) -> Result<[Nm; 2], Alarm> {
    if radius.0 == 0 {
        return Err(Alarm::NoRadius);
    }
    let [x, y] = chord.map(|Nm(nm)| i128::from(nm));
    let square = x * x + y * y;
    let diameter = 2 * i128::from(radius.0).abs();
    let longest = diameter + 2 * i128::from(tolerance.0);
    if square > longest * longest {
        return Err(Alarm::RadiusTolerance);
    }
    let left = f64::from(turn.sign()) * if radius.0 < 0 { -1.0 } else { 1.0 };
    let beyond = (diameter * diameter - square).max(0) as f64;
    let ratio = left * libm::sqrt(beyond / square as f64); // (1)
    let half = |along: i128, across: i128| Nm(libm::round(0.5 * (along as f64 + ratio * across as f64)) as i64);
    Ok([half(x, -y), half(y, x)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: Nm = Nm(30_000);

    fn nm(values: [f64; 2]) -> [Nm; 2] {
        values.map(Nm::from_mm)
    }

    fn center(chord: [f64; 2], radius: f64, turn: Turn) -> [Nm; 2] {
        center_offset(nm(chord), Nm::from_mm(radius), turn, TOLERANCE).unwrap()
    }

    #[test]
    fn the_four_ways_round_lie_on_the_sides_that_the_manual_draws() {
        // Chord 8, radius 5: the centre 3 from its middle.
        assert_eq!(center([8.0, 0.0], 5.0, Turn::Ccw), nm([4.0, 3.0]));
        assert_eq!(center([8.0, 0.0], 5.0, Turn::Cw), nm([4.0, -3.0]));
        assert_eq!(center([8.0, 0.0], -5.0, Turn::Ccw), nm([4.0, -3.0]));
        assert_eq!(center([8.0, 0.0], -5.0, Turn::Cw), nm([4.0, 3.0]));
        assert_eq!(center([0.0, 8.0], 5.0, Turn::Ccw), nm([-3.0, 4.0]));
    }

    #[test]
    fn pythagorean_triples_give_exact_centres_even_next_to_half_a_turn() {
        // (2k^2 + 2k)^2 + (2k + 1)^2 = (2k^2 + 2k + 1)^2: leg and hypotenuse differ by one nanometre.
        for k in [1_i64, 10, 1_000, 10_000] {
            let (half_chord, height) = (2 * k * k + 2 * k, 2 * k + 1);
            let found = center_offset([Nm(2 * half_chord), Nm(0)], Nm(half_chord + 1), Turn::Ccw, TOLERANCE);
            assert_eq!(found, Ok([Nm(half_chord), Nm(height)]), "{k}");
        }
    }

    #[test]
    fn too_long_chord_is_a_half_turn_within_the_tolerance_and_an_alarm_beyond() {
        assert_eq!(center([20.06, 0.0], 10.0, Turn::Cw), nm([10.03, 0.0]));
        let beyond = center_offset(nm([20.060_001, 0.0]), Nm::from_mm(10.0), Turn::Cw, TOLERANCE);
        assert_eq!(beyond, Err(Alarm::RadiusTolerance));
        assert_eq!(center_offset(nm([1.0, 0.0]), Nm(0), Turn::Cw, TOLERANCE), Err(Alarm::NoRadius));
    }
}
