//! The lines: serial and network ports, the DNC sender, the board link, the tap; files and memory of the commands.

mod alone;

mod campaigns;

mod slurm;

mod control_timing;

mod dnc;

mod example_campaigns;

mod first_thread;

mod instructions;

mod json_docs;

mod live_page;

mod output_files;

mod plain_build;

mod program_memory;

mod pyserial;

mod report_page;

mod screen;

mod serving;

mod serving_clients;

mod application;

mod assertions;

mod streaming;

mod traces;

mod view_page;

mod tap;

mod wire;

mod with_board;
