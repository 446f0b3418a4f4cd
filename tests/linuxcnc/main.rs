//! LinuxCNC, headless, runs our programs with and without the component `arcfeed` in its servo thread; the chip meter measures
//! the positions that it commands, every servo period.

mod machine;

mod run;

mod faults;

mod pocket;

mod slot;

mod streaming;
