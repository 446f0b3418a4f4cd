//! Opening of the port that a URL describes.

use std::fs::File;

use super::fault::Fault;
use super::list::{find, ports};
use super::loopback::Loopback;
use super::rfc2217::Rfc2217;
#[cfg(any(unix, windows))]
use super::serial::Serial;
use super::socket::Socket;
use super::spy::{CreateFile, Spy};
use super::url::{Base, PortUrl, Wrapper};
use super::{Port, PortError};
use crate::settings::SerialSettings;

/// Opens the port of a URL, with the wrappers that the URL names (`spy://`, `fault://`). An existing file of a spy is
/// overwritten.
///
/// # Errors
/// The port cannot be opened. `sim:` and `linuxcnc:` are no byte lines of this computer: this function always fails for
/// them.
pub fn open(url: &PortUrl, settings: &SerialSettings) -> Result<Box<dyn Port>, PortError> {
    open_with(url, settings, |path| File::create(path))
}

/// Opens the port as [`open`] does, but creates the files of `spy://` wrappers by calling `create`.
///
/// # Errors
/// Same as [`open`].
pub fn open_with(url: &PortUrl, settings: &SerialSettings, create: CreateFile) -> Result<Box<dyn Port>, PortError> {
    let port: Box<dyn Port> = match &url.base {
        Base::Sim => {
            return Err(PortError::in_words(&url.text, "the control in software is not there for this command"));
        }
        Base::LinuxCnc => {
            return Err(PortError::in_words(
                &url.text,
                "LinuxCNC reads files, not a line; this is a port for `stream` alone",
            ));
        }
        Base::Native(name) => native(name, settings)?,
        Base::Loop(logging) => Box::new(Loopback::open(*logging)),
        Base::Socket(address, logging) => Box::new(Socket::open(address, *logging)?),
        Base::Rfc2217(address, options) => Box::new(Rfc2217::open(address, options, settings)?),
        Base::Hwgrep(wanted) => {
            let can_be_opened = |name: &str| native(name, settings).is_ok();
            let found = find(&ports(false), wanted, can_be_opened);
            let message = "no such port; `arcfeed ports -v` lists what the expression is looked for in";
            let name = found.ok_or_else(|| PortError::in_words(&url.text, message))?;
            native(&name, settings)?
        }
    };
    wrap(url, port, create)
}

#[cfg(any(unix, windows))]
fn native(name: &str, settings: &SerialSettings) -> Result<Box<dyn Port>, PortError> {
    Ok(Box::new(Serial::open(name, settings)?))
}

#[cfg(not(any(unix, windows)))]
fn native(name: &str, _: &SerialSettings) -> Result<Box<dyn Port>, PortError> {
    Err(PortError::in_words(name, "this system has no serial ports"))
}

/// Puts the wrappers of a URL around an open port: the innermost first, so that the outermost one of the URL is
/// outermost here.
///
/// # Errors
/// The file of a spy cannot be created.
pub fn wrap<'p>(url: &PortUrl, port: Box<dyn Port + 'p>, create: CreateFile) -> Result<Box<dyn Port + 'p>, PortError> {
    url.wrappers.iter().rev().try_fold(port, |inner, wrapper| {
        let wrapped: Box<dyn Port + 'p> = match wrapper {
            Wrapper::Spy(options) => Box::new(Spy::new(inner, options, create)?),
            Wrapper::Fault(plan) => Box::new(Fault::new(inner, plan)),
        };
        Ok(wrapped)
    })
}
