//! The example job on the machine of its source.

use arcfeed_control::ControlSettings;
use arcfeed_tests::root;
use arcfeed_units::LengthUnit;

use crate::drives::indexing::hu80a;
use crate::drives::motion::Motion;

#[test]
fn the_example_stays_within_all_limits() {
    let program = std::fs::read_to_string(root().join("examples/ibr-slot/ibr-slot.nc")).expect("the example is there");
    let drives = hu80a(None);
    for preset in [arcfeed_control::Preset::Fanuc16i, arcfeed_control::Preset::Fanuc31i] {
        let settings =
            ControlSettings { drives: Some(drives), operator_restart: None, ..preset.settings(LengthUnit::Inch) };
        let motion = Motion::of(&program, settings, |_| 100);
        motion.keeps(&drives, "example");
        println!("{preset:?}: {:.1} s, {:?}", motion.seconds(), motion.greatest());
    }
}
