//! Unknowns of the displacements of a node.

use arcfeed_fe::unknowns::Unknowns;

/// For each node and direction the unknown; none where it is clamped. Each displacement must be one unknown alone.
pub fn unknowns_of_nodes(unknowns: &Unknowns) -> Vec<[Option<usize>; 3]> {
    // Unknowns of 1, 2, 3 and so on show in the displacements.
    let numbers: Vec<f64> = (0..unknowns.count()).map(|unknown| (unknown + 1) as f64).collect();
    let of_node = |u: [f64; 3]| u.map(|u| (u as usize).checked_sub(1));
    unknowns.displacements(0, &numbers).into_iter().map(of_node).collect()
}
