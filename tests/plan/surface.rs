//! A blade's surface against the crate curvo 0.3.3, which evaluated it before: points and derivatives as computed by that crate.

use crate::published_rotor::ROTOR;

/// Sections of the rotor, u, v, then S, S_u, S_v, S_uu, S_uv and S_vv of its pressure side. Degrees across are 1, 2, 3 and 3.
const TEXT: &str = include_str!("surface.csv");

#[test]
fn points_and_derivatives_are_those_of_curvo_to_the_bit() {
    for line in TEXT.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(|word| word.parse().unwrap()).collect();
        let [sections, u, v, expected @ ..] = numbers.as_slice() else { panic!("{line}") };
        let [face, _] = ROTOR.sections(*sections as usize, 81).unwrap().faces().unwrap();
        let jet = face.jet(*u, *v);
        let found = [jet.point.coords, jet.u, jet.v, jet.uu, jet.uv, jet.vv];
        assert_eq!(found.iter().flatten().copied().collect::<Vec<f64>>(), expected, "{sections} sections, {u}, {v}");
        assert_eq!(face.point(*u, *v), jet.point);
        assert!(face.normal(*u, *v).cross(&jet.u.cross(&jet.v).normalize()).norm() < 1e-15);
    }
}
