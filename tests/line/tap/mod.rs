//! The tap on the DNC line: any sender, the simulated control, and between them a board that only listens.

mod bench;

mod damage;

mod flash;

mod machining;

mod pass_through;

mod shop;
