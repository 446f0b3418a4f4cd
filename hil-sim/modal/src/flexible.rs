//! Tool and workpiece as one structure, with the modes at the points where they touch.
//!
//! The points move over the workpiece, so the shapes of its modes change there; the shapes of the tool's modes stay.
//! The workpiece's modes come first in the list of all modes, because
//! [`Vibration`](crate::dynamics::vibration::Vibration) leaves the rest as they are.
//!
//! Source: Lorong et al., Simulation of a finishing operation, 2012, eqs 3 to 6, reduced to modes; one damping ratio for all modes of a part as in their
//! section 4.3.

use std::f64::consts::TAU;
use std::fmt::Debug;
use std::sync::Arc;

use arcfeed_units::T_PER_KG;
use nalgebra::Vector3;

use crate::dynamics::modal::{Mode, ModeError};
use crate::modal_point::ModalPoint;

/// Body whose mode shapes can be found at each of its points, and around it.
pub trait Modal: Debug + Send + Sync {
    /// Angular frequencies of the modes, rad/s, the lowest first.
    fn omega_rad_per_s(&self) -> &[f64];

    /// Distance outside the body up to which its outermost elements extrapolate the displacement.
    fn reach_mm(&self) -> f64;

    /// Sets `modal_point` to a point or, if that is outside by more than `beyond_mm`, to the point at that distance
    /// from the body on the line from the nearest point of the body.
    fn evaluate_at(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint);
}

impl<B: Modal> Modal for &B {
    fn omega_rad_per_s(&self) -> &[f64] {
        (*self).omega_rad_per_s()
    }

    fn reach_mm(&self) -> f64 {
        (*self).reach_mm()
    }

    fn evaluate_at(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) {
        (*self).evaluate_at(point_mm, beyond_mm, modal_point);
    }
}

impl<B: Modal + ?Sized> Modal for Arc<B> {
    fn omega_rad_per_s(&self) -> &[f64] {
        (**self).omega_rad_per_s()
    }

    fn reach_mm(&self) -> f64 {
        (**self).reach_mm()
    }

    fn evaluate_at(&self, point_mm: [f64; 3], beyond_mm: f64, modal_point: &mut ModalPoint) {
        (**self).evaluate_at(point_mm, beyond_mm, modal_point);
    }
}

/// Fraction of a body's reach, which is about its thickness, by which an edge moves before the modes are updated: they
/// change by less than the error of the elements.
const SAME_RATIO: f64 = 0.02;

/// Flexible workpiece along which a tool moves. Keeps, for the cut and for each edge, the last point, near which the next one is found.
#[derive(Clone, Debug)]
pub struct Workpiece<B> {
    body: B,
    /// View of the cut, and one for each edge.
    views: Vec<View>,
}

/// Mode shapes at one point.
#[derive(Clone, Debug, Default)]
struct View {
    /// Last point.
    point_mm: Option<Vector3<f64>>,
    modal_point: ModalPoint,
    shapes: Vec<Vector3<f64>>,
}

impl<B: Modal> Workpiece<B> {
    /// Flexible workpiece with the modes of `body`.
    pub fn new(body: B) -> Self {
        Workpiece { body, views: Vec::new() }
    }

    /// Number of modes of the workpiece.
    pub fn count(&self) -> usize {
        self.body.omega_rad_per_s().len()
    }

    /// Shapes of all modes at the point of the body nearest to `point_mm`, 1/sqrt(kg).
    pub fn shapes_on(&mut self, point_mm: [f64; 3]) -> &[Vector3<f64>] {
        self.update_view(0, point_mm, [0.0, 0.0])
    }

    /// Mode shapes at an edge's point, or at one that the edge has passed just before, 1/sqrt(kg).
    pub fn shapes_at(&mut self, edge: usize, point_mm: [f64; 3]) -> &[Vector3<f64>] {
        let reach_mm = self.body.reach_mm();
        self.update_view(edge + 1, point_mm, [reach_mm, SAME_RATIO * reach_mm])
    }

    /// Modes at the point of the body nearest to another, all with the same damping.
    ///
    /// # Errors
    /// The damping is out of range.
    pub fn modes(&mut self, point_mm: [f64; 3], damping_ratio: f64) -> Result<Vec<Mode>, ModeError> {
        self.shapes_on(point_mm);
        modes(self.body.omega_rad_per_s(), &self.views[0].shapes, damping_ratio)
    }

    fn update_view(&mut self, view: usize, point_mm: [f64; 3], [beyond_mm, same_mm]: [f64; 2]) -> &[Vector3<f64>] {
        if self.views.len() <= view {
            self.views.resize(view + 1, View::default());
        }
        let View { point_mm: before, modal_point, shapes } = &mut self.views[view];
        let point = Vector3::from(point_mm);
        if before.is_none_or(|before| (point - before).norm() > same_mm) {
            *before = Some(point);
            self.body.evaluate_at(point_mm, beyond_mm, modal_point);
            shapes.clear();
            shapes.extend(modal_point.shapes.iter().map(per_root_kg));
        }
        shapes
    }
}

/// Modes of a body at one of its points, all with the same damping.
///
/// # Errors
/// The damping is out of range.
pub fn modes_at(
    omegas_rad_per_s: &[f64],
    modal_point: &ModalPoint,
    damping_ratio: f64,
) -> Result<Vec<Mode>, ModeError> {
    let shapes: Vec<Vector3<f64>> = modal_point.shapes.iter().map(per_root_kg).collect();
    modes(omegas_rad_per_s, &shapes, damping_ratio)
}

fn modes(omegas: &[f64], shapes: &[Vector3<f64>], damping_ratio: f64) -> Result<Vec<Mode>, ModeError> {
    omegas.iter().zip(shapes).map(|(omega, shape)| Mode::new(omega / TAU, damping_ratio, *shape)).collect()
}

/// Shape in 1/sqrt(kg) from 1/sqrt(t).
fn per_root_kg(shape: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(*shape) * libm::sqrt(T_PER_KG)
}
