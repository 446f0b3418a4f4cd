//! Instructions per tick, over the whole example job.

use std::sync::OnceLock;

use crate::emulator::run;

/// The circumference law with progress, limits, slew and rounding, instructions. The goal is 220 and 350.
const TICK_MEDIAN_MAX: u32 = 270;
const TICK_WORST_MAX: u32 = 370;
/// A tick on a line, a rapid or an arc without a law.
const UNGOVERNED_WORST_MAX: u32 = 430;
/// How many times cheaper than the source's own loop, in f32 (the goal is 20) and in f64 without hardware for it.
const TIMES_F32_MIN: f64 = 19.0;
const TIMES_F64_MIN: f64 = 100.0;

/// A line of `tick-cost`.
#[derive(Clone, Copy, Debug)]
struct Cost {
    count: u32,
    median: u32,
    worst: u32,
}

/// All that the image prints, run once.
pub fn text() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| run("tick-cost").text())
}

fn cost(name: &str) -> Cost {
    let line = text().lines().find(|line| line.split_whitespace().next() == Some(name));
    let words: Vec<&str> = line.unwrap_or_else(|| panic!("no {name} in\n{}", text())).split_whitespace().collect();
    match words[..] {
        [_, "count", count, "median", median, "worst", worst] => {
            let number = |word: &str| word.parse().expect("a number");
            Cost { count: number(count), median: number(median), worst: number(worst) }
        }
        _ => panic!("{words:?}"),
    }
}

#[test]
fn a_tick_takes_few_instructions_and_never_many() {
    print!("{}", text());
    let tick = cost("tick-governed");
    assert!(tick.count > 20_000, "the law hardly speaks: {tick:?}");
    assert!(tick.median <= TICK_MEDIAN_MAX, "{tick:?}");
    assert!(tick.worst <= TICK_WORST_MAX, "{tick:?}");
    assert!(cost("tick-ungoverned").worst <= UNGOVERNED_WORST_MAX, "{:?}", cost("tick-ungoverned"));
}

#[test]
fn a_tick_is_many_times_cheaper_than_the_sources_own_loop() {
    let tick = cost("tick-governed");
    let times = |name: &str| f64::from(cost(name).median) / f64::from(tick.median);
    for name in ["thesis-11-26-f32", "thesis-8-29-f32", "thesis-11-26-f64", "thesis-8-29-f64"] {
        assert_eq!(cost(name).count, tick.count, "the same ticks");
        println!("{name}: {} instructions, {:.1} times the tick's {}", cost(name).median, times(name), tick.median);
    }
    assert!(times("thesis-8-29-f32") >= TIMES_F32_MIN);
    assert!(times("thesis-8-29-f64") >= TIMES_F64_MIN);
}

#[test]
fn the_table_of_mathematics_in_the_docs_is_what_the_chip_does() {
    let docs = std::fs::read_to_string(arcfeed_tests::root().join("docs/real-time.md")).expect("the page is there");
    let table = run("math-cost").text();
    print!("{table}");
    let stale: Vec<&str> = table.lines().filter(|row| !docs.contains(row)).collect();
    assert!(table.lines().count() > 10 && stale.is_empty(), "not in docs/real-time.md: {stale:#?}");
}
