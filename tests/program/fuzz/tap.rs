//! The tap on a line that carries whatever comes, with a machine that stands wherever it likes.

use std::sync::OnceLock;

use arcfeed::job::JobFile;
use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_board_app::tap::status::TapState;
use arcfeed_board_app::tap::{AHEAD_MAX, Tap};
use arcfeed_control::code::{DC1, DC3, TapeCode};
use arcfeed_model::job::Job;
use arcfeed_nc::modal::Pose;
use arcfeed_tests::root;
use arcfeed_units::{Micros, Nm};
use fastrand::Rng;

fn job() -> &'static Job {
    static JOB: OnceLock<Job> = OnceLock::new();
    let path = || root().join("examples/ibr-slot/job.toml");
    JOB.get_or_init(|| JobFile::load(&path()).expect("the example's job is sound").job)
}

/// Sound blocks, and now and then a piece of the input between them.
fn program(input: &[u8], rng: &mut Rng) -> Vec<u8> {
    const SOUND: [&str; 12] = [
        "G1X1.F10.",
        "G0Z5.",
        "G2I2.",
        "G3J1.5",
        "Y0",
        "G91G28Z0\nG90",
        "G81X3.Y3.Z-1.R1.F5.",
        "G80",
        "G41D1X3.",
        "G40X0",
        "(COMMENT)",
        "G54M8",
    ];
    let mut text = if rng.u8(..10) > 0 { b"%\nG20G17G90G94\n".to_vec() } else { Vec::new() };
    for _ in 0..rng.usize(..40) {
        let kinds = if rng.u8(..6) == 0 { SOUND.len() } else { 5 };
        let at = rng.usize(..kinds);
        if rng.u8(..30) == 0 {
            let from = rng.usize(..=input.len());
            text.extend(&input[from..input.len().min(from + 40)]);
        }
        text.extend(SOUND[at].as_bytes());
        text.push(b'\n');
    }
    text.extend(b"M30\n%\n");
    text
}

/// Every character passes unchanged, segments are counted without a gap, no more are out than can be watched, and
/// none comes while the tap is not in step.
pub fn tap(input: &[u8], seed: u64) {
    let mut rng = Rng::with_seed(seed);
    let code = *rng.choice(&[None, Some(TapeCode::Iso), Some(TapeCode::Eia), Some(TapeCode::Ascii)]).expect("codes");
    let settings = TapSettings { code, resets_codes: rng.bool(), ..TapSettings::new(job().unit) };
    let mut tap = Tap::<600>::new(settings).expect("sound settings");
    let on_line = code.unwrap_or(*rng.choice(&[TapeCode::Iso, TapeCode::Eia]).expect("codes"));
    let text = [program(input, &mut rng), program(input, &mut rng)].concat();
    let (mut now, mut wanted, mut done, mut position) = (Micros(0), 0_u32, 0_u32, Pose::ORIGIN);
    (0..rng.u8(..30)).for_each(|_| tap.follow(None, 0, &position));
    for byte in &text {
        now = now.after(Micros(if rng.u8(..50) == 0 { 5_000_000 } else { 1_000 }));
        let noise = rng.u8(..);
        let frame = if rng.u16(..3_000) == 0 { noise } else { on_line.encode(*byte).unwrap_or(noise) };
        assert_eq!(tap.from_sender(now, frame), frame);
        match rng.u16(..300) {
            0..20 => assert_eq!(tap.from_control(now, noise), noise),
            20 => assert_eq!(tap.from_control(now, DC1), DC1),
            21 => assert_eq!(tap.from_control(now, DC3), DC3),
            22 if rng.u8(..20) == 0 => tap.on_line_error(),
            _ => {}
        }
        if rng.u8(..4) == 0 {
            if rng.u8(..100) == 0 {
                position.linear = std::array::from_fn(|_| Nm(rng.i64(-200_000_000..200_000_000)));
            }
            tap.follow((done < wanted).then_some(done), done, &position);
        }
        if tap.must_clear() {
            done = wanted;
        }
        while rng.u8(..4) > 0 {
            let state = tap.state();
            let Some(handed) = tap.next(job()) else { break };
            assert_eq!((handed.count, state), (wanted, TapState::InStep));
            wanted += 1;
        }
        assert!((wanted - done) as usize <= AHEAD_MAX + 1, "{wanted} {done}");
        if done < wanted && rng.u8(..6) == 0 {
            done += 1;
        }
    }
    assert!(tap.counters().segments == wanted && tap.counters().governed <= wanted);
}
