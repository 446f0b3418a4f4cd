//! Tool axes within the ranges of the rotary axes, against angles written out for each machine, and courses that the ranges bend or refuse.

use arcfeed::machine_file::MachineFile;
use arcfeed_kinematics::machine::{Letter, Machine};
use arcfeed_plan::finish::access::FinishInfeasible;
use arcfeed_plan::finish::needs::FinishNeeds;
use arcfeed_plan::finish::obstacles::obstacles;
use arcfeed_plan::finish::passes::Course;
use arcfeed_plan::finish::plan::{FinishPlan, Planner};
use arcfeed_plan::finish::rotary::range_excess;
use arcfeed_plan::finish::rows::Spacing;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::vector::Vector;
use arcfeed_tests::{Scratch, root, run};

use super::plans::{blisk, mikron, mill, needs};

/// Distance that stations keep from the ends of ranges.
const SPARE_DEG: f64 = 1.0;

fn machine(name: &str) -> Machine {
    MachineFile::load(&root().join("host/adapt/machines").join(name).with_extension("toml")).expect("a preset").machine
}

/// The machine with other ranges of its rotary axes.
fn with_ranges(machine: &Machine, ranges_deg: [Option<[f64; 2]>; 2]) -> Machine {
    let mut rotary = *machine.rotary();
    for (axis, range_deg) in rotary.iter_mut().zip(ranges_deg) {
        axis.range_deg = range_deg;
    }
    Machine::new(rotary, *machine.linear(), machine.tool()).expect("a machine")
}

/// Distance of an angle from the spared range, over the whole turns about it.
fn outside_deg(angle_deg: f64, [least, greatest]: [f64; 2]) -> f64 {
    let outside = |turns: i32| {
        let at = angle_deg + 360.0 * f64::from(turns);
        (least + SPARE_DEG - at).max(at - greatest + SPARE_DEG).max(0.0)
    };
    (-3..=3).map(outside).fold(f64::INFINITY, f64::min)
}

fn directions() -> Vec<Vector> {
    let mut random = fastrand::Rng::with_seed(17);
    let mut value = || 2.0 * random.f64() - 1.0;
    (0..20_000).filter_map(|_| Vector::new(value(), value(), value()).try_normalize(0.05)).collect()
}

