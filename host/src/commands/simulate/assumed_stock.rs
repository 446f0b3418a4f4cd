//! Stock of a program without a job file: a block from an option, from a comment, or from the extents of the cutting
//! moves.
//!
//! Comments are those that posts write for a viewer, `(STOCK/BLOCK, 100, 80, 20, 0, 0, 20)`: lengths along X, Y and Z, then
//! the program's zero point from the lowest corner. Extents are widened by the tool's radius: then all that the side of the
//! tool can reach is material. Only end mills that take material count. Their top is Z0, or their highest cut across Z where more of
//! the path across Z lies above Z0 than below: then the zero point is at the bottom of the part or below it.

use std::str::FromStr;

use arcfeed_kinematics::vector::difference;
use arcfeed_milling::cutting::material::MATERIALS;
use arcfeed_model::tool::Tool;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::segment::Path;
use arcfeed_units::LengthUnit;

use super::super::outcome::Failure;
use crate::console::note;
use crate::job::JobFile;
use crate::job::workpiece::{AssumedStock, Blank, Body, MEMORY_MAX_BYTES, StockSource, Workpiece};
use crate::program::{PathSummary, Program};

/// Diameter of the tool over the distance of the rays, where the stock is not too large for that.
const RAYS_PER_DIAMETER: f64 = 20.0;
/// Most rays, about.
const RAYS_MAX: f64 = 150_000.0;
/// Material below the lowest cut, as a fraction of the diameter.
const FLOOR_RATIO: f64 = 0.1;
/// Word of the comments.
const COMMENT: &str = "STOCK/BLOCK,";

/// Options for the stock of a program without a job file.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct StockArgs {
    /// Stock: X0,X1,Y0,Y1,Z0,Z1 in the program's unit and coordinates. Without it, the one in the program's comments, or a
    /// block about its cutting moves
    #[arg(long, value_name = "X0,X1,Y0,Y1,Z0,Z1", allow_hyphen_values = true)]
    #[arg(help_heading = "Values for a program without a job file")]
    stock: Option<StockBlock>,
    /// Material of the stock, or a part of its name, for an estimate of the power (docs/simulate.md)
    #[arg(long, value_name = "NAME", value_parser = material, help_heading = "Values for a program without a job file")]
    material: Option<&'static str>,
}

/// Lowest and highest coordinates of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StockBlock {
    lowest: [f64; 3],
    highest: [f64; 3],
}

impl StockBlock {
    fn new(lowest: [f64; 3], highest: [f64; 3]) -> Option<Self> {
        (0..3).all(|axis| lowest[axis] < highest[axis]).then_some(StockBlock { lowest, highest })
    }

    /// Block of a comment of the program, and its line counted from 1.
    fn commented(program: &Program) -> Option<(Self, usize)> {
        (1..).zip(program.texts()).find_map(|(line, text)| {
            let text: String = String::from_utf8_lossy(text).to_ascii_uppercase().split_whitespace().collect();
            let values = text.split_once(COMMENT)?.1.split(')').next()?;
            let [length, width, height, x, y, z] = numbers(values)?;
            Some((StockBlock::new([-x, -y, -z], [length - x, width - y, height - z])?, program.line_in_file(line)))
        })
    }

    /// Block about the cutting moves of end mills, the largest of this radius, mm; `None` if they have no length along an axis.
    fn about(program: &Program, mills: &[ToolInSpindle], radius_mm: f64, unit: LengthUnit) -> Option<Self> {
        let mut path = PathSummary::new(LengthUnit::Mm);
        let lines = || program.lines().filter(|line| mills.contains(&line.machining.tool));
        lines().for_each(|line| path.add_line(&line));
        let [Some(x), Some(y), Some([low, _]), ..] = path.extents else { return None };
        let (mut above_mm, mut below_mm, mut highest_mm) = (0.0, 0.0, low);
        for segment in lines().filter_map(|line| line.segment()).filter(|segment| segment.path != Path::Rapid) {
            let [start, end] = [segment.start, segment.end].map(|pose| pose.linear);
            if start[..2] == end[..2] && segment.arc().is_none() {
                continue;
            }
            highest_mm = f64::max(highest_mm, end[2].to_mm());
            match start[2].0 + end[2].0 {
                1.. => above_mm += segment.length_mm(),
                0 => {}
                _ => below_mm += segment.length_mm(),
            }
        }
        let top = if above_mm > below_mm { highest_mm } else { 0.0 };
        let lowest = [x[0] - radius_mm, y[0] - radius_mm, low - FLOOR_RATIO * 2.0 * radius_mm];
        let highest = [x[1] + radius_mm, y[1] + radius_mm, top];
        let [lowest, highest] = [lowest, highest].map(|corner| corner.map(|mm| mm / unit.mm()));
        StockBlock::new(lowest, highest)
    }
}

