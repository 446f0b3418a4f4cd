//! Ports of [`arcfeed_port`]; files of `spy://` wrappers are checked like all [outputs](crate::output).

pub use arcfeed_port::*;

/// Opening of ports whose spy files are checked.
pub mod open {
    use arcfeed_port::settings::SerialSettings;
    use arcfeed_port::url::PortUrl;
    use arcfeed_port::{Port, PortError};

    use crate::output::create;

    /// Opens the port of a URL, with the wrappers that the URL names (`spy://`, `fault://`).
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn open(url: &PortUrl, settings: &SerialSettings) -> Result<Box<dyn Port>, PortError> {
        arcfeed_port::open::open_with(url, settings, create)
    }

    /// Puts the wrappers of a URL around an open port: the innermost first, so that the outermost one of the URL is
    /// outermost here.
    ///
    /// # Errors
    /// The file of a spy cannot be created.
    pub fn wrap<'p>(url: &PortUrl, port: Box<dyn Port + 'p>) -> Result<Box<dyn Port + 'p>, PortError> {
        arcfeed_port::open::wrap(url, port, create)
    }
}
