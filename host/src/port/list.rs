//! The serial ports there are, as pyserial's `list_ports` lists them: on Linux from `/dev` and `/sys`, elsewhere what the
//! operating system tells.

#[cfg(target_os = "linux")]
mod linux;

use serde::Serialize;

use super::pattern::Pattern;
use super::url::Hwgrep;

#[cfg(target_os = "linux")]
pub use linux::below;

/// What pyserial says where nothing is known.
const UNKNOWN: &str = "n/a";

/// A port and what is known about it, under pyserial's names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PortInfo {
    /// What to open.
    pub device: String,
    /// Its last part.
    pub name: String,
    /// For people.
    pub description: String,
    /// For programs.
    pub hwid: String,
    /// USB: who made the chip.
    pub vid: Option<u16>,
    /// USB: which chip.
    pub pid: Option<u16>,
    /// USB: which of these.
    pub serial_number: Option<String>,
    /// USB: where it is plugged in.
    pub location: Option<String>,
    /// USB: who made the adapter.
    pub manufacturer: Option<String>,
    /// USB: what it is called.
    pub product: Option<String>,
    /// USB: which part of it.
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

    /// Makes description and hardware id of what is known of a USB device.
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

/// The ports there are, in natural order; with the links to them where asked for.
#[cfg(target_os = "linux")]
pub fn ports(with_links: bool) -> Vec<PortInfo> {
    below(std::path::Path::new("/"), with_links)
}

/// The ports there are, in natural order; links to ports are Linux's.
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

/// Those whose name, description or hardware id the expression matches, in either case.
///
/// # Errors
/// The text is no regular expression, or this build has none.
pub fn grep(ports: Vec<PortInfo>, regexp: &str) -> Result<Vec<PortInfo>, String> {
    let pattern = Pattern::new(regexp)?;
    let matches = |port: &PortInfo| [&port.device, &port.description, &port.hwid].iter().any(|x| pattern.matches(x));
    Ok(ports.into_iter().filter(matches).collect())
}

/// The device that `hwgrep://` means; `can_be_opened` is asked only where it matters.
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

/// Texts and numbers in turn, so that ttyS2 comes before ttyS10.
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
    fn the_nth_in_natural_order_is_found_and_busy_ones_are_skipped_where_told() {
        assert_eq!(devices("USB", 1, false).as_deref(), Some("/dev/ttyUSB2"));
        assert_eq!(devices("usb", 2, false).as_deref(), Some("/dev/ttyUSB10"));
        assert_eq!(devices("usb", 1, true).as_deref(), Some("/dev/ttyUSB10"));
        assert_eq!((devices("usb", 2, true), devices("acm", 1, false)), (None, None));
    }
}
