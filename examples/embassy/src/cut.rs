//! A job and its blocks, built in code: the outside contour of a boss, then the inside one of a bore.

use arcfeed_model::cut::{ContourSide, CutRule, Moves, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::tool::{EndMill, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, RevPerMin};

/// An end mill of 10 mm with 4 teeth, 0.05 mm per tooth at 4000 rev/min: 800 mm/min along the contour.
const TOOL: EndMill = EndMill { radius: Nm(5_000_000), teeth: 4 };
const SPINDLE: RevPerMin = RevPerMin(4_000.0);
const FEED_PER_TOOTH: MmPerTooth = MmPerTooth(0.05);
const FEED: Feed = Feed::PerMinute(Nm(800_000_000));
/// Radius of the path of the tool's centre. The boss has 15 mm: its contour is passed at 800 mm/min where the centre moves at
/// 800 * 20/15 mm/min, 133 %. The bore has 25 mm: 800 * 20/25 mm/min, 80 %. (docs/laws.md#contour)
const RADIUS: Nm = Nm(20_000_000);

/// The job: what is cut with which tool under which law.
pub fn job() -> Job {
    let law = LawKind::Contour { inside_only: false, floor_ratio: 0.1 };
    let mut job = Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(Tool::EndMill(TOOL), SPINDLE, law, FEED_PER_TOOTH)),
        policy: FeedPolicy::OverrideOnly,
        limits: OverrideLimits::default(),
        ceiling: Default::default(),
        machine: Default::default(),
        rules: Default::default(),
        knots: Default::default(),
    };
    // Climb milling: clockwise round the boss, counter-clockwise in the bore.
    for (turn, side) in [(Turn::Cw, ContourSide::Outside), (Turn::Ccw, ContourSide::Inside)] {
        let rule = CutRule {
            tool: 0,
            moves: Moves::Arcs(turn),
            work: Work::Mill { side, radial_depth: Nm(500_000) },
            feed_per_tooth: None,
            table: None,
            sequence: None,
            level: None,
        };
        job.rules.push(rule).ok();
    }
    job
}

/// The blocks, as `G2` and `G3` half circles from (-20, 0) to (20, 0) and back.
pub fn segments() -> [Segment; 2] {
    let (left, right) = (Nm(-RADIUS.0), RADIUS);
    [(Turn::Cw, left, right), (Turn::Ccw, right, left)].map(|(turn, from, to)| {
        let [from, to] = [from, to].map(|x| [x, Nm(0)]);
        let arc = Arc { plane: Plane::Xy, turn, center: [Nm(0); 2], from, to };
        Segment { sequence: None, start: pose(from), end: pose(to), feed: FEED, path: Path::Arc(arc) }
    })
}

fn pose([x, y]: [Nm; 2]) -> Pose {
    Pose { linear: [x, y, Nm(0)], ..Pose::default() }
}
