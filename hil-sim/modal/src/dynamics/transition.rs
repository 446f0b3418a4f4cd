//! Transition of one mode over one step: a linear map from its state and the forces at both ends.
//!
//! With a = f - 2 zeta w v - w^2 q, from 0 to 1 in the time T:
//!
//! ```text
//! Newmark, beta = 1/4, gamma = 1/2:  v1 = v0 + T/2 (a0 + a1)      q1 = q0 + T/2 (v0 + v1)      (1)
//! exact, for f = f0 + (f1 - f0) t/T: q = p(t) + h(t),  p = A + B t                             (2)
//!     B = (f1 - f0)/(T w^2),  A = f0/w^2 - 2 zeta B/w
//!     h(T) = E (c h0 + (zeta w h0 + h0') s/w'),  h'(T) = E (c h0' - (zeta w h0' + w^2 h0) s/w')
//!     E = exp(-zeta w T),  c, s of w' T,  w' = w sqrt(1 - zeta^2)
//! ```
//!
//! (1) lengthens every period by (w T)^2/12 of it and is stable for any T. (2) has no error of its own; the remaining
//! error is that of a force that is not linear between the ends (f'' T^2/12).
//!
//! Source: (1) N. M. Newmark 1959, as in Lorong et al. 2012; (2) own derivation, known since Nigam and Jennings 1969 (recalled).

use super::modal::Mode;

/// Rule by which a mode is integrated over one time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Newmark's rule with the average acceleration. (1)
    Newmark,
    /// Exact solution for a force that changes linearly within the step. (2)
    Exact,
}

/// q and q' of a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    pub(super) q: f64,
    pub(super) v: f64,
}

/// Linear map to q1 and v1 from q0, v0, f0, f1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transition {
    from: [[f64; 2]; 4],
}

impl Transition {
    pub(super) fn new(rule: Rule, mode: &Mode, dt_s: f64) -> Self {
        let step = match rule {
            Rule::Newmark => newmark,
            Rule::Exact => exact,
        };
        let unit = |which: usize| {
            let one = |at: usize| if at == which { 1.0 } else { 0.0 };
            let end = step(mode, dt_s, State { q: one(0), v: one(1) }, [one(2), one(3)]);
            [end.q, end.v]
        };
        Transition { from: [unit(0), unit(1), unit(2), unit(3)] }
    }

    /// The state after a step with no force at its end.
    pub(super) fn free(&self, before: &State, begin: f64) -> State {
        let [by_q, by_v, by_begin, _] = &self.from;
        let end = |i: usize| by_q[i] * before.q + by_v[i] * before.v + by_begin[i] * begin;
        State { q: end(0), v: end(1) }
    }

    /// Adds the effect of the force at the step's end.
    pub(super) fn push(&self, state: &mut State, end: f64) {
        let [.., by_end] = &self.from;
        state.q += by_end[0] * end;
        state.v += by_end[1] * end;
    }

    /// Compliance g: q per unit of force at the end.
    pub(super) fn compliance(&self) -> f64 {
        self.from[3][0]
    }
}

/// (1), solved for a1.
fn newmark(mode: &Mode, dt_s: f64, State { q, v }: State, [f0, f1]: [f64; 2]) -> State {
    let w = mode.circular_per_s();
    let drag = 2.0 * mode.damping_ratio * w;
    let a0 = f0 - drag * v - w * w * q;
    let half = dt_s / 2.0;
    let (q_ahead, v_ahead) = (q + dt_s * v + half * half * a0, v + half * a0);
    let a1 = (f1 - drag * v_ahead - w * w * q_ahead) / (1.0 + drag * half + w * w * half * half);
    State { q: q_ahead + half * half * a1, v: v_ahead + half * a1 }
}

/// Exact rule (2).
fn exact(mode: &Mode, dt_s: f64, State { q, v }: State, [f0, f1]: [f64; 2]) -> State {
    let (w, zeta) = (mode.circular_per_s(), mode.damping_ratio);
    let slope = (f1 - f0) / (dt_s * w * w);
    let begin = f0 / (w * w) - 2.0 * zeta * slope / w;
    let (h, h_dot) = (q - begin, v - slope);
    let damped = w * libm::sqrt(1.0 - zeta * zeta);
    let decay = libm::exp(-zeta * w * dt_s);
    let (sin, cos) = libm::sincos(damped * dt_s);
    State {
        q: begin + slope * dt_s + decay * (cos * h + (zeta * w * h + h_dot) * sin / damped),
        v: slope + decay * (cos * h_dot - (zeta * w * h_dot + w * w * h) * sin / damped),
    }
}
