//! A small plate and a small ball, for passes of a second.

use arcfeed_blades::blade::Blade;
use arcfeed_blades::finishing::pass::{FinishingPass, PassResolution, PassResult};
use arcfeed_blades::finishing::side::Side;
use arcfeed_fe::field::Field;
use arcfeed_milling::cutting::edges::EndMill;
use arcfeed_milling::cutting::material::MATERIALS;
use arcfeed_modal::dynamics::modal::Mode;
use nalgebra::Vector3;

pub const THICKNESS_MM: f64 = 1.5;
pub const FEED_MM_PER_TOOTH: f64 = 0.1;
pub const TOOTH_HZ: f64 = 180.0;

pub fn pass(blade: Blade, ray_mm: f64) -> FinishingPass {
    FinishingPass {
        side: Side::new(blade, 0.5),
        mill: EndMill { diameter_mm: 4.0, corner_mm: 2.0, teeth: 4, helix_rad: 30.0_f64.to_radians(), height_mm: 2.5 },
        allowance_mm: 0.1,
        stepover_mm: 0.2,
        feed_mm_per_tooth: FEED_MM_PER_TOOTH,
        tooth_hz: TOOTH_HZ,
        cutting: MATERIALS[0].tangential.with_ratios(0.4, 0.2),
        resolution: PassResolution { rise_mm: 0.2, ray_mm, steps: 300 },
    }
}

pub fn plate() -> Blade {
    Blade::plate(20.0, 8.0, THICKNESS_MM)
}

/// Only the tool is flexible, equally in both directions.
pub fn tool(frequency_hz: f64, damping_ratio: f64, stiffness_n_per_mm: f64) -> Vec<Mode> {
    let mode = |along| Mode::from_stiffness(frequency_hz, damping_ratio, stiffness_n_per_mm, &along).unwrap();
    vec![mode(Vector3::x()), mode(Vector3::y())]
}

pub fn run(pass: &FinishingPass, modes: Vec<Mode>) -> PassResult {
    pass.run::<Field>(modes, None).unwrap()
}
