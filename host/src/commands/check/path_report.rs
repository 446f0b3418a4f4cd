//! Summary of a program's path, as text and as JSON.

use serde::Serialize;

use crate::commands::outcome::say;
use crate::program::{PathSummary, ToolUse};
use arcfeed_units::{LengthUnit, Nm, S_PER_MIN};

const AXES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];
/// Longest comment in the table.
const COMMENT_MAX: usize = 48;

/// Results for a program's tool path (extents, times, tools), as they stand in the JSON output.
#[derive(Debug, Serialize)]
pub struct PathFigures {
    unit: &'static str,
    extents: Vec<ExtentFigures>,
    tools: Vec<ToolUseFigures>,
    cutting_distance: f64,
    rapid_distance: f64,
    cutting_time_s: f64,
    dwell_time_s: f64,
}

/// Lowest and highest coordinate of an axis, as they stand in the JSON output.
#[derive(Debug, Serialize)]
pub struct ExtentFigures {
    axis: &'static str,
    min: f64,
    max: f64,
}

/// Results for one tool's part of the program, as they stand in the JSON output.
#[derive(Debug, Serialize)]
pub struct ToolUseFigures {
    tool: Option<i64>,
    comment: String,
    line: usize,
    h: Vec<i64>,
    d: Vec<i64>,
    spindle_min: Option<i64>,
    spindle_max: Option<i64>,
    feed_min: Option<f64>,
    feed_max: Option<f64>,
    cutting_distance: f64,
    rapid_distance: f64,
    cutting_time_s: f64,
}

impl PathFigures {
    /// Results in the program's unit.
    pub fn new(path: &PathSummary) -> Self {
        let unit_mm = path.unit.mm();
        let tools: Vec<ToolUseFigures> = path.tools_in_use().map(|tool| ToolUseFigures::new(tool, path)).collect();
        let extents = AXES.iter().zip(path.extents).enumerate().filter_map(|(index, (axis, extent))| {
            let per_unit = if index < 3 { unit_mm } else { 1.0 };
            let [min, max] = extent?.map(|value| value / per_unit);
            Some(ExtentFigures { axis, min, max })
        });
        PathFigures {
            unit: path.unit.label(),
            extents: extents.collect(),
            cutting_distance: tools.iter().map(|tool| tool.cutting_distance).sum(),
            rapid_distance: tools.iter().map(|tool| tool.rapid_distance).sum(),
            cutting_time_s: tools.iter().map(|tool| tool.cutting_time_s).sum(),
            dwell_time_s: path.dwell.to_s(),
            tools,
        }
    }

    /// Prints the results as two small tables.
    pub fn print(&self) {
        let PathFigures { unit, extents, tools, .. } = self;
        if tools.is_empty() {
            return;
        }
        let decimals = if *unit == LengthUnit::Inch.label() { 4 } else { 3 };
        if !extents.is_empty() {
            say(format_args!("extents of the cutting moves from the workpiece's origin ({unit}; A, B, C in degrees):"));
        }
        for ExtentFigures { axis, min, max } in extents {
            say(format_args!("  {axis} {min:>12.decimals$} .. {max:>12.decimals$}"));
        }
        say(format_args!(
            "tools ({unit}); times at the programmed feeds only, without rapids, acceleration and tool changes:\n  \
             {:>4} {:>6} {:>6} {:>13} {:>17} {:>11} {:>11} {:>9}  comment",
            "T", "H", "D", "S", "F", "cutting", "rapid", "time"
        ));
        for tool in tools {
            tool.print();
        }
        say(format_args!(
            "  {:>4} {:>6} {:>6} {:>13} {:>17} {:>11.1} {:>11.1} {:>9}  dwells {}",
            "all",
            "",
            "",
            "",
            "",
            self.cutting_distance,
            self.rapid_distance,
            clock(self.cutting_time_s),
            clock(self.dwell_time_s)
        ));
    }
}

impl ToolUseFigures {
    fn new(tool: &ToolUse, path: &PathSummary) -> Self {
        let unit = path.unit;
        let feed = |feed: Nm| feed.0 as f64 / unit.nm() as f64;
        ToolUseFigures {
            tool: tool.number,
            comment: path.comment_of(tool).to_owned(),
            line: tool.line,
            h: tool.lengths.clone(),
            d: tool.radii.clone(),
            spindle_min: tool.spindle.map(|[low, _]| low),
            spindle_max: tool.spindle.map(|[_, high]| high),
            feed_min: tool.feed.map(|[low, _]| feed(low)),
            feed_max: tool.feed.map(|[_, high]| feed(high)),
            cutting_distance: tool.cutting_mm / unit.mm(),
            rapid_distance: tool.rapid_mm / unit.mm(),
            cutting_time_s: tool.cutting_s,
        }
    }

    fn print(&self) {
        let number = |number: Option<i64>| number.map_or("-".into(), |number| number.to_string());
        let comment: String =
            self.comment.chars().take(COMMENT_MAX).map(|c| if c.is_control() { ' ' } else { c }).collect();
        let row = format!(
            "  {:>4} {:>6} {:>6} {:>13} {:>17} {:>11.1} {:>11.1} {:>9}  {comment}",
            number(self.tool),
            list(&self.h),
            list(&self.d),
            range(self.spindle_min.map(|low| low as f64), self.spindle_max.map(|high| high as f64)),
            range(self.feed_min, self.feed_max),
            self.cutting_distance,
            self.rapid_distance,
            clock(self.cutting_time_s)
        );
        say(format_args!("{}", row.trim_end()));
    }
}

fn list(numbers: &[i64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(i64::to_string).collect();
    if numbers.is_empty() { "-".into() } else { numbers.join(",") }
}

fn range(low: Option<f64>, high: Option<f64>) -> String {
    let text = |value: f64| {
        let text = format!("{value:.2}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    match (low, high) {
        (Some(low), Some(high)) if low == high => text(low),
        (Some(low), Some(high)) => format!("{} .. {}", text(low), text(high)),
        _ => "-".into(),
    }
}

/// Minutes and seconds, or hours, minutes and seconds.
fn clock(time_s: f64) -> String {
    let seconds = time_s.round() as u64;
    let per_min = S_PER_MIN as u64;
    let (minutes, seconds) = (seconds / per_min, seconds % per_min);
    match (minutes / 60, minutes % 60) {
        (0, minutes) => format!("{minutes}:{seconds:02}"),
        (hours, minutes) => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_ranges_are_short() {
        assert_eq!([clock(0.4), clock(61.0), clock(3_661.0)], ["0:00", "1:01", "1:01:01"]);
        assert_eq!(range(Some(1_000.0), Some(1_000.0)), "1000");
        assert_eq!(range(Some(2.5), Some(40.0)), "2.5 .. 40");
        assert_eq!((range(None, None), list(&[1, 2])), ("-".into(), "1,2".into()));
    }
}
