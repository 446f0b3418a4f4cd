//! Instructions per tick of each law, over whole example jobs.

use std::sync::OnceLock;

use arcfeed_tests::emulation::qemu::run;

/// What a tick may cost, instructions: median and worst where the law has a wish, worst where it has none, and how often
/// it must have one for that to say anything.
struct Budget {
    law: &'static str,
    count_min: u32,
    median_max: u32,
    worst_max: u32,
    rest_worst_max: Option<u32>,
}

const fn budget(
    law: &'static str,
    count_min: u32,
    [median_max, worst_max]: [u32; 2],
    rest_worst_max: Option<u32>,
) -> Budget {
    Budget { law, count_min, median_max, worst_max, rest_worst_max }
}

/// The whole supervisor around each law, just above what it takes.
const BUDGETS: [Budget; 8] = [
    budget("circumference", 20_000, [325, 440], Some(1_280)),
    budget("circumference-filtered", 20_000, [845, 1_250], Some(1_360)),
    budget("engaged-arc-one-edge", 20_000, [1_140, 1_475], Some(1_280)),
    budget("engaged-arc-both-edges", 20_000, [1_270, 1_815], Some(1_280)),
    budget("table", 20_000, [745, 1_060], Some(1_280)),
    budget("programmed", 50_000, [625, 1_280], None),
    budget("contour", 4_000, [675, 985], Some(1_390)),
    budget("engagement", 8_000, [840, 1_150], Some(1_390)),
];
/// How many times cheaper than the source's own loop, in f32 and in f64 without hardware for it.
const TIMES_F32_MIN: f64 = 16.0;
const TIMES_F64_MIN: f64 = 85.0;

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
fn a_tick_takes_few_instructions_under_each_law_and_never_many() {
    print!("{}", text());
    for Budget { law, count_min, median_max, worst_max, rest_worst_max } in BUDGETS {
        let tick = cost(&format!("tick-{law}"));
        assert!(tick.count > count_min, "{law} hardly speaks: {tick:?}");
        assert!(tick.median <= median_max && tick.worst <= worst_max, "{law}: {tick:?}");
        if let Some(rest_worst_max) = rest_worst_max {
            let rest = cost(&format!("rest-{law}"));
            assert!(rest.worst <= rest_worst_max, "without a wish under {law}: {rest:?}");
        }
    }
    let laws = text().lines().filter(|line| line.starts_with("tick-")).count();
    assert_eq!(laws, BUDGETS.len(), "a law without a budget");
}

#[test]
fn a_tick_is_many_times_cheaper_than_the_sources_own_loop() {
    let tick = cost("tick-circumference");
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
