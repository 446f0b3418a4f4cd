//! Minimum of a function over a rectangle, and zero of a function on a line.
//!
//! ```text
//! f(x + d) = f + g.d + d.H.d / 2,  d = -(H + damping)^-1 g                    (1)
//! ```
//!
//! g and H come from differences over a stencil whose spacing shrinks where it finds nothing better, so that kinks and
//! borders slow the search down, but do not mislead it.

/// Place and value of a minimum of a function of two variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Place.
    pub at: [f64; 2],
    /// Value.
    pub value: f64,
}

/// Place and value of a function of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Place.
    pub at: f64,
    /// Value.
    pub value: f64,
}

/// Steps of a search.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// First steps in both directions.
    pub first: [f64; 2],
    /// Last steps, relative to the first.
    pub finest: f64,
}

/// Last steps of a search that exhausts the accuracy of its function, relative to the first.
pub const FINEST: f64 = 1e-6;
/// Limit of the rounds, more than a search needs.
const ROUNDS_MAX: usize = 2000;

/// Local minimum of a function of two variables near `start`, within `ranges`; the first steps are `spacing` wide.
pub fn descend(ranges: [[f64; 2]; 2], start: Minimum, spacing: [f64; 2], f: impl Fn([f64; 2]) -> f64) -> Minimum {
    descend_to(ranges, start, Steps { first: spacing, finest: FINEST }, f)
}

/// Local minimum of a function of two variables near `start`, within `ranges`, by a search in these steps.
pub fn descend_to(ranges: [[f64; 2]; 2], start: Minimum, steps: Steps, f: impl Fn([f64; 2]) -> f64) -> Minimum {
    let evaluate = |best: Minimum, places: &mut [Minimum]| {
        for k in 0..places.len() {
            // At a border several neighbours coincide.
            let known = places[..k].iter().chain([&best]).find(|known| known.at == places[k].at);
            places[k].value = known.map_or_else(|| f(places[k].at), |known| known.value);
        }
    };
    let inside = |at: [f64; 2]| [at[0].clamp(ranges[0][0], ranges[0][1]), at[1].clamp(ranges[1][0], ranges[1][1])];
    let mut best = start;
    let mut scale = 1.0;
    for _ in 0..ROUNDS_MAX {
        if scale < steps.finest {
            break;
        }
        let step = steps.first.map(|width| width * scale);
        let around =
            |[i, j]: [f64; 2]| Minimum { at: inside([best.at[0] + i * step[0], best.at[1] + j * step[1]]), ..best };
        // Along one line only the neighbours on it are used.
        let count = if step[1] > 0.0 { NEIGHBOURS.len() } else { 2 };
        let mut stencil = NEIGHBOURS.map(around);
        let stencil = &mut stencil[..count];
        evaluate(best, stencil);
        let mut newton = newton(best.value, stencil).map(around);
        evaluate(best, newton.as_mut_slice());
        let found = stencil.iter().copied().chain(newton).min_by(|a, b| a.value.total_cmp(&b.value)).unwrap_or(best);
        if found.value < best.value {
            best = found;
            scale *= 1.3;
        } else {
            scale *= 0.3;
        }
    }
    best
}

/// Zero of a function between `below`, where it is negative, and `above`, where it is not. At the place found the function is not negative, and either its
/// value is less than `precision`, or it is negative somewhere nearer than `precision`. Regula falsi with halved ends (Illinois) towards half the precision;
/// where two steps do not halve the range, as at a jump, its middle is next.
///
/// Source: Dowell, Jarratt, A modified regula falsi method for computing the root of an equation, BIT 11 (1971).
pub fn crossing(mut below: Sample, mut above: Sample, precision: f64, f: impl Fn(f64) -> f64) -> f64 {
    let mut weights = [1.0; 2];
    let mut last_is_below = None;
    let mut width_before = f64::INFINITY;
    for round in 0.. {
        let width = libm::fabs(above.at - below.at);
        if above.value < precision || width < precision {
            break;
        }
        let is_slow = round % 2 == 1 && width > width_before / 2.0;
        if round % 2 == 1 {
            width_before = width;
        }
        let [low, high] = [below.value * weights[0], above.value * weights[1]].map(|value| value - precision / 2.0);
        let secant = above.at - (above.at - below.at) * high / (high - low);
        let is_between = (secant - below.at) * (above.at - secant) > 0.0;
        let at = if is_between && !is_slow { secant } else { f64::midpoint(below.at, above.at) };
        let here = Sample { at, value: f(at) };
        let is_below = here.value < 0.0;
        if is_below {
            (below, weights[0]) = (here, 1.0);
        } else {
            (above, weights[1]) = (here, 1.0);
        }
        // The end that stays a second time counts half.
        if last_is_below == Some(is_below) {
            weights[usize::from(is_below)] /= 2.0;
        }
        last_is_below = Some(is_below);
    }
    above.at
}

