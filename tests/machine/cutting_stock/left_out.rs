//! Material removed at rapid, and blocks that remove none because the position of the workpiece is unknown.

use crate::cutting_stock::scratch_job::{MILL, SLOT, ScratchJob};

#[test]
fn a_rapid_through_the_workpiece_is_reported_with_its_block() {
    let program = SLOT.replace("N4G1X40.013F600.", "N12G0X40.013");
    let output = ScratchJob::new("rapid", MILL, &program).run(&[]);
    let at_rapid = output.material("/at_rapid");
    println!("{}{at_rapid} cm3", output.complaints);
    assert!((at_rapid / 1.6 - 1.0).abs() < 6e-3 && output.complaints.starts_with("warning: N12: 1.6"));
    assert!(output.complaints.ends_with(" cm3 taken at rapid\n") && output.complaints.lines().count() == 1);
    assert_eq!(output.block(12).expect("it cuts")["rapid"], true);
}

#[test]
fn the_approach_from_an_unknown_place_takes_nothing() {
    // With Z0 on the table, the axes would start within the block.
    let job = MILL.replace("-12], to = [50, 10, 0]", "0], to = [50, 10, 12]");
    let program = "%\nG21G17G90G94\nN1G0X30.Y5.\nN2G0Z20.\nN3G0X0.Y0.\nN4G1Z8.F400.\nN5G0Z20.\nN6M30\n%\n";
    let output = ScratchJob::new("approach", &job, program).run(&[]);
    assert_eq!((output.material("/at_rapid"), output.complaints.as_str()), (0.0, ""));
    assert!((output.removed(4) / (std::f64::consts::PI * 25.0 * 4.0 / 1e3) - 1.0).abs() < 6e-3);
}

/// A pocketing post's end, with 1 mm of stock above Z0: without a work offset the machine's zero is at no known place.
#[test]
fn a_return_to_the_reference_point_takes_nothing_unless_an_offset_says_where_it_is() {
    let end = "N5G0Z5.\nN7G28G91Z0.\nN8G28X0.Y0.\nN9G90\nN10G0X30.Y0.\n";
    let program = SLOT.replace("N5G0Z5.\n", end);
    let job = MILL.replace("to = [50, 10, 0]", "to = [50, 10, 1]");
    let output = ScratchJob::new("reference", &job, &program).run(&[]);
    println!("{}", output.complaints);
    assert_eq!(output.material("/at_rapid"), 0.0);
    let left_out = &output.report["material"]["left_out"];
    assert_eq!((&left_out[0]["cause"], &left_out[0]["blocks"]), (&"machine-position".into(), &3.into()), "{left_out}");
    assert!(
        output.complaints.starts_with("warning: 3 blocks from N7 on took no material: they go to a machine position")
    );
    // With the part 400 mm below the machine's zero, all is known, and nothing is met on the way.
    let job = format!("{job}[control]\npreset = \"fanuc-16i\"\nsettings = \"machine.toml\"\n");
    let placed = ScratchJob::new("placed", &job, &program);
    placed.scratch.write("machine.toml", "unit = \"mm\"\n[work]\nG54 = { X = -300.0, Y = -200.0, Z = -400.0 }\n");
    let output = placed.run(&[]);
    assert_eq!((output.material("/at_rapid"), output.complaints.as_str()), (0.0, ""));
}

/// The way from an unknown position is not known, but its end is.
#[test]
fn a_rapid_that_ends_in_the_material_is_found_also_after_a_return() {
    let program = SLOT.replace("N5G0Z5.\n", "N5G0Z5.\nN7G28G91Z0.\nN8G90G0X0.Y-6.\nN9Z-4.\nN10Z5.\n");
    let output = ScratchJob::new("arrival", MILL, &program).run(&[]);
    println!("{}", output.complaints);
    // The disk about the end, within the block and outside of the slot, in cells of 0.02 mm.
    let is_within = |x: f64, y: f64, [cx, cy]: [f64; 2]| libm::hypot(x - cx, y - cy) <= 5.0;
    let is_taken = |x: f64, y: f64| {
        let in_slot = x >= 0.013 && (y - 0.021).abs() <= 5.0 || is_within(x, y, [0.013, 0.021]);
        y >= -10.0 && is_within(x, y, [0.0, -6.0]) && !in_slot
    };
    let places =
        (0..500).flat_map(|i| (0..500).map(move |j| (f64::from(i) * 0.02 - 4.99, f64::from(j) * 0.02 - 10.99)));
    let cm3 = places.filter(|(x, y)| is_taken(*x, *y)).count() as f64 * 0.02 * 0.02 * 4.0 / 1e3;
    assert!((output.removed(9) / cm3 - 1.0).abs() < 1e-2, "{} of {cm3}", output.removed(9));
    assert!(output.complaints.starts_with("warning: N9: 0."));
    assert_eq!(output.block(9).expect("it cuts")["rapid"], true);
}

