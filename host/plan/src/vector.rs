//! Points and directions in space.

/// A place, mm.
pub type Point = nalgebra::Point3<f64>;

/// A direction or a distance.
pub type Vector = nalgebra::Vector3<f64>;

/// A place in a level, mm, slot frame.
pub type Flat = nalgebra::Point2<f64>;
