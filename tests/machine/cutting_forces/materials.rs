//! Coefficients against figures computed elsewhere, and no force where nothing is cut.

use arcfeed_milling::cutting::material::{
    AL_6082_T6, AL_7075_T6, ChipSection, Cutting, EdgeForce, MATERIALS, TI_6AL_4V_HELIX_30,
};

fn tangential(name: &str) -> Cutting {
    let found = MATERIALS.iter().find(|material| material.name.starts_with(name)).expect("a material of the list");
    found.tangential.with_ratios(0.4, 0.2)
}

#[test]
fn an_insert_of_the_published_tool_takes_what_was_computed_for_it() {
    let chip = ChipSection { thickness_mm: 0.1016, width_mm: 2.3825 };
    for (name, expected_n) in [("Al 6061", 343.00), ("Ti-6Al-4V", 844.68), ("Inconel 718", 1382.89)] {
        let force = tangential(name).force(&chip);
        println!("{name}: {:.2} N", force.tangential_n);
        assert!((force.tangential_n - expected_n).abs() <= 0.005, "{name}: {}", force.tangential_n);
        assert!((force.radial_n / force.tangential_n - 0.4).abs() < 1e-15);
        assert!((force.axial_n / force.tangential_n - 0.2).abs() < 1e-15);
    }
}

#[test]
fn specific_forces_at_a_tenth_of_a_millimetre_are_those_of_the_table() {
    // kc at h = 0.1 mm, from the same catalogue by another program.
    let at_tenth = [
        (37, 3501.7),
        (36, 2887.0),
        (34, 5734.7),
        (22, 1422.6),
        (24, 1244.8),
        (1, 2189.4),
        (2, 2489.4),
        (7, 2910.8),
        (9, 3128.0),
        (12, 3040.9),
        (14, 3407.5),
    ];
    assert_eq!(MATERIALS.len(), at_tenth.len());
    for (material, (group, specific_mpa)) in MATERIALS.iter().zip(at_tenth) {
        let chip = ChipSection { thickness_mm: 0.1, width_mm: 10.0 };
        let force = material.tangential.with_ratios(0.0, 0.0).force(&chip);
        assert_eq!(material.group, group);
        assert!((force.tangential_n - specific_mpa).abs() <= 0.05, "{}: {}", material.name, force.tangential_n);
    }
}

#[test]
fn out_of_the_cut_there_is_no_force_not_even_that_of_the_edge() {
    for cutting in [tangential("Ti"), TI_6AL_4V_HELIX_30] {
        for (thickness_mm, width_mm) in [(0.0, 1.0), (-0.1, 1.0), (0.1, 0.0), (0.1, -1.0), (f64::NAN, 1.0)] {
            assert_eq!(cutting.force(&ChipSection { thickness_mm, width_mm }), EdgeForce::default());
        }
    }
    let rubbing = TI_6AL_4V_HELIX_30.force(&ChipSection { thickness_mm: 1e-9, width_mm: 2.0 });
    assert!((rubbing.tangential_n - 59.4).abs() < 1e-5 && (rubbing.radial_n - 111.4).abs() < 1e-5);
}

#[test]
fn linear_coefficients_are_those_printed() {
    let chip = ChipSection { thickness_mm: 0.1, width_mm: 2.0 };
    // (767.01 * 0.1 + 27.7) * 2 and so on.
    let expected = [(AL_7075_T6, [208.802, 86.96, 45.8]), (AL_6082_T6, [152.2, 39.8, 60.2])];
    for (cutting, [t, r, a]) in expected {
        let EdgeForce { tangential_n, radial_n, axial_n } = cutting.force(&chip);
        assert!((tangential_n - t).abs() + (radial_n - r).abs() + (axial_n - a).abs() < 1e-12);
    }
}