impl FromStr for StockBlock {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let [x, x_end, y, y_end, z, z_end] = numbers(text).ok_or("write six numbers: X0,X1,Y0,Y1,Z0,Z1")?;
        StockBlock::new([x, y, z], [x_end, y_end, z_end])
            .ok_or("write the lower coordinate of each axis before the higher: X0,X1,Y0,Y1,Z0,Z1")
    }
}

fn numbers(text: &str) -> Option<[f64; 6]> {
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    text.split(',').map(number).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// Full name of the only material whose name has this part.
fn material(part: &str) -> Result<&'static str, String> {
    let part = part.to_lowercase();
    let names = || MATERIALS.iter().map(|material| material.name);
    let found: Vec<&str> = names().filter(|name| name.to_lowercase().contains(&part)).collect();
    match found.as_slice() {
        [only] => Ok(only),
        _ => Err(format!("write one of: {}", names().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", "))),
    }
}

impl StockArgs {
    /// Gives the job of a program without a job file its stock, or says why none can be assumed.
    ///
    /// # Errors
    /// The options do not go with this job.
    pub fn apply(&self, is_job: bool, file: &mut JobFile, program: &Program) -> Result<(), Failure> {
        let is_given = self.stock.is_some() || self.material.is_some();
        if is_job && is_given {
            let message = "--stock, --material: they do not go with a job file: write [workpiece] into the job";
            return Err(Failure::Usage(message.into()));
        }
        if is_job {
            return Ok(());
        }
        if self.material.is_some() && file.job.tools.iter().any(|setup| setup.follows_program) {
            let message =
                "--material: the estimate of the power needs the feed per tooth: add --teeth and --feed-per-tooth";
            return Err(Failure::Usage(message.into()));
        }
        let found = mills(file, program).and_then(|mills| {
            let radii = || mills.iter().map(|(_, radius_mm)| *radius_mm);
            let [smallest_mm, largest_mm] = [radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max)];
            let tools: Vec<ToolInSpindle> = mills.iter().map(|(tool, _)| *tool).collect();
            Ok((self.block(file, program, (&tools, largest_mm))?, smallest_mm))
        });
        match found {
            Ok(((source, block), smallest_mm)) => {
                let assumed = AssumedStock { source, from: block.lowest, to: block.highest };
                file.workpiece = Some(self.workpiece(assumed, smallest_mm, file));
                Ok(())
            }
            Err(why) if is_given => {
                let path = program.path.display();
                Err(Failure::Usage(format!("{path}: no stock can be cut: {why}; make a job file: `arcfeed init`")))
            }
            Err(why) => {
                note(format_args!("note: no stock is assumed, so no removed material is shown: {why}"));
                Ok(())
            }
        }
    }

    /// The stock, for these end mills, the largest of which has this radius.
    fn block(
        &self,
        file: &JobFile,
        program: &Program,
        (mills, radius_mm): (&[ToolInSpindle], f64),
    ) -> Result<(StockSource, StockBlock), String> {
        if let Some(block) = self.stock {
            return Ok((StockSource::Option, block));
        }
        if let Some((block, line)) = StockBlock::commented(program) {
            return Ok((StockSource::Comment { line }, block));
        }
        let block = StockBlock::about(program, mills, radius_mm, file.job.unit);
        block
            .map(|block| (StockSource::Extents, block))
            .ok_or("its cutting moves have no extents (--stock gives it)".into())
    }

    fn workpiece(&self, assumed: AssumedStock, radius_mm: f64, file: &JobFile) -> Workpiece {
        let unit = file.job.unit;
        let [lowest_mm, highest_mm] = [assumed.from, assumed.to].map(|corner| corner.map(|value| value * unit.mm()));
        let [x, y, z] = difference(highest_mm, lowest_mm);
        let finest_mm = libm::sqrt((x * y + y * z + z * x) / RAYS_MAX);
        Workpiece {
            blank: Blank::Block { lowest_mm, highest_mm },
            assumed: Some(assumed),
            target: None,
            material: self.material.map(|name| (name.to_owned(), 0)),
            step_mm: finest_mm.max(2.0 * radius_mm / RAYS_PER_DIAMETER),
            memory_max_bytes: MEMORY_MAX_BYTES,
            is_indexed: false,
            flexible: None,
            body: Body { corner_mm: 0.0, height_mm: z },
            other_bodies: vec![Body { corner_mm: 0.0, height_mm: z }; file.job.tools.len() - 1],
            offset: 0,
        }
    }
}

