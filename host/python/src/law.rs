//! `Law`: Python class for the feed law of one move, evaluated at many positions at once.

use std::path::PathBuf;

use arcfeed::adapt::places::MovePlaces;
use arcfeed::commands::call::{LineLaw, law_of_line};
use arcfeed::console::{Capture, captured};
use arcfeed_law::circumference::Circumference;
use arcfeed_law::{FeedDemand, FeedLaw, SegmentLaw};
use arcfeed_model::stock::StockLine;
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_nc::segment::Arc;
use arcfeed_units::{Mm, MmPerTooth, Nm};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::call::exception;

/// Feed law of one move.
#[pyclass(frozen, module = "arcfeed")]
pub struct Law {
    law: SegmentLaw,
    places: MovePlaces,
    length_mm: f64,
}

#[pymethods]
impl Law {
    /// Circumference law of an arc about the origin that begins at `start_deg` and turns by `sweep_deg` (positive
    /// counter-clockwise): the chip at the contact with the stock line `x cos(normal) + y sin(normal) = offset` is
    /// `feed_per_tooth`. Lengths in mm; the line's normal points out of the material.
    #[staticmethod]
    #[pyo3(signature = (*, path_radius, edge_radius, feed_per_tooth, normal_deg, offset, edge="outer", start_deg=0.0, sweep_deg=360.0))]
    #[allow(clippy::too_many_arguments, reason = "they have names in Python")]
    fn circumference(
        path_radius: f64,
        edge_radius: f64,
        feed_per_tooth: f64,
        normal_deg: f64,
        offset: f64,
        edge: &str,
        start_deg: f64,
        sweep_deg: f64,
    ) -> PyResult<Self> {
        let edge = match edge {
            "outer" => Edge::Outer,
            "inner" => Edge::Inner,
            _ => return Err(PyValueError::new_err(format!("edge: write \"outer\" or \"inner\" (found {edge:?})"))),
        };
        let positive = [("path_radius", path_radius), ("edge_radius", edge_radius), ("feed_per_tooth", feed_per_tooth)];
        if let Some((name, value)) = positive.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return Err(PyValueError::new_err(format!("{name} must be a positive length in mm (found {value})")));
        }
        if ![normal_deg, offset, start_deg].iter().all(|value| value.is_finite()) {
            return Err(PyValueError::new_err("normal_deg, offset and start_deg must be finite numbers"));
        }
        if !(sweep_deg != 0.0 && sweep_deg.abs() <= 360.0) {
            let message = format!("sweep_deg must be an angle up to 360 degrees, and not 0 (found {sweep_deg})");
            return Err(PyValueError::new_err(message));
        }
        let arc = arc(path_radius, start_deg, sweep_deg);
        let line = StockLine::from_angle(normal_deg, offset);
        let target = MmPerTooth(feed_per_tooth as f32);
        let law = Circumference::for_arc(&arc, Mm(edge_radius as f32), edge, &line, target);
        let law = SegmentLaw::Circumference(law);
        Ok(Law { law, places: MovePlaces::on_arc(&arc), length_mm: arc.length_mm() })
    }

    /// Law that the job gives to the first move on a line of its program, counted from 1.
    #[staticmethod]
    fn of_line(py: Python<'_>, job: PathBuf, line: usize) -> PyResult<Self> {
        let found = py.detach(|| captured(Some(Capture::default().into()), || law_of_line(&job, line)));
        let LineLaw { segment, law } = found.map_err(|failure| exception(py, failure))?;
        let places = MovePlaces::of(&segment);
        Ok(Law { law, places, length_mm: segment.feed_length_mm() })
    }

    /// Name of the law, as in job files.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.law {
            SegmentLaw::Circumference(_) => "circumference",
            SegmentLaw::EngagedArc(_) => "engaged-arc",
            SegmentLaw::Contour(_) => "contour",
            SegmentLaw::Engagement(_) => "engagement",
            SegmentLaw::Table(_) => "table",
            SegmentLaw::Programmed => "programmed",
        }
    }

    /// Length of the move along which F counts, mm.
    #[getter]
    fn length(&self) -> f64 {
        self.length_mm
    }

    /// Path of the tool's centre per tooth, mm, at parts of the move from 0 (start) to 1 (end); NaN where the law has no
    /// demand. Float32, the precision of the controller.
    fn feed_per_tooth<'py>(
        &self,
        py: Python<'py>,
        part: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.each(py, &part, |demand| demand.path_mm_per_tooth)
    }

    /// Angle of the decisive contact from the direction of the rotation centre, degrees, positive towards the cutting side;
    /// NaN where the law has no demand.
    fn contact_deg<'py>(
        &self,
        py: Python<'py>,
        part: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.each(py, &part, |demand| demand.contact_rad().to_degrees())
    }

    /// Why the law has no demand at a part of the move; None where it has one.
    fn no_demand(&self, part: f64) -> Option<String> {
        self.law.demand(&self.places.at(part)).err().map(|why| format!("{why:?}"))
    }
}

impl Law {
    /// A value of the demand at each position. The positions are read where they lie, and the result is not copied.
    fn each<'py>(
        &self,
        py: Python<'py>,
        part: &PyReadonlyArray1<'_, f64>,
        value: impl Fn(&FeedDemand) -> f32 + Sync,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let parts = part.as_array();
        let at = |part: &f64| {
            let demand = self.law.demand(&self.places.at(*part));
            if (0.0..=1.0).contains(part) { demand.map_or(f32::NAN, |demand| value(&demand)) } else { f32::NAN }
        };
        let values: Vec<f32> = py.detach(|| parts.iter().map(at).collect());
        Ok(values.into_pyarray(py))
    }
}

/// Arc about the origin in X and Y.
fn arc(radius_mm: f64, start_deg: f64, sweep_deg: f64) -> Arc {
    let at = |deg: f64| {
        let (sin, cos) = libm::sincos(deg.to_radians());
        [Nm::from_mm(radius_mm * cos), Nm::from_mm(radius_mm * sin)]
    };
    let turn = if sweep_deg > 0.0 { Turn::Ccw } else { Turn::Cw };
    let from = at(start_deg);
    let to = if sweep_deg.abs() < 360.0 { at(start_deg + sweep_deg) } else { from };
    Arc { plane: Plane::Xy, turn, center: [Nm(0); 2], from, to }
}
