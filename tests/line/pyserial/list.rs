//! The list of ports, compared with pyserial's own code on the same system.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use arcfeed::port::list::{PortInfo, below};
use arcfeed_tests::{Scratch, run};

use arcfeed_tests::python::{output, python_or_skip};

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
