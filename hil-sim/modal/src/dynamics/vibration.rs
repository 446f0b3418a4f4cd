//! Vibration of a structure under forces that depend on its displacement.
//!
//! Each step iterates force and displacement until they agree, like Lorong et al. 2012 (section 1.3): displacement from
//! the last force, force from that displacement, until the displacement does not change:
//!
//! ```text
//! u1 = free + G F1        free: where it would be with F1 = 0        (1)
//! G = sum of g s s^T      g: what the transition makes of F1         (2)
//! ```
//!
//! so an iteration costs no more with many modes than with one. Each one reduces the difference by the stiffness of the
//! cut times G, and g is about T^2/6 (exact) or T^2/4 (Newmark) for a short step T.
//!
//! Forces at several points, each with its own displacement, act through the modes:
//!
//! ```text
//! f_r = sum over places of s_r . F1     q_r = free_r + g_r f_r     u1 = sum of s_r q_r       (3)
//! ```
//!
//! Steps must resolve the fastest relevant mode: docs/forces.md shows the effect of coarse steps on a chatter verdict.

use arcfeed_units::MM_PER_M;
use nalgebra::{Matrix3, Vector3};

use super::modal::Mode;
use super::transition::{Rule, State, Transition};

/// Settings of the time steps of a vibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Integration rule of one mode over one step.
    pub rule: Rule,
    /// Largest change of the displacement in an iteration at which the step counts as converged.
    pub tolerance_mm: f64,
    /// Largest number of iterations in a step, at least one.
    pub iterations_max: usize,
}

/// Vibrating structure as a sum of its modes. Keeps its state between calls.
#[derive(Clone, Debug)]
pub struct Vibration {
    stepping: Stepping,
    modes: Vec<Mode>,
    states: Vec<State>,
    transitions: Vec<Transition>,
    /// Step size of the transitions.
    dt_s: f64,
    /// Compliance G, in mm/N.
    compliance: Matrix3<f64>,
    /// For each mode, the force at the end of the last step.
    drives: Vec<f64>,
}

/// Points of a structure at which forces act, with the mode shapes there.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Point by point, the shapes of all modes.
    shapes: Vec<Vector3<f64>>,
    moved_mm: Vec<Vector3<f64>>,
    forces_n: Vec<Vector3<f64>>,
    /// For each mode, its force and its amplitude.
    drives: Vec<f64>,
    amplitudes: Vec<f64>,
}

/// Result of a time step of a vibrating structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VibrationStep {
    /// Displacement at the end of the step; with forces at several points, that at the place of the cut.
    pub displacement_mm: Vector3<f64>,
    /// Force on the structure at the end of the step; the sum over all points.
    pub force_n: Vector3<f64>,
    /// Number of iterations of the step, each with one evaluation of the force.
    pub iterations: usize,
    /// Change of the displacement in the last iteration.
    pub change_mm: f64,
    /// Whether that change is within the tolerance.
    pub has_converged: bool,
}

impl Places {
    /// Removes all points.
    pub fn clear(&mut self) {
        self.shapes.clear();
        self.moved_mm.clear();
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.moved_mm.len()
    }

    /// Displacements of the points, mm, in the order in which they were added.
    pub fn moved_mm(&self) -> &[Vector3<f64>] {
        &self.moved_mm
    }
}

impl Vibration {
    /// Structure with these modes, at rest and without force.
    pub fn new(modes: Vec<Mode>, stepping: Stepping) -> Self {
        let states = vec![State::default(); modes.len()];
        let drives = vec![0.0; modes.len()];
        Vibration { stepping, modes, states, transitions: Vec::new(), dt_s: 0.0, compliance: Matrix3::zeros(), drives }
    }

    /// Modes of the structure, in the order of their numbers.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Present displacement of the structure at the place of the cut, mm.
    pub fn displacement_mm(&self) -> Vector3<f64> {
        self.shaped(|n| self.states[n].q)
    }

    /// Whether the structure is rigid: it has no modes.
    pub fn is_rigid(&self) -> bool {
        self.modes.is_empty()
    }

    /// Brings the structure to rest, without force.
    pub fn rest(&mut self) {
        self.states.fill(State::default());
        self.drives.fill(0.0);
    }

    /// Replaces the shapes of the first modes, for another position of the cut or another frame; the other shapes stay as they are.
    pub fn set_shapes(&mut self, shapes: &[Vector3<f64>]) {
        for (mode, shape) in self.modes.iter_mut().zip(shapes) {
            mode.shape = *shape;
        }
        self.compliance = self.compliance_of_step();
    }

    /// Adds to `onto` a point with these shapes of the first modes; for the other modes it has their shapes at the place of the cut.
    pub fn add_place(&self, shapes: &[Vector3<f64>], onto: &mut Places) {
        let shapes = &shapes[..shapes.len().min(self.modes.len())];
        onto.shapes.extend(shapes.iter().copied().chain(self.modes[shapes.len()..].iter().map(|mode| mode.shape)));
        onto.moved_mm.push(Vector3::zeros());
    }

