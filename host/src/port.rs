//! Ports of [`arcfeed_port`], in which files of spies are checked as all [outputs](crate::output) are.

pub use arcfeed_port::*;

/// Opens ports.
pub mod open {
    use arcfeed_port::settings::SerialSettings;
    use arcfeed_port::url::PortUrl;
    use arcfeed_port::{Port, PortError};

    use crate::output::create;

    /// Opens the port and adds the URL's wrappers.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(url: &PortUrl, settings: &SerialSettings) -> Result<Box<dyn Port>, PortError> {
        arcfeed_port::open::open_with(url, settings, create)
    }

    /// Adds the wrappers of a URL to a port, the outermost last.
    ///
    /// # Errors
    /// The file of a spy cannot be created.
    pub fn wrap<'p>(url: &PortUrl, port: Box<dyn Port + 'p>) -> Result<Box<dyn Port + 'p>, PortError> {
        arcfeed_port::open::wrap(url, port, create)
    }
}
