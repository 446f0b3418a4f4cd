//! Python classes `Stock` (a workpiece of dexels) and `Tool` (the body that cuts it).

use std::path::PathBuf;

use arcfeed::commands::simulate::write_surface;
use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::files::read_stl;
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::{Block, Revolved, Solid};
use arcfeed_dexel::tool;
use arcfeed_dexel::workpiece;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::call::exception;

/// Tolerance of chords, as a fraction of the step between rays.
const TOLERANCE_RATIO: f64 = 1.0 / 50.0;
/// Tolerance of the rounded parts of tools, mm.
const TOOL_TOLERANCE_MM: f64 = 1e-3;
/// Tool axis: upwards.
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Solid of revolution that cuts: its tip is the reference point, its axis points up. Lengths in mm.
#[pyclass(frozen, module = "arcfeed")]
pub struct Tool(tool::Tool);

#[pymethods]
impl Tool {
    /// End mill: flat, with a rounded corner, or a ball if the corner has the tool's radius.
    #[staticmethod]
    #[pyo3(signature = (*, radius, height, corner=0.0))]
    fn end_mill(radius: f64, height: f64, corner: f64) -> PyResult<Self> {
        tool::Tool::bull_nose([radius, corner], height, TOOL_TOLERANCE_MM).map(Tool).map_err(invalid)
    }

    /// Ring of a cup mill, with rounded corners of its inserts.
    #[staticmethod]
    #[pyo3(signature = (*, outer_radius, inner_radius, height, corner=0.0))]
    fn cup_mill(outer_radius: f64, inner_radius: f64, height: f64, corner: f64) -> PyResult<Self> {
        tool::Tool::ring([outer_radius, inner_radius], corner, height, TOOL_TOLERANCE_MM).map(Tool).map_err(invalid)
    }

    /// Volume, mm3; arcs count as their chords.
    #[getter]
    fn volume(&self) -> f64 {
        self.0.volume_mm3()
    }
}

/// Workpiece of rays along X, Y and Z (tri-dexels), which tools cut. Lengths in mm.
#[pyclass(module = "arcfeed")]
pub struct Stock(workpiece::Stock);

#[pymethods]
impl Stock {
    /// Block between two corners, by rays `step` apart.
    #[staticmethod]
    #[pyo3(signature = (lowest, highest, *, step, memory_max_bytes=1_073_741_824))]
    fn block(
        py: Python<'_>,
        lowest: [f64; 3],
        highest: [f64; 3],
        step: f64,
        memory_max_bytes: usize,
    ) -> PyResult<Self> {
        Stock::of(py, &Block { lowest_mm: lowest, highest_mm: highest }, step, memory_max_bytes)
    }

    /// Upright cylinder that stands on `center`, the middle of its bottom.
    #[staticmethod]
    #[pyo3(signature = (center, *, radius, height, step, memory_max_bytes=1_073_741_824))]
    #[allow(clippy::too_many_arguments, reason = "they have names in Python")]
    fn cylinder(
        py: Python<'_>,
        center: [f64; 3],
        radius: f64,
        height: f64,
        step: f64,
        memory_max_bytes: usize,
    ) -> PyResult<Self> {
        let body = tool::Tool::cylinder(radius, height).map_err(invalid)?;
        let solid = Revolved::new(body, &Pose { tip_mm: center, axis: UP });
        let solid = solid.ok_or_else(|| PyValueError::new_err("center must be three finite numbers"))?;
        Stock::of(py, &solid, step, memory_max_bytes)
    }

    /// Solid in an STL file, text or binary, in mm.
    #[staticmethod]
    #[pyo3(signature = (path, *, step, memory_max_bytes=1_073_741_824))]
    fn stl(py: Python<'_>, path: PathBuf, step: f64, memory_max_bytes: usize) -> PyResult<Self> {
        let file = std::fs::File::open(&path)?;
        let mesh = py.detach(|| read_stl(std::io::BufReader::new(file)));
        let mesh = mesh.map_err(|error| PyValueError::new_err(format!("{}: {error}", path.display())))?;
        Stock::of(py, &mesh, step, memory_max_bytes)
    }