#[test]
fn blocks_whose_place_is_not_known_are_counted_by_cause() {
    for (name, from, to, cause, words) in [
        ("turning", "N4G1X40.013", "N4G1X40.013A10.", "turning", "rotary axes turn"),
        ("other", "N4G1X40.013", "N9G0Z5.\nN10G0A10.\nN11G0Z0.\nN4G1X40.013", "other-position", "stand elsewhere"),
        ("tip", "N4G1X40.013", "N9G43.4H0\nN4G1X40.013", "no-machine", "names no machine"),
        ("contour", "N4G1X40.013", "N4G41D1G1X40.013", "contour", "G41 or G42"),
    ] {
        let output = ScratchJob::new(name, MILL, &SLOT.replace(from, to)).run(&[]);
        let left_out = &output.report["material"]["left_out"];
        println!("{}", output.complaints);
        assert_eq!((&left_out[0]["cause"], &left_out[0]["first_n"]), (&cause.into(), &4.into()), "{left_out}");
        assert!(output.complaints.contains("N4 took no material: ") && output.complaints.contains(words));
        assert!(output.block(4).is_none() && output.material("/removal/removed") < 0.32, "{name}");
    }
}

#[test]
fn contour_with_a_known_radius_removes_the_volume_of_its_tool_path() {
    // The contour lies 5 mm beside the slot.
    let contour = SLOT
        .replace("N4G1X40.013", "G10L12P1R5.\nN7G41D1G1X.013\nN4X40.013")
        .replace("N5G0", "N8G40G1Y5.\nN5G0")
        .replace("Z-4.F400.", "Z-4.F400.\nN9X-9.987Y-4.979F600.");
    let by_hand = SLOT
        .replace("N4G1X40.013", "N7G1X.013Y.021\nN4X40.013")
        .replace("N5G0", "N8G1Y5.\nN5G0")
        .replace("Z-4.F400.", "Z-4.F400.\nN9X-9.987Y-4.979F600.");
    let [contour, by_hand] = [("radius", contour), ("by-hand", by_hand)].map(|(name, program)| {
        let output = ScratchJob::new(name, MILL, &program).run(&[]);
        assert!(output.report["material"]["left_out"].as_array().expect("a list").is_empty(), "{}", output.complaints);
        [4, 8].map(|n| output.removed(n))
    });
    println!("{contour:?} {by_hand:?}");
    for (contour, by_hand) in contour.into_iter().zip(by_hand) {
        assert!((contour / by_hand - 1.0).abs() < 1e-9 && by_hand > 0.0, "{contour} {by_hand}");
    }
}

#[test]
fn under_g43_4_the_machine_says_where_the_tool_points() {
    let job = format!("{MILL}[machine]\npreset = \"mikron-ucp710\"\n");
    let under = |words: &str| SLOT.replace("N4G1", &format!("N9G43.4H0{words}\nN4G1"));
    let plain = ScratchJob::new("plain", MILL, SLOT).run(&[]);
    let upright = ScratchJob::new("upright", &job, &under("")).run(&[]);
    println!("{} {}", plain.removed(4), upright.removed(4));
    assert!((upright.removed(4) / plain.removed(4) - 1.0).abs() < 1e-6, "{}", upright.complaints);
    // Tilted in the plane of the way, the tool takes more of the block's end and of its floor.
    let tilted =
        SLOT.replace("N4G1X40.013F600.", "N9G0Z5.\nN8G43.4H0\nN7G0A-20.C90.\nN10G1Z-4.F400.\nN4G1X40.013F600.");
    let tilted = ScratchJob::new("tilted", &job, &tilted).run(&[]);
    println!("{} {}", tilted.removed(4), tilted.complaints);
    assert!(tilted.report["material"]["left_out"].as_array().expect("a list").is_empty());
    assert!(tilted.removed(4) > 0.0);
}
