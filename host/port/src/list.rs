//! List of the serial ports, like pyserial's `list_ports`: on Linux from `/dev` and `/sys`, elsewhere from the
//! operating system.

#[cfg(target_os = "linux")]
mod linux;

use serde::Serialize;

use super::pattern::Pattern;
use super::url::Hwgrep;

#[cfg(target_os = "linux")]
pub use linux::below;

/// pyserial's text for an unknown value.
const UNKNOWN: &str = "n/a";

/// Serial port of this computer with its properties, named as in pyserial's `ListPortInfo`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PortInfo {
    /// Name by which the port is opened, such as `/dev/ttyUSB0` or `COM3`.
    pub device: String,
    /// Last part of the device's path, such as `ttyUSB0`.
    pub name: String,
    /// Description for people, such as the name of the USB adapter; `n/a` without one.
    pub description: String,
    /// Identification text for programs (USB numbers, serial number, location), which `hwgrep://` searches; `n/a`
    /// without one.
    pub hwid: String,
    /// USB vendor number (VID); `None` for other ports.
    pub vid: Option<u16>,
    /// USB product number (PID); `None` for other ports.
    pub pid: Option<u16>,
    /// USB serial number, if the adapter has one.
    pub serial_number: Option<String>,
    /// Place on the USB, such as `1-1.2`.
    pub location: Option<String>,
    /// Name of the adapter's manufacturer.
    pub manufacturer: Option<String>,
    /// Name of the product.
    pub product: Option<String>,
    /// Name of the USB interface to which the port belongs, of devices with several.
    pub interface: Option<String>,
}

impl PortInfo {
    fn unknown(device: &str) -> Self {
        PortInfo {
            device: device.to_owned(),
            name: device.rsplit('/').next().unwrap_or(device).to_owned(),
            description: UNKNOWN.to_owned(),
            hwid: UNKNOWN.to_owned(),
            vid: None,
            pid: None,
            serial_number: None,
            location: None,
            manufacturer: None,
            product: None,
            interface: None,
        }
    }

    /// Builds description and hardware id from the USB properties.
    fn describe_usb(&mut self) {
        let product = self.product.as_deref();
        self.description = match &self.interface {
            Some(interface) => format!("{} - {interface}", product.unwrap_or("None")),
            None => product.unwrap_or(&self.name).to_owned(),
        };
        let part = |label: &str, value: &Option<String>| {
            value.as_ref().map_or_else(String::new, |value| format!(" {label}={value}"))
        };
        self.hwid = format!(
            "USB VID:PID={:04X}:{:04X}{}{}",
            self.vid.unwrap_or_default(),
            self.pid.unwrap_or_default(),
            part("SER", &self.serial_number),
            part("LOCATION", &self.location)
        );
    }
}

/// Serial ports of this computer, in natural order (`ttyUSB2` before `ttyUSB10`). With `with_links`, symbolic links to
/// the ports are listed, too.
#[cfg(target_os = "linux")]
pub fn ports(with_links: bool) -> Vec<PortInfo> {
    below(std::path::Path::new("/"), with_links)
}

/// Serial ports of this computer, in natural order (`COM2` before `COM10`). Links to ports exist on Linux only,
/// therefore the argument is ignored.
#[cfg(not(target_os = "linux"))]
pub fn ports(_with_links: bool) -> Vec<PortInfo> {
    let found = serialport::available_ports().unwrap_or_default();
    sorted(found.into_iter().map(|port| {
        let mut info = PortInfo::unknown(&port.port_name);
        if let serialport::SerialPortType::UsbPort(usb) = port.port_type {
            (info.vid, info.pid) = (Some(usb.vid), Some(usb.pid));
            info.serial_number = usb.serial_number;
            (info.manufacturer, info.product) = (usb.manufacturer, usb.product);
            info.describe_usb();
        }
        info
    }))
}

/// Those of `ports` whose device name, description or hardware id contains a match of the regular expression, ignoring
/// case.
///
/// # Errors
/// The text is not a regular expression, or this build has none.
pub fn grep(ports: Vec<PortInfo>, regexp: &str) -> Result<Vec<PortInfo>, String> {
    let pattern = Pattern::new(regexp)?;
    let matches = |port: &PortInfo| [&port.device, &port.description, &port.hwid].iter().any(|x| pattern.matches(x));
    Ok(ports.into_iter().filter(matches).collect())
}

/// Device name of the port that a `hwgrep://` URL selects among `ports`; `None` if there are too few matches.
/// `can_be_opened` is called only with the option `skip_busy`.
pub fn find(ports: &[PortInfo], wanted: &Hwgrep, can_be_opened: impl Fn(&str) -> bool) -> Option<String> {
    let found = grep(ports.to_vec(), &wanted.regexp).unwrap_or_default();
    let mut devices = found.into_iter().map(|port| port.device);
    devices.by_ref().filter(|device| !wanted.skip_busy || can_be_opened(device)).nth(wanted.n - 1)
}

fn sorted(ports: impl Iterator<Item = PortInfo>) -> Vec<PortInfo> {
    let mut sorted: Vec<PortInfo> = ports.collect();
    sorted.sort_by_cached_key(|port| natural(&port.device));
    sorted
}

/// Texts and numbers alternately, so that ttyS2 comes before ttyS10.
fn natural(text: &str) -> Vec<(String, u64)> {
    let mut parts = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (word, behind) = rest.split_at(digits);
        let end = behind.find(|c: char| !c.is_ascii_digit()).unwrap_or(behind.len());
        parts.push((word.to_owned(), behind[..end].parse().unwrap_or_default()));
        rest = &behind[end..];
    }
    parts
}

#[cfg(all(test, feature = "hwgrep"))]
mod tests {
    use super::*;

    fn devices(regexp: &str, n: usize, skip_busy: bool) -> Option<String> {
        let names = ["/dev/ttyUSB10", "/dev/ttyS0", "/dev/ttyUSB2"];
        let ports = sorted(names.into_iter().map(PortInfo::unknown));
        find(&ports, &Hwgrep { regexp: regexp.into(), n, skip_busy }, |device| device != "/dev/ttyUSB2")
    }

    #[test]
    fn the_nth_in_natural_order_is_found_and_busy_ones_are_skipped_on_request() {
        assert_eq!(devices("USB", 1, false).as_deref(), Some("/dev/ttyUSB2"));
        assert_eq!(devices("usb", 2, false).as_deref(), Some("/dev/ttyUSB10"));
        assert_eq!(devices("usb", 1, true).as_deref(), Some("/dev/ttyUSB10"));
        assert_eq!((devices("usb", 2, true), devices("acm", 1, false)), (None, None));
    }
}
