//! The runs of [`arcfeed_bench::trace`] on this machine, a line each: the law, then names and numbers in turn.

use arcfeed_bench::trace::{LAWS, run};

fn main() {
    for (name, choice) in LAWS {
        println!("{name} {}", run(choice));
    }
}
