//! The source's own route to the feed per tooth at the centre, equation by equation: the baseline of the tick's cost.
//!
//! Not used for control: in f32 it loses most of its digits (docs/laws.md#circumference). It is written as one writes
//! down what is printed: both intersections where two are printed, the angle of the contact and its sine and cosine
//! where the angle is printed, `libm` for every function, squares as products.
//!
//! ```text
//! A, B, C of the stock limit through M and N                           (8)-(10)
//! B: circle (O, r0) with the line A x + B y + C = 0, both points       (11)-(15)
//! the admissible one of the two                                        (16)
//! C: the next point of the edge                                        (17) (18)
//! O': circle (rotation centre, rho) with circle (C, r0), both points   (19)-(23)
//! the forward one of the two                                           (24)
//! s: chord from O to O'; alpha: its angle about the rotation centre    (25) (26)
//! M and N in the frame at O', for the next step                        (27)-(29)
//! ```
//!
//! Frame at O as in the firmware's law: y towards the rotation centre, x in the direction of travel. Departures from
//! print, all needed for it to work: (16) and (24) choose by side and by turn instead of "max(x, y)" and "min(x, y)",
//! which are ambiguous; (25) takes the coordinates of O', where those of C are printed; (29) turns after it translates,
//! and with x in the direction of travel the turn has the sign that makes y point to the rotation centre again.
//!
//! Source: Petean 2004, ch. 5.

use core::ops::{Add, Div, Mul, Neg, Sub};

use arcfeed_units::fmath;

/// A floating-point number: f32 or f64.
pub trait Real:
    Copy
    + PartialOrd
    + From<i8>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
}

impl Real for f32 {}

impl Real for f64 {}

/// Mathematical functions of the equations.
pub trait Maths<T> {
    /// Square root.
    fn sqrt(x: T) -> T;
    /// Sine of an angle in radians.
    fn sin(x: T) -> T;
    /// Cosine of an angle in radians.
    fn cos(x: T) -> T;
    /// Angle in radians of a cosine.
    fn acos(x: T) -> T;
    /// Angle in radians from the x axis to `(x, y)`.
    fn atan2(y: T, x: T) -> T;
}

/// Implementation of [`Maths`] with all functions from `libm`.
#[derive(Debug)]
pub enum Libm {}

/// Implementation of [`Maths`] for a chip with FPU: square root by an instruction, sine and cosine by a polynomial in
/// single precision (4e-6 off within a right angle, which the equations do not leave), the rest from `libm`.
#[derive(Debug)]
pub enum Fpu {}

impl Maths<f32> for Libm {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }
    fn sin(x: f32) -> f32 {
        libm::sinf(x)
    }
    fn cos(x: f32) -> f32 {
        libm::cosf(x)
    }
    fn acos(x: f32) -> f32 {
        libm::acosf(x)
    }
    fn atan2(y: f32, x: f32) -> f32 {
        libm::atan2f(y, x)
    }
}

impl Maths<f64> for Libm {
    fn sqrt(x: f64) -> f64 {
        libm::sqrt(x)
    }
    fn sin(x: f64) -> f64 {
        libm::sin(x)
    }
    fn cos(x: f64) -> f64 {
        libm::cos(x)
    }
    fn acos(x: f64) -> f64 {
        libm::acos(x)
    }
    fn atan2(y: f64, x: f64) -> f64 {
        libm::atan2(y, x)
    }
}

impl Maths<f32> for Fpu {
    fn sqrt(x: f32) -> f32 {
        fmath::sqrt(x)
    }
    fn sin(x: f32) -> f32 {
        let square = x * x;
        x * (1.0 + square * (-1.0 / 6.0 + square * (1.0 / 120.0 + square * (-1.0 / 5_040.0 + square / 362_880.0))))
    }
    fn cos(x: f32) -> f32 {
        let square = x * x;
        let end = square * (1.0 / 40_320.0 - square / 3_628_800.0);
        1.0 + square * (-0.5 + square * (1.0 / 24.0 + square * (-1.0 / 720.0 + end)))
    }
    fn acos(x: f32) -> f32 {
        libm::acosf(x)
    }
    fn atan2(y: f32, x: f32) -> f32 {
        libm::atan2f(y, x)
    }
}

