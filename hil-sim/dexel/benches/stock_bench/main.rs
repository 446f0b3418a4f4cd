//! Cost of cutting a stock: rays a second, threads, memory. Times are processor times, so that other work on the
//! machine has less effect; wall-clock times are printed beside them. The gain of two threads is the time of one over
//! the time of the busier of two.
//!
//! A height field of one family of rays is the yardstick for three axes: how much longer the stock takes for a ray and for a move.
//!
//! `cargo bench --profile dist -p arcfeed-dexel --bench stock_bench -- [STEP_MM [CASE [RAYS_MIN]]]`, CASE being a part of a case's name:
//! only such cases run. With RAYS_MIN 0 each is done once, which is how instructions are counted (`valgrind --tool=callgrind`).
//! Figures of one run and its machine are in docs/stock.md.

mod height_field;

use std::collections::HashMap;

use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::sweep::passes;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;

use height_field::HeightField;

const EDGE_MM: f64 = 50.0;
const HEIGHT_MM: f64 = 20.0;
const MEMORY_MAX: usize = 4 << 30;

/// The processor clock counts hundredths of a second, so cases with fewer rays are repeated.
const ASKED_MIN: usize = 40_000_000;

/// Cuts of the height field for one of the stock.
const HEIGHT_FIELD_RUNS: usize = 10;

type Error = Box<dyn std::error::Error + Send + Sync>;

/// Lines across the block, to and fro, 1 mm forward at a time, each line further by `stepover_mm`.
fn zigzag(depth_mm: f64, stepover_mm: f64, axis: impl Fn(f64) -> [f64; 3]) -> Vec<Move> {
    let lines = (EDGE_MM / stepover_mm) as u32;
    let pieces = EDGE_MM as u32;
    let pose = |line: u32, piece: u32| {
        let along = f64::from(if line.is_multiple_of(2) { piece } else { pieces - piece });
        let tip_mm = [along, (f64::from(line) + 0.5) * stepover_mm, HEIGHT_MM - depth_mm];
        Pose { tip_mm, axis: axis(along) }
    };
    let pairs = (0..lines).flat_map(|line| (0..pieces).map(move |piece| (line, piece)));
    pairs.map(|(line, piece)| Move::Straight { from: pose(line, piece), to: pose(line, piece + 1) }).collect()
}

/// The benchmark of an open simulator (cutrail 0.1.1, `bench 1000 10 1`): a thousand millimetres in rows 2 mm apart, 1.5 mm deep.
mod rows {
    use super::{Move, Pose};

    pub const SEGMENTS: usize = 1000;
    pub const HIGHEST_MM: [f64; 3] = [200.0, 100.0, 20.0];
    pub const RADIUS_MM: f64 = 3.0;
    /// Volume of the union of all discs, by integration.
    pub const TRUE_MM3: f64 = 4268.0731;

    const FROM_MM: f64 = 5.0;
    const PIECES: usize = 190;

    /// Moves of the benchmark.
    pub fn moves() -> Vec<Move> {
        let pose = |row: usize, piece: usize| {
            let piece = if row.is_multiple_of(2) { piece } else { PIECES - piece };
            let tip_mm = [FROM_MM + piece as f64, FROM_MM + 2.0 * row as f64, 18.5];
            Pose { tip_mm, axis: [0.0, 0.0, 1.0] }
        };
        let straight = |n: usize| {
            let (row, piece) = (n / PIECES, n % PIECES);
            Move::Straight { from: pose(row, piece), to: pose(row, piece + 1) }
        };
        (0..SEGMENTS).map(straight).collect()
    }
}

