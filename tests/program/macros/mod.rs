//! Custom macros against truth that does not come from the interpreter: closed forms of the paths, published examples of
//! punched lines, the tables of the operator's manual, and programs made at random that must come to an end.

mod run;

mod paths;

mod arithmetic;

mod calls;

mod alarms;

mod garbage;

mod loops;

mod control;

mod wired;