/// Inputs of the equations for one movement of the cup mill, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement<T> {
    /// M and N, two points of the stock line, in the frame at the tool's centre O.
    pub limits: [[T; 2]; 2],
    /// Radius of the circle that cuts: R or r, depending on the movement.
    pub edge_radius: T,
    /// Radius of the path of the tool's centre about the rotation centre: r or R, depending on the movement.
    pub path_radius: T,
    /// k: +1 if the outer circle cuts, -1 if the inner one does.
    pub advance: T,
    /// a, feed per tooth on the circumference.
    pub feed_per_tooth: T,
}

/// Result of the equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T> {
    /// s, feed per tooth at the centre, mm along the chord.
    pub chord: T,
    /// alpha, the same step as an angle about the rotation centre, rad.
    pub turn: T,
}

/// One pass through the source's loop, equations (8) to (29): the step of the tool's centre for one tooth, and the
/// points M and N of the stock line in the frame after the step.
pub fn tooth<T: Real, M: Maths<T>>(movement: &Movement<T>) -> (Step<T>, [[T; 2]; 2]) {
    let (step, next) = step::<T, M>(movement, line(movement.limits));
    let (cos, sin) = (M::cos(step.turn), M::sin(step.turn));
    let map = |[x, y]: [T; 2]| {
        let (x, y) = (x - next[0], y - next[1]); // (27)
        [cos * x + sin * y, cos * y - sin * x] // (28) (29)
    };
    (step, movement.limits.map(map))
}

/// Equations (8) to (10): A, B, C of the line through M and N.
pub fn line<T: Real>([[x_m, y_m], [x_n, y_n]]: [[T; 2]; 2]) -> [T; 3] {
    [y_n - y_m, -(x_n - x_m), x_n * y_m - x_m * y_n] // (8) (9) (10)
}

/// Equations (11) to (26): the step and the next tool centre O'; NaN where there is no solution.
pub fn step<T: Real, M: Maths<T>>(movement: &Movement<T>, line: [T; 3]) -> (Step<T>, [T; 2]) {
    let (x_b, y_b) = contact::<T, M>(movement, line);
    let theta = M::atan2(x_b, y_b);
    let x_c = (movement.edge_radius + movement.advance * movement.feed_per_tooth) * M::sin(theta); // (17)
    let y_c = (movement.edge_radius + movement.advance * movement.feed_per_tooth) * M::cos(theta); // (18)
    let (x, y) = next_center::<T, M>(movement, x_c, y_c);
    let chord = M::sqrt(x * x + y * y); // (25)
    let radius = movement.path_radius;
    let turn = M::acos(T::from(1) - chord * chord / (T::from(2) * radius * radius)); // (26)
    (Step { chord, turn }, [x, y])
}

fn contact<T: Real, M: Maths<T>>(movement: &Movement<T>, [a, b, c]: [T; 3]) -> (T, T) {
    let (x1, y1, r0) = (T::from(0), T::from(0), movement.edge_radius);
    let delta = r0 * r0 * (a * a + b * b) - (a * x1 + b * y1 + c) * (a * x1 + b * y1 + c); // (15)
    let root = M::sqrt(delta);
    let x = (b * b * x1 - a * b * y1 - a * c + b * root) / (a * a + b * b); // (11)
    let y = (a * a * y1 - a * b * x1 - b * c - a * root) / (a * a + b * b); // (12)
    let x_other = (b * b * x1 - a * b * y1 - a * c - b * root) / (a * a + b * b); // (13)
    let y_other = (a * a * y1 - a * b * x1 - b * c + a * root) / (a * a + b * b); // (14)
    let admissible = |x: T, y: T| movement.advance * x > T::from(0) && y >= T::from(0);
    let thicker_chip = movement.advance * x > movement.advance * x_other;
    // The one that advances, on the rotation centre's side; of two the one with the thicker chip. (16)
    if admissible(x, y) && (thicker_chip || !admissible(x_other, y_other)) { (x, y) } else { (x_other, y_other) }
}

