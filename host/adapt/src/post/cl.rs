//! CL data in APT: `GOTO/x,y,z,i,j,k` and the statements around it.
//!
//! The reader knows `GOTO`, `FROM`, `FEDRAT` per minute, `RAPID`, `UNITS` and `PARTNO`; `$$` begins a remark, a `$` at
//! the end continues the line. Other words do not move the tool and are counted; words that would move it in other ways
//! (`CIRCLE`, `GODLTA`, `CYCLE`) are rejected.
//!
//! Source: ISO 3592 as CAM systems write it; the extracts in Tournier 2006, section 7.

use std::fmt::Write;

use arcfeed_kinematics::forward::ToolPose;
use arcfeed_kinematics::vector::{Vector, unit};
use arcfeed_units::MM_PER_INCH;

/// Words that move the tool in ways not supported here.
const REFUSED: [&str; 5] = ["CIRCLE", "GODLTA", "CYCLE", "MOVARC", "COPY"];
/// Tolerance of the length of i, j, k: beyond it they are no direction.
const UNIT_SLACK: f64 = 0.01;

/// CL data (cutter location data): the tool path of a CAM system, before it is adapted to a machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cl {
    /// Name of the part, from `PARTNO`; `None` without one.
    pub name: Option<String>,
    /// CL points in the order of the path.
    pub points: Vec<ClPoint>,
    /// Number of statements that do not move the tool and were ignored.
    pub passed_over: usize,
}

/// Point of CL data: tool tip, tool axis and feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClPoint {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Position of the tool's tip and direction of its axis.
    pub pose: ToolPose,
    /// Feed to this point, mm/min; `None`: rapid.
    pub feed_mm_per_min: Option<f64>,
}

/// Modal state while lines are read.
#[derive(Clone, Copy, Debug)]
struct State {
    mm: f64,
    feed_mm_per_min: Option<f64>,
    is_rapid: bool,
    axis: Vector,
}

impl Cl {
    /// Reads CL data.
    ///
    /// # Errors
    /// Describes the fault as `line: message`.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut cl = Cl::default();
        let mut state = State { mm: 1.0, feed_mm_per_min: None, is_rapid: false, axis: [0.0, 0.0, 1.0] };
        let (mut begun, mut statement) = (1, String::new());
        for (index, line) in text.lines().enumerate() {
            if statement.is_empty() {
                begun = index + 1;
            }
            let code = line.split("$$").next().unwrap_or_default().trim();
            if let Some(part) = code.strip_suffix('$') {
                statement.push_str(part);
                continue;
            }
            statement.push_str(code);
            cl.take(begun, &statement, &mut state)
                .map_err(|what| format!("{begun}: {what} (found `{}`)", statement.trim()))?;
            statement.clear();
        }
        if cl.points.is_empty() { Err("1: no GOTO: these are no CL data".into()) } else { Ok(cl) }
    }

    /// Text of the CL data in APT, lengths in mm.
    pub fn write(&self) -> String {
        let mut text = format!("PARTNO/{}\nUNITS/MM\nMULTAX/ON\n", self.name.as_deref().unwrap_or("NONE"));
        let mut feed = None;
        for point in &self.points {
            match point.feed_mm_per_min {
                None => text.push_str("RAPID\n"),
                Some(now) if feed != Some(now) => {
                    feed = Some(now);
                    let _infallible = writeln!(text, "FEDRAT/{now},MMPM");
                }
                Some(_) => {}
            }
            let ([x, y, z], [i, j, k]) = (point.pose.tip_mm, point.pose.axis);
            let _infallible = writeln!(text, "GOTO/{x:.5},{y:.5},{z:.5},{i:.6},{j:.6},{k:.6}");
        }
        text.push_str("FINI\n");
        text
    }

    /// Reads one statement.
    fn take(&mut self, line: usize, statement: &str, state: &mut State) -> Result<(), String> {
        let (word, rest) = statement.split_once('/').unwrap_or((statement, ""));
        match word.trim().to_ascii_uppercase().as_str() {
            "" => {}
            "GOTO" => {
                let pose = goto(rest, state)?;
                let feed_mm_per_min = if state.is_rapid { None } else { state.feed_mm_per_min };
                self.points.push(ClPoint { line, pose, feed_mm_per_min });
                state.is_rapid = false;
            }
            "FROM" => state.axis = goto(rest, state)?.axis,
            "RAPID" => state.is_rapid = true,
            "FEDRAT" => state.feed_mm_per_min = Some(feed(rest, state.mm)?),
            "UNITS" if rest.trim().to_ascii_uppercase().starts_with("INCH") => state.mm = MM_PER_INCH,
            "UNITS" if rest.trim().to_ascii_uppercase().starts_with("MM") => state.mm = 1.0,
            "UNITS" => return Err("units are MM or INCHES".into()),
            "PARTNO" => self.name = Some(rest.trim().to_owned()).filter(|name| !name.is_empty()),
            word if REFUSED.contains(&word) => {
                return Err(format!("{word} is not read; let the CAM system write points (linear output)"));
            }
            _ => self.passed_over += 1,
        }
        Ok(())
    }
}

