//! Assembly of a board: a host link and a control task at the two ends of their queues.

use arcfeed_link::message::link_settings;
use arcfeed_link::settings::{Role, SettingsError as LinkError};

use crate::application::command_handler::{CommandHandler, Identity};
use crate::application::control_task::{ControlTask, Supply};
use crate::application::host_link::HostLink;
use crate::application::messages::Queues;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::signals::BoardFault;

/// Number of sessions of a start: after as many losses of the link, session numbers overlap with those of the next
/// start.
const SESSIONS_PER_START: u32 = 1 << 16;

/// Configuration of a board at its start.
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// Source of its segments.
    pub supply: Supply,
    /// Settings of the supervisor.
    pub settings: Settings,
    /// Identity of the board. The number of starts makes its sessions unique.
    pub identity: Identity,
    /// A fault found at the start.
    pub fault: Option<BoardFault>,
}

/// Reason why a board cannot be assembled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssemblyError {
    /// Invalid settings of the supervisor.
    Settings(SettingsError),
    /// Invalid settings of the link.
    Link(LinkError),
}

/// Assembles a board at its start, with these queues.
///
/// # Errors
/// Invalid settings.
pub fn assemble<const AHEAD: usize>(
    queues: &mut Queues<AHEAD>,
    config: Config,
) -> Result<(HostLink<'_>, ControlTask<'_>), AssemblyError> {
    let (at_host, at_tick) = queues.split();
    let task =
        ControlTask::new(at_tick, config.supply, config.settings, config.fault).map_err(AssemblyError::Settings)?;
    let handler = CommandHandler::new(at_host, config.identity, config.settings).map_err(AssemblyError::Settings)?;
    let handler = if config.supply == Supply::Tap { handler.tapped() } else { handler };
    let session = config.identity.starts.wrapping_mul(SESSIONS_PER_START);
    let host_link = HostLink::new(link_settings(Role::Board), session, handler).map_err(AssemblyError::Link)?;
    Ok((host_link, task))
}
