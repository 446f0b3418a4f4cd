//! `[workpiece]` of a planned job: the material that `simulate` cuts.

use crate::output::toml_text::quoted;
use crate::vector::Point;

/// Workpiece of a job file: meshes in millimetres, by paths relative to the job file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workpiece<'a> {
    /// Shape before the cut.
    pub stock: StockShape<'a>,
    /// Path of the target shape's mesh; `None` without one.
    pub target: Option<&'a str>,
    /// Distance of the rays of the simulation's tri-dexel model.
    pub step_mm: f64,
}

/// Shape of the workpiece before the cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StockShape<'a> {
    /// Mesh of the blank about one slot or passage, by its path.
    Mesh(&'a str),
    /// Mesh of the whole part, by its path; it is cut at all positions of the rotary axes.
    WholeMesh(&'a str),
    /// Whole blank, which is cut at all positions of the rotary axes.
    Ring(BlankRing),
}

/// Blank as a ring about an axis, in the program's coordinates at the first cut; dimensions in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlankRing {
    /// Middles of both end faces.
    pub ends_mm: [Point; 2],
    /// Outer radius.
    pub radius_mm: f64,
    /// Radius of the ring's bore.
    pub bore_mm: f64,
}

impl Workpiece<'_> {
    /// Text of the table; `length` writes a length in the unit of the job.
    pub(super) fn text(&self, length: impl Fn(f64) -> String) -> String {
        let stock = match self.stock {
            StockShape::Mesh(path) => format!("stl = {}", quoted(path)),
            StockShape::WholeMesh(path) => format!("stl = {}\nindexed = true", quoted(path)),
            StockShape::Ring(BlankRing { ends_mm, radius_mm, bore_mm }) => {
                let [from, to] = ends_mm.map(|end| [end.x, end.y, end.z].map(&length).join(", "));
                let (radius, bore) = (length(radius_mm), length(bore_mm));
                format!("round = {{ from = [{from}], to = [{to}], radius = {radius}, bore = {bore} }}\nindexed = true")
            }
        };
        let target = self.target.map_or(String::new(), |target| format!("target = {}\n", quoted(target)));
        format!("[workpiece]\n{stock}\nstl_units = \"mm\"\n{target}step = {}\n", length(self.step_mm))
    }
}
