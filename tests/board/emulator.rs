//! QEMU, with bounded time.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use crate::images::image;

/// No image takes more than some seconds.
const PATIENCE: Duration = Duration::from_secs(300);
/// One instruction takes 2^7 ns, waiting takes no time: `clock.rs` of the board.
const CLOCK: &str = "shift=7,sleep=off";

/// What a run left behind.
pub struct Run {
    /// What the image wrote to the emulator's console.
    pub console: Vec<u8>,
    /// What UART 1 sent.
    pub uart1: Vec<u8>,
}

impl Run {
    /// The console as text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.console).into_owned()
    }
}

/// Runs an image to its end, which must be a good one.
pub fn run(name: &str) -> Run {
    let image = image(name);
    let place = scratch(&image, name);
    let (console, uart1) = (place.join("console"), place.join("uart1"));
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "mps2-an386", "-cpu", "cortex-m4", "-display", "none", "-monitor", "none"]);
    qemu.args(["-icount", CLOCK, "-semihosting-config", "enable=on,target=native", "-serial", "null", "-serial"]);
    qemu.arg(format!("file:{}", uart1.display())).arg("-kernel").arg(&image);
    qemu.stdin(Stdio::null()).stdout(File::create(&console).expect("a file for the console"));
    let mut child = qemu.spawn().unwrap_or_else(|error| {
        panic!("qemu-system-arm: {error}. It is what stands for the chip here; `cargo xtask test` installs it.")
    });
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("the emulator can be waited for") {
            break status;
        }
        if started.elapsed() > PATIENCE {
            child.kill().expect("the emulator can be stopped");
            panic!("{name} still runs after {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let read = |path: &PathBuf| fs::read(path).unwrap_or_default();
    let run = Run { console: read(&console), uart1: read(&uart1) };
    let _ = fs::remove_dir_all(&place);
    assert!(status.success(), "{name}: {status}\n{}", run.text());
    run
}

/// An empty folder beside the image, for this run alone.
fn scratch(image: &Path, name: &str) -> PathBuf {
    static RUNS: AtomicU32 = AtomicU32::new(0);
    let run = RUNS.fetch_add(1, Ordering::Relaxed);
    let place = image.with_file_name(format!("run-{name}-{}-{run}", std::process::id()));
    let _ = fs::remove_dir_all(&place);
    fs::create_dir_all(&place).expect("a folder beside the image");
    place
}
