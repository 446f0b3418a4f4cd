//! pyserial's port URLs, and three of our own (`sim:`, `linuxcnc:`, `fault://`): parses the text without opening the port.
//!
//! ```text
//! NAME                                          a native port
//! loop://[?logging=LEVEL]                       what is written is read
//! socket://HOST:PORT[?logging=LEVEL]            bare TCP
//! rfc2217://HOST:PORT[?OPTION[&OPTION...]]      a serial port at a server: timeout=S, ign_set_control, poll_modem, logging
//! hwgrep://REGEXP[&n=N][&skip_busy]             the Nth port that `arcfeed ports` lists and the expression matches
//! alt://NAME[?class=CLASS]                      a native port by one of pyserial's classes
//! spy://PORT[?OPTION[&OPTION...]]               any of these, its traffic written down: file=NAME, color, raw, all
//! fault://NAME=VALUE[,NAME=VALUE...]/PORT       any of these, corrupted from a seed
//! ```
//! The grammar is that of pyserial 3.5; where we differ is listed in docs/ports.md. Wrappers nest. The options behind the
//! last `?` are the outermost `spy://`'s if they are all options of a spy; else they belong to the port inside.

mod options;

mod faults;

use std::path::Path;
use std::str::FromStr;

pub use faults::{FaultPlan, Faults};
use options::Options;

use crate::log::Level;
use crate::pattern::Pattern;

/// Most wrappers around one port.
const WRAPPERS_MAX: usize = 8;

/// Parsed URL of a port: the port itself, and the wrappers around it.
#[derive(Clone, Debug, PartialEq)]
pub struct PortUrl {
    /// Text of the URL, as given.
    pub text: String,
    /// Wrappers of the port, outermost first.
    pub wrappers: Vec<Wrapper>,
    /// Port inside all wrappers.
    pub base: Base,
}

/// Wrapper around a port, such as a spy or injected faults.
#[derive(Clone, Debug, PartialEq)]
pub enum Wrapper {
    /// `spy://`: records the traffic.
    Spy(SpyOptions),
    /// `fault://`: corrupts the data.
    Fault(FaultPlan),
}

/// Port of a URL, without its wrappers.
#[derive(Clone, Debug, PartialEq)]
pub enum Base {
    /// `sim:`, the simulated control and machine.
    Sim,
    /// `linuxcnc:`, LinuxCNC on this computer.
    LinuxCnc,
    /// Serial port of the operating system, by its device name.
    Native(String),
    /// `loop://`, a queue that returns what is written; with the level of its messages, if they are wanted.
    Loop(Option<Level>),
    /// `socket://`, plain bytes over TCP; with the level of its messages.
    Socket(Address, Option<Level>),
    /// `rfc2217://`, a serial port at a server, with its options.
    Rfc2217(Address, Rfc2217Options),
    /// `hwgrep://`, the serial port of the operating system whose properties match.
    Hwgrep(Hwgrep),
}

/// Network address of a server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// Host name, or IP address as text.
    pub host: String,
    /// Number of the TCP port.
    pub port: u16,
}

/// Options of `rfc2217://`.
#[derive(Clone, Debug, PartialEq)]
pub struct Rfc2217Options {
    /// The client does not wait for answers to SET-CONTROL, which some servers never send.
    pub ign_set_control: bool,
    /// The client asks for the modem lines periodically, for servers that do not report them.
    pub poll_modem: bool,
    /// Longest wait for an answer of the server, s.
    pub timeout_s: f64,
    /// Level from which messages are printed on stderr; `None`: no messages.
    pub logging: Option<Level>,
}

/// Options of `spy://`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpyOptions {
    /// Path of the output file; `None`: stderr.
    pub file: Option<String>,
    /// The output has terminal colours.
    pub color: bool,
    /// The output is the plain bytes, not a hexadecimal dump.
    pub raw: bool,
    /// Reads that return no data are recorded, too.
    pub all: bool,
}

/// Search for a port by its description (`hwgrep://`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hwgrep {
    /// Regular expression that device name, description or hardware id must match, ignoring case.
    pub regexp: String,
    /// Number of the match that is used, counted from 1.
    pub n: usize,
    /// Matching ports that cannot be opened are skipped.
    pub skip_busy: bool,
}

