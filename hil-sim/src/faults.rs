//! Faults of the controller, for tests that the measurement must detect.

/// Fault that a simulated controller is made to have, for tests.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ControllerFault {
    /// No fault.
    #[default]
    None,
    /// No controller acts: the override stays at 100 %.
    LawOff,
    /// The controller assumes radii of the tool that are wrong by this factor.
    RadiusScale(f64),
    /// The controller stops ticking after this many ticks; its output stays.
    FrozenAfter(u64),
    /// No position arrives after this many ticks.
    PositionLostAfter(u64),
    /// No message of the host arrives after this many ticks.
    HostLostAfter(u64),
}
