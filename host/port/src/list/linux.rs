//! Serial ports of Linux: the names in `/dev` that pyserial looks for, and their properties in `/sys`.

use std::fs;
use std::path::{Path, PathBuf};

use super::{PortInfo, sorted};

/// Prefixes of the names of serial ports.
const NAMES: [&str; 7] = ["ttyS", "ttyUSB", "ttyXRUSB", "ttyACM", "ttyAMA", "rfcomm", "ttyAP"];

/// Serial ports of a Linux system in natural order. `root` is the directory that has `dev` and `sys` (`/`, elsewhere in
/// tests); with `with_links`, symbolic links to the ports are listed, too.
pub fn below(root: &Path, with_links: bool) -> Vec<PortInfo> {
    let entries = fs::read_dir(root.join("dev")).into_iter().flatten().flatten();
    let all: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    let is_port = |path: &&PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        NAMES.iter().any(|start| name.starts_with(start))
    };
    let mut devices: Vec<PathBuf> = all.iter().filter(is_port).cloned().collect();
    if with_links {
        let links = all.iter().filter(|path| path.is_symlink());
        let to_a_port = links.filter(|path| path.canonicalize().is_ok_and(|target| devices.contains(&target)));
        let to_a_port: Vec<PathBuf> = to_a_port.cloned().collect();
        devices.extend(to_a_port);
    }
    sorted(devices.iter().filter_map(|device| described(root, device)))
}

/// Properties of a port; `None` for one that does not exist in hardware.
fn described(root: &Path, path: &Path) -> Option<PortInfo> {
    let device = Path::new("/").join(path.strip_prefix(root).unwrap_or(path));
    let mut info = PortInfo::unknown(&device.to_string_lossy());
    let link = path.is_symlink().then(|| path.canonicalize().ok()).flatten();
    if let Some(target) = &link {
        info.hwid = format!("LINK={}", shown(root, target));
    }
    let sys = root.join("sys/class/tty").join(&info.name).join("device").canonicalize().ok();
    if let Some(sys) = sys {
        let subsystem = sys.join("subsystem").canonicalize().ok();
        let subsystem = subsystem.as_deref().and_then(file_name).unwrap_or_else(|| "subsystem".to_owned());
        match subsystem.as_str() {
            // The kernel lists more ports than the machine has.
            "platform" => return None,
            "usb-serial" => describe_usb(&mut info, sys.parent()?),
            "usb" => describe_usb(&mut info, &sys),
            "pnp" => {
                info.description = info.name.clone();
                info.hwid = first_line(&sys, "id").unwrap_or_else(|| "None".to_owned());
            }
            "amba" => {
                info.description = info.name.clone();
                info.hwid = file_name(&sys)?;
            }
            _ => {}
        }
    }
    if let Some(target) = &link {
        info.hwid += &format!(" LINK={}", shown(root, target));
    }
    Some(info)
}

fn describe_usb(info: &mut PortInfo, interface: &Path) {
    let Some(device) = interface.parent() else { return };
    let number = |file: &str| first_line(device, file).and_then(|text| u16::from_str_radix(&text, 16).ok());
    let interfaces: u32 = first_line(device, "bNumInterfaces").and_then(|text| text.parse().ok()).unwrap_or(1);
    (info.vid, info.pid) = (number("idVendor"), number("idProduct"));
    info.serial_number = first_line(device, "serial");
    info.location = file_name(if interfaces > 1 { interface } else { device });
    info.manufacturer = first_line(device, "manufacturer");
    info.product = first_line(device, "product");
    info.interface = first_line(interface, "interface");
    info.describe_usb();
}

fn first_line(folder: &Path, file: &str) -> Option<String> {
    let text = fs::read(folder.join(file)).ok()?;
    let text = String::from_utf8_lossy(&text);
    Some(text.lines().next().unwrap_or_default().trim().to_owned())
}

fn file_name(path: &Path) -> Option<String> {
    Some(path.file_name()?.to_string_lossy().into_owned())
}

/// Path below the root, as seen from there.
fn shown(root: &Path, path: &Path) -> String {
    let root = root.canonicalize().unwrap_or_else(|_| root.to_owned());
    let inner = path.strip_prefix(&root).unwrap_or(path);
    Path::new("/").join(inner).to_string_lossy().into_owned()
}
