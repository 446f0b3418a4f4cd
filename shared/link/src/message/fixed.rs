//! Numbers of a job as scaled integers: NaN cannot be encoded, and numbers arrive bit-identical.
//!
//! The scales are powers of two: every f32 from 2^-17 (7.6 nm as a length) to 2^23 is a whole multiple of 2^-40, and
//! every f64 in millimetres from 2^6 on a multiple of 2^-46. Therefore a controller behind the link computes with the
//! same numbers as one that has read the job's file.

/// Declares a fixed-point number with its floating-point type and binary places.
macro_rules! fixed_point {
    ($($(#[$doc:meta])* $name:ident $float:ident $places:literal)+) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
            pub struct $name(pub i64);

            impl $name {
                const ONE: f64 = (1_u64 << $places) as f64;

                /// The number, rounded to the nearest multiple of the scale; `None` for NaN, and for numbers too large
                /// for the type.
                pub fn of(value: impl Into<f64>) -> Option<Self> {
                    let scaled = libm::round(value.into() * Self::ONE);
                    // Outside the range the conversion would saturate; NaN is in no range.
                    (i64::MIN as f64..i64::MAX as f64).contains(&scaled).then_some($name(scaled as i64))
                }

                /// The number that this value stands for.
                pub fn value(self) -> $float {
                    (self.0 as f64 / Self::ONE) as $float
                }
            }
        )+
    };
}

fixed_point! {
    /// An f32 as a whole multiple of 2^-40 of its unit.
    Q40 f32 40
    /// An f64 in millimetres as a whole multiple of 2^-46 mm; at most 131 m.
    Q46 f64 46
    /// A component of a unit vector as a whole multiple of 2^-62.
    Q62 f64 62
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_f32_in_its_range_arrives_as_it_was() {
        let mut bits = 1_u32;
        let mut tried = 0;
        for _ in 0..2_000_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from_bits(bits);
            if (2.0_f32.powi(-17)..8_388_608.0).contains(&value.abs()) {
                assert_eq!(Q40::of(value).unwrap().value().to_bits(), bits, "{value}");
                tried += 1;
            }
        }
        println!("{tried} tried");
        assert!(tried > 200_000);
    }

    #[test]
    fn unit_vectors_and_offsets_arrive_as_they_were() {
        for tenths in 0..3_600 {
            let (sin, cos) = libm::sincos(f64::from(tenths) * 0.001_745_3 + 0.001);
            // Below 2^-9 a component loses what the law, which takes f32, never sees.
            for value in [sin, cos].into_iter().filter(|value| value.abs() > 0.002) {
                assert_eq!(Q62::of(value), Q62::of(Q62::of(value).unwrap().value()));
                assert_eq!(Q62::of(value).unwrap().value(), value);
            }
            let offset_mm = 64.0 + sin * 60.0 + 107.673;
            assert_eq!(Q46::of(offset_mm).unwrap().value(), offset_mm);
        }
    }

    #[test]
    fn what_is_no_number_or_too_large_is_not_encoded() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 8_388_608.0, -1e30] {
            assert_eq!(Q40::of(bad), None, "{bad}");
        }
        assert_eq!(Q46::of(131_072.0), None);
        assert_eq!(Q62::of(f64::NAN), None);
        assert_eq!(Q62::of(-1.0), Some(Q62(-(1 << 62))));
    }

    #[test]
    fn whatever_arrives_is_a_number() {
        for raw in [i64::MIN, -1, 0, 1, i64::MAX] {
            assert!(Q40(raw).value().is_finite() && Q46(raw).value().is_finite() && Q62(raw).value().is_finite());
        }
    }
}
