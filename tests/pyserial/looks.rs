//! What people and scripts see: the lines of a spy, the list of ports.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use arcfeed::job::{Parity, SerialSettings};
use arcfeed::port::list::{PortInfo, below};
use arcfeed::port::open::open;
use arcfeed_tests::{Scratch, run};

use crate::python::{output, python_or_skip};

const SETTINGS: SerialSettings = SerialSettings {
    baudrate: 9_600,
    bytesize: 8,
    parity: Parity::None,
    stopbits: 1,
    xonxoff: false,
    rtscts: false,
    write_timeout: None,
    exclusive: true,
};

/// What our spy writes down while data goes round a loop.
fn ours(file: &str, options: &str, data: &[Vec<u8>]) -> String {
    let url = format!("spy://loop://?file={file}{options}").parse().expect("a URL");
    let mut port = open(&url, &SETTINGS).expect("a loop opens");
    let mut buffer = [0; 512];
    for bytes in data {
        assert_eq!(port.write(bytes).expect("room"), bytes.len());
        assert_eq!(port.read(&mut buffer).expect("a loop stays"), bytes.len());
    }
    if options.contains("all") {
        assert_eq!(port.read(&mut buffer).expect("a loop stays"), 0);
    }
    drop(port);
    fs::read_to_string(file).expect("the spy's file")
}

/// Lines without their times, which must look like one.
fn without_times(text: &str) -> Vec<String> {
    let without = |line: &str| {
        let at = line.find(|c: char| c.is_ascii_digit() && !line.starts_with('\u{1b}')).unwrap_or(5);
        let (time, rest) = line[at..].split_at(10);
        assert!(time.len() == 10 && time.as_bytes()[6] == b'.', "{line:?}");
        format!("{}{rest}", &line[..at])
    };
    text.lines().map(without).collect()
}

#[test]
fn the_spy_writes_what_pyserials_spy_writes() {
    let Some(python) = python_or_skip("spy") else { return };
    let scratch = Scratch::new("spy");
    let data: Vec<Vec<u8>> = [1, 7, 8, 9, 15, 16, 17, 40, 256].map(|len| (0..len).map(|at| at as u8).collect()).into();
    let hex: Vec<String> = data.iter().map(|bytes| bytes.iter().map(|byte| format!("{byte:02x}")).collect()).collect();
    for options in ["", "&color", "&all"] {
        let (theirs, file) = (scratch.path("theirs"), scratch.path("ours"));
        let theirs_options = format!("?file={theirs}{options}");
        let arguments: Vec<&str> =
            std::iter::once(theirs_options.as_str()).chain(hex.iter().map(String::as_str)).collect();
        output(python, "spy.py", &arguments, "");
        let theirs = fs::read_to_string(theirs).expect("pyserial's file");
        // What pyserial calls to close a port is not traffic.
        let traffic: Vec<String> =
            without_times(&theirs).into_iter().filter(|line| line.contains("TX  ") || line.contains("RX  ")).collect();
        assert_eq!(without_times(&ours(&file, options, &data)), traffic, "{options}");
        assert!(traffic.len() > 40, "{} lines", traffic.len());
    }
}

#[test]
fn a_raw_spy_writes_the_bytes() {
    let scratch = Scratch::new("raw-spy");
    assert_eq!(ours(&scratch.path("raw"), "&raw", &[b"G0X1.\n".to_vec()]), "G0X1.\nG0X1.\n");
}

