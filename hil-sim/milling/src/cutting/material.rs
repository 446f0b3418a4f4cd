//! Cutting force models: force of a workpiece material on an edge that cuts it.
//!
//! For a chip of thickness h and width b, each of the three directions has its own
//!
//! ```text
//! F = k b h^(1 - m)        h in mm, k in N/mm2 for h = 1 mm, b = 1 mm      (1) Kienzle
//! F = k b h + e b          e in N/mm: what the edge takes by rubbing       (2) linear
//! ```
//!
//! and no force outside the cut (h <= 0), where the edge does not touch material. Radial and axial forces have
//! coefficients of their own, or a ratio of the tangential ones.
//!
//! Source: (1) O. Kienzle, 1952, as catalogues use it; (2) the linear edge model of E. Budak, Y. Altintas, E. J. A.
//! Armarego, 1996 (recalled). Each constant names its source; docs/forces.md shows how far sources differ.

/// Cross-section of the chip in front of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipSection {
    /// Thickness h, along the edge's normal.
    pub thickness_mm: f64,
    /// Width b in the plane of axis and radius, so that h b is the section.
    pub width_mm: f64,
}

impl ChipSection {
    /// One chip that replaces two adjacent ones: with their total width, and the thickness that gives their total section.
    pub fn with(&self, other: &ChipSection) -> Self {
        let width_mm = self.width_mm + other.width_mm;
        let section_mm2 = self.thickness_mm * self.width_mm + other.thickness_mm * other.width_mm;
        ChipSection { thickness_mm: section_mm2 / width_mm, width_mm }
    }
}

/// Force of the workpiece on an edge, as components along the edge's own directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EdgeForce {
    /// Component against the motion of the edge.
    pub tangential_n: f64,
    /// Component along the inward normal, away from the material.
    pub radial_n: f64,
    /// Component along the edge towards the tip; with a right-hand helix it pulls the tool out of its holder.
    pub axial_n: f64,
}

/// Kienzle's specific cutting force for one of the directions tangential, radial, axial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kienzle {
    /// k of (1): kc1.1 for the tangential direction.
    pub specific_mpa: f64,
    /// m of (1): mc for the tangential direction.
    pub exponent_ratio: f64,
}

/// Linear force model for one of the directions tangential, radial, axial: cutting and edge coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// k of (2).
    pub specific_mpa: f64,
    /// e of (2).
    pub edge_n_per_mm: f64,
}

/// Cutting force model for the tangential, radial and axial direction, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cutting {
    /// Kienzle's model (1).
    Kienzle([Kienzle; 3]),
    /// Linear edge model (2).
    Linear([Linear; 3]),
}

impl Cutting {
    /// Force of the workpiece on an edge with this chip; zero without a chip.
    pub fn force(&self, chip: &ChipSection) -> EdgeForce {
        let (h_mm, b_mm) = (chip.thickness_mm, chip.width_mm);
        if !(h_mm > 0.0 && b_mm > 0.0) {
            return EdgeForce::default();
        }
        let [tangential_n, radial_n, axial_n] = match self {
            Cutting::Kienzle(each) => {
                let softer = |exponent_ratio: f64| libm::pow(h_mm, 1.0 - exponent_ratio);
                let tangential_ratio = each[0].exponent_ratio;
                let of_tangential = softer(tangential_ratio);
                // Most materials have one exponent in all directions.
                each.map(|k| {
                    let is_same = k.exponent_ratio == tangential_ratio;
                    k.specific_mpa * b_mm * if is_same { of_tangential } else { softer(k.exponent_ratio) } // (1)
                })
            }
            Cutting::Linear(each) => each.map(|k| (k.specific_mpa * h_mm + k.edge_n_per_mm) * b_mm), // (2)
        };
        EdgeForce { tangential_n, radial_n, axial_n }
    }

