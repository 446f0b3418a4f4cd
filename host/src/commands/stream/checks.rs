//! Options of `stream` that need the simulated control, a board or a feature.

use arcfeed_model::job::FeedPolicy;

use super::Stream;
use crate::commands::outcome::Failure;
use crate::commands::simulate::assertions::Assertion;
use crate::features::not_built_in;
use crate::port::url::Base;

impl Stream {
    /// Checks that the line has what the options ask for.
    pub(super) fn check_line_options(&self) -> Result<(), Failure> {
        if self.web.is_some() && cfg!(not(feature = "web")) {
            return Err(Failure::Usage(format!("--web: {}", not_built_in("the live page", "web"))));
        }
        if self.port.base == Base::Sim {
            return Ok(());
        }
        if self.executed.is_some() {
            let message = "--executed: a control on a serial line does not say what it executed; drop the option";
            return Err(Failure::Input(message.into()));
        }
        let positions = [
            ("--report", self.report.is_some()),
            ("--trace", self.trace.is_some()),
            ("--assert", !self.assertions.is_empty()),
        ];
        if let Some((option, _)) = positions.iter().find(|(_, is_given)| *is_given) {
            return Err(Failure::Usage(format!(
                "{option}: a control on a serial line does not say where its axes are; drop the option, or use sim:"
            )));
        }
        match self.speed {
            None => Ok(()),
            Some(_) => {
                let message = "--speed: only the control in software (sim:) has a speed; drop the option";
                Err(Failure::Usage(message.into()))
            }
        }
    }

    /// Checks that a run has the figures that are asserted.
    pub(super) fn check_assertions(&self) -> Result<(), Failure> {
        match self.assertions.iter().find_map(Assertion::of_material) {
            None => Ok(()),
            Some(figure) => Err(Failure::Usage(format!(
                "--assert {figure}: stream removes no material, so it has no {figure}; give this one to `arcfeed simulate`"
            ))),
        }
    }

    /// Checks that the feed mode and the board belong together.
    pub(super) fn check_mode(&self, policy: &FeedPolicy) -> Result<(), Failure> {
        let message = match (policy, &self.board) {
            (FeedPolicy::RewriteOnly(_), Some(_)) => {
                "--board: in the mode rewrite-only the feeds are in the F words, and a board has nothing to do: write safe-base or \
                 override-only as the mode, or drop the option"
            }
            (FeedPolicy::SafeBase | FeedPolicy::OverrideOnly, None)
                if !self.input.is_job() && self.port.base != Base::Sim =>
            {
                "--mode: this mode needs a feed board at the override: name it with --board, or drop the option for feeds in F words"
            }
            _ => return Ok(()),
        };
        Err(Failure::Usage(message.into()))
    }
}