/// Reads `x,y,z` or `x,y,z,i,j,k`; without a direction the previous one stays.
fn goto(numbers: &str, state: &mut State) -> Result<ToolPose, String> {
    let parsed: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
    let values = parsed.ok().filter(|values| values.iter().all(|value: &f64| value.is_finite()));
    let (tip, axis) = match values.as_deref() {
        Some([x, y, z]) => ([*x, *y, *z], state.axis),
        Some([x, y, z, i, j, k]) => ([*x, *y, *z], direction([*i, *j, *k])?),
        _ => return Err("GOTO takes x,y,z or x,y,z,i,j,k".into()),
    };
    state.axis = axis;
    Ok(ToolPose { tip_mm: tip.map(|coordinate| coordinate * state.mm), axis })
}

/// Normalises i, j, k, whose length differs from 1 by rounding.
fn direction(ijk: Vector) -> Result<Vector, String> {
    let axis = unit(ijk).ok_or("i,j,k have no direction")?;
    let is_unit = axis.iter().zip(ijk).all(|(one, given)| libm::fabs(one - given) < UNIT_SLACK);
    if is_unit { Ok(axis) } else { Err("i,j,k are not of length one".into()) }
}

/// Reads `500`, `500,MMPM`, `MMPM,500`, `20,IPM`.
fn feed(rest: &str, mm: f64) -> Result<f64, String> {
    let words: Vec<String> = rest.split(',').map(|word| word.trim().to_ascii_uppercase()).collect();
    let value = words.iter().find_map(|word| word.parse::<f64>().ok()).filter(|feed| *feed > 0.0 && feed.is_finite());
    let unit = words.iter().find(|word| word.parse::<f64>().is_err());
    let factor = match unit.map(String::as_str) {
        None => mm,
        Some("MMPM" | "PERMIN") => 1.0,
        Some("IPM") => MM_PER_INCH,
        Some(_) => return Err("feeds are read per minute: MMPM or IPM".into()),
    };
    Ok(value.ok_or("FEDRAT needs a feed above zero")? * factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_feeds_rapids_and_units_are_read() {
        let text = "PARTNO/VANE 7\n$$ remark\nUNITS/INCHES\nRAPID\nGOTO/1,0,0\nFEDRAT/20,IPM\nGOTO/ 1.0, $\n 2.0, 0, 0,0.6,0.8\nSPINDL/ON\n\
                    GOTO/2,2,0\nFINI\n";
        let cl = Cl::read(text).unwrap();
        assert_eq!((cl.name.as_deref(), cl.points.len(), cl.passed_over), (Some("VANE 7"), 3, 2));
        assert_eq!(cl.points[0].feed_mm_per_min, None);
        assert_eq!((cl.points[1].line, cl.points[1].feed_mm_per_min), (7, Some(508.0)));
        assert_eq!(cl.points[2].pose.axis, cl.points[1].pose.axis);
        assert_eq!(cl.points[2].pose.tip_mm, [50.8, 50.8, 0.0]);
        let again = Cl::read(&cl.write()).unwrap();
        assert!(
            again
                .points
                .iter()
                .zip(&cl.points)
                .all(|(a, b)| a.pose == b.pose && a.feed_mm_per_min == b.feed_mm_per_min)
        );
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_its_line() {
        for (text, expected) in [
            ("GOTO/1,2\n", "1: GOTO takes"),
            ("\nGOTO/1,2,3,0,0,2\n", "2: i,j,k are not"),
            ("GOTO/1,2,3,0,0,0\n", "1: i,j,k have no"),
            ("GOTO/1,2,NaN\n", "1: GOTO takes"),
            ("GOTO/1,2,3\nCIRCLE/0,0,0\n", "2: CIRCLE"),
            ("FEDRAT/0.1,MMPR\n", "1: feeds are"),
            ("G1X1\n", "1: no GOTO"),
        ] {
            let error = Cl::read(text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
