//! Isotropic elastic materials of parts and tools.

use arcfeed_units::T_PER_MM3_IN_KG_PER_M3;

/// A linear elastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticMaterial {
    /// Young's modulus.
    pub young_mpa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Density.
    pub density_kg_per_m3: f64,
}

/// Ti-6Al-4V, annealed: ASM (MatWeb, MTP643 and MTP644; the bar's own Poisson's ratio there is 0.33).
pub const TITANIUM_6AL_4V: ElasticMaterial =
    ElasticMaterial { young_mpa: 114e3, poisson_ratio: 0.342, density_kg_per_m3: 4430.0 };

/// Structural steel: EN 1993-1-1, 3.2.6, and EN 1991-1-1, table A.4.
pub const STEEL: ElasticMaterial = ElasticMaterial { young_mpa: 210e3, poisson_ratio: 0.3, density_kg_per_m3: 7850.0 };

/// Inconel 718 at room temperature, aged: Special Metals, publication SMC-045 (29.0e6 psi, 0.29, 0.297 lb/in3).
pub const INCONEL_718: ElasticMaterial =
    ElasticMaterial { young_mpa: 200e3, poisson_ratio: 0.29, density_kg_per_m3: 8220.0 };

/// Aluminium 7075-T6: ASM (10.4e6 psi, 0.33, 2.81 g/cm3).
pub const ALUMINIUM_7075: ElasticMaterial =
    ElasticMaterial { young_mpa: 71.7e3, poisson_ratio: 0.33, density_kg_per_m3: 2810.0 };

/// Materials by name.
pub const MATERIALS: [(&str, ElasticMaterial); 4] = [
    ("Ti-6Al-4V", TITANIUM_6AL_4V),
    ("structural steel", STEEL),
    ("Inconel 718", INCONEL_718),
    ("7075-T6", ALUMINIUM_7075),
];

impl ElasticMaterial {
    /// Density, t/mm3.
    pub fn density_t_per_mm3(&self) -> f64 {
        self.density_kg_per_m3 * T_PER_MM3_IN_KG_PER_M3
    }

    /// Lame's constants lambda and mu, MPa.
    pub fn lame_mpa(&self) -> [f64; 2] {
        let mu = self.young_mpa / (2.0 * (1.0 + self.poisson_ratio));
        [2.0 * mu * self.poisson_ratio / (1.0 - 2.0 * self.poisson_ratio), mu]
    }

    /// Whether the constants are physically possible.
    pub fn is_sound(&self) -> bool {
        self.young_mpa > 0.0 && self.density_kg_per_m3 > 0.0 && (0.0..0.5).contains(&self.poisson_ratio)
    }
}
