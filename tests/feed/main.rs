//! The feed: what the laws demand, what is written or put out, and that it never exceeds what the chip may be.

mod geometry;

mod compensated;

mod corners;

mod engage;

mod engaged_arc_oracle;

mod engaged_end_mill;

mod feed_bounds;

mod job_values;

mod law_command;

mod law_oracle;

mod law_suite;

mod machine_limits;

mod macros;

mod main_job;

mod plunge_law;

mod pocket;

mod progress_noise;

mod published_factors;

mod published_table;

mod rewrite_only;

mod shop_program;

mod supervisor;

mod tables;
