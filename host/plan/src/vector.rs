//! Points and vectors in space.

/// Point, mm.
pub type Point = nalgebra::Point3<f64>;

/// Direction or distance.
pub type Vector = nalgebra::Vector3<f64>;

/// Rotation from one frame into another.
pub type FrameRotation = nalgebra::Rotation3<f64>;

/// Point in a level, mm, slot frame.
pub type Flat = nalgebra::Point2<f64>;