/// A system with every kind of port that pyserial knows.
fn system(root: &Path) {
    let file = |path: &str, text: &str| {
        let path = root.join(path);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a scratch folder");
        fs::write(path, text).expect("a scratch file");
    };
    let device = |name: &str, place: &str, subsystem: &str| {
        file(&format!("dev/{name}"), "");
        fs::create_dir_all(root.join(place)).expect("a scratch folder");
        fs::create_dir_all(root.join("sys/bus").join(subsystem)).expect("a scratch folder");
        let tty = root.join("sys/class/tty").join(name);
        fs::create_dir_all(&tty).expect("a scratch folder");
        symlink(root.join(place), tty.join("device")).expect("a link");
        symlink(root.join("sys/bus").join(subsystem), root.join(place).join("subsystem")).expect("a link");
    };
    device("ttyUSB10", "sys/devices/usb1/1-2/1-2:1.0/ttyUSB10", "usb-serial");
    for (name, text) in
        [("idVendor", "0403\n"), ("idProduct", "6001\n"), ("serial", " A1\n"), ("bNumInterfaces", " 1\n")]
    {
        file(&format!("sys/devices/usb1/1-2/{name}"), text);
    }
    file("sys/devices/usb1/1-2/product", "FT232R USB UART\n");
    file("sys/devices/usb1/1-2/manufacturer", "FTDI\n");
    device("ttyUSB2", "sys/devices/usb1/1-3/1-3:1.1/ttyUSB2", "usb-serial");
    for (name, text) in [("idVendor", "0403"), ("idProduct", "6011"), ("bNumInterfaces", " 4")] {
        file(&format!("sys/devices/usb1/1-3/{name}"), text);
    }
    file("sys/devices/usb1/1-3/1-3:1.1/interface", "Port B\n");
    device("ttyACM0", "sys/devices/usb1/1-4/1-4:1.0", "usb");
    for (name, text) in [("idVendor", "2341"), ("idProduct", "0043"), ("product", "Uno"), ("bNumInterfaces", " 2")] {
        file(&format!("sys/devices/usb1/1-4/{name}"), text);
    }
    device("ttyS0", "sys/devices/pnp0/00:05", "pnp");
    file("sys/devices/pnp0/00:05/id", "PNP0501\n");
    device("ttyS1", "sys/devices/platform/serial8250", "platform");
    device("ttyS2", "sys/devices/00:05:0/00:05:0.0", "serial-base");
    device("ttyAMA0", "sys/devices/amba/fe201000.serial", "amba");
    file("dev/rfcomm0", "");
    file("dev/tty1", "");
    symlink(root.join("dev/ttyUSB10"), root.join("dev/mill")).expect("a link");
}

fn line(port: &PortInfo) -> String {
    let number = |number: Option<u16>| number.map_or("None".to_owned(), |number| number.to_string());
    let text = |text: &Option<String>| text.clone().unwrap_or_else(|| "None".to_owned());
    let first = [port.device.clone(), port.name.clone(), port.description.clone(), port.hwid.clone()];
    let usb = [number(port.vid), number(port.pid), text(&port.serial_number), text(&port.location)];
    let words = [text(&port.manufacturer), text(&port.product), text(&port.interface)];
    [&first[..], &usb, &words].concat().join("\t")
}

#[cfg(target_os = "linux")]
#[test]
fn the_list_of_ports_is_pyserials_on_a_system_with_every_kind() {
    let Some(python) = python_or_skip("list_ports") else { return };
    let scratch = Scratch::new("list");
    let root = scratch.path("root");
    system(Path::new(&root));
    for links in [false, true] {
        let arguments: Vec<&str> = std::iter::once(root.as_str()).chain(links.then_some("links")).collect();
        let theirs = output(python, "list_ports.py", &arguments, "");
        let ours: Vec<String> = below(Path::new(&root), links).iter().map(line).collect();
        println!("{theirs}");
        assert_eq!(ours, theirs.lines().collect::<Vec<_>>());
        assert_eq!(ours.len(), if links { 8 } else { 7 });
    }
}

#[test]
fn the_command_prints_what_list_ports_prints_here() {
    let Some(python) = python_or_skip("ports command") else { return };
    for arguments in [&[][..], &["-v"], &["-q", "-v", "tty"], &["-n", "1"], &["-s", "-v"], &["no such port"]] {
        let theirs =
            std::process::Command::new(python).args(["-m", "serial.tools.list_ports"]).args(arguments).output();
        let theirs = theirs.expect("Python runs");
        let ours = run(&[&["ports"], arguments].concat());
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        assert_eq!((text(&ours.stdout), text(&ours.stderr)), (text(&theirs.stdout), text(&theirs.stderr)));
        assert_eq!(ours.status.code(), Some(0));
    }
}