#[test]
fn excesses_are_those_of_each_machines_own_equations() {
    let limited = with_ranges(&mikron(), [Some([-90.0, 60.0]), Some([-120.0, 30.0])]);
    // Table 2 of the documents: solutions (first, second) of each structure.
    let about_z = |t: &Vector| [libm::acos(t.z).to_degrees(), libm::atan2(t.x, -t.y).to_degrees()];
    type Equations<'e> = &'e dyn Fn(&Vector) -> f64;
    let tilting = |t: &Vector| {
        let [tilt, _] = about_z(t);
        outside_deg(tilt, [-120.0, 30.0]).min(outside_deg(-tilt, [-120.0, 30.0]))
    };
    let both = |t: &Vector| {
        let [tilt, turn] = about_z(t);
        let greater = |a: f64, c: f64| outside_deg(a, [-120.0, 30.0]).max(outside_deg(c, [-90.0, 60.0]));
        greater(tilt, turn).min(greater(-tilt, turn + 180.0))
    };
    let head = |t: &Vector| outside_deg(about_z(t)[0], [-110.0, 110.0]);
    // t = (sin B cos A, -sin A, cos B cos A), and B is endless.
    let trunnion = |t: &Vector| {
        let a = libm::asin(-t.y).to_degrees();
        outside_deg(a, [-95.0, 5.0]).min(outside_deg(180.0 - a, [-95.0, 5.0]))
    };
    let cases: [(&str, Machine, Equations<'_>); 4] = [
        ("A/C table", mikron(), &tilting),
        ("A/C table, limited C", limited, &both),
        ("C table, B head", machine("ferrari-rtttr"), &head),
        ("B on tilting A", machine("mitsui-seiki-hu80a-5x"), &trunnion),
    ];
    for (name, machine, equations) in cases {
        let (mut worst, mut inside, mut outside) = (0.0_f64, 0, 0);
        for axis in directions() {
            let found = range_excess(&machine, &axis).expect("axes at right angles reach every direction");
            let (found, expected) = (found.map_or(0.0, |excess| excess.excess_deg), equations(&axis));
            worst = worst.max((found - expected).abs());
            *if expected == 0.0 { &mut inside } else { &mut outside } += 1;
        }
        println!("{name}: {inside} axes within the ranges, {outside} outside; excesses to {worst:.1e} degrees");
        assert!(worst < 1e-9 && inside > 1000 && outside > 1000);
    }
}

fn plan(blisk: &Blisk, machine: &Machine, needs: &FinishNeeds) -> Result<FinishPlan, FinishInfeasible> {
    Planner { blisk, mill: &mill(), machine, needs, bodies: &obstacles(blisk, &[]) }.plan()
}

/// Smallest and largest angle between the tool axes and Z, which is -A.
fn tilts_deg(plan: &FinishPlan) -> [f64; 2] {
    let tilts = plan.path.iter().map(|step| libm::acos(step.location.axis.z).to_degrees());
    tilts.fold([f64::INFINITY, 0.0], |[least, most], tilt| [least.min(tilt), most.max(tilt)])
}

#[test]
fn ranges_that_exclude_the_smoothest_course_bend_it_and_narrower_ones_are_refused() {
    let (blisk, mikron) = (blisk(), mikron());
    let needs = needs(Course::OneWay(arcfeed_plan::geometry::flaws::BladeSide::Pressure), Spacing::IsoParametric);
    let range = |least: f64, greatest: f64| with_ranges(&mikron, [None, Some([least, greatest])]);
    let free = tilts_deg(&plan(&blisk, &range(-180.0, 180.0), &needs).unwrap());
    let cut = [free[0] - 30.0, free[1] - 4.0];
    let bent = tilts_deg(&plan(&blisk, &range(-cut[1], -cut[0]), &needs).unwrap());
    println!("-A {free:.2?}; with the range {cut:.2?}: {bent:.2?}");
    assert!(bent[1] <= cut[1] && bent[0] >= cut[0]);

    let refused = plan(&blisk, &range(-20.0, 30.0), &needs).unwrap_err();
    println!("{refused}");
    let FinishInfeasible::OutOfRange { excess, .. } = refused else { panic!("{refused}") };
    assert_eq!((excess.letter, excess.range_deg), (Letter::A, [-20.0, 30.0]));
    assert!(excess.position_deg.abs() > 31.0);
    let said = refused.to_string();
    assert!(said.contains("A would have to stand at") && said.contains("its range is -20 to 30"), "{said}");
}

#[test]
fn the_command_refuses_a_machine_that_does_not_tilt_far_enough() {
    let scratch = Scratch::new("finish-ranges");
    let folder = scratch.path("out");
    let machine = std::fs::read_to_string(root().join("host/adapt/machines/mikron-ucp710.toml")).unwrap();
    assert!(machine.contains("range = [-120, 30]"));
    scratch.write("narrow.toml", machine.replace("range = [-120, 30]", "range = [-20, 30]"));
    let part = std::fs::read_to_string(root().join("examples/finish-blisk/PART.toml")).unwrap();
    let part = part.replace("preset = \"mikron-ucp710\"", "file = \"narrow.toml\"");
    let part = scratch.write("PART.toml", part.replace("scallop = 0.01", "scallop = 0.02\nfrom = 0.5\nto = 0.53"));
    let output = run(&["plan", "finish", &part, "-o", &folder]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    println!("{said}");
    assert_eq!(output.status.code(), Some(1));
    assert!(said.contains("A would have to stand at") && said.contains("its range is -20 to 30"), "{said}");
    assert!(!std::path::Path::new(&folder).exists());
}
