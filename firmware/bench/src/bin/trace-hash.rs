//! The hashes of [`arcfeed_bench::trace`] on this machine, a line each: `LAW hash H governed G refused R`.

use arcfeed_bench::trace::{LAWS, Trace, run};

fn main() {
    for (name, law) in LAWS {
        let Trace { hash, governed, refused } = run(law);
        println!("{name} hash {hash:016x} governed {governed} refused {refused}");
    }
}
