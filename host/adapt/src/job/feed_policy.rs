//! `[override]`: the way in which the demanded feed reaches the control, and the bounds of the override.

use arcfeed_firmware::ramp::{LimitsError, Ramp};
use arcfeed_model::job::{FeedCeiling, FeedPolicy, LawKind, OverrideLimits, PieceSettings, ToolSetup, Tools};
use arcfeed_model::machine::MachineLimits;
use arcfeed_units::{LengthUnit, MmPerMin, Nm};
use toml::Spanned;

use super::schema::{JobTable, LimitsTable, OverrideTable};
use super::{Complaint, at, length_mm};

/// Largest value of `piece_step` and `piece_hysteresis`, %.
const RATIO_MAX_PERCENT: f32 = 50.0;
/// Largest value of `max_raise`.
const RAISE_MAX: f64 = 100.0;
/// Most pieces of an arc: more than a control reads at its line's rate.
const PIECES_MAX: u16 = 250;

/// Feed mode of a job and, for `rewrite-only`, the settings of the pieces; fails at the first faulty value.
pub fn policy(given: &OverrideTable, unit: LengthUnit) -> Result<FeedPolicy, Complaint> {
    let policy = match given.mode.as_ref().as_str() {
        "safe-base" => FeedPolicy::SafeBase,
        "override-only" => FeedPolicy::OverrideOnly,
        "rewrite-only" => return pieces(given, unit).map(FeedPolicy::RewriteOnly),
        _ => {
            let message = "no such mode; write \"safe-base\", \"override-only\" or \"rewrite-only\"";
            return Err(at(&given.mode, message));
        }
    };
    let ratio = given.piece_step.as_ref().or(given.piece_hysteresis.as_ref()).map(|value| value.span().start);
    let length = given.piece_length.as_ref().map(|value| value.span().start);
    let most = given.pieces_max.as_ref().map(|value| value.span().start);
    match ratio.or(length).or(most) {
        None => Ok(policy),
        Some(offset) => {
            Err((offset, "this mode cuts no arc into pieces; remove this, or write mode = \"rewrite-only\"".into()))
        }
    }
}

fn pieces(given: &OverrideTable, unit: LengthUnit) -> Result<PieceSettings, Complaint> {
    let defaults = PieceSettings::default();
    let least_length = match &given.piece_length {
        Some(length) => Nm::from_mm(length_mm(length, unit, "piece_length")?),
        None => defaults.least_length,
    };
    let most = match &given.pieces_max {
        Some(most) if !(1..=PIECES_MAX).contains(most.as_ref()) => {
            return Err(at(most, &format!("pieces_max must lie between 1 and {PIECES_MAX}")));
        }
        Some(most) => *most.as_ref(),
        None => defaults.most,
    };
    Ok(PieceSettings {
        step_percent: ratio(&given.piece_step, "piece_step", defaults.step_percent)?,
        hysteresis_percent: ratio(&given.piece_hysteresis, "piece_hysteresis", defaults.hysteresis_percent)?,
        least_length,
        most,
    })
}

fn ratio(given: &Option<Spanned<f32>>, name: &str, default: f32) -> Result<f32, Complaint> {
    let Some(value) = given else { return Ok(default) };
    let percent = *value.as_ref();
    // A step of 0 would never reach the end.
    let least = if name == "piece_step" { 0.1 } else { 0.0 };
    if (least..=RATIO_MAX_PERCENT).contains(&percent) {
        return Ok(percent);
    }
    Err(at(value, &format!("{name} must lie between {least} and {RATIO_MAX_PERCENT} %")))
}

/// Upper limit of all governed feeds, from a job; fails at the first faulty value.
pub fn ceiling(
    table: &JobTable,
    unit: LengthUnit,
    tools: &Tools,
    machine: &MachineLimits,
) -> Result<FeedCeiling, Complaint> {
    let LimitsTable { max_feed, max_raise } = &table.limits;
    let max_feed = max_feed.as_ref().map(|feed| length_mm(feed, unit, "max_feed")).transpose()?;
    let max_raise_ratio = match max_raise {
        Some(raise) if !(1.0..=RAISE_MAX).contains(raise.as_ref()) => {
            return Err(at(raise, &format!("max_raise must lie between 1 and {RAISE_MAX}, times the programmed feed")));
        }
        Some(raise) => *raise.as_ref() as f32,
        None => FeedCeiling::DEFAULT_RAISE_RATIO,
    };
    let is_bounded = max_feed.is_some() || machine.linear.iter().all(Option::is_some);
    // A target that follows the program's F is bounded by F itself.
    let needs_bound = |setup: &ToolSetup| setup.law != LawKind::Programmed && !setup.follows_program;
    let governing = tools.iter().zip(&table.tool.0).find(|(setup, _)| needs_bound(setup));
    if let Some((_, tool)) = governing.filter(|_| !is_bounded) {
        let message = "the job has no fastest feed: add a table [limits] with max_feed, per minute along the path, or give the machine's \
                       axes (max_feed of X, Y and Z in [machine])";
        let law = tool.law.as_ref().or(table.law.as_ref());
        return Err(at(law.map_or(&tool.kind, |law| &law.kind), message));
    }
    Ok(FeedCeiling { max_feed: max_feed.map(|feed| MmPerMin(feed as f32)), max_raise_ratio })
}

/// Bounds and slew rates of the override, from a job; fails at the first faulty value.
pub fn limits(given: &OverrideTable) -> Result<OverrideLimits, Complaint> {
    let limits = OverrideLimits {
        min_percent: *given.min.as_ref(),
        max_percent: *given.max.as_ref(),
        step_percent: *given.step.as_ref(),
        slew_up_percent_per_s: *given.slew_up.as_ref(),
        slew_down_percent_per_s: *given.slew_down.as_ref(),
    };
    match Ramp::new(&limits) {
        Ok(_) if (1..limits.step_percent).contains(&limits.min_percent) => {
            let message = "min must be 0 or at least one step: an override below one step is put out as 0 %, and the axes would stand";
            Err(at(&given.min, message))
        }
        Ok(_) => Ok(limits),
        Err(LimitsError::Range) if limits.min_percent > 100 => Err(at(&given.min, "min must be at most 100 %")),
        Err(LimitsError::Range) => Err(at(&given.max, "max must lie between 100 % and 254 %, the control's limit")),
        Err(LimitsError::Step) => Err(at(&given.step, "step must be a divisor of 100 %")),
        Err(LimitsError::Slew) => {
            let wrong = if limits.slew_up_percent_per_s > 0.0 { &given.slew_down } else { &given.slew_up };
            Err(at(wrong, "slew_up and slew_down must be positive, in % per second"))
        }
    }
}
