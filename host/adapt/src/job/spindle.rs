//! Limits of the spindle in `[spindle]`.

use toml::Spanned;

use super::schema::JobTable;
use super::{Complaint, at};
use crate::unit_value::{POWER, TORQUE, with_unit};

/// Largest power and torque of the spindle, if the job names them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleLimits {
    /// Power, W.
    pub power_w: Option<f64>,
    /// Torque, N m.
    pub torque_n_m: Option<f64>,
}

/// Limits of the first tool's spindle from a job; fails at the first faulty value.
pub fn build(job: &JobTable) -> Result<SpindleLimits, Complaint> {
    let own = job.tool.0.first().and_then(|tool| tool.spindle.as_ref());
    let Some(table) = own.or(job.spindle.as_ref()) else { return Ok(SpindleLimits::default()) };
    Ok(SpindleLimits {
        power_w: power_w(table.max_power.as_ref())?,
        torque_n_m: torque_n_m(table.max_torque.as_ref())?,
    })
}

/// Power in W, from a text with a unit; `None` if it is not given.
pub fn power_w(given: Option<&Spanned<String>>) -> Result<Option<f64>, Complaint> {
    limit(given, POWER, "max_power is a power such as \"11 kW\" or \"750 W\"")
}

/// Torque in N m, from a text with a unit; `None` if it is not given.
pub fn torque_n_m(given: Option<&Spanned<String>>) -> Result<Option<f64>, Complaint> {
    limit(given, TORQUE, "max_torque is a torque such as \"40 Nm\"")
}

fn limit(given: Option<&Spanned<String>>, units: &[(&str, f64)], needs: &str) -> Result<Option<f64>, Complaint> {
    let Some(given) = given else { return Ok(None) };
    match with_unit(given.as_ref(), units).filter(|value| *value > 0.0) {
        Some(value) => Ok(Some(value)),
        None => Err(at(given, needs)),
    }
}
