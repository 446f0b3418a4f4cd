//! Live page of a transmission: the planned path in the viewer, at the programmed feeds.

use std::net::SocketAddr;

use arcfeed_control::action::{MoveContext, ProgrammedPath};
use arcfeed_hil_sim::path_trace::TracePoint;
use arcfeed_hil_sim::removal::placement::{UP, WorkpiecePlacement};
use arcfeed_hil_sim::removal::trail::AxisPosition;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MicroDeg, Micros, S_PER_MIN, US_PER_S};

use super::super::outcome::Failure;
use super::super::simulate::viewer::{outlines, path_columns};
use super::preparation::{LineMove, PreparedProgram};
use crate::console::note;
use crate::dnc::transmission::Transmission;
use crate::post::walk::point_at;
use crate::report::page::Page;
use crate::report::page::viewer::{RunPath, ViewerData};
use crate::screen::view::View;
use crate::web::LivePage;
use crate::web::snapshot::Snapshot;

/// Largest distance of an arc from the chords in its place.
const TOLERANCE_MM: f64 = 1e-2;
/// Most chords of a move.
const CHORDS_MAX: f64 = 256.0;
/// Most points of the path; of a longer one, points within cuts are left out.
const POINTS_MAX: usize = 1 << 18;

/// Starts a server of the live page at an address and prints the address.
///
/// # Errors
/// The address cannot be used.
pub fn serve(
    ready: &PreparedProgram,
    sending: &Transmission,
    address: SocketAddr,
    view: View,
) -> Result<(View, LivePage), Failure> {
    let opened = LivePage::open(address, page(ready, sending, &view.title), Snapshot::new(&view));
    let page = opened.map_err(|error| Failure::Usage(format!("--web {address}: {error}")))?;
    note(format_args!("live page: {}", page.url()));
    Ok((view, page))
}

/// Page without values: they come while the program is sent.
fn page(ready: &PreparedProgram, sending: &Transmission, title: &str) -> String {
    let job = &ready.file.job;
    let lines: Vec<Option<usize>> = sending.lines().iter().map(|line| Some(line.source).filter(|n| *n > 0)).collect();
    let mut columns = path_columns(job, &thinned(path(ready, sending)), &lines);
    // The override is the machine's, and the chip load is measured there.
    columns.retain(|column| column.head.name != "override" && !column.has_no_value());
    let viewer = ViewerData {
        title: title.to_owned(),
        unit: job.unit.label(),
        runs: vec![RunPath { name: "planned", columns }],
        tools: outlines(job, None),
        heights: None,
        solids: Vec::new(),
        findings: Vec::new(),
        lines: listing(&ready.whole),
        purposes: &[],
        is_live: true,
    };
    Page { title: title.to_owned(), lead: None, viewer: Some(viewer), sections: Vec::new() }.to_string()
}

/// Points of the moves, with the time at which each is reached if the control never waits.
fn path(ready: &PreparedProgram, sending: &Transmission) -> Vec<TracePoint> {
    let (mut points, mut time_s) = (Vec::<TracePoint>::new(), 0.0);
    let (machine, mut placement) =
        (ready.file.machine.as_ref().map(|named| named.machine), WorkpiecePlacement::default());
    for (index, (load, moved)) in ready.moves(sending).enumerate() {
        let begin_s = time_s;
        time_s += load.time_s;
        let Some(LineMove { segment, origin, follows_tip }) = moved else { continue };
        let programmed_path = if follows_tip { ProgrammedPath::Tip } else { ProgrammedPath::Axes };
        let context = MoveContext { origin, programmed_path, ..MoveContext::default() };
        if segment.path != Path::Rapid {
            placement.locate_at(&axes_at(&segment, 0.0), &context, turned_deg(&segment) == 0.0);
        }
        let chords = chords(&segment);
        let feed_mm_per_min = if load.time_s > 0.0 { segment.length_mm() / load.time_s * S_PER_MIN } else { 0.0 };
        let point = |chord: u32| {
            let ratio = f64::from(chord) / f64::from(chords);
            let axes = axes_at(&segment, ratio);
            let pose = machine.as_ref().and_then(|machine| placement.pose(&axes, &context, machine));
            let in_program = || [0, 1, 2].map(|axis: usize| axes[axis] - origin.linear[axis].to_mm());
            let (position_mm, axis) = pose.map_or_else(|| (in_program(), UP), |pose| (pose.tip_mm, pose.axis));
            TracePoint {
                at: Micros(libm::round((begin_s + ratio * load.time_s) * US_PER_S as f64) as u64),
                position_mm,
                block: index as u32 + 1,
                is_rapid: segment.path == Path::Rapid,
                feed_mm_per_min,
                chip_ratio: None,
                percent: 100,
                tool: ToolInSpindle::Unstated,
                axis,
            }
        };
        let first = u32::from(!points.is_empty());
        points.extend((first..=chords).map(point));
    }
    points
}

/// Positions of the axes, with the linear ones those of the tip, at the fraction `ratio` of a move.
fn axes_at(segment: &Segment, ratio: f64) -> AxisPosition {
    let [x, y, z] = point_at(segment, ratio);
    let [from, to] = [segment.start, segment.end].map(|pose| pose.rotary.map(MicroDeg::to_deg));
    let [a, b, c] = [0, 1, 2].map(|axis: usize| from[axis] + ratio * (to[axis] - from[axis]));
    [x, y, z, a, b, c]
}

/// Largest turn of a rotary axis during a move.
fn turned_deg(segment: &Segment) -> f64 {
    let [from, to] = [segment.start, segment.end].map(|pose| pose.rotary.map(MicroDeg::to_deg));
    from.iter().zip(to).map(|(from, to)| libm::fabs(to - from)).fold(0.0, f64::max)
}

/// Number of chords of a move; while rotary axes turn, one for each degree at least.
fn chords(segment: &Segment) -> u32 {
    // The sagitta of a chord over the angle a is r (1 - cos(a / 2)).
    let of_arc = segment
        .arc()
        .map_or(1.0, |arc| arc.sweep_rad() / (2.0 * libm::acos((1.0 - TOLERANCE_MM / arc.radius_mm()).max(0.0))));
    libm::ceil(of_arc.max(turned_deg(segment))).clamp(1.0, CHORDS_MAX) as u32
}

/// Leaves out as many points within cuts as are too many; ends of rapids stay.
fn thinned(points: Vec<TracePoint>) -> Vec<TracePoint> {
    let every = points.len().div_ceil(POINTS_MAX);
    let mut kept: Vec<TracePoint> = Vec::with_capacity(points.len() / every.max(1) + 1);
    for (index, point) in points.iter().enumerate() {
        let is_end = points.get(index + 1).is_none_or(|next| next.is_rapid != point.is_rapid);
        if index % every == 0 || is_end {
            kept.push(*point);
        }
    }
    kept
}

/// Lines of the program's file as they are sent.
fn listing(whole: &Transmission) -> Vec<[Vec<u8>; 2]> {
    let count = whole.lines().iter().map(|line| line.source).max().unwrap_or(0);
    let mut lines = vec![Vec::new(); count];
    for (index, sent) in whole.lines().iter().enumerate() {
        let Some(line) = sent.source.checked_sub(1).and_then(|source| lines.get_mut(source)) else { continue };
        if !line.is_empty() {
            line.extend(" \u{23ce} ".as_bytes());
        }
        line.extend(whole.line_text(index).unwrap_or_default().trim_ascii_end());
    }
    lines.into_iter().map(|line| [line.clone(), line]).collect()
}
