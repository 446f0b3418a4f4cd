//! Number of finishing passes, and the step of contact points along them.
//!
//! ```text
//! J = ceil(max L_i / s) + 1,  steps L_i / (J - 1)                                                             (1)
//! q = rho +- r,  th = 2 acos(1 - tol/q),  between ball centres 2 q sin(th / 2),  along the surface rho th     (2)
//! ```
//!
//! with the lengths L_i of the cross lines, the stepover s, the ball's radius r and the surface's radius rho along the pass; the upper sign is for a
//! convex surface. The step (1) is constant along one cross line, not from line to line, as Feng et al. imply. A chord of the ball's centre gouges a
//! convex surface by the tolerance, and leaves it on a hollow one. (2) is ours; s from the cusp height is that of `plunge::step`.

/// Number and distances of passes over a patch of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassSpacing {
    /// Number of passes, J.
    pub passes: usize,
    /// Distance of neighbouring passes on the shortest cross line.
    pub least_mm: f64,
    /// Distance of neighbouring passes on the longest cross line.
    pub greatest_mm: f64,
}

/// Distance of neighbouring contact points along a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactChord {
    /// Distance between the positions of the ball's centre.
    pub centres_mm: f64,
    /// Distance along the surface.
    pub surface_mm: f64,
}

/// Passes at steps of at most `stepover_mm` over cross lines with these lengths; `None` without a line or a positive stepover.
pub fn pass_spacing(lengths_mm: &[f64], stepover_mm: f64) -> Option<PassSpacing> {
    let longest_mm = lengths_mm.iter().copied().fold(0.0, f64::max);
    let shortest_mm = lengths_mm.iter().copied().fold(f64::INFINITY, f64::min);
    if !(stepover_mm > 0.0 && longest_mm > 0.0 && longest_mm.is_finite()) {
        return None;
    }
    let steps = libm::ceil(longest_mm / stepover_mm).max(1.0); // (1)
    Some(PassSpacing { passes: steps as usize + 1, least_mm: shortest_mm / steps, greatest_mm: longest_mm / steps })
}

/// Longest chord along a surface with a curvature, positive if it is convex; `None` if the hollow is as narrow as the ball, or the tolerance is no
/// chord's. On a flat surface both are infinite.
pub fn contact_chord(ball_mm: f64, tolerance_mm: f64, curvature_per_mm: f64) -> Option<ContactChord> {
    if curvature_per_mm == 0.0 {
        return Some(ContactChord { centres_mm: f64::INFINITY, surface_mm: f64::INFINITY });
    }
    let rho_mm = 1.0 / curvature_per_mm;
    let centre_mm = rho_mm + ball_mm;
    if centre_mm * rho_mm <= 0.0 || tolerance_mm <= 0.0 {
        return None;
    }
    let ratio = tolerance_mm / centre_mm.abs();
    if ratio >= 1.0 {
        return None;
    }
    // acos(1 - x) = 2 asin(sqrt(x / 2)), without the cancellation of a small tolerance.
    let angle_rad = 4.0 * libm::asin(libm::sqrt(ratio / 2.0)); // (2)
    Some(ContactChord {
        centres_mm: 2.0 * centre_mm.abs() * libm::sin(angle_rad / 2.0),
        surface_mm: rho_mm.abs() * angle_rad,
    })
}
