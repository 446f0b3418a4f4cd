//! Numbering of coupled points, such that all couplings are near the diagonal.
//!
//! Reverse Cuthill-McKee: outwards from a point at the end of the body, layer by layer, points with few neighbours
//! first; then reversed. Source: George, Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981,
//! chapter 4.

/// New number of each point. `neighbours` must list both directions of each pair; a point may be among its own
/// neighbours.
pub fn reverse_cuthill_mckee(neighbours: &[Vec<usize>]) -> Vec<usize> {
    let mut is_reached = vec![false; neighbours.len()];
    let mut order = Vec::with_capacity(neighbours.len());
    for start in 0..neighbours.len() {
        if !is_reached[start] {
            let start = far_end(neighbours, start);
            order.extend(outwards(neighbours, start, &mut is_reached).0);
        }
    }
    let mut places = vec![0; neighbours.len()];
    for (place, old) in order.into_iter().rev().enumerate() {
        places[old] = place;
    }
    places
}

/// All points connected with `start`, layer by layer, and the number of layers.
fn outwards(neighbours: &[Vec<usize>], start: usize, is_reached: &mut [bool]) -> (Vec<usize>, usize) {
    let mut order = vec![start];
    is_reached[start] = true;
    let (mut layers, mut from) = (0, 0);
    while from < order.len() {
        let end = order.len();
        for at in from..end {
            let mut next: Vec<usize> = neighbours[order[at]].iter().copied().filter(|to| !is_reached[*to]).collect();
            next.sort_by_key(|to| neighbours[*to].len());
            for to in next {
                // Lists may name a neighbour twice.
                if !std::mem::replace(&mut is_reached[to], true) {
                    order.push(to);
                }
            }
        }
        (from, layers) = (end, layers + 1);
    }
    (order, layers)
}

/// Point with the most layers, found by repeated search from the far end.
fn far_end(neighbours: &[Vec<usize>], start: usize) -> usize {
    let (mut best, mut most) = (start, 0);
    loop {
        let mut is_reached = vec![false; neighbours.len()];
        let (order, layers) = outwards(neighbours, best, &mut is_reached);
        if layers <= most {
            return best;
        }
        most = layers;
        best = *order.last().unwrap_or(&best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shuffled_chain_is_in_order_again() {
        // Point 7 i mod 20 follows 7 (i - 1) mod 20.
        let mut neighbours = vec![Vec::new(); 20];
        for i in 0..19 {
            let (a, b) = (7 * i % 20, 7 * (i + 1) % 20);
            neighbours[a].push(b);
            neighbours[b].push(a);
        }
        let places = reverse_cuthill_mckee(&neighbours);
        for (point, others) in neighbours.iter().enumerate() {
            assert!(others.iter().all(|other| places[*other].abs_diff(places[point]) == 1));
        }
    }

    #[test]
    fn unconnected_parts_are_all_numbered() {
        let mut places = reverse_cuthill_mckee(&[vec![1, 1], vec![0], vec![], vec![4], vec![3]]);
        places.sort_unstable();
        assert_eq!(places, [0, 1, 2, 3, 4]);
    }
}
