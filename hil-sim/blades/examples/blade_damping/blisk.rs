//! One of 56 blades on their disk, and the same blade clamped at its foot.
//!
//! The pass has its own frame: along the chord against the disk's axis, through the thickness, outwards from the rim.

use std::f64::consts::FRAC_PI_2;
use std::time::Instant;

use arcfeed_blades::blade::Blade;
use arcfeed_blades::cyclic::Sector;
use arcfeed_blades::disk::{BladedDisk, SectorCells};
use arcfeed_blades::disk_field::DiskField;
use arcfeed_fe::material::TITANIUM_6AL_4V;
use arcfeed_modal::flexible::Modal;
use arcfeed_modal::modal_point::ModalPoint;

use crate::bench::{Bench, Damping, Failure, blade_alone};
use crate::{FINENESS, STEPOVER_MM, print_outcome};

const MODES: usize = 180;

const DISK: BladedDisk = BladedDisk {
    sectors: 56,
    bore_radius_mm: 120.0,
    rim_radius_mm: 190.0,
    width_mm: 80.0,
    span_mm: 75.0,
    taper_ratio: 0.8,
    twist_rad: 0.0,
    cells: SectorCells { around: [2, 1], along: 5, outwards: [2, 7] },
};

/// The disk in the frame of the pass.
#[derive(Debug)]
struct Blisk {
    disk: DiskField,
}

impl Modal for Blisk {
    fn omega_rad_per_s(&self) -> &[f64] {
        self.disk.omega_rad_per_s()
    }

    fn reach_mm(&self) -> f64 {
        self.disk.reach_mm()
    }

    fn evaluate_at(&self, [x_mm, y_mm, z_mm]: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) {
        self.disk.evaluate_at([DISK.rim_radius_mm + z_mm, y_mm, -x_mm], beyond_mm, modal_point);
        modal_point.shapes.iter_mut().for_each(|shape| *shape = [-shape[2], shape[1], shape[0]]);
    }
}

/// The disk's blade by itself, with the same sides.
fn blade() -> Blade {
    let [gap, half] = DISK.cells.around;
    let pitch_mm = 4.0 * FRAC_PI_2 / DISK.sectors as f64 * DISK.rim_radius_mm;
    let thickness_mm = pitch_mm * half as f64 / (gap + half) as f64;
    let tapered = |foot_mm: f64| [foot_mm, foot_mm * DISK.taper_ratio];
    Blade {
        chord_mm: tapered(DISK.width_mm),
        thickness_mm: tapered(thickness_mm),
        ..Blade::plate(DISK.span_mm, 1.0, 1.0)
    }
}

/// Runs the same passes on the blade alone and on the whole disk, and prints the processing times.
pub fn compare(dampings: &[Damping]) -> Result<(), Failure> {
    let sector = Sector::new(DISK.sector()?, DISK.sectors, &TITANIUM_6AL_4V)?;
    let hub = sector.body().mesh().nodes_where(BladedDisk::is_hub);
    let begin = Instant::now();
    let waves = sector.modes(&hub, MODES)?;
    eprintln!("{MODES} modes in {:.1} s", begin.elapsed().as_secs_f64());
    let disk = DiskField::new(&sector, &waves, 2.0);
    let alone = Bench::new(blade_alone(&blade(), 2.0)?, blade(), STEPOVER_MM, FINENESS)?;
    let whole = Bench::new(Blisk { disk }, blade(), STEPOVER_MM, FINENESS)?;
    let hz = |omegas: &[f64]| -> Vec<String> {
        let places = [0, 1, 2, 55, 56, 111, 112, omegas.len() - 1];
        places.iter().filter_map(|at| Some(format!("{:.0}", omegas.get(*at)? / (4.0 * FRAC_PI_2)))).collect()
    };
    println!("blade of the disk alone, modes 1, 2, 3, 10: {} Hz", hz(alone.body.omega_rad_per_s()).join(", "));
    println!("disk, modes 1, 2, 3, 56, 57, 112, 113, 180: {} Hz", hz(whole.body.omega_rad_per_s()).join(", "));
    for damping in dampings {
        // One after the other: their times are compared.
        let begin = Instant::now();
        let of_alone = alone.run(*damping)?;
        let between = Instant::now();
        let of_whole = whole.run(*damping)?;
        let times_s = [between.duration_since(begin), between.elapsed()].map(|time| time.as_secs_f64());
        print_outcome("blade alone", damping, &of_alone);
        print_outcome("whole disk", damping, &of_whole);
        eprintln!("{:.2} s and {:.2} s, ratio {:.2}", times_s[0], times_s[1], times_s[1] / times_s[0]);
    }
    Ok(())
}
