//! `arcfeed view`: a page on which a program is adapted: dropped in, completed by a form, simulated, downloaded.

#[cfg(feature = "web")]
mod input;

#[cfg(all(feature = "web", not(target_family = "wasm")))]
mod runner;

#[cfg(all(feature = "web", target_family = "wasm"))]
mod in_page;

#[cfg(feature = "web")]
pub mod workspace;

#[cfg(feature = "web")]
pub mod site;

use std::net::SocketAddr;
use std::path::PathBuf;

use super::outcome::Failure;
#[cfg(all(feature = "web", target_family = "wasm"))]
use in_page::Runner;
#[cfg(all(feature = "web", not(target_family = "wasm")))]
use runner::Runner;

/// Output of a command that the page has run.
#[cfg(feature = "web")]
#[derive(Debug, Default)]
pub struct CommandOutput {
    /// Lines for stderr.
    pub messages: String,
    /// Text for stdout.
    pub printed: String,
}

/// Adapt a program on a page in the browser: drop it in, answer what its job needs, see it before and after, download it
///
/// With a job file the page shows the report of its run at once. Files that are dropped in stay in a temporary folder, which
/// is removed at the end. Ctrl-C ends the page.
#[derive(Debug, clap::Args)]
pub struct ViewCommand {
    /// The job file (.toml), whose report is shown; or an NC program; without it the page waits for a program
    #[arg(value_name = "JOB.toml|PROGRAM.nc")]
    job: Option<PathBuf>,
    /// Address of the page; port 0 is a free one
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:0")]
    web: SocketAddr,
}

impl ViewCommand {
    /// Runs the command until Ctrl-C.
    ///
    /// # Errors
    /// The file cannot be read, nothing can listen at the address, or the build has no pages.
    #[cfg(all(feature = "web", not(target_family = "wasm")))]
    pub fn run(&self) -> Result<(), Failure> {
        use std::sync::Arc;
        use std::sync::atomic::Ordering;

        use super::outcome::{on_interrupt, say};
        use crate::web::server::{Server, warn_of_network};
        use site::ViewSite;
        use workspace::Workspace;

        /// Time between two looks at Ctrl-C.
        const PERIOD: std::time::Duration = std::time::Duration::from_millis(50);

        let interrupted = on_interrupt();
        let failed = |error: std::io::Error| Failure::Machine(format!("temporary folder: {error}"));
        let folder = tempfile::tempdir().map_err(failed)?;
        let real = folder.path().canonicalize().map_err(failed)?;
        let workspace = Arc::new(Workspace::new(&real).map_err(failed)?);
        if let Some(path) = &self.job {
            workspace.open(path)?;
        }
        let site = Arc::new(ViewSite(Arc::clone(&workspace)));
        let server =
            Server::start(self.web, site).map_err(|error| Failure::Usage(format!("--web {}: {error}", self.web)))?;
        warn_of_network(self.web);
        say(format_args!("page: {}", server.url()));
        while !interrupted.load(Ordering::Relaxed) {
            std::thread::sleep(PERIOD);
        }
        workspace.close();
        folder.close().map_err(failed)
    }

    /// Always fails.
    ///
    /// # Errors
    /// The build has no pages.
    #[cfg(any(not(feature = "web"), target_family = "wasm"))]
    pub fn run(&self) -> Result<(), Failure> {
        let _options = (&self.job, self.web);
        Err(Failure::Usage(format!("view: {}", crate::features::not_built_in("pages", "web"))))
    }
}
