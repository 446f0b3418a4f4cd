//! The planner of cup-mill paths: its rotors, its method, the proof that nothing is touched, and what it writes; held to what the planner did not
//! make.

mod published_rotor;

mod generator;

mod surface;

mod files;

mod formats;

mod slots;

mod meshes;

mod flaws;

mod refusals;

mod rotor37;

mod proof_cases;

mod proof_exact;

mod proof_dense;

mod proof_volumes;

mod proof_published;

mod proof_dexels;

mod passes;

mod parts;

mod listing;

mod limits;

mod rise;

mod job;

mod approach;

mod twisted;

mod dense;

mod closed_form;

mod method;

mod method_levels;

mod free_width;

mod symmetry;

mod splitters;

mod widths;

mod sampler;

mod fallback;

mod threads;

mod chain;

mod wheel;

mod plunge;

mod finish;

mod repair;
