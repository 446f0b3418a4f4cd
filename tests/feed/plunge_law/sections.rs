//! Engaged sections of plunges beside earlier ones: by rays in closed form, and in layers of dexels.

use std::f64::consts::TAU;

use arcfeed_milling::cutting::engaged_section::{EngagedSection, is_above};
use arcfeed_milling::cutting::layer::Layer;
use nalgebra::Vector2;

use crate::plunge_law::table::{Row, rows};

const RAYS: usize = 72_000;
const ENGAGEMENT: &str = include_str!("an_engagement.csv");
const SEQUENCE: &str = include_str!("an_sequence.csv");

/// Earlier discs about [x, y] with a radius, and a half plane n.p <= offset.
struct Stock {
    discs: Vec<[f64; 3]>,
    half_plane: Option<[f64; 2]>,
}

impl Stock {
    fn of(row: &Row) -> Self {
        let disc = |group: Vec<f64>| [group[0], group[1], group[2]];
        let half_plane = row.groups("half_plane_angle_rad_offset").first().map(|group| [group[0], group[1]]);
        Stock { discs: row.groups("cut_discs_x_y_r").into_iter().map(disc).collect(), half_plane }
    }

    /// Parts of a ray from the origin up to a radius that are in material.
    fn parts(&self, angle_rad: f64, radius_mm: f64) -> Vec<[f64; 2]> {
        let (sin, cos) = libm::sincos(angle_rad);
        let mut parts = vec![[0.0, radius_mm]];
        for [x, y, r] in &self.discs {
            let (middle, off) = (x * cos + y * sin, x * sin - y * cos);
            if off.abs() < *r {
                let half = libm::sqrt(r * r - off * off);
                parts = parts.into_iter().flat_map(|part| without(part, [middle - half, middle + half])).collect();
            }
        }
        if let Some([normal_rad, offset]) = self.half_plane {
            let along = libm::cos(angle_rad - normal_rad);
            let [low, high] =
                if along > 0.0 { [offset / along, f64::INFINITY] } else { [f64::NEG_INFINITY, offset / along] };
            parts = parts.into_iter().flat_map(|part| without(part, [low, high])).collect();
        }
        parts
    }

    /// The same stock in a layer, if it has no half plane.
    fn layer(&self, radius_mm: f64, step_mm: f64) -> Option<Layer> {
        let mut layer = Layer::rectangle([-2.0 * radius_mm; 2], [4.0 * radius_mm; 2], step_mm);
        self.discs.iter().for_each(|[x, y, r]| layer.clear_ring(Vector2::new(*x, *y), 0.0, *r));
        self.half_plane.is_none().then_some(layer)
    }
}

fn without([from, to]: [f64; 2], [low, high]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    [[from, to.min(low)], [from.max(high), to]].into_iter().filter(|[from, to]| from < to)
}

/// Area, widest edge and engaged angle beside one equal disc at a distance below the radius.
fn crescent(radius_mm: f64, d: f64) -> [f64; 3] {
    let lens = 2.0 * radius_mm * radius_mm * libm::acos(d / (2.0 * radius_mm))
        - d / 2.0 * libm::sqrt(4.0 * radius_mm * radius_mm - d * d);
    [TAU / 2.0 * radius_mm * radius_mm - lens, d, TAU - 2.0 * libm::acos(d / (2.0 * radius_mm))]
}

