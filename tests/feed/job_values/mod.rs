//! Numbers and keys that make no sense, put in place of every number and every key of job, machine and part files: each is
//! refused at its place, by its name.

mod files;

mod values;

mod rules;

mod scopes;

mod messages;
