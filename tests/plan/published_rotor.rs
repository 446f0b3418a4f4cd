//! The 19-blade rotor that an independent program made, from its own file. Its axis is y.

use arcfeed_plan::geometry::blade::{RotorAxis, Sections};
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::generator::{Hand, Rotor};
use arcfeed_plan::vector::Point;

pub const TEXT: &str = include_str!("blisk_sections.csv");

/// The numbers it was made from.
pub const ROTOR: Rotor = Rotor {
    blades: 19,
    hub_radius_mm: 70.0,
    tip_radius_mm: 98.6,
    chord_mm: [26.0, 26.0],
    stagger_deg: [28.0, 42.0],
    camber_deg: [14.0, 10.0],
    thickness_ratio: [0.1, 0.055],
    edge_mm: 0.0,
    lean_deg: 0.0,
    hand: Hand::Right,
};

/// Least distance of neighbouring sections in their unrolled cylinder, as that program printed it: span and mm.
pub const GAPS_MM: [(f64, f64); 3] = [(0.0, 18.36128809940221), (0.5, 21.178754697149603), (1.0, 23.27208014514583)];

/// Sections in the part frame, read line by line without the crate's reader.
pub fn sections() -> Sections {
    let mut sections = Sections::default();
    for line in TEXT.lines().skip(1) {
        let words: Vec<&str> = line.split(',').collect();
        let number = |at: usize| words[at].parse::<f64>().unwrap();
        let side = if words[2] == "PS" { &mut sections.pressure } else { &mut sections.suction };
        if words[3] == "0" {
            side.push(Vec::new());
        }
        side.last_mut().unwrap().push(RotorAxis::Y.to_part([number(4), number(5), number(6)]));
    }
    sections
}

/// The rotor in its blank.
pub fn blisk() -> Blisk {
    rotor(&sections())
}

/// A rotor of 19 blades on the same hub.
pub fn rotor(sections: &Sections) -> Blisk {
    let [pressure, suction] = sections.faces().unwrap();
    let hub = Revolution { profile_mm: vec![[-20.0, 70.0], [20.0, 70.0]] };
    Blisk {
        blades: 19,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: 100.0, faces_mm: [-15.0, 15.0] },
    }
}

/// Greatest distance of two lists of points.
pub fn farthest_mm(one: &[Vec<Point>], other: &[Vec<Point>]) -> f64 {
    assert_eq!(one.len(), other.len());
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max)
}
