#![doc = include_str!("../README.md")]
//!
//! Unit types for interfaces, and conversion factors.
//!
//! Lengths of a program are exact integers ([`Nm`]). Formulas use plain floats whose names carry the unit (`_mm`,
//! `_mm_per_min`, `_mm_per_tooth`, `_rad`, `_us`, `_ratio`). The newtypes have no arithmetic: a formula unwraps its
//! inputs, computes, and wraps its result.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod fmath;

/// Nanometres in a millimetre.
pub const NM_PER_MM: i64 = 1_000_000;
/// Micrometres in a millimetre.
pub const UM_PER_MM: i64 = 1_000;
/// Millimetres in a metre.
pub const MM_PER_M: f64 = 1_000.0;
/// Nanometres in an inch (exact).
pub const NM_PER_INCH: i64 = 25_400_000;
/// Millimetres in an inch (exact).
pub const MM_PER_INCH: f64 = 25.4;
/// Microdegrees in a degree.
pub const MICRODEG_PER_DEG: i64 = 1_000_000;
/// Microseconds in a millisecond.
pub const US_PER_MS: u64 = 1_000;
/// Microseconds in a second.
pub const US_PER_S: u64 = 1_000_000;
/// Factor from kilograms per cubic metre to tonnes per cubic millimetre (mm, N, t and s are one set: 1 N = 1 t mm/s2).
pub const T_PER_MM3_IN_KG_PER_M3: f64 = 1e-12;
/// Factor from kilograms to tonnes.
pub const T_PER_KG: f64 = 1e-3;
/// Seconds in a minute.
pub const S_PER_MIN: f64 = 60.0;
/// Factor from a fraction to per cent.
pub const PERCENT: f32 = 100.0;
/// Thousandths of a per cent in a per cent.
pub const MILLIPERCENT_PER_PERCENT: u32 = 1_000;

/// A length or coordinate in whole nanometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Nm(pub i64);

impl Nm {
    /// The same length in millimetres.
    pub fn to_mm(self) -> f64 {
        self.0 as f64 / NM_PER_MM as f64
    }

    /// The nearest whole nanometre to a length in millimetres; beyond the range the nearest end of it, for NaN zero.
    pub fn from_mm(mm: f64) -> Self {
        Nm(nearest(mm * NM_PER_MM as f64))
    }
}

/// The nearest whole number, halves away from zero; beyond the range the nearest end of it, for NaN zero.
fn nearest(value: f64) -> i64 {
    let whole = value as i64;
    // Exact: numbers too large for that have no fraction.
    let rest = value - whole as f64;
    whole.saturating_add(i64::from(rest >= 0.5) - i64::from(rest <= -0.5))
}

/// An angle of a rotary axis in whole microdegrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MicroDeg(pub i64);

impl MicroDeg {
    /// The same angle in degrees.
    pub fn to_deg(self) -> f64 {
        self.0 as f64 / MICRODEG_PER_DEG as f64
    }

    /// The nearest whole microdegree to an angle in degrees; beyond the range the nearest end of it, for NaN zero.
    pub fn from_deg(deg: f64) -> Self {
        MicroDeg(nearest(deg * MICRODEG_PER_DEG as f64))
    }
}

/// A length in millimetres as f32, for formulas that run at each control tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Mm(pub f32);

/// Feed along the path, millimetres per minute.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MmPerMin(pub f32);

/// Feed of a rotary axis, degrees per minute.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DegPerMin(pub f32);

/// Feed per tooth (IPT), millimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MmPerTooth(pub f32);

/// Spindle speed, revolutions per minute.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RevPerMin(pub f32);

/// Microseconds: an instant since the start of a clock, or a duration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Micros(pub u64);

/// A duration of at most 71 minutes in microseconds, such as a tick's period or the age of a sample. Longer durations
/// are stored as 71 minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Span(pub u32);

impl Micros {
    /// The same duration in seconds.
    pub fn to_s(self) -> f64 {
        self.0 as f64 / US_PER_S as f64
    }

    /// A duration of whole milliseconds.
    pub const fn from_ms(ms: u64) -> Self {
        Micros(ms.saturating_mul(US_PER_MS))
    }

    /// The instant `span` after this one, at most the largest that the type holds.
    pub const fn after(self, span: Micros) -> Self {
        Micros(self.0.saturating_add(span.0))
    }

    /// Time since `earlier`; zero if `earlier` is later.
    pub const fn since(self, earlier: Micros) -> Self {
        Micros(self.0.saturating_sub(earlier.0))
    }
}

impl Span {
    /// A duration of whole milliseconds.
    pub const fn from_ms(ms: u32) -> Self {
        Span(ms.saturating_mul(US_PER_MS as u32))
    }

    /// This duration plus `more`.
    #[must_use]
    pub const fn longer_by(self, more: Span) -> Self {
        Span(self.0.saturating_add(more.0))
    }

    /// This duration minus `less`, at least zero.
    #[must_use]
    pub const fn shorter_by(self, less: Span) -> Self {
        Span(self.0.saturating_sub(less.0))
    }

    /// Microseconds as a plain number.
    pub const fn us(self) -> f32 {
        self.0 as f32
    }
}

impl From<Micros> for Span {
    fn from(span: Micros) -> Self {
        Span(u32::try_from(span.0).unwrap_or(u32::MAX))
    }
}

/// Unit system of a program or a job (G20 / G21).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LengthUnit {
    /// G20.
    Inch,
    /// G21.
    Mm,
}

impl LengthUnit {
    /// Nanometres per unit.
    pub const fn nm(self) -> i64 {
        match self {
            LengthUnit::Inch => NM_PER_INCH,
            LengthUnit::Mm => NM_PER_MM,
        }
    }

    /// Millimetres per unit.
    pub const fn mm(self) -> f64 {
        match self {
            LengthUnit::Inch => MM_PER_INCH,
            LengthUnit::Mm => 1.0,
        }
    }

    /// Label of the unit.
    pub const fn label(self) -> &'static str {
        match self {
            LengthUnit::Inch => "in",
            LengthUnit::Mm => "mm",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inch_is_the_same_in_every_constant() {
        assert_eq!(NM_PER_INCH as f64, MM_PER_INCH * NM_PER_MM as f64);
        assert_eq!(Nm(NM_PER_INCH).to_mm(), LengthUnit::Inch.mm());
    }

    #[test]
    fn the_nearest_whole_number_is_that_of_libm() {
        let bits = |k: u64| k.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let any = (0..100_000).map(|k| f64::from_bits(bits(k)));
        let half = (0..100_000).map(|k| (bits(k) >> (k % 64)) as f64 + 0.5);
        let edges = [0.499_999_999_999_999_94, 4_503_599_627_370_495.5, 9.3e18, f64::MAX, f64::INFINITY, f64::NAN];
        for value in any.chain(half).chain(edges).flat_map(|value| [value, -value]) {
            assert_eq!(nearest(value), libm::round(value) as i64, "{value:e}");
        }
    }

    #[test]
    fn nanometres_survive_the_way_to_millimetres_and_back() {
        for nm in [0, 1, -1, 2_540, 999_999_999_999] {
            assert_eq!(Nm::from_mm(Nm(nm).to_mm()), Nm(nm));
        }
        assert_eq!(Nm::from_mm(f64::NAN), Nm(0));
    }
}
