//! Why each block has the feed that it has.

/// Reason for the feed with which a block is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanReason {
    /// The law governs it.
    Law,
    /// The law governs it; on part of it it has no demand, there the block runs at 100 %.
    LawInPart,
    /// The law governs it, at the least feed that it allows: its floor, not the radius, decides.
    LawFloor,
    /// The law governs it, but the override ends below what it wants.
    Ceiling,
    /// The law governs it, but the override ends above what it wants: the chip exceeds its target.
    Floor,
    /// The law governs it, but an axis cannot follow it everywhere.
    Axis,
    /// The law governs it, but the control clamps the feed on an arc of this radius.
    ArcClamp,
    /// The law governs it, but the job's fastest feed, or its largest raise of the programmed one, is lower.
    FeedCeiling,
    /// The law governs it, and the control itself reduces its F there (parameter 1710).
    ControlReduces,
    /// The chamfer or rounded corner at its end has this feed, the least that both may have.
    Corner,
    /// A cut rule matches it, but it moves along the tool's axis: a plunge, ramp, helix or roll-in.
    Axial,
    /// A cut rule matches it, but another tool than the job's is in the spindle.
    OtherTool,
    /// A cut rule matches it, but the spindle is off, or its speed is stated nowhere.
    Spindle,
    /// A cut rule matches it, but its move or its feed depends on the block-delete switches.
    BlockDelete,
    /// A cut rule matches it, but its F would stay in force for a block that must have another one.
    FeedLeak,
    /// A cut rule matches it, but a rotary axis turns with it.
    Rotary,
    /// A cut rule matches it, but it is shorter than the way to brake to the feed that the law demands.
    Short,
    /// A cut rule matches it, but no block before it has stated where the tool is.
    StartUnknown,
    /// A cut rule matches it, but the D in force under G41 or G42 has no radius.
    NoRadius,
    /// A cut rule matches it, but the radius of the D in force is not that of the job's tool.
    OtherRadius,
    /// A cut rule matches it, but it is under G41 or G42, or beside a chamfer or rounded corner, where only F words govern.
    NeedsRewriting,
    /// A cut rule speaks of it, but the law has no demand anywhere on it.
    NoDemand,
    /// The move descends, but the plunge law has no feed that keeps the limits of the spindle.
    Overload,
    /// The move descends, but the engagement map has no sections of it.
    Unmapped,
    /// No cut rule speaks of it.
    NoRule,
    /// Positioning.
    Rapid,
    /// Inverse time: F is no feed.
    InverseTime,
    /// Under G43.4, G63 or G95, or under G41 or G42 where no law describes the path of the tool centre.
    Special,
}

impl PlanReason {
    /// Name of the reason in tables and JSON.
    pub const fn label(self) -> &'static str {
        match self {
            PlanReason::Law => "law",
            PlanReason::LawInPart => "law-in-part",
            PlanReason::LawFloor => "law-floor",
            PlanReason::Ceiling => "ceiling",
            PlanReason::Floor => "floor",
            PlanReason::Axis => "axis",
            PlanReason::ArcClamp => "arc-clamp",
            PlanReason::FeedCeiling => "feed-ceiling",
            PlanReason::ControlReduces => "control-reduces",
            PlanReason::Corner => "corner",
            PlanReason::Axial => "axial",
            PlanReason::OtherTool => "other-tool",
            PlanReason::Spindle => "spindle",
            PlanReason::BlockDelete => "block-delete",
            PlanReason::FeedLeak => "feed-leak",
            PlanReason::Rotary => "rotary",
            PlanReason::Short => "short",
            PlanReason::StartUnknown => "start-unknown",
            PlanReason::NoRadius => "no-radius",
            PlanReason::OtherRadius => "other-radius",
            PlanReason::NeedsRewriting => "needs-rewriting",
            PlanReason::NoDemand => "no-demand",
            PlanReason::Overload => "overload",
            PlanReason::Unmapped => "unmapped",
            PlanReason::NoRule => "no-rule",
            PlanReason::Rapid => "rapid",
            PlanReason::InverseTime => "inverse-time",
            PlanReason::Special => "special",
        }
    }

    /// Explanation for a person why a move keeps its feed although a cut rule selects it; `None` if no explanation is
    /// needed.
    pub const fn keeps_feed(self) -> Option<&'static str> {
        match self {
            PlanReason::Axial => Some("it moves along the tool's axis, and the law describes motion across it"),
            PlanReason::OtherTool => Some(
                "no values are given for the tool in the spindle: give them to its number by a [[tool]] of the job, or by --tool T2=DIAMETER where there is no job file",
            ),
            PlanReason::Spindle => Some(
                "the program has not turned the spindle on at a speed (M6 and M5 stop it); where the operator does, say set_by = \"operator\" in [spindle]",
            ),
            PlanReason::BlockDelete => Some("a block-delete switch decides on it, or on a block (/) before it"),
            PlanReason::FeedLeak => {
                Some("its F would stay in force for a block behind it that has none of its own and must have another")
            }
            PlanReason::Rotary => Some("a rotary axis turns with it, and F is no feed along its path then"),
            PlanReason::NoRadius => Some(
                "its D has no radius, so the path of the tool centre under G41 and G42 is unknown: give it in the settings file ([radius]), or state there that D holds only wear (compensation = \"wear\")",
            ),
            PlanReason::OtherRadius => Some(
                "the radius of its D differs by more than a quarter from that of the job's tool: correct one of them; where D holds only wear, state compensation = \"wear\" in the settings file",
            ),
            PlanReason::NeedsRewriting => Some(
                "it is under G41 or G42, or beside a chamfer or rounded corner, where a law works through F words only: write mode = \"rewrite-only\" in [override]",
            ),
            PlanReason::Overload => Some(
                "no feed of it keeps max_power and max_torque in [spindle]: the material rubs too much, or they are too low",
            ),
            PlanReason::Unmapped => Some(
                "the engagement map has no sections of it: make it anew with `arcfeed engage`, or see its warnings",
            ),
            PlanReason::Short => Some(
                "it is shorter than the distance in which the axes brake to the feed of the law, so slowing down would gain nothing",
            ),
            PlanReason::StartUnknown => Some("no block before it states X and Y: where it starts is unknown"),
            _ => None,
        }
    }
}
