//! Reasons why a block has the feed with which it is sent.

/// Reason for the feed with which a block is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanReason {
    /// The law governs the block, and nothing else limits the feed.
    Law,
    /// The law governs the block; where it has no demand, the block runs with the override at 100 %.
    LawInPart,
    /// The law governs the block, and demands its lowest feed (the floor of the contour law) rather than the one that the radius would
    /// give.
    LawFloor,
    /// The law governs the block, but its demand is above what the largest override gives.
    Ceiling,
    /// The law governs the block, but its demand is below what the smallest override gives: there the chip is thicker than its target.
    Floor,
    /// The law governs the block, but a machine axis cannot follow its demand everywhere.
    Axis,
    /// The law governs the block, but the control limits the feed on an arc of this radius.
    ArcClamp,
    /// The law governs the block, but the job's largest feed, or its largest factor on the programmed feed, is below the demand.
    FeedCeiling,
    /// The law governs the block. The control itself reduces F on this inside arc (parameter 1710), therefore F is correspondingly higher.
    ControlReduces,
    /// The chamfer or rounded corner after the move needs a lower feed, and one F holds for both.
    Corner,
    /// A cut rule selects the block, but it moves along the tool's axis (plunge, ramp, helix, roll-in), where the rule's law does not
    /// apply.
    Axial,
    /// A cut rule selects the block, but a tool without values in the job is in the spindle.
    OtherTool,
    /// A cut rule selects the block, but the spindle is off or its speed is not known.
    Spindle,
    /// A cut rule selects the block, but its move or its feed depends on the block-delete switches.
    BlockDelete,
    /// A cut rule selects the block, but its new F would stay in force for a later block that needs another one.
    FeedLeak,
    /// A cut rule selects the block, but a rotary axis moves with it, so that F is not the feed along the path.
    Rotary,
    /// The contour law would slow the block down, but the block is shorter than the braking distance of the axes.
    Short,
    /// A cut rule selects the block, but no block before it has stated where the tool is.
    StartUnknown,
    /// A cut rule selects the block, but the D in force under G41 or G42 has no radius.
    NoRadius,
    /// A cut rule selects the block, but the radius of the D in force does not belong to the job's tool.
    OtherRadius,
    /// A cut rule selects the block, but it is under G41 or G42, or next to a chamfer or rounded corner: there a law works through F words
    /// only (mode `rewrite-only`).
    NeedsRewriting,
    /// A cut rule selects the block, but its law has no demand anywhere on it.
    NoDemand,
    /// The move descends into material, but no feed keeps the torque and power of the spindle.
    Overload,
    /// The move descends into material, but the engagement map has no sections of it.
    Unmapped,
    /// No cut rule selects the block.
    NoRule,
    /// The block is a rapid move.
    Rapid,
    /// Under G93 (inverse time): F is not a feed.
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
