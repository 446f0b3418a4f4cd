//! Controllers corrupted on purpose: what the measurement must catch.

/// What is wrong with the controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ControllerFault {
    /// Nothing.
    #[default]
    None,
    /// No controller at all: the override stays at 100 %.
    LawOff,
    /// It believes its tool's radii are this many times what they are.
    RadiusScale(f64),
    /// It ticks no more after this many ticks; its output stays.
    FrozenAfter(u64),
}