    /// Advances the vibration by `dt_s`. `force` returns the force, N, on the structure at the end of the step if its displacement
    /// there is the given one, mm; it is called several times, until both agree.
    pub fn step(&mut self, dt_s: f64, mut force: impl FnMut(&Vector3<f64>) -> Vector3<f64>) -> VibrationStep {
        self.advance_free(dt_s);
        let free_mm = self.displacement_mm();
        let mut displacement_mm = free_mm + self.shaped(|n| self.mode_compliance(n) * self.drives[n]);
        let (mut force_n, mut change_mm, mut iterations) = (Vector3::zeros(), f64::INFINITY, 0);
        while change_mm > self.stepping.tolerance_mm && iterations < self.stepping.iterations_max.max(1) {
            force_n = force(&displacement_mm);
            let next_mm = free_mm + self.compliance * force_n; // (1)
            change_mm = (next_mm - displacement_mm).norm();
            displacement_mm = next_mm;
            iterations += 1;
        }
        self.push(|_, mode| mode.drive(&force_n));
        VibrationStep {
            displacement_mm,
            force_n,
            iterations,
            change_mm,
            has_converged: change_mm <= self.stepping.tolerance_mm,
        }
    }

    /// Advances by `dt_s` as [`Vibration::step`], with forces at several points: `force` writes the forces into its second argument for
    /// the displacements in the first, both in the order of the points. The step's displacement is still that of the cut.
    pub fn step_at(
        &mut self,
        dt_s: f64,
        places: &mut Places,
        mut force: impl FnMut(&[Vector3<f64>], &mut [Vector3<f64>]),
    ) -> VibrationStep {
        self.advance_free(dt_s);
        let count = self.modes.len();
        places.drives.clone_from(&self.drives);
        places.forces_n.clear();
        places.forces_n.resize(places.count(), Vector3::zeros());
        self.move_places(places);
        let (mut change_mm, mut iterations) = (f64::INFINITY, 0);
        while change_mm > self.stepping.tolerance_mm && iterations < self.stepping.iterations_max.max(1) {
            places.forces_n.fill(Vector3::zeros());
            force(&places.moved_mm, &mut places.forces_n);
            let drives = &mut places.drives;
            drives.fill(0.0);
            for (shapes, force_n) in places.shapes.chunks(count.max(1)).zip(&places.forces_n) {
                drives.iter_mut().zip(shapes).for_each(|(drive, shape)| *drive += shape.dot(force_n) * MM_PER_M);
            }
            change_mm = self.move_places(places); // (3)
            iterations += 1;
        }
        self.push(|n, _| places.drives[n]);
        VibrationStep {
            displacement_mm: self.displacement_mm(),
            force_n: places.forces_n.iter().sum(),
            iterations,
            change_mm,
            has_converged: change_mm <= self.stepping.tolerance_mm,
        }
    }

    /// Advances all modes over the step, without a force at its end.
    fn advance_free(&mut self, dt_s: f64) {
        if self.dt_s != dt_s {
            self.transitions = self.modes.iter().map(|mode| Transition::new(self.stepping.rule, mode, dt_s)).collect();
            self.dt_s = dt_s;
            self.compliance = self.compliance_of_step();
        }
        for ((drive, state), transition) in self.drives.iter().zip(&mut self.states).zip(&self.transitions) {
            *state = transition.free(state, *drive);
        }
    }

    /// Adds the effect of the forces at the end of the step; `drive` gives the force of each mode.
    fn push(&mut self, drive: impl Fn(usize, &Mode) -> f64) {
        for (n, ((mode, state), transition)) in
            self.modes.iter().zip(&mut self.states).zip(&self.transitions).enumerate()
        {
            self.drives[n] = drive(n, mode);
            transition.push(state, self.drives[n]);
        }
    }

    /// Updates the points' displacements at the end of the step from the forces on the modes; returns the largest
    /// change.
    fn move_places(&self, places: &mut Places) -> f64 {
        let Places { drives, amplitudes, .. } = places;
        amplitudes.clear();
        amplitudes
            .extend(drives.iter().enumerate().map(|(n, drive)| self.states[n].q + self.mode_compliance(n) * drive));
        let mut change_mm = 0.0_f64;
        for (shapes, moved_mm) in places.shapes.chunks(amplitudes.len().max(1)).zip(&mut places.moved_mm) {
            let next_mm: Vector3<f64> =
                shapes.iter().zip(&*amplitudes).map(|(shape, amplitude)| shape * *amplitude).sum();
            change_mm = change_mm.max((next_mm - *moved_mm).norm());
            *moved_mm = next_mm;
        }
        change_mm
    }

    /// Compliance g of a mode.
    fn mode_compliance(&self, mode: usize) -> f64 {
        self.transitions[mode].compliance()
    }

    /// Displacement at the cut for these amplitudes of the modes.
    fn shaped(&self, amplitude: impl Fn(usize) -> f64) -> Vector3<f64> {
        self.modes.iter().enumerate().map(|(n, mode)| mode.shape * amplitude(n)).sum()
    }

    /// Compliance (2) of a step.
    fn compliance_of_step(&self) -> Matrix3<f64> {
        let each = self.modes.iter().zip(&self.transitions);
        each.map(|(mode, transition)| mode.shape * mode.shape.transpose() * (transition.compliance() * MM_PER_M)).sum()
    }
}
