use std::path::Path;
use std::time::{Duration, SystemTime};

use arcfeed_line_errors::Counts;
use arcfeed_units::Micros;
use clap::Parser;

use super::*;
use crate::port::PortError;
use crate::report::summary::RunSummary;

#[derive(Parser)]
struct CommandLine {
    #[command(flatten)]
    stream: Stream,
}

/// Control that requests once and accepts everything; from the hundredth character on two of its own come in damaged.
#[derive(Default)]
struct Damaged {
    now: Micros,
    has_asked: bool,
    taken: usize,
}

impl Port for Damaged {
    fn now(&self) -> Micros {
        self.now
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        if std::mem::replace(&mut self.has_asked, true) {
            return Ok(0);
        }
        buffer[0] = 0x11;
        Ok(1)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.taken += bytes.len();
        Ok(bytes.len())
    }

    fn wait(&mut self, deadline: Micros) {
        self.now = deadline.max(self.now.after(Micros(1)));
    }

    fn line_errors(&self) -> Option<Counts> {
        let (parity, frame) = if self.taken < 100 { (0, 0) } else { (1, 1) };
        Some(Counts { parity, frame, ..Counts::default() })
    }

    fn opened(&self) -> Option<SystemTime> {
        Some(SystemTime::UNIX_EPOCH + Duration::from_secs(951_782_400))
    }
}

#[test]
fn damaged_characters_are_reported_at_once_in_the_log_in_the_report_and_in_json() {
    let scratch = tempfile::tempdir().unwrap();
    let log = scratch.path().join("log");
    let job = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/ibr-slot/job.toml");
    let arguments = ["stream", job.to_str().unwrap(), "--port", "COM7", "--log", log.to_str().unwrap(), "--json"];
    let stream = CommandLine::parse_from(arguments).stream;
    let ready = PreparedProgram::load(&stream.input, &stream.line, false).unwrap();
    let mut sender = Sender::new(ready.whole.clone(), ready.line_use(&stream.port));
    let (report, end) = stream
        .over_line(&ready, &mut Damaged::default(), &mut sender, (Logbook::none(), BoardSession::none()))
        .unwrap();
    assert!(matches!(end, End::Complete));
    let log = std::fs::read_to_string(log).unwrap();
    assert!(log.starts_with("# ibr-slot.nc to COM7; opened 2000-02-29T00:00:00Z; seconds since"), "{log}");
    let warnings: Vec<&str> = log.lines().filter(|line| line.contains("warning:")).collect();
    assert_eq!(warnings.len(), 1, "{log}");
    assert!(warnings[0].contains("1 with wrong parity, 1 without stop bits") && warnings[0].contains("DC3"), "{log}");
    let place = log.find("warning:").unwrap();
    assert!(log[place..].contains("sent line 20:"), "reported while the program is sent:\n{log}");
    let json = serde_json::json!(report);
    let wanted = serde_json::json!({ "frame": 1, "overrun": 0, "parity": 1, "break": 0, "buffer_overrun": 0 });
    assert_eq!(json["link"]["line_errors"], wanted);
    let text = RunSummary { title: String::new(), report: &report }.to_string();
    assert!(text.contains("DAMAGED characters from the control: 1 with wrong parity, 1 without stop bits"), "{text}");
}
