//! The operator at the panel while the axes move under their limits: feed hold, single block, reset, whenever they come.

use arcfeed_control::Control;
use arcfeed_units::Micros;

use crate::drives::limits::any_program;
use crate::drives::motion::{Motion, STEP, drives, settings};

/// Actions of the operator, each millisecond.
#[derive(Clone, Copy, Debug)]
enum Hand {
    /// Feed hold, and cycle start when the axes rest.
    Holds,
    /// Single block on for a while, cycle start at each stop.
    Steps,
    /// Reset, once.
    Resets,
}

/// Runs a program with a hand at the panel; the axes, and where they came to rest.
fn run(program: &str, hand: Hand, random: &mut fastrand::Rng) -> (Motion, Vec<[f64; 6]>) {
    let mut control = Control::from_memory(settings(drives()), format!("{program}\nM30\n").as_bytes());
    let (mut axes, mut rests, mut now) = (vec![*control.axes(); 3], Vec::new(), Micros(0));
    let reset_at = random.u64(1..3_000);
    while !control.is_over() && now < Micros::from_ms(600_000) {
        now = now.after(STEP);
        match hand {
            Hand::Holds if random.u16(..200) == 0 => control.hold(),
            Hand::Steps if random.u16(..100) == 0 => {
                control.switches_mut().single_block = random.bool();
            }
            Hand::Resets if now == Micros::from_ms(reset_at) => control.reset(),
            _ => {}
        }
        let was_moving = !control.is_at_rest();
        control.step(now, STEP, 100);
        axes.push(*control.axes());
        if was_moving && control.is_at_rest() {
            rests.push(*control.axes());
        }
        if control.is_at_rest() && random.u8(..20) == 0 && !matches!(hand, Hand::Resets) {
            control.cycle_start();
        }
        if matches!(hand, Hand::Resets) && now > Micros::from_ms(reset_at + 3_000) {
            break;
        }
    }
    axes.extend([*control.axes(); 3]);
    (Motion { axes }, rests)
}

#[test]
fn whatever_the_operator_presses_no_axis_is_beyond_its_limits() {
    for seed in 0..20 {
        for hand in [Hand::Holds, Hand::Steps, Hand::Resets] {
            let mut random = fastrand::Rng::with_seed(seed);
            let program = any_program(&mut random);
            let (motion, _) = run(&program, hand, &mut random);
            motion.keeps(&drives(), &format!("{hand:?}, seed {seed}"));
        }
    }
}

/// Corners at whole millimetres, 3 mm apart.
#[test]
fn in_single_block_the_axes_rest_at_the_ends_of_blocks_and_nowhere_else() {
    let corners: String = (1..30).map(|i| format!("G1X{}.Y{}.F{}\n", 3 * i, 3 * (i % 2), 300 * (1 + i % 7))).collect();
    for seed in 0..10 {
        let (motion, rests) = run(&corners, Hand::Steps, &mut fastrand::Rng::with_seed(seed));
        assert!(rests.len() > 5, "{} rests", rests.len());
        for [x, y, ..] in rests {
            assert_eq!((x % 3.0, y % 3.0), (0.0, 0.0), "seed {seed}: at rest at {x}, {y}");
        }
        let [x, y, ..] = motion.axes[motion.axes.len() - 1];
        assert_eq!((x, y), (87.0, 3.0), "nothing is left out");
    }
}
