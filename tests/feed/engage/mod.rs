//! `arcfeed engage`: what the map says of cuts whose engagement is known in closed form, and what the laws, the machine and the
//! edges make of it. The truth about chips is the edges', who know neither map nor law.
#![cfg(unix)]

mod cut_job;

mod closed_forms;

mod feeds;

mod chips;

mod alike;

mod planned;

mod complaints;
