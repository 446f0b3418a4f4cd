//! NC programs: read, checked, run by the interpreter, and given back; the commands of the tutorials.

mod alarms;

mod arcs;

mod cli_check;

mod command_help;

mod compensation;

mod bolt_circles;
mod coordinates;
mod cycles;

mod everyday;

mod fuzz;

mod helices;

mod init;

mod linuxcnc;

mod macros;

mod moves_rs274;

mod nc_text;

mod noticed;

mod planes;

mod styles;

mod tutorials;

mod without_job;
