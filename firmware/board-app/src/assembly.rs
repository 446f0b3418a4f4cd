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

/// Data that a board needs at its start.
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// Source of its segments: the host, or the DNC line that it taps.
    pub supply: Supply,
    /// Time-outs and thresholds of the supervisor.
    pub settings: Settings,
    /// Name, version and last start; the number of starts makes the numbers of its sessions unique.
    pub identity: Identity,
    /// Fault that was found at the start; `None` without one.
    pub fault: Option<BoardFault>,
}

/// Reason why a board cannot be assembled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssemblyError {
    /// The settings of the supervisor contradict each other.
    Settings(SettingsError),
    /// The settings of the link are invalid.
    Link(LinkError),
}

/// Makes the host link and the control task of a board, at the two ends of these queues.
///
/// # Errors
/// The settings of the supervisor or of the link are invalid.
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
