//! Settings of `fault://`: kinds of faults, their probabilities, and the seed of their random numbers.

use arcfeed_units::Micros;

use super::UrlError;

/// Longest delay of a byte.
const DELAY_MAX_MS: u64 = 60_000;
/// Most bytes of garbage.
const GARBAGE_MAX: usize = 65_536;

/// Faults that `fault://` injects into a port; the default has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultPlan {
    /// Seed of the random numbers: the same seed and the same bytes give the same faults.
    pub seed: u64,
    /// Faults of bytes to the control.
    pub tx: Faults,
    /// Faults of bytes from the control.
    pub rx: Faults,
    /// Number of random bytes that the reader gets first, as from a line that is switched on.
    pub garbage: usize,
    /// Probability, from 0 to 1, that a DC1 from the control is lost.
    pub lost_xon: f64,
    /// Probability that a DC3 from the control is lost.
    pub lost_xoff: f64,
    /// Number of written bytes after which the port fails as if it were unplugged; `None`: never.
    pub disconnect: Option<u64>,
    /// Probability of each write to accept only a part of its bytes, or none.
    pub short: f64,
}

/// Faults in one direction: probabilities for each byte, from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Probability that the byte is lost.
    pub drop: f64,
    /// Probability that one of its bits is inverted.
    pub flip: f64,
    /// Probability that the byte arrives twice.
    pub dup: f64,
    /// Probability that a burst of noise begins, which replaces 2 to 16 bytes by random ones.
    pub burst: f64,
    /// Largest delay of a byte; each is delayed by a random time up to it, and the order stays.
    pub delay: Micros,
}

/// Parses the part of a URL after `fault://`, `NAME=VALUE[,NAME=VALUE...]/PORT`; returns the faults and the text of
/// PORT.
pub fn read(rest: &str) -> Result<(FaultPlan, &str), UrlError> {
    let Some((settings, inner)) = rest.split_once('/').filter(|(settings, _)| !settings.is_empty()) else {
        let message =
            "write fault://NAME=VALUE[,NAME=VALUE...]/PORT, for example fault://drop=0.01,seed=7//dev/ttyUSB0";
        return Err(UrlError::new(format!("fault://{rest}"), message));
    };
    let mut plan = FaultPlan::default();
    for part in settings.split(',') {
        let (name, value) = part.split_once('=').unwrap_or((part, ""));
        set(&mut plan, name, value).map_err(|message| UrlError::new(part, message))?;
    }
    Ok((plan, inner))
}

fn set(plan: &mut FaultPlan, name: &str, value: &str) -> Result<(), &'static str> {
    match name {
        "seed" => plan.seed = value.parse().map_err(|_| "seed is a whole number; write seed=7")?,
        "garbage" => {
            let bytes = value.parse().ok().filter(|bytes| *bytes <= GARBAGE_MAX);
            plan.garbage = bytes.ok_or("garbage is a number of bytes, up to 65536")?;
        }
        "disconnect" => {
            plan.disconnect =
                Some(value.parse().map_err(|_| "disconnect is the number of bytes the line still takes")?);
        }
        "lost_xon" => plan.lost_xon = chance(value)?,
        "lost_xoff" => plan.lost_xoff = chance(value)?,
        "short" => plan.short = chance(value)?,
        _ => {
            let (both, name) = match name.split_once('.') {
                Some(("tx", name)) => ([Some(&mut plan.tx), None], name),
                Some(("rx", name)) => ([None, Some(&mut plan.rx)], name),
                _ => ([Some(&mut plan.tx), Some(&mut plan.rx)], name),
            };
            for faults in both.into_iter().flatten() {
                set_one_way(faults, name, value)?;
            }
        }
    }
    Ok(())
}

fn set_one_way(faults: &mut Faults, name: &str, value: &str) -> Result<(), &'static str> {
    match name {
        "drop" => faults.drop = chance(value)?,
        "flip" => faults.flip = chance(value)?,
        "dup" => faults.dup = chance(value)?,
        "burst" => faults.burst = chance(value)?,
        "delay" => {
            let ms = value.parse().ok().filter(|ms| *ms <= DELAY_MAX_MS);
            faults.delay = Micros::from_ms(ms.ok_or("delay is a number of milliseconds, up to 60000")?);
        }
        _ => {
            return Err(
                "no such fault; there are drop, flip, dup, burst and delay (both ways, or one: tx.drop, rx.drop), \
                        garbage, lost_xon, lost_xoff, disconnect and short, and the seed",
            );
        }
    }
    Ok(())
}

fn chance(value: &str) -> Result<f64, &'static str> {
    let parsed = value.parse().ok().filter(|chance| (0.0..=1.0).contains(chance));
    parsed.ok_or("is a chance; write a number from 0 to 1")
}
