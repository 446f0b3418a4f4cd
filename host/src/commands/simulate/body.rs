//! Flexible part of the job's workpiece: its vibration modes from finite elements.

#[cfg(feature = "fe")]
mod elements;

#[cfg(feature = "fe")]
pub use elements::flexible;

/// Fault in a job: byte offset of its place in the file (`None`: the whole table), and message.
pub type SetupFault = (Option<usize>, String);

/// Refuses the flexible workpiece, because its modes are not built in.
///
/// # Errors
/// Always.
#[cfg(not(feature = "fe"))]
pub fn flexible(
    flexible: &crate::job::flexible::Flexible,
    _blank: &dyn arcfeed_dexel::solid::Solid,
    _edges_mm: f64,
) -> Result<
    (arcfeed_hil_sim::removal::flexible_workpiece::FlexibleWorkpiece, Vec<arcfeed_modal::dynamics::modal::Mode>),
    SetupFault,
> {
    Err((Some(flexible.offset), crate::features::not_built_in("finite elements for flexible workpieces", "fe")))
}
