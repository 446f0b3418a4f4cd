//! Minimum of a function over a rectangle.
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
