//! Ten-node tetrahedron: shape functions, their derivatives, and integration points.
//!
//! Reference coordinates r, s, t run from the first corner along the edges to the other three; L0 = 1 - r - s - t, L1 =
//! r, L2 = s, L3 = t. The corners come first, then the middles of [`EDGES`]:
//!
//! ```text
//! N_i = L_i (2 L_i - 1)     corners                                              (1)
//! N_e = 4 L_i L_j           the middle of the edge from corner i to corner j     (2)
//! ```
//!
//! Source: Zienkiewicz, Taylor, Zhu, The Finite Element Method, 6th ed., chapters 4 (functions) and 5 (four points); fourteen
//! points: Walkington, Quadrature on simplices of arbitrary dimension, 2000 (exact to degree 5, all weights positive).

/// Number of nodes of an element.
pub const NODES: usize = 10;

/// Pairs of corners between which the nodes 4 to 9 are, in this order.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// Reference (natural) coordinates r, s, t of a point in an element.
pub type NaturalCoordinates = [f64; 3];

/// The middle of the reference element.
pub const MIDDLE: NaturalCoordinates = [0.25; 3];

/// Integration point, with its fraction of the reference element's volume, 1/6 in all.
pub type Point = (NaturalCoordinates, f64);

/// Barycentric coordinates L0 to L3 of a point.
pub fn barycentric(place: NaturalCoordinates) -> [f64; 4] {
    [1.0 - place[0] - place[1] - place[2], place[0], place[1], place[2]]
}

/// Reference coordinates of the nodes.
pub fn nodes() -> [NaturalCoordinates; NODES] {
    let mut places = [[0.0; 3]; NODES];
    for corner in 1..4 {
        places[corner][corner - 1] = 1.0;
    }
    for (edge, [i, j]) in EDGES.into_iter().enumerate() {
        places[4 + edge] = std::array::from_fn(|k| 0.5 * (places[i][k] + places[j][k]));
    }
    places
}

/// The ten shape functions at a point, inside the element or not.
pub fn functions(place: NaturalCoordinates) -> [f64; NODES] {
    let l = barycentric(place);
    let mut n = [0.0; NODES];
    for corner in 0..4 {
        n[corner] = l[corner] * (2.0 * l[corner] - 1.0); // (1)
    }
    for (edge, [i, j]) in EDGES.into_iter().enumerate() {
        n[4 + edge] = 4.0 * l[i] * l[j]; // (2)
    }
    n
}

/// Derivatives of the shape functions by r, s and t.
pub fn derivatives(place: NaturalCoordinates) -> [[f64; 3]; NODES] {
    const OF_L: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let l = barycentric(place);
    let mut d = [[0.0; 3]; NODES];
    for k in 0..3 {
        for corner in 0..4 {
            d[corner][k] = (4.0 * l[corner] - 1.0) * OF_L[corner][k]; // (1)
        }
        for (edge, [i, j]) in EDGES.into_iter().enumerate() {
            d[4 + edge][k] = 4.0 * (l[i] * OF_L[j][k] + l[j] * OF_L[i][k]); // (2)
        }
    }
    d
}

/// Integration rule of four points, exact to degree 2: the degree of the stiffness of an element with straight edges.
pub fn four_points() -> [Point; 4] {
    const NEAR: f64 = 0.585_410_196_624_968_5;
    const FAR: f64 = 0.138_196_601_125_010_5;
    let weight = 1.0 / 24.0;
    [([FAR; 3], weight), ([NEAR, FAR, FAR], weight), ([FAR, NEAR, FAR], weight), ([FAR, FAR, NEAR], weight)]
}

/// Integration rule of 14 points, exact to degree 5: the mass of an element with straight edges is of degree 4.
pub fn fourteen_points() -> [Point; 14] {
    const CORNERS: [[f64; 2]; 2] = [
        [0.310_885_919_263_300_6, 0.112_687_925_718_015_85 / 6.0],
        [0.092_735_250_310_891_23, 0.073_493_043_116_361_95 / 6.0],
    ];
    const EDGE: [f64; 2] = [0.045_503_704_125_649_65, 0.042_546_020_777_081_47 / 6.0];
    let mut points = [(MIDDLE, 0.0); 14];
    for (set, [a, weight]) in CORNERS.into_iter().enumerate() {
        for corner in 0..4 {
            let mut l = [a; 4];
            l[corner] = 1.0 - 3.0 * a;
            points[4 * set + corner] = ([l[1], l[2], l[3]], weight);
        }
    }
    for (edge, [i, j]) in EDGES.into_iter().enumerate() {
        let mut l = [EDGE[0]; 4];
        l[i] = 0.5 - EDGE[0];
        l[j] = 0.5 - EDGE[0];
        points[8 + edge] = ([l[1], l[2], l[3]], EDGE[1]);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// Largest error of a rule over all monomials of a degree, against i! j! k! / (i + j + k + 3)!.
    fn error_ratio(points: &[Point], degree: i32) -> f64 {
        let mut worst: f64 = 0.0;
        for i in 0..=degree {
            for j in 0..=degree - i {
                let k = degree - i - j;
                let exact = factorial(i) * factorial(j) * factorial(k) / factorial(degree + 3);
                let sum: f64 = points.iter().map(|(p, w)| w * p[0].powi(i) * p[1].powi(j) * p[2].powi(k)).sum();
                worst = worst.max((sum / exact - 1.0).abs());
            }
        }
        worst
    }

    #[test]
    fn rules_are_exact_to_their_degree_and_no_further() {
        for degree in 0..=5 {
            assert!(error_ratio(&fourteen_points(), degree) < 1e-13, "14 points, degree {degree}");
            assert_eq!(error_ratio(&four_points(), degree) < 1e-13, degree <= 2, "4 points, degree {degree}");
        }
        assert!(error_ratio(&fourteen_points(), 6) > 1e-6);
    }

    #[test]
    fn each_function_is_one_at_its_node_and_zero_at_the_others() {
        for (at, place) in nodes().into_iter().enumerate() {
            for (of, value) in functions(place).into_iter().enumerate() {
                assert_eq!(value, if at == of { 1.0 } else { 0.0 }, "function {of} at node {at}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_functions() {
        let (place, step) = ([0.2, 0.3, 0.15], 1e-4);
        for k in 0..3 {
            let at = |way: f64| {
                let mut moved = place;
                moved[k] += way;
                functions(moved)
            };
            // A central difference of a quadratic is exact but for rounding.
            let (ahead, behind) = (at(step), at(-step));
            for (node, d) in derivatives(place).iter().enumerate() {
                assert!(((ahead[node] - behind[node]) / (2.0 * step) - d[k]).abs() < 1e-11);
            }
        }
    }
}
