//! Planning of repairs, held to closed forms and to an independent program's figures (data/README.md).

mod surfaces;

mod blend;

mod nearest;

mod spacing;

mod registration;

mod evenness;

mod regions;

mod dexels;

mod scan;

mod plan;

mod blade;

mod command;

mod chain;

mod edge;

mod edge_chain;

mod clouds;

mod large_clouds;

mod peers;
