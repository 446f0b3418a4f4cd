//! A serial port of this machine's own, where it has one.

use std::os::unix::fs::FileTypeExt;
use std::process::Command;

use arcfeed_line_errors::{Counts, NativePort, counts};
use arcfeed_tests::skip_loudly;

/// Asks the system what it has counted; prints nothing where it does not count.
const ASK: &str = "
import fcntl, os, struct, sys
port = os.open(sys.argv[1], os.O_RDWR | os.O_NONBLOCK | os.O_NOCTTY)
counted = bytearray(80)
fcntl.ioctl(port, 0x545D, counted)
print(*struct.unpack('20i', counted)[6:11])
";

/// Counters as Python reads them: frame, overrun, parity, break, buffer overrun.
fn by_python(name: &str) -> Option<[u32; 5]> {
    let output = Command::new("python3").args(["-c", ASK, name]).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let numbers: Vec<u32> = text.split_whitespace().filter_map(|number| number.parse().ok()).collect();
    numbers.try_into().ok()
}

#[test]
fn line_errors_of_a_real_port_are_those_that_python_reads() {
    let names = ["ttyS0", "ttyS1", "ttyS2", "ttyS3", "ttyUSB0", "ttyUSB1"].map(|name| format!("/dev/{name}"));
    let is_device = |name: &String| std::fs::metadata(name).is_ok_and(|found| found.file_type().is_char_device());
    let open = |name: String| Some((NativePort::open(&serialport::new(&name, 9_600)).ok()?, name));
    let mut compared = 0;
    for (port, name) in names.into_iter().filter(is_device).filter_map(open) {
        // A port is ours alone once it is open; root reads it all the same, others after it is closed.
        let found = counts(&port);
        drop(port);
        let Some([frame, overrun, parity, breaks, buffer_overrun]) = by_python(&name) else { continue };
        assert_eq!(found, Some(Counts { frame, overrun, parity, breaks, buffer_overrun }), "{name}");
        println!("{name}: {found:?}");
        compared += 1;
    }
    if compared == 0 {
        let why = "no serial port with counters that this user may open, or no Python 3 to compare with";
        skip_loudly("line_errors_of_a_real_port_are_those_that_python_reads", why);
    }
}
