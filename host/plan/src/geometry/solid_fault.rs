//! Faults of surfaces that other programs export.

use thiserror::Error;

use super::point_file::Fault;

/// Fault of a surface that another program has exported (STL or STEP).
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SolidFault {
    /// The file has no surface.
    #[error("there are no triangles in it")]
    Empty,
    /// The hub, or the tip, is no surface of revolution.
    #[error(
        "at {z_mm:.3} mm along the axis the radius is {:.3} to {:.3} mm: no surface about the rotor's axis; export the gas path alone, without \
         blades and fillets, or give `hub_radius`; check `axis` and `units`", .radii_mm[0], .radii_mm[1]
    )]
    NotRound {
        /// Place along the axis.
        z_mm: f64,
        /// Least and greatest radius there.
        radii_mm: [f64; 2],
    },
    /// No face of the file is a surface about the rotor's axis.
    #[error("there is no surface about the rotor's axis in it; check `axis`, or give `hub_radius`")]
    NoRevolution,
    /// The blade has no tip.
    #[error("the blade has no face at its tip; give `tip_radius`, or the shroud's curve as `shroud`")]
    NoTip,
    /// The blade is not above the hub.
    #[error("the blade reaches from {:.1} to {:.1} % of the height between hub and tip; the files do not belong together, or `axis` or `units` is wrong", 100.0 * .shares[0], 100.0 * .shares[1])]
    OffTheHub {
        /// Least and greatest share of the height.
        shares: [f64; 2],
    },
    /// At some height the blade has no outline, or several separate ones.
    #[error(
        "{found} separate outlines at {:.1} % of the height, where one blade has one; export one blade alone, from hub to tip, without the hub", 100.0 * .share_ratio
    )]
    Outlines {
        /// Number of separate outlines.
        found: usize,
        /// Height, as a fraction from hub (0) to tip (1).
        share_ratio: f64,
    },
    /// An outline is not closed.
    #[error(
        "the surface is open at {:.1} % of the height: {gap_mm:.3} mm between two ends; export all faces of the blade, both sides and both edges, joined", 100.0 * .share_ratio
    )]
    Gap {
        /// Least distance of two ends.
        gap_mm: f64,
        /// Height, as a fraction from hub (0) to tip (1).
        share_ratio: f64,
    },
    /// An outline cannot be split into the two sides of a blade.
    #[error("{0}")]
    Section(Fault),
}