fn next_center<T: Real, M: Maths<T>>(movement: &Movement<T>, x_c: T, y_c: T) -> (T, T) {
    let (x1, y1, r1) = (T::from(0), movement.path_radius, movement.path_radius);
    let (x2, y2, r2) = (x_c, y_c, movement.edge_radius);
    let two = T::from(2);
    let square = |v: T| v * v;
    let apart = square(x1 - x2) + square(y1 - y2);
    let root = M::sqrt(-(apart - square(r1 - r2)) * (apart - square(r1 + r2))); // (23)
    let below = two * square(x1 - x2) + two * square(y1 - y2);
    let x_terms = -(x1 - x2) * (r1 * r1 - r2 * r2 - x1 * x1 + x2 * x2) + (x1 + x2) * square(y1 - y2);
    let y_terms = -(y1 - y2) * (r1 * r1 - r2 * r2 - y1 * y1 + y2 * y2) + (y1 + y2) * square(x1 - x2);
    let x = (x_terms + (y1 - y2) * root) / below; // (19)
    let y = (y_terms - (x1 - x2) * root) / below; // (20)
    let x_other = (x_terms - (y1 - y2) * root) / below; // (21)
    let y_other = (y_terms + (x1 - x2) * root) / below; // (22)
    // The forward one with the smaller turn. (24)
    let nearer = x * x + y * y < x_other * x_other + y_other * y_other;
    if nearer { (x, y) } else { (x_other, y_other) }
}

