//! Reaction time of this computer to a DC3: from the arrival of the DC3 at the port until the last character that still
//! leaves after it. No operating system documents it: the job sets it, or it is assumed here.

use arcfeed_units::Micros;

use super::url::{Base, PortUrl};

/// Port in this machine: an interrupt, and a process that must be woken.
const NATIVE: Micros = Micros::from_ms(1);
/// Adapter that reports no latency: two frames of the bus each way.
const USB: Micros = Micros::from_ms(4);
/// Network in working order.
const NETWORK: Micros = Micros::from_ms(10);

/// Assumed longest time from the arrival of a DC3 at the port of this URL until the sender stops: 1 ms for a built-in
/// port, more for a USB adapter or a network, 0 for simulated ports.
pub fn reaction(url: &PortUrl) -> Micros {
    match &url.base {
        Base::Sim | Base::LinuxCnc | Base::Loop(_) => Micros(0),
        Base::Native(name) if is_usb(name) => latency_timer(name).map_or(USB, |timer| timer.after(NATIVE)),
        Base::Native(_) => NATIVE,
        Base::Hwgrep(_) => USB,
        Base::Socket(..) | Base::Rfc2217(..) => NETWORK,
    }
}

fn is_usb(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.contains("usb") || name.contains("ttyacm")
}

/// Time for which an FTDI adapter keeps received characters, from Linux.
fn latency_timer(name: &str) -> Option<Micros> {
    let device = std::path::Path::new(name).file_name()?.to_str()?;
    let text = std::fs::read_to_string(format!("/sys/bus/usb-serial/devices/{device}/latency_timer")).ok()?;
    text.trim().parse().ok().map(Micros::from_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farther_the_port_the_later_it_reacts() {
        let of = |url: &str| reaction(&url.parse().expect("a URL"));
        assert_eq!([of("sim:"), of("spy://loop://")], [Micros(0); 2]);
        assert!(of("/dev/ttyS0") < of("/dev/ttyUSB987"));
        assert!(of("COM3") < of("fault://seed=1/rfc2217://host:1"));
    }
}
