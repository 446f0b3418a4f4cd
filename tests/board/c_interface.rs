//! The C interface: its header, its static library without a reachable panic, and the example in C on the emulated board.

use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

use arcfeed::job::JobFile;
use arcfeed_board_app::application::report::state_code;
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller::Measurement;
use arcfeed_firmware::output::telemetry::reason::Cause;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_link::message::page::{self, TappedLine};
use arcfeed_model::job::Job;
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path as Track, Segment};
use arcfeed_tests::emulation::images::static_library;
use arcfeed_tests::emulation::qemu;
use arcfeed_tests::valgrind::valgrind_or_skip;
use arcfeed_tests::{Scratch, root};
use arcfeed_units::{Nm, RevPerMin, Span};
use cbindgen::{Builder, Config, DocumentationStyle, Language, RenameRule};

/// Undefined function that the panic handler calls.
const GATE: &str = "arcfeed_a_panic_can_be_reached";
const CHIP: [&str; 9] = [
    "-std=c11",
    "-O2",
    "-ffreestanding",
    "-mcpu=cortex-m4",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv4-sp-d16",
    "-nostdlib",
    "-Werror",
];
/// First lines of the header.
const HEADER_TOP: &str = "\
// arcfeed: feed controller for milling, C interface. See firmware/c/README.md.
//
// Every call checks its arguments; one with an error does nothing, except that arcfeed_tick and arcfeed_adaptive_feed
// write outputs that stop the feed. Calls for one controller must not overlap in time.";
const SPINDLE: RevPerMin = RevPerMin(4_000.0);

/// A line that the example prints.
#[derive(Debug, PartialEq, Eq)]
struct Tick {
    line: i64,
    position: [i64; 2],
    state: i64,
    reason: i64,
    percent: i64,
}

fn job() -> Job {
    JobFile::load(&root().join("examples/c/job.toml")).expect("the example's job").job
}

fn write_page(scratch: &Scratch) {
    scratch.write("page.bin", page::write(&job(), TappedLine::default()).expect("a page"));
}

/// Compiles the example with this library; the emulator is to run `image`.
fn compile_example(scratch: &Scratch, library: &Path) -> Output {
    write_page(scratch);
    let folder = root().join("examples/c");
    let mut gcc = Command::new("arm-none-eabi-gcc");
    gcc.args(CHIP).args(["-Wall", "-Wextra", "-I"]).arg(root().join("firmware/c/include"));
    gcc.arg(format!("-Wa,-I{}", Path::new(&scratch.path("page.bin")).parent().expect("a folder").display()));
    gcc.args(["-T", "mps2.ld", "-Wl,--gc-sections,-z,noexecstack", "main.c", "start.c"]).arg(library);
    gcc.args(["-lgcc", "-o"]).arg(scratch.path("image")).current_dir(folder);
    gcc.output().unwrap_or_else(|error| {
        panic!("arm-none-eabi-gcc: {error}. It compiles the example in C; `cargo xtask test` installs it.")
    })
}

fn assert_done(output: &Output) {
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn ticks() -> &'static [Tick] {
    static TICKS: OnceLock<Vec<Tick>> = OnceLock::new();
    TICKS.get_or_init(|| {
        let scratch = Scratch::new("example-in-c");
        assert_done(&compile_example(&scratch, &static_library(true, "")));
        let console = qemu::run_image("example-in-c", Path::new(&scratch.path("image"))).text();
        let tick = |line: &str| {
            let numbers: Vec<i64> = line.split(' ').map(|number| number.parse().expect("a number")).collect();
            let [line, x, y, state, reason, percent] = numbers[..] else { panic!("six numbers: {line}") };
            Tick { line, position: [x, y], state, reason, percent }
        };
        console.lines().map(tick).collect()
    })
}

/// The half circles of the example by line and rule.
fn segments(job: &Job) -> [(u32, ActiveSegment); 2] {
    [(6, -20_000_000, Turn::Cw), (7, 20_000_000, Turn::Ccw)].map(|(line, x, turn)| {
        let [from, to] = [[Nm(x), Nm(0)], [Nm(-x), Nm(0)]];
        let pose = |[x, y]: [Nm; 2]| Pose { linear: [x, y, Nm(0)], ..Pose::default() };
        let path = Track::Arc(Arc { plane: Plane::Xy, turn, center: [Nm(0); 2], from, to });
        let feed = Feed::PerMinute(Nm(800_000_000));
        let segment = Segment { sequence: None, start: pose(from), end: pose(to), feed, path };
        (line, ActiveSegment::new(&segment, job.rules.get(line as usize - 6), job))
    })
}

