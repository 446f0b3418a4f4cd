//! Why each block has the feed that it has.

/// Why a block is sent with the feed it is sent with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanReason {
    /// The law governs it.
    Law,
    /// The law governs it; on part of it it has no wish, there the block runs at 100 %.
    LawInPart,
    /// The law governs it, but the override ends below what it wants.
    Ceiling,
    /// The law governs it, but the override ends above what it wants: the chip exceeds its target.
    Floor,
    /// The law governs it, but an axis cannot follow it everywhere.
    Axis,
    /// The law governs it, but the control clamps the feed on an arc of this radius.
    ArcClamp,
    /// A cut rule speaks of it, but the law has no wish anywhere on it.
    NoWish,
    /// No cut rule speaks of it.
    NoRule,
    /// Positioning.
    Rapid,
    /// Inverse time: F is no feed.
    InverseTime,
    /// Under G41, G42, G43.4, G63 or G95: what the tool centre does, or what F means, is not looked at.
    Special,
}

impl PlanReason {
    /// As written in tables and JSON.
    pub const fn label(self) -> &'static str {
        match self {
            PlanReason::Law => "law",
            PlanReason::LawInPart => "law-in-part",
            PlanReason::Ceiling => "ceiling",
            PlanReason::Floor => "floor",
            PlanReason::Axis => "axis",
            PlanReason::ArcClamp => "arc-clamp",
            PlanReason::NoWish => "no-wish",
            PlanReason::NoRule => "no-rule",
            PlanReason::Rapid => "rapid",
            PlanReason::InverseTime => "inverse-time",
            PlanReason::Special => "special",
        }
    }
}
