//! Instructions per tick of each law, over whole example jobs.

use std::sync::OnceLock;

use arcfeed_tests::emulation::qemu::run;

/// Most instructions of a tick under every law and without one: median and worst.
const MEDIAN_MAX: u32 = 450;
const WORST_MAX: u32 = 700;
/// The laws, how often each must have a demand for that to say anything, and the most instructions in which a block is prepared under it.
const LAWS: [(&str, u32, u32); 8] = [
    ("circumference", 20_000, 60_000),
    ("circumference-filtered", 20_000, 60_000),
    ("engaged-arc-one-edge", 20_000, 110_000),
    ("engaged-arc-both-edges", 20_000, 160_000),
    ("table", 20_000, 60_000),
    ("programmed", 50_000, 13_000),
    ("contour", 4_000, 33_000),
    ("engagement", 8_000, 35_000),
];
/// Least ratio of the cost of the source's own loop, in f32 and in software f64, to the cost of a tick.
const TIMES_F32_MIN: f64 = 12.0;
const TIMES_F64_MIN: f64 = 62.0;

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
fn a_tick_and_a_block_take_few_instructions_under_each_law_and_without_one_and_never_many() {
    print!("{}", text());
    for (law, count_min, prepare_max) in LAWS {
        let prepare = cost(&format!("prepare-{law}"));
        assert!(prepare.worst <= prepare_max, "{law}: a block is prepared in {prepare:?}");
        let tick = cost(&format!("tick-{law}"));
        assert!(tick.count > count_min, "{law} hardly speaks: {tick:?}");
        // Without a law all ticks are of one kind.
        let rest = (law != "programmed").then(|| cost(&format!("rest-{law}")));
        for cost in [Some(tick), rest].into_iter().flatten() {
            assert!(cost.median <= MEDIAN_MAX && cost.worst <= WORST_MAX, "{law}: {cost:?}");
        }
    }
    let laws = text().lines().filter(|line| line.starts_with("tick-")).count();
    assert_eq!(laws, LAWS.len(), "a law that is not judged");
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
fn documented_costs_of_functions_agree_with_the_chip() {
    let docs = std::fs::read_to_string(arcfeed_tests::root().join("docs/real-time.md")).expect("the page is there");
    let table = run("math-cost").text();
    print!("{table}");
    let stale: Vec<&str> = table.lines().filter(|row| !docs.contains(row)).collect();
    assert!(table.lines().count() > 10 && stale.is_empty(), "not in docs/real-time.md: {stale:#?}");
}
