//! The plunge law: engaged sections and feeds against an independent program, and descending moves through the whole
//! command. The truth about chips, torque and power is the edges', which know neither map nor law.
#![cfg(unix)]

mod table;

mod sections;

mod limits;

mod plunge_job;

mod complaints;

mod rows;

mod slot;

mod planned_slot;

mod indexed;

mod held;

mod random;

mod raised_feeds;
