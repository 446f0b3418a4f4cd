//! Cuts at several positions of the rotary axes without G43.4: slots in the faces of a cube, against their closed form, and against
//! the same slots with the tip given on the part.

use std::f64::consts::PI;

use crate::cutting_stock::scratch_job::ScratchJob;

/// A cube about the point where the rotary axes cross.
const CUBE: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n\
    [spindle]\nrev_per_min = 3000\n[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n\
    [workpiece]\nblock = { from = [-20, -20, -20], to = [20, 20, 20] }\nstep = 0.4\n";
/// Volume of a slot of 15 mm, 4 mm deep, by a mill of R 5 mm.
const SLOT_CM3: f64 = (2.0 * 5.0 * 15.0 + PI * 25.0) * 4e-3;
/// Positions of A and C that present the top and the four sides.
const FACES: [[f64; 2]; 5] = [[0.0, 0.0], [-90.0, 0.0], [-90.0, 90.0], [-90.0, 180.0], [-90.0, 270.0]];

/// Point of the tool's frame on the part: A turns about X, then C about Z.
fn on_part([a_deg, c_deg]: [f64; 2], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(a_deg.to_radians());
    let (y, z) = (y * cos - z * sin, y * sin + z * cos);
    let (sin, cos) = libm::sincos(c_deg.to_radians());
    [x * cos - y * sin, x * sin + y * cos, z]
}

/// A slot off the middle of a face, so that one turned the wrong way lies elsewhere; its cut has this N.
fn slot(n: usize, [a_deg, c_deg]: [f64; 2], to: impl Fn([f64; 3]) -> String) -> String {
    let [from, floor, end] = [[-11.987, 3.021, 60.0], [-11.987, 3.021, 16.0], [3.013, 3.021, 16.0]];
    let back = [3.013, 3.021, 60.0];
    format!("G0A{a_deg:.3}C{c_deg:.3}\nG0{}\nN{n}G1{}F600.\n{}\nG0{}\n", to(from), to(floor), to(end), to(back))
}

fn words([x, y, z]: [f64; 3]) -> String {
    format!("X{x:.6}Y{y:.6}Z{z:.6}")
}

/// Slots in these faces along the axes, then the same with the tip on the part.
fn removed(name: &str, faces: &[[f64; 2]], with_tip: bool) -> Vec<f64> {
    let mut program = String::from("%\nG21G17G90G94\nG0Z60.\n");
    for (index, face) in faces.iter().enumerate() {
        program += &slot(index + 1, *face, words);
    }
    if with_tip {
        program += "G43.4H0\n";
        for (index, face) in faces.iter().enumerate() {
            program += &slot(faces.len() + index + 1, *face, |point| words(on_part(*face, point)));
        }
    }
    program += "M30\n%\n";
    let job = format!("{CUBE}[machine]\npreset = \"mikron-ucp710\"\n");
    let output = ScratchJob::new(name, &job, &program).run(&[]);
    let left_out = &output.report["material"]["left_out"];
    assert!(left_out.as_array().is_some_and(Vec::is_empty), "{left_out}");
    let blocks = output.report["material"]["blocks"].as_array().expect("a list");
    let of = |n: usize| {
        // The cut along the face has no N of its own; it follows the plunge.
        let at = blocks.iter().position(|block| block["n"] == n)?;
        let volume = |index: usize| blocks[index]["removal"]["removed"].as_f64();
        let next = blocks.get(at + 1).filter(|block| block["n"].is_null()).and_then(|_| volume(at + 1));
        Some(volume(at)? + next.unwrap_or(0.0))
    };
    (1..=faces.len() * (1 + usize::from(with_tip))).map(|n| of(n).unwrap_or(0.0)).collect()
}

#[test]
fn slots_in_all_faces_have_the_volume_of_their_closed_form() {
    let removed = removed("faces", &FACES, true);
    println!("{SLOT_CM3:.6} cm3 by hand: {removed:.6?}");
    let (by_axes, by_tip) = removed.split_at(FACES.len());
    for volume in by_axes {
        assert!((volume / SLOT_CM3 - 1.0).abs() < 6e-3, "{volume}");
    }
    // The tip on the part runs through slots that are there already.
    assert!(by_tip.iter().all(|volume| *volume < 1e-3 * SLOT_CM3), "{by_tip:?}");
}

#[test]
fn the_first_cut_may_be_on_any_face() {
    for first in 1..FACES.len() {
        let mut faces = FACES;
        faces.rotate_left(first);
        let removed = removed(&format!("face-{first}"), &faces, false);
        println!("{removed:.6?}");
        assert!(removed.iter().all(|volume| (volume / SLOT_CM3 - 1.0).abs() < 6e-3), "{removed:?}");
    }
}