/// Stencil around a place, in its spacings: two pairs along the axes, one along each diagonal.
const NEIGHBOURS: [[f64; 2]; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];

/// Largest step of (1), in spacings of the stencil.
const FARTHEST: f64 = 8.0;

/// Step (1), in spacings of the stencil; `None` if the stencil has no values.
fn newton(middle: f64, stencil: &[Minimum]) -> Option<[f64; 2]> {
    if stencil.len() < NEIGHBOURS.len() {
        let (low, high) = (stencil[1].value, stencil[0].value);
        let curvature = libm::fabs(high + low - 2.0 * middle);
        let step = -(high - low) / 2.0 / curvature;
        return step.is_finite().then(|| [step.clamp(-FARTHEST, FARTHEST), 0.0]);
    }
    let at = |index: usize| stencil[index].value;
    let gradient = [(at(0) - at(1)) / 2.0, (at(2) - at(3)) / 2.0];
    let (xx, yy) = (at(0) + at(1) - 2.0 * middle, at(2) + at(3) - 2.0 * middle);
    let xy = (at(4) + at(5) - at(6) - at(7)) / 4.0;
    let damping = (libm::fabs(xx) + libm::fabs(yy)) * 1e-3;
    let (xx, yy) = (libm::fabs(xx) + damping, libm::fabs(yy) + damping);
    let determinant = xx * yy - xy * xy;
    let step =
        [(xy * gradient[1] - yy * gradient[0]) / determinant, (xy * gradient[0] - xx * gradient[1]) / determinant];
    let is_sound = determinant > 0.0 && step.iter().all(|part| part.is_finite());
    is_sound.then(|| step.map(|part| part.clamp(-FARTHEST, FARTHEST)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_is_found_within_the_precision_in_few_steps() {
        use core::cell::Cell;
        let found = |f: fn(f64) -> f64, [below, above]: [f64; 2]| {
            let count = Cell::new(0);
            let counted = |at: f64| {
                count.set(count.get() + 1);
                f(at)
            };
            let [below, above] = [below, above].map(|at| Sample { at, value: f(at) });
            (crossing(below, above, 1e-10, counted), count.get())
        };
        type Case = (fn(f64) -> f64, [f64; 2], f64, usize);
        let cases: [Case; 5] = [
            (|x| x * x - 2.0, [1.0, 2.0], core::f64::consts::SQRT_2, 7),
            // From above to below.
            (|x| libm::cos(x), [3.0, 0.0], core::f64::consts::FRAC_PI_2, 5),
            (|x| libm::exp(20.0 * x) - 5.0, [-1.0, 2.0], libm::log(5.0) / 20.0, 19),
            // At a jump the range is halved, if not each time.
            (|x| if x < 0.3 { -1e-3 } else { 7.0 }, [0.0, 1.0], 0.3, 102),
            (|x| if x < 0.3 { f64::NEG_INFINITY } else { f64::NAN }, [0.0, 1.0], 0.3, 40),
        ];
        for (f, ends, truth, most) in cases {
            let (at, count) = found(f, ends);
            assert!((at - truth).abs() < 1e-10 && count <= most, "{at} {truth} {count}");
            assert!(f(at) >= 0.0 || f(at).is_nan());
        }
    }
}