/// End mills that cut, each with its radius, mm. The other tools of several take no material.
fn mills(file: &JobFile, program: &Program) -> Result<Vec<(ToolInSpindle, f64)>, String> {
    let cuts = program.lines().filter(|line| line.segment().is_some_and(|segment| segment.path != Path::Rapid));
    let mut tools: Vec<ToolInSpindle> = Vec::new();
    cuts.for_each(|line| {
        if !tools.contains(&line.machining.tool) {
            tools.push(line.machining.tool);
        }
    });
    // A job for one tool counts for the only one that cuts.
    let setup = |tool: &ToolInSpindle| match tools.as_slice() {
        [_] => Some(file.job.tools.first()),
        _ => file.job.tools.get(file.job.tool_in(*tool)?),
    };
    let mill = |tool: &ToolInSpindle| match setup(tool)?.tool {
        Tool::EndMill(mill) if !file.job.rules.is_empty() => Some((*tool, mill.radius.to_mm())),
        _ => None,
    };
    let mills: Vec<_> = tools.iter().filter_map(mill).collect();
    let none = "no end mill of known diameter has arcs in G17 that a law governs";
    if mills.is_empty() { Err(none.into()) } else { Ok(mills) }
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;

    use arcfeed_nc::settings::Reading;

    use super::*;

    fn program(text: &str) -> Program {
        Program::parse(FilePath::new("p.nc"), text.as_bytes(), LengthUnit::Mm, Reading::Lenient)
    }

    fn block(lowest: [f64; 3], highest: [f64; 3]) -> StockBlock {
        StockBlock { lowest, highest }
    }

    #[test]
    fn an_option_is_six_numbers_in_order() {
        assert_eq!("-5,95,-10,70,-20,0".parse(), Ok(block([-5.0, -10.0, -20.0], [95.0, 70.0, 0.0])));
        for wrong in ["", "1,2,3,4,5", "1,2,3,4,5,6,7", "2,1,0,1,0,1", "0,0,0,1,0,1", "0,1,0,1,0,inf", "a,1,0,1,0,1"] {
            assert!(wrong.parse::<StockBlock>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_material_is_found_by_a_part_of_its_name() {
        assert_eq!(material("6061"), Ok("Al 6061-T6, 7075-T6"));
        for wrong in ["steel", "wood"] {
            assert!(material(wrong).is_err_and(|message| message.contains("\"Ti-6Al-4V\"")), "{wrong}");
        }
    }

    #[test]
    fn a_comment_for_a_viewer_has_lengths_and_the_zero_point_from_the_lowest_corner() {
        let text = "%\nO1\n(stock/block, 100.0, 80, 20., 50, 40, 18.5)\nG0X0\nM30\n";
        let wanted = block([-50.0, -40.0, -18.5], [50.0, 40.0, 1.5]);
        assert_eq!(StockBlock::commented(&program(text)), Some((wanted, 3)));
        assert_eq!(StockBlock::commented(&program(&text.replace("100.0", "0"))), None);
        assert_eq!(StockBlock::commented(&program(&text.replace("/block", ""))), None);
    }

    #[test]
    fn a_block_about_the_cuts_reaches_as_far_as_the_tools_side() {
        // An arc whose highest Y is between its ends; rapids do not count.
        let cuts = "G90G21G17G54\nG0X-99.Y0Z50.\nG0X0\nG1Z-4.F100.\nX20.\nG3X0Y0I-10.J0\nG0Z50.\nM30\n";
        let about = |text: &str| {
            StockBlock::about(&program(text), &[ToolInSpindle::Unstated, ToolInSpindle::Number(1)], 5.0, LengthUnit::Mm)
        };
        let cut = Some(block([-5.0, -5.0, -5.0], [25.0, 15.0, 0.0]));
        assert_eq!(about(cuts), cut);
        // A lead-in above the part, and a drill beside it, change nothing.
        assert_eq!(about(&cuts.replace("G1Z-4.F100.", "G1Z1.F100.\nX1.\nX0Z-4.")), cut);
        let drill = "T2M6\nG0X-50.Y0Z5.\nG1Z-30.F90.\nG0Z5.\nM30";
        assert_eq!(about(&cuts.replace("G0X-99.", "T1M6\nG0X-99.").replace("M30", drill)), cut);
        // Zero point below the part: the top is that of the highest cut across Z, also where the last cut goes through.
        let above = cuts.replace("Z-4.", "Z12.").replace("X20.\n", "X20.\nG1Z8.\n");
        assert_eq!(about(&above), Some(block([-5.0, -5.0, 7.0], [25.0, 15.0, 12.0])));
        let through = above.replace("G0Z50.\nM30", "G1Z-0.5\nX1.\nG0Z50.\nM30");
        assert_eq!(about(&through), Some(block([-5.0, -5.0, -1.5], [25.0, 15.0, 12.0])));
        assert_eq!(about("G90G21\nG0X0Y0\nG1X10.F100.\nM30\n"), None);
    }
}