/// Cuts height fields, one move at a time; seconds a run, rays asked in a run, what is left.
fn cut_plain(
    runs: usize,
    step_mm: f64,
    ball_mm: Option<f64>,
    radius_mm: f64,
    moves: &[Move],
) -> (f64, usize, Vec<f64>) {
    let mut fields: Vec<_> = (0..runs).map(|_| HeightField::new(EDGE_MM, HEIGHT_MM, step_mm)).collect();
    let (before, mut asked) = (processor_s(), 0);
    for field in &mut fields {
        for moved in moves {
            let Move::Straight { from, to } = moved else { continue };
            let ways = [from.tip_mm, to.tip_mm];
            asked += match ball_mm {
                Some(ball_mm) => lower_to_ball(field, ways, ball_mm),
                None => lower_to_disc(field, ways, radius_mm),
            };
        }
    }
    let spent_s = spent_s(&before).0;
    (spent_s / runs as f64, asked / runs, fields.swap_remove(0).heights_mm)
}

#[inline(never)]
fn lower_to_ball(field: &mut HeightField, way: [[f64; 3]; 2], radius_mm: f64) -> usize {
    let center_mm = way[0][2] + radius_mm;
    field.cut(way, radius_mm, |near| {
        let square = radius_mm * radius_mm - near;
        center_mm - libm::sqrt(if square > 0.0 { square } else { 0.0 })
    })
}

#[inline(never)]
fn lower_to_disc(field: &mut HeightField, way: [[f64; 3]; 2], radius_mm: f64) -> usize {
    let tip_mm = way[0][2];
    field.cut(way, radius_mm, |_| tip_mm)
}

/// Sweeps of all moves, and the rays of each family that are asked, a sweep at a time: those in its outline, as far as that is known.
fn rays_asked(stock: &Stock, tool: &Tool, moves: &[Move], tolerance_mm: f64) -> Result<(usize, [usize; 3]), Error> {
    let (mut asked, mut count) = ([0; 3], 0);
    let lattice = stock.lattice();
    // The last sweep that has asked a ray.
    let mut last = [0, 1, 2].map(|axis| vec![0; lattice.size(axis).iter().product()]);
    for moved in moves {
        for sweep in moved.sweeps(tool, tolerance_mm)? {
            count += 1;
            for axis in 0..3 {
                let ([width, _], [_, row_axis]) = (lattice.size(axis), Lattice::across(axis));
                for pass in passes(tool, &[sweep], axis) {
                    for row in pass.rows(lattice) {
                        let reach = pass.reach(lattice, lattice.center_mm(row_axis, row));
                        for column in reach.iter().flat_map(|reach| reach.columns()) {
                            let last = &mut last[axis][row * width + column];
                            asked[axis] += usize::from(*last != count);
                            *last = count;
                        }
                    }
                }
            }
        }
    }
    Ok((count, asked))
}

/// Processor time of each thread of this process, in hundredths of a second as Linux counts.
fn processor_s() -> HashMap<String, f64> {
    let of_thread = |entry: std::fs::DirEntry| {
        let stat = std::fs::read_to_string(entry.path().join("stat")).unwrap_or_default();
        let after_name = stat.rsplit(')').next().unwrap_or_default();
        let ticks = after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok());
        (entry.file_name().to_string_lossy().into_owned(), ticks.sum::<f64>() / 100.0)
    };
    std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten().map(of_thread).collect()
}

/// Since then: by all threads together, by the busiest.
fn spent_s(before: &HashMap<String, f64>) -> (f64, f64) {
    let spent = processor_s().into_iter().map(|(thread, s)| s - before.get(&thread).copied().unwrap_or_default());
    spent.fold((0.0, 0.0), |(all, most): (f64, f64), s| (all + s, most.max(s)))
}

/// Times of a run.
struct Took {
    /// Processor time of all threads.
    all_s: f64,
    /// Processor time of the busiest thread: the time of the run if every thread has its own core.
    busiest_s: f64,
    clock_s: f64,
}