#[test]
fn sections_beside_discs_and_half_planes_are_those_of_an_independent_program() {
    let (mut worst, mut worst_deg, mut values, mut crescents) = (0.0_f64, 0.0_f64, 0, 0);
    for row in rows(ENGAGEMENT) {
        let (stock, radius_mm) = (Stock::of(&row), row.number("R_mm"));
        let section = EngagedSection::new(RAYS, |angle_rad| stock.parts(angle_rad, radius_mm));
        let mut found = vec![("area_mm2", section.area_mm2()), ("width_max_mm", section.width_max_mm())];
        for (edges, [width, moment]) in [
            (2, ["width_sum_z2", "moment_sum_z2"]),
            (3, ["width_sum_z3", "moment_sum_z3"]),
            (4, ["width_sum_z4", "moment_sum_z4"]),
        ] {
            found.push((width, section.width_sum_max_mm(edges)));
            found.push((moment, section.moment_sum_max_mm2(edges)));
        }
        for (column, value) in found {
            let error = value / row.number(column) - 1.0;
            (worst, values) = (worst.max(error.abs()), values + 1);
            assert!(error.abs() < 1e-4, "{} {column}: {value}", row.text("case"));
        }
        let off_deg = (section.engaged_rad().to_degrees() - row.number("arc_deg")).abs();
        (worst_deg, values) = (worst_deg.max(off_deg), values + 1);
        assert!(off_deg <= 2.01 * 360.0 / RAYS as f64, "{}: {off_deg}", row.text("case"));
        if let ([[x, y, r]], None) = (stock.discs.as_slice(), stock.half_plane)
            && *r == radius_mm
            && libm::hypot(*x, *y) < radius_mm
        {
            crescents += 1;
            let [area, width, arc_rad] = crescent(radius_mm, libm::hypot(*x, *y));
            assert!((section.area_mm2() / area - 1.0).abs() < 1e-6, "{}", row.text("case"));
            assert!((section.width_max_mm() / width - 1.0).abs() < 1e-6);
            assert!((section.engaged_rad() - arc_rad).abs() < 2.01 * TAU / RAYS as f64);
        }
    }
    println!(
        "an_engagement: {values} values, largest error {worst:.1e}, of arcs {worst_deg:.4} deg; {crescents} crescents in closed form"
    );
    assert_eq!((values, crescents), (18 * 9, 3));
}

#[test]
fn plunges_one_after_the_other_have_the_sections_of_an_independent_program() {
    let (mut worst, mut count) = (0.0_f64, 0);
    let mut earlier: Vec<(String, [f64; 3])> = Vec::new();
    for row in rows(SEQUENCE) {
        let (case, radius_mm) = (row.text("case").to_owned(), row.number("R_mm"));
        let at = [row.number("x_mm"), row.number("y_mm")];
        let discs = earlier.iter().filter(|(other, _)| *other == case);
        let discs = discs.map(|(_, [x, y, r])| [x - at[0], y - at[1], *r]).collect();
        let stock = Stock { discs, half_plane: None };
        let section = EngagedSection::new(RAYS / 10, |angle_rad| stock.parts(angle_rad, radius_mm));
        let error = (section.area_mm2() - row.number("engaged_mm2")).abs() / (radius_mm * radius_mm);
        (worst, count) = (worst.max(error), count + 1);
        assert!(error < 1e-5, "{case} {}: {}", row.text("i"), section.area_mm2());
        earlier.push((case, [at[0], at[1], radius_mm]));
    }
    println!("an_sequence: {count} sections, largest error {worst:.1e} R^2");
    assert_eq!(count, 44);
}

#[test]
fn sections_in_dexels_are_nowhere_below_the_true_ones() {
    for step_mm in [0.1, 0.25] {
        let (mut excess, mut count, mut deficit) = (0.0_f64, 0, 0.0_f64);
        for row in rows(ENGAGEMENT) {
            let (stock, radius_mm) = (Stock::of(&row), row.number("R_mm"));
            let Some(layer) = stock.layer(radius_mm, step_mm) else { continue };
            let center_mm = Vector2::zeros();
            for edges in [2, 3, 4] {
                let below = |point_mm: Vector2<f64>| is_above(&layer, point_mm, center_mm, 0.0);
                let section = EngagedSection::of_ring(center_mm, [0.0, radius_mm], edges, (step_mm, below));
                let true_mm2 = row.number(&format!("moment_sum_z{edges}"));
                // In steps of a ray times the radius, for each edge.
                let off = (section.moment_sum_max_mm2(edges) - true_mm2) / (step_mm * radius_mm * edges as f64);
                (excess, deficit, count) = (excess.max(off), deficit.min(off), count + 1);
            }
        }
        println!("dexels {step_mm} mm: {count} sums, {deficit:.3} to {excess:.3} rays times radius off for each edge");
        assert!(deficit > -0.01 && excess < 2.0, "{deficit} {excess}");
    }
}
