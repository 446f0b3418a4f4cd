//! Random plunges and ramps in random stocks, with random tools, materials and limits: never above the limits.

use std::fmt::Write;

use arcfeed_tests::of_full_set;
use fastrand::Rng;

use crate::plunge_law::plunge_job::PlungeJob;

/// A chip is measured on the floor that the tooth before has left, within a step of the tool's rotation.
const CHIP_RATIO: f64 = 1.005;

/// A job with its limits.
pub struct RandomPlunges {
    pub tool: String,
    workpiece: String,
    pub cutting: String,
    spindle: String,
    pub program: String,
    pub feed_per_tooth_mm: f64,
    max_raise: f64,
    pub power_w: f64,
    pub torque_n_m: f64,
}

fn between(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

impl RandomPlunges {
    pub fn sample(random: &mut Rng) -> Self {
        let diameter = between(random, 6.0, 16.0);
        let (teeth, rev_per_min) = (random.u16(2..=5), random.u16(4..=30) * 100);
        let (specific, exponent) = (between(random, 400.0, 2_500.0), between(random, 0.0, 0.3));
        let feed_per_tooth_mm = between(random, 0.02, 0.12);
        // The torque of a full section at the wanted chip, and a share of it.
        let full_n_m =
            specific * libm::pow(feed_per_tooth_mm, 1.0 - exponent) * f64::from(teeth) * diameter * diameter / 8e3;
        let torque_n_m = full_n_m * between(random, 0.2, 1.3);
        let power_w = full_n_m * between(random, 0.2, 1.3) * std::f64::consts::TAU * f64::from(rev_per_min) / 60.0;
        let is_ring = random.u8(..3) == 0;
        let tool = match is_ring {
            true => format!(
                "kind = \"cup-mill\"\nouter_radius = {:.4}\ninner_radius = {:.4}\nactive_teeth = {teeth}\nheight = 30",
                diameter / 2.0,
                diameter * between(random, 0.25, 0.4)
            ),
            false => format!("kind = \"end-mill\"\ndiameter = {diameter:.4}\nteeth = {teeth}\nheight = 30"),
        };
        let cutting = match random.bool() {
            true => format!("kc11 = {specific:.1}\nmc = {exponent:.3}\nradial = 0.3\naxial = 0.2"),
            false => format!("cutting = [{specific:.1}, 100, 50]\nedge = [{:.2}, 5, 1]", between(random, 0.0, 8.0)),
        };
        let workpiece = match random.u8(..3) {
            0 => "round = { from = [-20, 0, -30], to = [30, 0, -30], radius = 30 }".to_owned(),
            1 => "round = { from = [4, 0, -16], to = [4, 0, 0], radius = 14, bore = 5 }".to_owned(),
            _ => "block = { from = [-9, -12, -16], to = [22, 14, 0] }".to_owned(),
        };
        RandomPlunges {
            tool,
            workpiece: format!("{workpiece}\nstep = 0.4"),
            cutting: format!("{cutting}\naxial_depth = 3\nlayers = {}", random.u8(2..=6)),
            spindle: format!(
                "rev_per_min = {rev_per_min}\nmax_power = \"{power_w:.2} W\"\nmax_torque = \"{torque_n_m:.4} Nm\""
            ),
            program: program(random, rev_per_min),
            feed_per_tooth_mm,
            max_raise: between(random, 1.0, 3.0),
            power_w,
            torque_n_m,
        }
    }

    /// The job in this mode.
    pub fn job<'a>(&'a self, name: &'a str, mode: &'a str) -> PlungeJob<'a> {
        PlungeJob {
            name,
            tool: &self.tool,
            workpiece: &self.workpiece,
            cutting: &self.cutting,
            spindle: &self.spindle,
            mode,
            feed_per_tooth_mm: self.feed_per_tooth_mm,
            max_raise: self.max_raise,
            program: &self.program,
        }
    }
}

/// Chains of plunges and ramps in any order, one directly after the other, some of them beside earlier ones.
fn program(random: &mut Rng, rev_per_min: u16) -> String {
    let mut text = format!("%\nG21G17G90G94\nS{rev_per_min}M3\nN1G0X0.Y0.Z3.\n");
    let [mut x, mut y] = [0.0, 0.0];
    for _ in 0..random.u8(2..=4) {
        (x, y) = (x + between(random, -3.0, 6.0), y + between(random, -4.0, 4.0));
        let (mut depth, feed) = (between(random, 1.0, 8.0), between(random, 20.0, 900.0));
        // Writing to a string never fails.
        let _ = write!(text, "G0X{x:.3}Y{y:.3}\nG1Z-{depth:.3}F{feed:.1}\n");
        for _ in 0..random.u8(..4) {
            depth += between(random, 0.5, 3.0);
            if random.u8(..3) > 0 {
                (x, y) = (x + between(random, -2.0, 2.0), y + between(random, -2.0, 2.0));
            }
            let feed = if random.bool() { format!("F{:.1}", between(random, 20.0, 900.0)) } else { String::new() };
            let _ = writeln!(text, "X{x:.3}Y{y:.3}Z-{depth:.3}{feed}");
        }
        text += "G0Z3.\n";
    }
    text + "M30\n%\n"
}

#[test]
fn no_descent_is_above_the_limits_of_chip_torque_power_and_feed() {
    let (mut governed, mut most, mut above_before) = (0, [0.0_f64; 3], 0);
    let programs = of_full_set(120, 10);
    for seed in 0..programs {
        let mut random = Rng::with_seed(0x26 + seed);
        let sample = RandomPlunges::sample(&mut random);
        let mode = ["mode = \"safe-base\"", "mode = \"rewrite-only\""][usize::from(random.bool())];
        let found = sample.job(&format!("random-{seed}"), mode).found();
        let context = || {
            format!(
                "program {seed}, {mode}\n{}\n{}\n{}\n{}",
                sample.tool, sample.cutting, sample.spindle, sample.program
            )
        };
        for block in found.adapted.iter().filter(|block| block["law"] == "plunge") {
            let number = |key: &str| block[key].as_f64();
            let Some(sent) = number("sent_feed").filter(|_| number("feed_min").is_some()) else { continue };
            governed += 1;
            let most_feed = (number("programmed_feed").expect("F") * sample.max_raise).min(3_000.0);
            assert!(sent > 0.0 && sent <= most_feed, "{sent} {most_feed}: {}", context());
        }
        let limits = [sample.power_w, sample.torque_n_m, sample.feed_per_tooth_mm * CHIP_RATIO];
        let loads =
            [found.most(|load| load.power_w), found.most(|load| load.torque_n_m), found.most(|load| load.chip_mm)];
        if seed % 10 == 9 {
            println!("{} programs", seed + 1);
        }
        above_before += usize::from(loads.iter().zip(limits).any(|(load, limit)| load[1] > limit));
        for ((load, limit), most) in loads.iter().zip(limits).zip(&mut most) {
            *most = most.max(load[0] / limit);
            assert!(load[0] <= limit, "{load:?} for {limit}: {}", context());
        }
    }
    println!(
        "{programs} programs, {governed} descents; largest power, torque and chip over their limits {:.4}, {:.4}, {:.4}; {above_before} programs \
         above a limit as programmed",
        most[0], most[1], most[2]
    );
    assert!(above_before > usize::try_from(programs).expect("few") / 4, "{above_before}");
}