/// Cuts a stock move by move, `repeats` times; returns the time of each and the remaining stock.
fn cut(repeats: u32, threads: usize, whole: &Stock, tool: &Tool, moves: &[Move]) -> Result<(Took, Stock), Error> {
    let step_mm = whole.lattice().step_mm();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let mut stocks = vec![whole.clone(); repeats as usize];
    let (started, before) = (std::time::Instant::now(), processor_s());
    pool.install(|| -> Result<(), Error> {
        for stock in &mut stocks {
            // Sixteen moves at a time, as a simulation does between two volume measurements.
            for moves in moves.chunks(16) {
                let mut sweeps = Vec::new();
                for moved in moves {
                    sweeps.extend(moved.sweeps(tool, step_mm / 20.0)?);
                }
                stock.cut(tool, &sweeps)?;
            }
        }
        Ok(())
    })?;
    let clock_s = started.elapsed().as_secs_f64() / f64::from(repeats);
    let (all_s, busiest_s) = spent_s(&before);
    let took = Took { all_s: all_s / f64::from(repeats), busiest_s: busiest_s / f64::from(repeats), clock_s };
    Ok((took, stocks.swap_remove(0)))
}

struct Case {
    name: &'static str,
    tool: Tool,
    moves: Vec<Move>,
    /// Radius, where a height field can do the same, and whether the tool is a ball.
    plain: Option<(f64, bool)>,
}

fn cases(step_mm: f64) -> Result<Vec<Case>, Error> {
    let up = |_| [0.0, 0.0, 1.0];
    let swaying = |along: f64| [0.3 * libm::sin(along / 4.0), 0.1, 1.0];
    let tolerance_mm = step_mm / 20.0;
    let case = |name, tool, moves, plain| Case { name, tool, moves, plain };
    Ok(vec![
        case("flat R5, 3 axes", Tool::cylinder(5.0, 30.0)?, zigzag(4.0, 4.0, up), Some((5.0, false))),
        case("ring 12/9, corner 1", Tool::ring([12.0, 9.0], 1.0, 30.0, tolerance_mm)?, zigzag(4.0, 6.0, up), None),
        case("ball R3, 3 axes", Tool::ball(3.0, 30.0, tolerance_mm)?, zigzag(3.0, 2.0, up), Some((3.0, true))),
        case("ball R3, 5 axes", Tool::ball(3.0, 10.0, tolerance_mm)?, zigzag(3.0, 5.0, swaying), None),
    ])
}

fn main() -> Result<(), Error> {
    // Cargo adds `--bench` to the arguments.
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let step_mm = arguments.next().map_or(Ok(0.2), |step| step.parse())?;
    let only = arguments.next().unwrap_or_default();
    let asked_min = arguments.next().map_or(Ok(ASKED_MIN), |rays| rays.parse())?;
    println!("block {EDGE_MM} x {EDGE_MM} x {HEIGHT_MM} mm, step {step_mm} mm");
    println!(
        "tool                   sweeps  rays asked  CPU s: 1 thread  Mrays/s  2 threads  busiest  gain  clock s: 1, 2"
    );
    for case in cases(step_mm)?.iter().filter(|case| case.name.contains(&only)) {
        print_case(case, step_mm, asked_min)?;
    }
    if "rows".contains(&only) { print_rows(&[0.2, 0.1]) } else { Ok(()) }
}

