//! The image's log, and that a bad one is found out.

use std::fs;
use std::panic::catch_unwind;

use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::run;

#[test]
fn a_log_that_is_cut_off_or_corrupted_is_not_taken_for_a_whole_one() {
    let (image, log) = (fs::read(image("example-run")).expect("the image is there"), run("example-run").console);
    let corrupted = [&log[..], &[1, 0]].concat();
    let is_taken = |log: &[u8]| catch_unwind(|| messages(&image, log)).is_ok();
    assert!(is_taken(&log) && !is_taken(&log[..log.len() - 1]) && !is_taken(&corrupted));
}