#[test]
fn the_example_in_c_has_on_the_chip_the_overrides_of_the_rust_controller_to_the_bit() {
    let (job, ticks) = (job(), ticks());
    let segments = segments(&job);
    let supervisor = Supervisor::new(&job, Settings::default()).expect("settings");
    let mut memory = Memory::with_override(FeedOverride::PROGRAMMED);
    for (at, tick) in ticks.iter().enumerate() {
        let work = segments.iter().find(|(line, _)| i64::from(*line) == tick.line);
        let [x, y] = tick.position.map(Nm);
        let position = Some(Pose { linear: [x, y, Nm(0)], ..Pose::default() });
        let measured = Measurement { position, spindle: SPINDLE, dt: Span::from_ms(1) };
        let signals = if at == 1 { Signals::of_request(Request::Arm) } else { Signals::NONE };
        let input = Input { signals, ..Input::of(measured) };
        let output = supervisor.tick(&mut memory, work.map(|(line, segment)| (*line, segment)), &input);
        let expected = Tick {
            line: tick.line,
            position: tick.position,
            state: state_code(&output.state) as i64,
            reason: Cause::from(output.reason) as i64,
            percent: i64::from(output.feed_override.percent),
        };
        assert_eq!(*tick, expected, "tick {at}");
    }
    println!("{} ticks in C on the emulated chip, each as the Rust controller has it", ticks.len());
    assert!(ticks.len() > 5_000);
}

/// docs/laws.md#contour: q/(q - r) outside and q/(q + r) inside, of q = 20 mm and r = 5 mm.
#[test]
fn the_example_in_c_keeps_the_feed_of_both_contours() {
    let overrides = |line| ticks().iter().filter(move |tick| tick.line == line).map(|tick| tick.percent);
    assert_eq!((overrides(6).max(), overrides(7).max(), overrides(7).min()), (Some(133), Some(80), Some(80)));
}

#[test]
fn no_program_with_a_panic_in_reach_links() {
    let scratch = Scratch::new("c-gate");
    let failed = compile_example(&scratch, &static_library(true, "prove-the-gate"));
    let errors = text(&failed.stderr);
    assert!(!failed.status.success() && errors.contains(&format!("undefined reference to `{GATE}'")), "{errors}");
    let failed = compile_readme(&scratch, &static_library(false, "prove-the-gate"));
    let errors = text(&failed.stderr);
    assert!(!failed.status.success() && errors.contains(&format!("undefined reference to `{GATE}'")), "{errors}");
}

fn compile_readme(scratch: &Scratch, library: &Path) -> Output {
    let readme = std::fs::read_to_string(root().join("firmware/c/README.md")).expect("the readme");
    let snippet = readme.split("```c\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a program in C");
    scratch.write("readme.c", snippet.as_bytes());
    let mut cc = Command::new("cc");
    cc.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-Wl,--gc-sections", "-I"]);
    cc.arg(root().join("firmware/c/include")).arg(scratch.path("readme.c")).arg(library).arg("-o");
    cc.arg(scratch.path("readme")).output().expect("the compiler that links Rust's programs, too")
}

#[test]
fn the_program_of_the_readme_runs() {
    let scratch = Scratch::new("c-readme");
    write_page(&scratch);
    assert_done(&compile_readme(&scratch, &static_library(false, "")));
    let mut program = Command::new(scratch.path("readme"));
    program.current_dir(Path::new(&scratch.path("page.bin")).parent().expect("a folder"));
    let output = program.output().expect("it runs");
    assert_done(&output);
    assert_eq!(text(&output.stdout), "100 % in state 2\n".repeat(3));
}

/// As valgrind's memcheck sees it: no access beyond the caller's memory, no use of what was never written.
#[test]
fn the_library_touches_only_the_memory_that_it_was_given() {
    let test = "the_library_touches_only_the_memory_that_it_was_given";
    let Some(mut memcheck) = valgrind_or_skip(test) else { return };
    let scratch = Scratch::new("c-memcheck");
    write_page(&scratch);
    assert_done(&compile_readme(&scratch, &static_library(false, "")));
    memcheck.args(["--error-exitcode=99", &scratch.path("readme")]);
    let output = memcheck.current_dir(scratch.path("")).output().expect("it runs");
    assert_done(&output);
    let summary = text(&output.stderr);
    assert!(summary.contains("ERROR SUMMARY: 0 errors"), "{summary}");
    println!("{}", summary.lines().last().unwrap_or_default());
}

/// Form of the header. Not in a file `cbindgen.toml`, because the reader of that would be compiled with the tests, a third of their code.
fn header_form() -> Config {
    let mut form = Config {
        language: Language::C,
        include_guard: Some("ARCFEED_H".into()),
        no_includes: true,
        sys_includes: ["stddef.h", "stdint.h"].map(str::to_owned).to_vec(),
        cpp_compat: true,
        documentation_style: DocumentationStyle::C99,
        line_length: 110,
        usize_is_size_t: true,
        header: Some(HEADER_TOP.into()),
        ..Config::default()
    };
    form.enumeration.prefix_with_name = true;
    form.enumeration.rename_variants = RenameRule::ScreamingSnakeCase;
    form
}

/// `UPDATE_GOLDEN=1` writes it.
#[test]
fn the_header_is_that_of_the_sources() {
    let folder = root().join("firmware/c");
    let sources = ["status", "values", "exports"].map(|name| folder.join(format!("src/{name}.rs")));
    let builder = sources.iter().fold(Builder::new().with_config(header_form()), Builder::with_src);
    let mut generated = Vec::new();
    builder.generate().expect("a header").write(&mut generated);
    let path = folder.join("include/arcfeed.h");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &generated).expect("the header is written");
    }
    assert_eq!(text(&std::fs::read(path).expect("the header")), text(&generated));
}
