//! The one place for f32 maths: the same bits on the desk and on the chip.
//!
//! `sqrt` is correctly rounded everywhere (IEEE 754), so the FPU's instruction and `libm`'s routine agree to the bit.
//! `atan2` is `libm`'s, plain f32 on every target. Rounding is micromath's, which is exact up to 2^31; its square root
//! (6 % off) and its trigonometry (3e-3 rad off) are not used for anything: see docs/laws.md.

/// Square root; NaN below zero.
#[cfg(not(all(target_arch = "arm", target_os = "none", target_abi = "eabihf")))]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Square root; NaN below zero.
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

/// Angle of the vector `(x, y)` from the x axis, radians in (-pi, pi].
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Angle with this cosine, radians in [0, pi]; NaN beyond +-1.
pub fn acos(x: f32) -> f32 {
    libm::acosf(x)
}

/// Cosine; not for the tick: it goes through f64.
pub fn cos(x_rad: f32) -> f32 {
    libm::cos(f64::from(x_rad)) as f32
}

/// Angle with this sine, radians in [-pi/2, pi/2]; NaN beyond +-1.
pub fn asin(x: f32) -> f32 {
    libm::asinf(x)
}

/// The largest whole number not above `x`, exact for |x| < 2^31.
pub fn floor(x: f32) -> f32 {
    micromath::F32(x).floor().0
}

/// Length of the vector `(x, y)`; no scaling, so only for |x|, |y| < 1e18.
pub fn length(x: f32, y: f32) -> f32 {
    sqrt(x * x + y * y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floor_is_exact_on_both_sides_of_zero() {
        for (x, want) in [
            (0.0, 0.0),
            (0.999_999_9, 0.0),
            (-0.1, -1.0),
            (-3.0, -3.0),
            (117.0, 117.0),
            (2_147_483_500.0, 2_147_483_500.0),
        ] {
            assert_eq!(floor(x), want, "floor({x})");
        }
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