/// Error in a URL: the faulty part, and what to write instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{part}`: {message}")]
pub struct UrlError {
    /// Part of the URL that is wrong.
    pub part: String,
    /// Fault, and what to write instead.
    pub message: String,
}

impl UrlError {
    fn new(part: impl Into<String>, message: impl Into<String>) -> Self {
        UrlError { part: part.into(), message: message.into() }
    }
}

impl FromStr for PortUrl {
    type Err = UrlError;

    fn from_str(text: &str) -> Result<Self, UrlError> {
        let mut wrappers = Vec::new();
        let base = read(text, &mut wrappers)?;
        Ok(PortUrl { text: text.to_owned(), wrappers, base })
    }
}

impl PortUrl {
    /// Paths of the files that the URL's `spy://` wrappers write.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.wrappers.iter().filter_map(|wrapper| match wrapper {
            Wrapper::Spy(options) => options.file.as_deref().map(Path::new),
            Wrapper::Fault(_) => None,
        })
    }
}

fn read(text: &str, wrappers: &mut Vec<Wrapper>) -> Result<Base, UrlError> {
    if text.is_empty() {
        return Err(UrlError::new(
            text,
            "the port is missing; write its name (`/dev/ttyUSB0`, `COM3`), a URL or `sim:`",
        ));
    }
    if wrappers.len() > WRAPPERS_MAX {
        return Err(UrlError::new(text, format!("more than {WRAPPERS_MAX} wrappers; remove some")));
    }
    if text.eq_ignore_ascii_case("sim:") {
        return Ok(Base::Sim);
    }
    if text.eq_ignore_ascii_case("linuxcnc:") {
        return Ok(Base::LinuxCnc);
    }
    let Some((scheme, rest)) = text.split_once("://") else { return Ok(Base::Native(text.to_owned())) };
    match scheme.to_ascii_lowercase().as_str() {
        "loop" => loopback(rest),
        "socket" => socket(rest),
        "rfc2217" => rfc2217(rest),
        "hwgrep" => hwgrep(rest),
        "alt" => alt(rest),
        "spy" => {
            let (inner, options) = spy(rest)?;
            wrappers.push(Wrapper::Spy(options));
            read(inner, wrappers)
        }
        "fault" => {
            let (plan, inner) = faults::read(rest)?;
            wrappers.push(Wrapper::Fault(plan));
            read(inner, wrappers)
        }
        other => Err(UrlError::new(format!("{scheme}://"), unknown(other))),
    }
}

fn unknown(scheme: &str) -> &'static str {
    match scheme {
        "sim" => "the control in software is `sim:`, without slashes",
        "linuxcnc" => "LinuxCNC is `linuxcnc:`, without slashes",
        "tcp" | "telnet" => "write socket://host:port for bare TCP, rfc2217://host:port for a serial server",
        "cp2110" => "CP2110 adapters (USB HID) are not supported; use one that appears as a serial port",
        _ => "no such protocol; there are loop, socket, rfc2217, hwgrep, alt, spy and fault, native names and `sim:`",
    }
}

fn loopback(rest: &str) -> Result<Base, UrlError> {
    let (place, mut options) = Options::split(rest);
    let level = options.logging()?;
    options.no_more("loop://[?logging=debug|info|warning|error]")?;
    match place {
        "" | "/" => Ok(Base::Loop(level)),
        _ => Err(UrlError::new(place, "a loop has no name; write loop://")),
    }
}

fn socket(rest: &str) -> Result<Base, UrlError> {
    let (place, mut options) = Options::split(rest);
    let level = options.logging()?;
    options.no_more("socket://host:port[?logging=debug|info|warning|error]")?;
    Ok(Base::Socket(address(place)?, level))
}

fn rfc2217(rest: &str) -> Result<Base, UrlError> {
    let (place, mut options) = Options::split(rest);
    let parsed = Rfc2217Options {
        ign_set_control: options.flag("ign_set_control")?,
        poll_modem: options.flag("poll_modem")?,
        timeout_s: options.seconds("timeout")?.unwrap_or(3.0),
        logging: options.logging()?,
    };
    options.no_more("rfc2217://host:port[?ign_set_control][&poll_modem][&timeout=SECONDS][&logging=LEVEL]")?;
    Ok(Base::Rfc2217(address(place)?, parsed))
}

