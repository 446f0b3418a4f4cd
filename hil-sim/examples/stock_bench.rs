//! Cost of cutting a stock: rays a second, threads, memory. Times are processor times, so that other work on the
//! machine has less effect; wall-clock times are printed beside them. The gain of two threads is the time of one over
//! the time of the busier of two.
//!
//! `cargo run --profile dist -p arcfeed-hil-sim --example stock_bench [STEP_MM]`. Figures of one run and its machine are in docs/stock.md.

use std::collections::HashMap;

use arcfeed_hil_sim::stock::motion::{Move, Pose};
use arcfeed_hil_sim::stock::solid::Block;
use arcfeed_hil_sim::stock::sweep::passes;
use arcfeed_hil_sim::stock::tool::Tool;
use arcfeed_hil_sim::stock::workpiece::Stock;

const EDGE_MM: f64 = 50.0;
const HEIGHT_MM: f64 = 20.0;
const MEMORY_MAX: usize = 4 << 30;

/// The processor clock counts hundredths of a second, so cases with fewer rays are repeated.
const ASKED_MIN: usize = 40_000_000;

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

/// Rays in the boxes of all sweeps.
fn rays_asked(stock: &Stock, tool: &Tool, moves: &[Move], tolerance_mm: f64) -> Result<(usize, usize), Error> {
    let (mut asked, mut count) = (0, 0);
    for moved in moves {
        let sweeps = moved.sweeps(tool, tolerance_mm)?;
        count += sweeps.len();
        for axis in 0..3 {
            let [_, row_axis] = arcfeed_hil_sim::stock::lattice::Lattice::across(axis);
            for pass in passes(tool, &sweeps, axis) {
                let lattice = stock.lattice();
                let reaches =
                    pass.rows(lattice).filter_map(|row| pass.reach(lattice, lattice.center_mm(row_axis, row)));
                asked += reaches.map(|reach| reach.columns().count()).sum::<usize>();
            }
        }
    }
    Ok((asked, count))
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
    let spent = processor_s().into_iter().map(|(thread, s)| s - before.get(&thread).copied().unwrap_or_default());
    let (all_s, busiest_s) = spent.fold((0.0, 0.0), |(all, most): (f64, f64), s| (all + s, most.max(s)));
    let took = Took { all_s: all_s / f64::from(repeats), busiest_s: busiest_s / f64::from(repeats), clock_s };
    Ok((took, stocks.swap_remove(0)))
}

fn main() -> Result<(), Error> {
    let step_mm = std::env::args().nth(1).map_or(Ok(0.2), |step| step.parse())?;
    let up = |_| [0.0, 0.0, 1.0];
    let swaying = |along: f64| [0.3 * libm::sin(along / 4.0), 0.1, 1.0];
    let cases = [
        ("flat R5, 3 axes", Tool::cylinder(5.0, 30.0)?, zigzag(4.0, 4.0, up)),
        ("ring 12/9, corner 1", Tool::ring([12.0, 9.0], 1.0, 30.0, step_mm / 20.0)?, zigzag(4.0, 6.0, up)),
        ("ball R3, 3 axes", Tool::ball(3.0, 30.0, step_mm / 20.0)?, zigzag(3.0, 2.0, up)),
        ("ball R3, 5 axes", Tool::ball(3.0, 10.0, step_mm / 20.0)?, zigzag(3.0, 5.0, swaying)),
    ];
    let volume_mm3 = EDGE_MM * EDGE_MM * HEIGHT_MM;
    println!("block {EDGE_MM} x {EDGE_MM} x {HEIGHT_MM} mm, step {step_mm} mm");
    println!(
        "tool                   sweeps  rays asked  CPU s: 1 thread  Mrays/s  2 threads  busiest  gain  clock s: 1, 2"
    );
    for (name, tool, moves) in cases {
        let block = Block { lowest_mm: [0.0; 3], highest_mm: [EDGE_MM, EDGE_MM, HEIGHT_MM] };
        let whole = Stock::new(&block, step_mm, MEMORY_MAX)?;
        let (asked, sweeps) = rays_asked(&whole, &tool, &moves, step_mm / 20.0)?;
        let repeats = (ASKED_MIN / asked + 1) as u32;
        let (alone, stock) = cut(repeats, 1, &whole, &tool, &moves)?;
        let (both, _) = cut(repeats, 2, &whole, &tool, &moves)?;
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
    }
    print_rows(&[0.2, 0.1])
}

/// Prints the time of a segment of [`rows`] and the error of the volume.
fn print_rows(steps_mm: &[f64]) -> Result<(), Error> {
    println!("rows of a flat end mill, {} segments of 1 mm:", rows::SEGMENTS);
    let (tool, moves) = (Tool::cylinder(rows::RADIUS_MM, 20.0)?, rows::moves());
    for step_mm in steps_mm {
        let whole = Stock::new(&Block { lowest_mm: [0.0; 3], highest_mm: rows::HIGHEST_MM }, *step_mm, MEMORY_MAX)?;
        let before = whole.volume();
        let (asked, _) = rays_asked(&whole, &tool, &moves, step_mm / 20.0)?;
        let (took, left) = cut((ASKED_MIN / asked + 1) as u32, 1, &whole, &tool, &moves)?;
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
