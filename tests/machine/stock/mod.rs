//! The stock against geometry: what the kernel takes from a ray against brute force, swept areas and volumes against
//! closed forms, and what must hold whatever is cut.

mod figures;

mod kernel;

mod level;

mod areas;

mod volumes;

mod laws;

mod five_axis;

mod solids;