/// `host:port`, `[IPv6]:port`; a lone `/` behind it is allowed.
fn address(place: &str) -> Result<Address, UrlError> {
    let place = place.strip_suffix('/').unwrap_or(place);
    let wrong = |message: &str| UrlError::new(place, message);
    if let Some(at) = place.find(['/', '@', '#']) {
        return Err(UrlError::new(&place[at..], "a server has a host and a port, nothing else; write host:port"));
    }
    let (host, port) = match place.strip_prefix('[') {
        Some(bracketed) => bracketed.split_once("]:").ok_or_else(|| wrong("write [::1]:port"))?,
        None => place.rsplit_once(':').ok_or_else(|| wrong("the port is missing; write host:port"))?,
    };
    if host.is_empty() || !place.starts_with('[') && host.contains([':', '[', ']']) {
        return Err(wrong("write host:port, an IPv6 address in brackets"));
    }
    let is_number = !port.is_empty() && port.bytes().all(|byte| byte.is_ascii_digit());
    match port.parse() {
        Ok(port) if is_number && port > 0 => Ok(Address { host: host.to_lowercase(), port }),
        _ => Err(UrlError::new(port, "no TCP port; write a number from 1 to 65535 behind the host")),
    }
}

fn hwgrep(rest: &str) -> Result<Base, UrlError> {
    let mut parts = rest.split('&');
    let regexp = parts.next().unwrap_or_default().to_owned();
    let _is_good = Pattern::new(&regexp).map_err(|message| UrlError::new(&*regexp, message))?;
    let mut found = Hwgrep { regexp, n: 1, skip_busy: false };
    for part in parts {
        match part.split_once('=').unwrap_or((part, "")) {
            ("n", number) => {
                let n = number.parse().ok().filter(|n| *n > 0);
                found.n = n.ok_or_else(|| UrlError::new(part, "n counts from 1; write n=2 for the second"))?;
            }
            ("skip_busy", "") => found.skip_busy = true,
            _ => return Err(UrlError::new(part, "no such option; write hwgrep://regexp[&n=N][&skip_busy]")),
        }
    }
    Ok(Base::Hwgrep(found))
}

fn alt(rest: &str) -> Result<Base, UrlError> {
    let (place, mut options) = Options::split(rest);
    let class = options.take("class").unwrap_or_else(|| "Serial".to_owned());
    options.no_more("alt://port[?class=Serial]")?;
    match class.as_str() {
        _ if place.is_empty() => Err(UrlError::new("alt://", "the port is missing; write alt://port")),
        "Serial" | "PosixPollSerial" => Ok(Base::Native(place.to_owned())),
        "VTIMESerial" => Err(UrlError::new(
            class,
            "chooses how reads wait, and nothing here waits in a read; write the port's name without alt://",
        )),
        _ => Err(UrlError::new(class, "no such class; there are Serial and PosixPollSerial, which are the same here")),
    }
}

/// Port inside, and the options of the spy.
fn spy(rest: &str) -> Result<(&str, SpyOptions), UrlError> {
    let own = |name: &str| matches!(name, "file" | "color" | "raw" | "all");
    let (mut inner, mut options) = Options::split_last(rest);
    if rest.contains("://") && !options.names().all(own) {
        if options.names().any(own) {
            let message = "options of the spy and of the port inside mixed; write those of the port first, then the spy's \
                           behind a `?` of their own: spy://rfc2217://host:port?timeout=5?file=name";
            return Err(UrlError::new(&rest[inner.len()..], message));
        }
        (inner, options) = (rest, Options::none());
    }
    let parsed = SpyOptions {
        file: options.take("file"),
        color: options.flag("color")?,
        raw: options.flag("raw")?,
        all: options.flag("all")?,
    };
    options.no_more("spy://port[?file=NAME][&color][&raw][&all]")?;
    if parsed.file.as_deref() == Some("") {
        return Err(UrlError::new("file", "the file's name is missing; write file=NAME, or leave it out for stderr"));
    }
    if inner.is_empty() {
        return Err(UrlError::new("spy://", "the port is missing; write spy://port"));
    }
    Ok((inner, parsed))
}

#[cfg(test)]
mod tests;
