//! arcfeed inside the page (`cargo xtask web`), in a real browser: the same bytes as the program.

use std::process::Command;

use arcfeed_tests::{Scratch, arcfeed, root};

use super::{has_browser, has_node, node};

/// The data of a report's viewer.
fn data(page: &str) -> &str {
    let (_, data) = page.split_once("id=\"arcfeed-data\">").expect("its data");
    data.split_once("</script>").expect("their end").0
}

#[test]
fn the_page_adapts_and_simulates_the_example_to_the_bytes_of_the_program() {
    let test = "page-in-page";
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    let site = scratch.path("site");
    let xtask = ["run", "--quiet", "--locked", "--package", "xtask", "--", "web", &site, "release"];
    let built = Command::new(env!("CARGO")).args(xtask).current_dir(root()).output().expect("cargo runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    for file in ["ibr-slot.nc", "job.toml"] {
        let from = root().join("examples/ibr-slot").join(file);
        // The page names the job as its program.
        let to = scratch.path(&file.replace("job", "ibr-slot"));
        std::fs::copy(from, to).expect("a copy");
    }
    let [page, program, job] = ["site/index.html", "ibr-slot.nc", "ibr-slot.toml"].map(|name| scratch.path(name));
    println!("{}", node(&["test/inpage.mjs", &page, &program, &job, &scratch.path("")]));
    let mut native = Command::new(arcfeed());
    native.args(["adapt", "ibr-slot.toml", "--output", "native.nc", "--report", "native.html"]);
    let native = native.current_dir(scratch.path("")).output().expect("arcfeed runs");
    assert!(native.status.success(), "{}", String::from_utf8_lossy(&native.stderr));
    let read = |name: &str| std::fs::read_to_string(scratch.path(name)).expect(name);
    let adapted = read("adapted.nc");
    assert!(adapted == read("native.nc") && adapted.contains('F'), "another program than the native one");
    assert!(read("data.txt") == data(&read("native.html")), "other runs than the native ones");
}
