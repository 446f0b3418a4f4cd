//! Pieces under the cup mill's own laws: random rings, arcs and stocks, asked by brute force.

use std::f64::consts::TAU;

use arcfeed::adapt::{PlanReason, adapt};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_law::{FeedLaw, Place, SegmentLaw};
use arcfeed_nc::block::Reading;
use arcfeed_units::{LengthUnit, Nm};
use fastrand::Rng;

use crate::rewrite_only::{POINTS, SINGLE, travelled};

/// Jobs, each with four arcs.
const JOBS: u64 = 400;
/// rev/min times teeth.
const TEETH_PER_MIN: f64 = 1_000.0 * 10.0;

fn stock(rng: &mut Rng, outer: f64) -> String {
    let normal = 360.0 * rng.f64();
    let offset = outer * (2.4 * rng.f64() - 1.2);
    match rng.u8(0..4) {
        0 => {
            let [x, y] = [(); 2].map(|()| outer * (2.0 * rng.f64() - 1.0));
            format!("{{ disc = [{x}, {y}, {}] }}", outer * (0.2 + 2.0 * rng.f64()))
        }
        1 => {
            let turned = TAU * rng.f64();
            let size = outer * (0.3 + 2.0 * rng.f64());
            let corner = |at: f64| format!("[{}, {}]", size * libm::cos(turned + at), size * libm::sin(turned + at));
            format!("{{ polygon = [{}, {}, {}] }}", corner(0.0), corner(1.9), corner(4.1))
        }
        _ => format!("{{ normal_deg = {normal}, offset = {offset} }}"),
    }
}

fn job(rng: &mut Rng) -> (String, [f64; 2]) {
    let outer = 40.0 + 100.0 * rng.f64();
    let inner = outer * (0.7 + 0.25 * rng.f64());
    let stock = stock(rng, outer);
    let is_line = stock.contains("normal");
    let law = match rng.u8(0..3) {
        0 if is_line => "kind = \"circumference\"",
        1 => "kind = \"engaged-arc\"\nedges = \"side\"",
        _ => "kind = \"engaged-arc\"",
    };
    let rules: String = [
        ("interior", "ccw", "outer"),
        ("interior", "cw", "inner"),
        ("exterior", "ccw", "inner"),
        ("exterior", "cw", "outer"),
    ]
    .map(|(rotation, direction, side)| {
        format!("[[cut]]\nrotation = \"{rotation}\"\ndirection = \"{direction}\"\nside = \"{side}\"\nstock = {stock}\n")
    })
    .concat();
    let text = format!(
        "units = \"mm\"\nprogram = \"p.nc\"\n[tool]\nkind = \"cup-mill\"\nouter_radius = {outer}\ninner_radius = {inner}\n\
         active_teeth = 10\n[spindle]\nrev_per_min = 1000\nset_by = \"operator\"\n[limits]\nmax_feed = \"90000 mm\"\nmax_raise = 100\n[law]\n{law}\nfeed_per_tooth = 0.1\n[override]\nmode = \
         \"rewrite-only\"\nmax = 254\n{rules}"
    );
    (text, [inner, outer])
}

fn program(rng: &mut Rng, radii: [f64; 2]) -> String {
    let mut text = String::from("G21G17G90G94\n");
    for (radius, code) in [(radii[0], 3), (radii[0], 2), (radii[1], 3), (radii[1], 2)] {
        let from = TAU * rng.f64();
        let by = 0.1 + 3.0 * rng.f64();
        let to = if code == 3 { from + by } else { from - by };
        let at = |angle: f64| [radius * libm::cos(angle), radius * libm::sin(angle)];
        let ([x, y], [to_x, to_y]) = (at(from), at(to));
        text += &format!("G0X{x:.3}Y{y:.3}\nG{code}X{to_x:.3}Y{to_y:.3}I{:.3}J{:.3}F500.\n", -x, -y);
    }
    text + "M30\n"
}

#[test]
fn under_a_cup_mills_laws_no_piece_is_faster_than_the_demand_either() {
    let (mut governed, mut in_part, mut pieces, mut worst) = (0, 0, 0, f64::NEG_INFINITY);
    for seed in 0..JOBS {
        let mut rng = Rng::with_seed(seed);
        let (text, radii) = job(&mut rng);
        let Ok(file) = JobFile::parse("p.toml".as_ref(), &text) else { panic!("{text}") };
        let program = program(&mut rng, radii);
        let program = Program::parse("p.nc".as_ref(), program.as_bytes(), LengthUnit::Mm, Reading::Lenient);
        assert!(!program.has_errors(), "{:?}", program.diagnostics);
        let adapted = adapt(&program, &file.job);
        let mut sent = crate::rewrite_only::moves(&adapted.text, LengthUnit::Mm).into_iter();
        for block in &adapted.blocks {
            let own: Vec<_> = sent.by_ref().take(block.pieces.len().max(1)).collect();
            let (Some(arc), Some(rule)) = (block.segment.arc(), block.rule) else { continue };
            if block.pieces.is_empty() {
                continue;
            }
            let law = SegmentLaw::for_segment(&block.segment, file.job.rules.get(rule), &file.job);
            let ends: Vec<f64> = own.iter().map(|piece| travelled(arc, &piece.end.linear)).collect();
            for point in 0..=POINTS {
                let ratio = point as f64 / POINTS as f64;
                let path = arc.length_mm() * ratio;
                let direction = arc.direction_at(ratio).map(|component| component as f32);
                let place = Place::on_arc(direction, f32::from(arc.turn.sign()), arc.radius_mm() as f32, path as f32);
                let Ok(demand) = law.demand(&place) else { continue };
                let index = ends[..own.len() - 1].iter().take_while(|end| **end < path).count();
                let error = crate::rewrite_only::feed_mm(&own[index])
                    / (TEETH_PER_MIN * f64::from(demand.path_mm_per_tooth))
                    - 1.0;
                assert!(error <= SINGLE, "seed {seed}, line {}, {ratio}: {error} too thick\n{text}", block.line);
                worst = error.max(worst);
            }
            governed += 1;
            in_part += usize::from(block.reason == PlanReason::LawInPart);
            pieces += own.len();
            assert!(block.sent.is_some_and(|feed| feed > Nm(0)), "seed {seed}, line {}", block.line);
        }
    }
    println!(
        "{governed} arcs governed, {in_part} in part, {pieces} pieces, the thickest chip {:+.5} % off",
        1e2 * worst
    );
    assert!(governed > 700 && in_part > 100 && pieces > 3 * governed);
}
