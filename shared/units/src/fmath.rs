//! All f32 maths of the project: bit-identical on the host and on the chip.
//!
//! `sqrt` is correctly rounded everywhere (IEEE 754), so the FPU's instruction and `libm`'s routine agree to the bit.
//! `atan2` is `libm`'s, plain f32 on every target. Rounding is micromath's, which is exact up to 2^31; its square root
//! (6 % off) and its trigonometry (3e-3 rad off) are not used for anything: see docs/laws.md.

/// Sign bit.
const SIGN: u32 = 1 << 31;

/// Square root; NaN for negative numbers.
#[cfg(not(all(target_arch = "arm", target_os = "none", target_abi = "eabihf")))]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Square root; NaN for negative numbers.
#[cfg(all(target_arch = "arm", target_os = "none", target_abi = "eabihf"))]
#[allow(unsafe_code)]
pub fn sqrt(x: f32) -> f32 {
    let mut bits = x.to_bits();
    // SAFETY: moves between registers and one arithmetic instruction; no memory, no stack, no flags.
    unsafe {
        core::arch::asm!(
            "vmov s0, {bits}",
            "vsqrt.f32 s0, s0",
            "vmov {bits}, s0",
            bits = inout(reg) bits,
            out("s0") _,
            options(pure, nomem, nostack)
        );
    }
    f32::from_bits(bits)
}

/// The two whole numbers as f32, rounded to nearest (`x as f32`). Faster than two conversions on the chip if both fit
/// 32 bits.
#[inline(always)]
pub fn from_pair([x, y]: [i64; 2]) -> [f32; 2] {
    let (short_x, short_y) = (x as i32, y as i32);
    let lost = ((x >> 32) as i32 ^ (short_x >> 31)) | ((y >> 32) as i32 ^ (short_y >> 31));
    if lost == 0 { [short_x as f32, short_y as f32] } else { long_pair([x, y]) }
}

/// Not inlined: otherwise the compiler executes both conversions and then selects one.
#[cold]
#[inline(never)]
fn long_pair(pair: [i64; 2]) -> [f32; 2] {
    pair.map(|x| x as f32)
}

/// The whole number as f32, rounded to nearest (`x as f32`); faster on the chip if it fits 32 bits.
pub fn from_u64(x: u64) -> f32 {
    match u32::try_from(x) {
        Ok(short) => short as f32,
        Err(_) => unsigned_long_to_f32(x),
    }
}

#[cold]
#[inline(never)]
fn unsigned_long_to_f32(x: u64) -> f32 {
    x as f32
}

/// Whether `x` is above zero, finite and not subnormal. Tests sign and exponent, which takes 5 instructions on the
/// chip; `x > 0.0 && x.is_finite()` takes 25.
#[inline(always)]
pub fn is_positive(x: f32) -> bool {
    let sign_and_exponent = x.to_bits().cast_signed() >> (f32::MANTISSA_DIGITS - 1);
    (sign_and_exponent - 1).cast_unsigned() < f32::MAX_EXP.cast_unsigned() * 2 - 2
}

/// The absolute value of `x` with the sign of `sign`.
#[inline(always)]
pub fn with_sign_of(x: f32, sign: f32) -> f32 {
    f32::from_bits(x.to_bits() & !SIGN | sign.to_bits() & SIGN)
}

/// The smaller of two numbers; `b` if one of them is NaN. `f32::min` is a call on the chip; this is a comparison and a
/// move.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers; `b` if one of them is NaN. See [`min`].
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Angle of the vector `(x, y)` from the x axis, radians in (-pi, pi].
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Angle with this cosine, radians in [0, pi]; NaN beyond +-1.
pub fn acos(x: f32) -> f32 {
    libm::acosf(x)
}

/// Cosine of an angle in radians. Too slow for the control tick, because it computes in f64.
pub fn cos(x_rad: f32) -> f32 {
    libm::cos(f64::from(x_rad)) as f32
}

/// Cosine and sine of an angle of at most 1/8 turn in either sense, radians. Fast enough for the control tick, because
/// it is a Taylor series in f32; its remainder is below the resolution of f32.
pub fn cos_sin_of_octant(x_rad: f32) -> [f32; 2] {
    let square = x_rad * x_rad;
    let series = |divisors: [f32; 4]| divisors.iter().rev().fold(1.0, |rest, d| 1.0 - square * (1.0 / d) * rest);
    let [cos, sin] = [[12.0, 30.0, 56.0, 90.0], [6.0, 20.0, 42.0, 72.0]].map(series);
    [1.0 - square / 2.0 * cos, x_rad * sin]
}

/// Angle with this sine, radians in [-pi/2, pi/2]; NaN beyond +-1.
pub fn asin(x: f32) -> f32 {
    libm::asinf(x)
}

/// The smallest whole number not below `x`, exact for |x| < 2^31.
pub fn ceil(x: f32) -> f32 {
    micromath::F32(x).ceil().0
}

/// Length of the vector `(x, y)`; no scaling, so only for |x|, |y| < 1e18.
pub fn length(x: f32, y: f32) -> f32 {
    sqrt(x * x + y * y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ceil_is_exact_on_both_sides_of_zero() {
        for (x, want) in
            [(0.0, 0.0), (1e-6, 1.0), (-0.1, 0.0), (-3.0, -3.0), (117.0, 117.0), (2_147_483_500.0, 2_147_483_500.0)]
        {
            assert_eq!(ceil(x), want, "ceil({x})");
        }
    }

    #[test]
    fn an_eighth_of_a_turn_has_the_cosine_and_the_sine_of_f64() {
        for x in (-7_854..=7_854).map(|i| i as f32 * 1e-4) {
            let (sin, cos) = libm::sincos(f64::from(x));
            let [found_cos, found_sin] = cos_sin_of_octant(x).map(f64::from);
            assert!((found_cos - cos).abs() < 1e-7 && (found_sin - sin).abs() <= 1.5e-7 * sin.abs(), "{x}");
        }
    }

    #[test]
    fn whole_numbers_become_the_nearest_float_on_both_routes() {
        let edge = i64::from(i32::MAX);
        for x in [0, -1, 16_777_217, edge - 64, edge, edge + 1, -edge - 1, -edge - 2, i64::MAX, i64::MIN] {
            assert_eq!(from_pair([x, 1]), [x as f32, 1.0], "{x}");
            assert_eq!(from_pair([1, x]), [1.0, x as f32], "{x}");
            assert_eq!(from_u64(x.unsigned_abs()), x.unsigned_abs() as f32, "{x}");
        }
    }

    #[test]
    fn positive_is_what_is_finite_and_above_zero() {
        for x in [
            0.0,
            -0.0,
            f32::MIN_POSITIVE,
            1.0,
            -1.0,
            f32::MAX,
            f32::MIN,
            f32::INFINITY,
            -f32::INFINITY,
            f32::NAN,
            -f32::NAN,
        ] {
            assert_eq!(is_positive(x), x > 0.0 && x.is_finite(), "{x}");
        }
        assert!(!is_positive(1e-45));
    }

    #[test]
    fn sqrt_is_correctly_rounded() {
        for x in [2.0_f32, 0.1, 1e-20, 1e20, 16_777_215.0] {
            let exact = f64::from(x);
            let root = sqrt(x);
            assert_eq!(root, libm::sqrt(exact) as f32, "sqrt({x})");
        }
        assert!(sqrt(-1.0).is_nan());
    }
}
