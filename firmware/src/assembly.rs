//! A whole board from its parts: a desk and a ticker at the two ends of their queues.

use arcfeed_shared::wire::message::link_settings;
use arcfeed_shared::wire::settings::{Role, SettingsError as LinkError};

use crate::station::clerk::{Clerk, Identity};
use crate::station::desk::Desk;
use crate::station::order::Queues;
use crate::station::ticker::{Supply, Ticker};
use crate::supervisor::settings::{Settings, SettingsError};
use crate::supervisor::signals::BoardFault;

/// So many times a link may be lost before its session's number is that of another start.
const SESSIONS_PER_START: u32 = 1 << 16;

/// What a board is told before it starts; config.
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// Where its segments come from.
    pub supply: Supply,
    /// Of the supervisor.
    pub settings: Settings,
    /// What it says of itself. Its starts tell its sessions apart.
    pub identity: Identity,
    /// What its start found.
    pub fault: Option<BoardFault>,
}

/// Why there is no board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssemblyError {
    /// Of the supervisor.
    Settings(SettingsError),
    /// Of the link.
    Link(LinkError),
}

/// A board that has just started, over these queues.
///
/// # Errors
/// Settings that make no sense.
pub fn assemble<const AHEAD: usize>(
    queues: &mut Queues<AHEAD>,
    config: Config,
) -> Result<(Desk<'_>, Ticker<'_>), AssemblyError> {
    let (at_desk, at_tick) = queues.split();
    let ticker = Ticker::new(at_tick, config.supply, config.settings, config.fault).map_err(AssemblyError::Settings)?;
    let clerk = Clerk::new(at_desk, config.identity, config.settings).map_err(AssemblyError::Settings)?;
    let clerk = if config.supply == Supply::Tap { clerk.tapped() } else { clerk };
    let session = config.identity.starts.wrapping_mul(SESSIONS_PER_START);
    let desk = Desk::new(link_settings(Role::Board), session, clerk).map_err(AssemblyError::Link)?;
    Ok((desk, ticker))
}
