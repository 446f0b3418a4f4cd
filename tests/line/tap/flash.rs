//! `arcfeed parameters`: what a board at a tapped line finds in its flash is the job, and nothing is written of a bad one.

use std::fs;

use arcfeed::job::JobFile;
use arcfeed_link::message::page::{PAGE_MAX, TappedLine, read};
use arcfeed_link::message::staging::Staging;
use arcfeed_nc::settings::Decimals;
use arcfeed_nc::tape_code::TapeCode;
use arcfeed_tests::{Scratch, root, run};

#[test]
fn a_page_of_flash_has_the_whole_job() {
    for example in ["ibr-slot/job.toml", "pocket/job-engagement.toml"] {
        let (scratch, job) = (Scratch::new("flash-page"), root().join("examples").join(example));
        let page = scratch.path("page");
        let output = run(&["parameters", &job.to_string_lossy(), "--output", &page]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        println!("{}", String::from_utf8_lossy(&output.stdout));
        assert!(!String::from_utf8_lossy(&output.stderr).contains("plunges"), "it has none");
        let bytes = fs::read(page).expect("it is written");
        let wanted = JobFile::load(&job).expect("the example is sound").job;
        let tapped = TappedLine { code: Some(TapeCode::Ascii), decimals: Decimals::LeastIncrement };
        assert_eq!(read(&bytes, &mut Staging::new()), Ok((&wanted, tapped)));
        assert!(bytes.len() <= PAGE_MAX / 4, "{}", bytes.len());
    }
}

#[test]
fn a_job_that_leaves_a_board_nothing_to_do_writes_nothing() {
    let scratch = Scratch::new("flash-no-page");
    let text = fs::read_to_string(root().join("examples/ibr-slot/job.toml")).expect("the example");
    let job = scratch.write("job.toml", text.replace("mode = \"safe-base\"", "mode = \"rewrite-only\""));
    let page = scratch.path("page");
    let output = run(&["parameters", &job, "--output", &page]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("rewrite-only") && said.contains("safe-base"), "{said}");
    assert!(fs::metadata(page).is_err(), "nothing is written");
}
