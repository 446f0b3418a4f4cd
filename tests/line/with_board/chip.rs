//! The same program with the chip at the end of the line, its image in the emulator.

use arcfeed_link::message::codes::StateCode;
use arcfeed_tests::emulation::served_chip::ServedChip;
use arcfeed_tests::wait_for;

use crate::with_board::{ONE_AT_A_TIME, RESTARTED, ends_the_sending, while_the_link_holds};

#[test]
fn a_chip_that_loses_its_power_in_the_middle_of_a_job_ends_the_sending_and_comes_back_disarmed() {
    let _alone = ONE_AT_A_TIME.lock();
    while_the_link_holds(|| {
        let chip = ServedChip::start();
        ends_the_sending("power", &chip.url, || chip.power_cycle(), RESTARTED)?;
        let state = wait_for("the chip's first tick", || chip.state());
        assert_eq!(state, StateCode::Idle, "nothing arms by itself");
        let log = chip.log();
        assert!(log.iter().any(|line| line.contains("feedboard: start 2,")), "{log:#?}");
        Ok(())
    });
}