    /// Takes away what the tool sweeps along straight moves through the points of an (n, 3) array; returns the volume
    /// removed, mm3.
    fn cut(&mut self, py: Python<'_>, tool: &Tool, path: PyReadonlyArray2<'_, f64>) -> PyResult<f64> {
        let points = path.as_array();
        if points.ncols() != 3 || points.nrows() < 2 {
            let message = format!("path must be an array of two or more points (n, 3) (found {:?})", points.shape());
            return Err(PyValueError::new_err(message));
        }
        if !points.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(PyValueError::new_err("path has a coordinate that is not a finite number"));
        }
        let point = |row: usize| [points[[row, 0]], points[[row, 1]], points[[row, 2]]];
        let sweep = |row| Sweep { from_mm: point(row), to_mm: point(row + 1), axis: UP };
        let sweeps: Vec<Sweep> = (0..points.nrows() - 1).map(sweep).collect();
        self.take(py, tool, &sweeps)
    }

    /// The same along an arc or helix about the vertical line through `center`, by `angle_deg` (positive
    /// counter-clockwise) and `rise` upwards. The chords stay within a fiftieth of the step.
    #[pyo3(signature = (tool, start, center, angle_deg, *, rise=0.0))]
    #[allow(clippy::too_many_arguments, reason = "they have names in Python")]
    fn cut_arc(
        &mut self,
        py: Python<'_>,
        tool: &Tool,
        start: [f64; 3],
        center: [f64; 2],
        angle_deg: f64,
        rise: f64,
    ) -> PyResult<f64> {
        let [x, y] = center;
        let from = Pose { tip_mm: start, axis: UP };
        let (center_mm, angle_rad) = ([x, y, start[2]], angle_deg.to_radians());
        let turn = Move::Turn { from, center_mm, normal: UP, angle_rad, rise_mm: rise };
        let sweeps = turn.sweeps(&tool.0, self.0.lattice().step_mm() * TOLERANCE_RATIO).map_err(invalid)?;
        self.take(py, tool, &sweeps)
    }

    /// Volume of the remaining material, mm3: the mean over the three directions of rays.
    #[getter]
    fn volume(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.0.volume().mean_mm3())
    }

    /// The same for the rays along each axis. Their differences show how fine the rays are.
    #[getter]
    fn volume_by_axis(&self, py: Python<'_>) -> [f64; 3] {
        py.detach(|| self.0.volume().by_axis)
    }

    /// Distance of the rays, mm.
    #[getter]
    fn step(&self) -> f64 {
        self.0.lattice().step_mm()
    }

    /// Memory of the rays.
    #[getter]
    fn memory_bytes(&self) -> usize {
        self.0.memory_bytes()
    }

    /// Upper ends of the material along an axis (0, 1, 2 for X, Y, Z), mm; NaN where there is none. For Z the rows are along Y
    /// and the columns along X, in general along the axes after the next and after this one.
    #[pyo3(signature = (axis=2))]
    fn heights<'py>(&self, py: Python<'py>, axis: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        checked(axis)?;
        let heights: Vec<f64> = py.detach(|| {
            let map = HeightMap::new(&self.0, axis);
            map.heights_mm().iter().map(|height| height.unwrap_or(f64::NAN)).collect()
        });
        let [columns, rows] = self.0.lattice().size(axis);
        heights.into_pyarray(py).reshape([rows, columns])
    }

    /// Coordinates of the rays along an axis, mm: those of the columns or rows of `heights`.
    fn centers<'py>(&self, py: Python<'py>, axis: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        checked(axis)?;
        let lattice: &Lattice = self.0.lattice();
        let centers: Vec<f64> = (0..lattice.cells()[axis]).map(|cell| lattice.center_mm(axis, cell)).collect();
        Ok(centers.into_pyarray(py))
    }

    /// Writes the surface, in mm: .stl or .ply, binary.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write_surface(&self.0, &path)).map_err(|failure| exception(py, failure))
    }

    /// Another stock with the same material.
    fn copy(&self, py: Python<'_>) -> Self {
        Stock(py.detach(|| self.0.clone()))
    }
}

impl Stock {
    fn of(py: Python<'_>, solid: &dyn Solid, step_mm: f64, memory_max_bytes: usize) -> PyResult<Self> {
        py.detach(|| workpiece::Stock::new(solid, step_mm, memory_max_bytes)).map(Stock).map_err(invalid)
    }

    fn take(&mut self, py: Python<'_>, tool: &Tool, sweeps: &[Sweep]) -> PyResult<f64> {
        py.detach(|| self.0.cut(&tool.0, sweeps)).map(|removed| removed.mean_mm3()).map_err(invalid)
    }
}

fn invalid(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn checked(axis: usize) -> PyResult<()> {
    if axis < 3 { Ok(()) } else { Err(PyValueError::new_err(format!("axis must be 0, 1 or 2 (found {axis})"))) }
}