    /// Linear model from the usual lists: Ktc, Krc, Kac in N/mm2, then Kte, Kre, Kae in N/mm.
    pub const fn linear(cutting: [f64; 3], edge: [f64; 3]) -> Self {
        Cutting::Linear([
            Linear { specific_mpa: cutting[0], edge_n_per_mm: edge[0] },
            Linear { specific_mpa: cutting[1], edge_n_per_mm: edge[1] },
            Linear { specific_mpa: cutting[2], edge_n_per_mm: edge[2] },
        ])
    }
}

impl Kienzle {
    /// Kienzle model from a catalogue's tangential coefficient; the radial and axial coefficients are these fractions of it, with the
    /// same exponent.
    pub fn with_ratios(self, radial_ratio: f64, axial_ratio: f64) -> Cutting {
        let part = |ratio: f64| Kienzle { specific_mpa: self.specific_mpa * ratio, ..self };
        Cutting::Kienzle([self, part(radial_ratio), part(axial_ratio)])
    }
}

/// Workpiece material of the ISCAR catalogue with its specific cutting force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatalogueMaterial {
    /// Common name.
    pub name: &'static str,
    /// Number of the material group in VDI 3323.
    pub group: u8,
    /// Coefficient of the tangential direction. Other catalogues differ by 35 % either way.
    pub tangential: Kienzle,
}

impl CatalogueMaterial {
    const fn new(name: &'static str, group: u8, specific_mpa: f64, exponent_ratio: f64) -> Self {
        CatalogueMaterial { name, group, tangential: Kienzle { specific_mpa, exponent_ratio } }
    }
}

/// Tangential coefficients. Source: ISCAR, turning catalogue 2017, p. 558, by groups of VDI 3323; it does not give rake
/// angle and wear. The catalogue names conditions only; the assignment of alloys to groups is common knowledge.
pub const MATERIALS: [CatalogueMaterial; 11] = [
    CatalogueMaterial::new("Ti-6Al-4V", 37, 2110.0, 0.22),
    CatalogueMaterial::new("titanium, pure", 36, 1700.0, 0.23),
    CatalogueMaterial::new("Inconel 718, aged", 34, 3300.0, 0.24),
    CatalogueMaterial::new("Al 6061-T6, 7075-T6", 22, 800.0, 0.25),
    CatalogueMaterial::new("AlSi cast, up to 12 % Si, cured", 24, 700.0, 0.25),
    CatalogueMaterial::new("steel below 0.25 % C, annealed", 1, 1350.0, 0.21),
    CatalogueMaterial::new("steel from 0.25 % C, annealed (C45)", 2, 1500.0, 0.22),
    CatalogueMaterial::new("low-alloy steel, quenched and tempered, 275 HB (42CrMo4)", 7, 1675.0, 0.24),
    CatalogueMaterial::new("low-alloy steel, quenched and tempered, 350 HB", 9, 1800.0, 0.24),
    CatalogueMaterial::new("stainless steel, martensitic", 12, 1875.0, 0.21),
    CatalogueMaterial::new("stainless steel, austenitic", 14, 2150.0, 0.20),
];

/// Al 7075-T6, linear; cemented carbide, dry. Source: Chinese Journal of Mechanical Engineering 34, 2021, doi
/// 10.1186/s10033-021-00536-9, table 5 (its reference 190), which prints N mm where N/mm is meant. For 7075 alone the same table
/// has Ktc from 600 to 1319 N/mm2.
pub const AL_7075_T6: Cutting = Cutting::linear([767.01, 168.8, 222.0], [27.7, 26.6, 0.7]);

/// Al 6082-T6, linear; tool of cemented carbide, dry. Source: table 5 of the paper named at [`AL_7075_T6`] (its reference 189).
pub const AL_6082_T6: Cutting = Cutting::linear([631.0, 99.0, 273.0], [13.0, 10.0, 2.8]);

/// Ti-6Al-4V with a right-hand helix of 30 degrees, linear. Not verified: recalled from text-books, no page was at hand, and an
/// oblique transformation of recalled orthogonal data gives 1510, 215, 515 N/mm2 instead. For tests and demonstrations.
pub const TI_6AL_4V_HELIX_30: Cutting = Cutting::linear([1825.0, 770.0, 735.0], [29.7, 55.7, 1.8]);