fn print_case(case: &Case, step_mm: f64, asked_min: usize) -> Result<(), Error> {
    let Case { name, tool, moves, plain } = case;
    let volume_mm3 = EDGE_MM * EDGE_MM * HEIGHT_MM;
    let block = Block { lowest_mm: [0.0; 3], highest_mm: [EDGE_MM, EDGE_MM, HEIGHT_MM] };
    let whole = Stock::new(&block, step_mm, MEMORY_MAX)?;
    let (sweeps, by_axis) = rays_asked(&whole, tool, moves, step_mm / 20.0)?;
    let asked = by_axis.iter().sum::<usize>();
    let repeats = (asked_min / asked + 1) as u32;
    let (alone, stock) = cut(repeats, 1, &whole, tool, moves)?;
    let (both, _) = cut(repeats, 2, &whole, tool, moves)?;
    println!(
        "{name:20} {sweeps:8}  {asked:10}  {:15.3}  {:7.1}  {:9.3}  {:7.3}  {:4.2}  {:10.3}, {:.3}",
        alone.all_s,
        asked as f64 / alone.all_s / 1e6,
        both.all_s,
        both.busiest_s,
        alone.all_s / both.busiest_s,
        alone.clock_s,
        both.clock_s,
    );
    let [before, after] = [&whole, &stock].map(|stock| stock.memory_bytes() as f64 / volume_mm3);
    let removed_mm3 = volume_mm3 - stock.volume().mean_mm3();
    println!("  removed {removed_mm3:.2} mm3; {before:.1} bytes/mm3 of block before, {after:.1} after");
    if let Some((radius_mm, is_ball)) = *plain {
        let runs = HEIGHT_FIELD_RUNS * repeats as usize;
        let (plain_s, plain_asked, heights_mm) =
            cut_plain(runs, step_mm, is_ball.then_some(radius_mm), radius_mm, moves);
        let upright_s = cut_upright(repeats as usize, &whole, tool, moves)?;
        let tops_mm = stock.grids()[2].dexels().iter().map(|ray| ray.extent().map_or(0.0, |extent| extent.to_mm));
        let off_mm = tops_mm.zip(heights_mm).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let ns = |s: f64, rays: usize| s / rays as f64 * 1e9;
        let plain_ns = ns(plain_s, plain_asked);
        println!(
            "  height field: {plain_asked} rays, {plain_ns:.2} ns each; largest difference of heights {off_mm:.1e} mm"
        );
        for (family, s, rays) in [("x, y, z", alone.all_s, asked), ("z alone", upright_s, by_axis[2])] {
            let ns = ns(s, rays);
            println!(
                "    {family}: {rays} rays, {ns:.2} ns each: {:.1} times the height field a ray, {:.1} a move",
                ns / plain_ns,
                s / plain_s
            );
        }
        println!("    asked along x, y, z: {by_axis:?}");
    }
    Ok(())
}

/// Cuts the rays along z only; seconds a run.
fn cut_upright(runs: usize, whole: &Stock, tool: &Tool, moves: &[Move]) -> Result<f64, Error> {
    let mut grids = vec![whole.grids()[2].clone(); runs];
    let step_mm = whole.lattice().step_mm();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let before = processor_s();
    pool.install(|| -> Result<(), Error> {
        for grid in &mut grids {
            for moves in moves.chunks(16) {
                let mut sweeps = Vec::new();
                for moved in moves {
                    sweeps.extend(moved.sweeps(tool, step_mm / 20.0)?);
                }
                grid.cut(&passes(tool, &sweeps, 2));
            }
        }
        Ok(())
    })?;
    Ok(spent_s(&before).0 / runs as f64)
}

/// Prints the time of a segment of [`rows`] and the error of the volume.
fn print_rows(steps_mm: &[f64]) -> Result<(), Error> {
    println!("rows of a flat end mill, {} segments of 1 mm:", rows::SEGMENTS);
    let (tool, moves) = (Tool::cylinder(rows::RADIUS_MM, 20.0)?, rows::moves());
    for step_mm in steps_mm {
        let whole = Stock::new(&Block { lowest_mm: [0.0; 3], highest_mm: rows::HIGHEST_MM }, *step_mm, MEMORY_MAX)?;
        let before = whole.volume();
        let (_, asked) = rays_asked(&whole, &tool, &moves, step_mm / 20.0)?;
        let (took, left) = cut((ASKED_MIN / asked.iter().sum::<usize>() + 1) as u32, 1, &whole, &tool, &moves)?;
        let removed = [0, 1, 2].map(|axis: usize| before.by_axis[axis] - left.volume().by_axis[axis]);
        println!(
            "  {step_mm} mm: {:.1} us a segment; by rays along z {:+.1e} of {} mm3, mean of all {:+.1e}; {:.1} MiB",
            took.all_s / rows::SEGMENTS as f64 * 1e6,
            removed[2] / rows::TRUE_MM3 - 1.0,
            rows::TRUE_MM3,
            removed.iter().sum::<f64>() / 3.0 / rows::TRUE_MM3 - 1.0,
            left.memory_bytes() as f64 / f64::from(1 << 20),
        );
    }
    Ok(())
}