/// The same result as [`tooth`] with fewer instructions: it computes one intersection instead of two, coordinates
/// instead of angles, and no function except square roots.
pub fn lean_tooth<T: Real, M: Maths<T>>(movement: &Movement<T>) -> (Step<T>, [[T; 2]; 2]) {
    let Movement { limits, edge_radius: r0, path_radius: rho, advance, feed_per_tooth } = *movement;
    let [a, b, c] = line(limits);
    let (square, zero) = (a * a + b * b, T::from(0));
    let root = M::sqrt(r0 * r0 * square - c * c);
    let half = if advance * b > zero { root } else { -root };
    // C lies behind B as seen from O. (11) to (18)
    let scale = (r0 + advance * feed_per_tooth) / (r0 * square);
    let (x_c, y_c) = ((b * half - a * c) * scale, (-b * c - a * half) * scale);
    // From the rotation centre to C; O' lies on the side of that line on which O does. (19) to (24)
    let v = y_c - rho;
    let apart = x_c * x_c + v * v;
    let along = (rho * rho - r0 * r0 + apart) / (apart + apart);
    let across = M::sqrt(rho * rho / apart - along * along);
    let across = if x_c > zero { -across } else { across };
    let (x, y) = (along * x_c - across * v, rho + along * v + across * x_c);
    let chord = M::sqrt(x * x + y * y); // (25)
    let half_turn = chord / (rho + rho);
    // Twice the arcsine of a small number. (26)
    let turn = (half_turn + half_turn) * (T::from(1) + half_turn * half_turn / T::from(6));
    let (cos, sin) = (T::from(1) - y / rho, x / rho);
    let map = |[x_m, y_m]: [T; 2]| {
        let (x_m, y_m) = (x_m - x, y_m - y); // (27)
        [cos * x_m + sin * y_m, cos * y_m - sin * x_m] // (28) (29)
    };
    (Step { chord, turn }, limits.map(map))
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_law::step::Cut;
    use arcfeed_model::tool::Edge;
    use arcfeed_units::{Mm, MmPerTooth};

    /// The published tool on a line that it meets at `contact_deg` and on the side that recedes.
    fn movement(edge: Edge, contact_deg: f64) -> Movement<f64> {
        let (rho, r0) = (128.576, if edge == Edge::Outer { 128.576 } else { 112.701 });
        let k = f64::from(edge.advance());
        let (sin, cos) = libm::sincos(contact_deg.to_radians());
        let (normal_x, normal_y) = libm::sincos((0.5 * contact_deg - 5.0).to_radians());
        let along = |mm: f64| [k * (r0 * sin - normal_y * mm), r0 * cos + normal_x * mm];
        Movement {
            limits: [along(-150.0), along(40.0)],
            edge_radius: r0,
            path_radius: rho,
            advance: k,
            feed_per_tooth: 0.1016,
        }
    }

    fn law(edge: Edge, movement: &Movement<f64>, contact_deg: f64) -> f64 {
        let cut = Cut {
            path_radius: Mm(movement.path_radius as f32),
            edge_radius: Mm(movement.edge_radius as f32),
            edge,
            feed_per_tooth: MmPerTooth(movement.feed_per_tooth as f32),
        };
        let (sin, cos) = libm::sincos(contact_deg.to_radians());
        f64::from(cut.path_per_tooth((movement.advance * sin) as f32, cos as f32).expect("a demand").0)
    }

    #[test]
    fn the_equations_in_f64_agree_with_the_firmwares_law() {
        for edge in [Edge::Outer, Edge::Inner] {
            for contact_deg in [20.0, 40.0, 60.0, 80.0] {
                let movement = movement(edge, contact_deg);
                let (Step { chord, turn }, _) = tooth::<f64, Libm>(&movement);
                let path = law(edge, &movement, contact_deg);
                assert!((turn * movement.path_radius / path - 1.0).abs() < 1e-5, "{edge:?} {contact_deg}: {turn}");
                assert!((chord / path - 1.0).abs() < 1e-5, "{edge:?} {contact_deg}: {chord} {path}");
            }
        }
    }

    #[test]
    fn written_leanly_the_loop_is_the_same() {
        for edge in [Edge::Outer, Edge::Inner] {
            for contact_deg in [20.0, 40.0, 60.0, 80.0] {
                let movement = movement(edge, contact_deg);
                let (printed, lean) = (tooth::<f64, Libm>(&movement), lean_tooth::<f64, Libm>(&movement));
                assert!((lean.0.chord / printed.0.chord - 1.0).abs() < 1e-9, "{edge:?} {contact_deg}");
                assert!((lean.0.turn / printed.0.turn - 1.0).abs() < 1e-9, "{edge:?} {contact_deg}");
                for (lean, printed) in lean.1.as_flattened().iter().zip(printed.1.as_flattened()) {
                    assert!((lean - printed).abs() < 1e-9, "{edge:?} {contact_deg}: {lean} {printed}");
                }
            }
        }
    }

    #[test]
    fn sine_and_cosine_in_single_precision_hold_within_a_right_angle() {
        for step in -100..=100 {
            let angle = core::f64::consts::FRAC_PI_2 * f64::from(step) / 100.0;
            let (sin, cos) = libm::sincos(angle);
            let off = |ours: f32, truth: f64| (f64::from(ours) - truth).abs();
            assert!(off(Fpu::sin(angle as f32), sin) < 4e-6 && off(Fpu::cos(angle as f32), cos) < 4e-6, "{angle}");
        }
    }

    #[test]
    fn the_rotation_centre_lies_straight_ahead_of_every_frame() {
        for edge in [Edge::Outer, Edge::Inner] {
            let before = movement(edge, 50.0);
            let (_, after) = tooth::<f64, Libm>(&before);
            let from_center = |[x, y]: [f64; 2]| libm::hypot(x, y - before.path_radius);
            for (one, other) in before.limits.into_iter().zip(after) {
                assert!((from_center(one) - from_center(other)).abs() < 1e-9, "{edge:?} {one:?} {other:?}");
            }
        }
    }
}
