//! A structure that is moved by forces which depend on where it is.
//!
//! In each step force and displacement are made to agree, as Lorong et al. 2012 (section 1.3) do: displacement from the
//! last force, force from that displacement, and so on until the displacement stays:
//!
//! ```text
//! u1 = free + G F1        free: where it would be with F1 = 0        (1)
//! G = sum of g s s^T      g: what the transition makes of F1         (2)
//! ```
//!
//! so a pass costs no more with many modes than with one. Each makes the difference smaller by the stiffness of the cut times G,
//! and g is about T^2/6 (exact) or T^2/4 (Newmark) for a short step T.
//!
//! Steps must resolve the fastest mode that matters: docs/forces.md has what coarse ones do to a verdict on chatter.

use arcfeed_shared::units::MM_PER_M;
use nalgebra::{Matrix3, Vector3};

use super::modal::Mode;
use super::transition::{Rule, State, Transition};

/// How steps are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Of one mode over one step.
    pub rule: Rule,
    /// A displacement stays if it changes by no more than this in a pass.
    pub tolerance_mm: f64,
    /// At most so many passes a step, one at least.
    pub passes_max: usize,
}

/// Modes and where they are; state.
#[derive(Clone, Debug)]
pub struct Vibration {
    stepping: Stepping,
    modes: Vec<Mode>,
    states: Vec<State>,
    transitions: Vec<Transition>,
    /// The step that the transitions are for.
    dt_s: f64,
    /// G, in mm/N.
    compliance: Matrix3<f64>,
    force_n: Vector3<f64>,
}

/// What came out of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// At its end.
    pub displacement_mm: Vector3<f64>,
    /// On the structure, at its end.
    pub force_n: Vector3<f64>,
    /// How often the force was asked for.
    pub passes: usize,
    /// What the displacement changed by in the last pass.
    pub change_mm: f64,
    /// Whether that is within the tolerance.
    pub agrees: bool,
}

impl Vibration {
    /// At rest, without force.
    pub fn new(modes: Vec<Mode>, stepping: Stepping) -> Self {
        let states = vec![State::default(); modes.len()];
        let (transitions, compliance, force_n) = (Vec::new(), Matrix3::zeros(), Vector3::zeros());
        Vibration { stepping, modes, states, transitions, dt_s: 0.0, compliance, force_n }
    }

    /// The modes.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Where the structure is.
    pub fn displacement_mm(&self) -> Vector3<f64> {
        self.modes.iter().zip(&self.states).map(|(mode, state)| mode.shape * state.q).sum()
    }

    /// Whether nothing can be moved: there are no modes.
    pub fn is_rigid(&self) -> bool {
        self.modes.is_empty()
    }

    /// Comes to rest, without force.
    pub fn rest(&mut self) {
        self.states.fill(State::default());
        self.force_n = Vector3::zeros();
    }

    /// The cut is elsewhere, or is seen in another frame: the same modes with other shapes. Shapes left out stay as they are.
    pub fn see_from(&mut self, shapes: &[Vector3<f64>]) {
        for (mode, shape) in self.modes.iter_mut().zip(shapes) {
            mode.shape = *shape;
        }
        self.compliance = self.compliance_of_step();
    }

    /// Goes on by `dt_s`; `force` tells the force on the structure at the end of the step for a displacement there, and may be
    /// asked more than once.
    pub fn step(&mut self, dt_s: f64, mut force: impl FnMut(&Vector3<f64>) -> Vector3<f64>) -> Step {
        if self.dt_s != dt_s {
            self.transitions = self.modes.iter().map(|mode| Transition::new(self.stepping.rule, mode, dt_s)).collect();
            self.dt_s = dt_s;
            self.compliance = self.compliance_of_step();
        }
        let mut force_n = self.force_n;
        self.let_free();
        let free_mm = self.displacement_mm();
        let mut displacement_mm = free_mm + self.compliance * force_n;
        let (mut change_mm, mut passes) = (f64::INFINITY, 0);
        while change_mm > self.stepping.tolerance_mm && passes < self.stepping.passes_max.max(1) {
            force_n = force(&displacement_mm);
            let next_mm = free_mm + self.compliance * force_n; // (1)
            change_mm = (next_mm - displacement_mm).norm();
            displacement_mm = next_mm;
            passes += 1;
        }
        self.push(&force_n);
        Step { displacement_mm, force_n, passes, change_mm, agrees: change_mm <= self.stepping.tolerance_mm }
    }

    /// All modes over the step, without a force at its end.
    fn let_free(&mut self) {
        for ((mode, state), transition) in self.modes.iter().zip(&mut self.states).zip(&self.transitions) {
            *state = transition.free(state, mode.drive(&self.force_n));
        }
    }

    /// What the force at the end of the step adds.
    fn push(&mut self, end_n: &Vector3<f64>) {
        for ((mode, state), transition) in self.modes.iter().zip(&mut self.states).zip(&self.transitions) {
            transition.push(state, mode.drive(end_n));
        }
        self.force_n = *end_n;
    }

    /// (2)
    fn compliance_of_step(&self) -> Matrix3<f64> {
        let each = self.modes.iter().zip(&self.transitions);
        each.map(|(mode, transition)| mode.shape * mode.shape.transpose() * (transition.given_way() * MM_PER_M)).sum()
    }
}
