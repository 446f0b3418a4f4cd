//! Cutting edges in pieces so short that each acts as a straight tool of its own.
//!
//! The tool frame does not rotate: its origin is the tool's tip, z points along the axis to the holder, and M3 turns
//! the tool clockwise as seen from there. For a piece at radius r and angle a (counter-clockwise from x), with u = (cos
//! a, sin a, 0), lead angle k, and s = +1 on an outer edge and -1 on an inner one:
//!
//! ```text
//! width of its cut               b = dz / sin k                     (1)
//! its angle                      a = a0 - turned                    (2)
//! direction in which it moves    t = (sin a, -cos a, 0)             (3)
//! outward normal                 n = s u sin k - z cos k            (4)
//! along the edge, upwards        m = s u cos k + z sin k            (5)
//! helix: lag at height z         a0(z) - a0(0) = z tan(helix) / R   (6)
//! ```
//!
//! so u sin k - z cos k points sideways on a cylinder's side (k = 90 degrees) and down at the bottom of a ball (k = 0).
//! The width (1) is in the plane of axis and radius. It is not divided by cos(helix), because cutting coefficients are
//! identified for the chip seen in that plane; h b is then the section that the stock loses.
//!
//! Source: elementary tools after Lorong et al., Simulation of a finishing operation, 2012, sections 1 and 2.3; (2) to (5)
//! are geometry; (1) and (6), a constant lead also on a ball, are the usual ones of mechanistic models (Engin, Altintas,
//! Int. J. Machine Tools & Manufacture 41, 2001, recalled); docs/forces.md.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

use arcfeed_model::tool::Edge;
use nalgebra::{Vector2, Vector3};

use self::meridian::{Meridian, Pieces};

pub mod meridian;

/// Tolerance of the sum of all pitches against a full turn.
const TURN_TOLERANCE_RAD: f64 = 1e-9;

/// Short piece of a cutting edge, which acts as a straight tool of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePiece {
    /// Index of the tooth, in the order in which M3 (clockwise rotation) brings the teeth to a place.
    pub tooth: usize,
    /// Height of the piece's middle above the tip.
    pub height_mm: f64,
    /// Extent of the piece along the tool's axis.
    pub rise_mm: f64,
    /// Distance from the spindle's axis.
    pub radius_mm: f64,
    /// Angle about the spindle's axis before it turns, counter-clockwise as seen from the holder.
    pub angle_rad: f64,
    /// Lead angle: between the outward normal and the direction from the holder to the tip; 90 degrees on a cylinder's side.
    pub lead_rad: f64,
    /// Whether the edge is on the outer or on the inner cutting circle.
    pub side: Edge,
}

/// Cutting directions of an edge piece at one time: unit vectors in the tool frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directions {
    /// Direction of motion (3).
    pub motion: Vector3<f64>,
    /// Outward normal (4).
    pub normal: Vector3<f64>,
    /// Direction along the edge, upwards (5).
    pub along: Vector3<f64>,
}

/// Dimensions of an end mill: square, with rounded corners, or with a ball end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndMill {
    /// Diameter of the cylinder.
    pub diameter_mm: f64,
    /// Radius of the corner: 0 for a square end, half of the diameter for a ball end.
    pub corner_mm: f64,
    /// Number of teeth.
    pub teeth: usize,
    /// Helix angle, positive for a right-hand helix.
    pub helix_rad: f64,
    /// Height above the tip up to which the teeth have edges.
    pub height_mm: f64,
}

/// Dimensions of the ring of a cup mill; its inserts alternate between the outer and the inner circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Radius of the outer edges.
    pub outer_radius_mm: f64,
    /// Radius of the inner edges.
    pub inner_radius_mm: f64,
    /// Radius of the inserts' corners, 0 for square ones.
    pub corner_mm: f64,
    /// Number of inserts on each of the two circles. The ring has twice as many teeth: even ones outside, odd ones inside.
    pub active_teeth: usize,
    /// Height above the tip up to which the inserts have edges.
    pub height_mm: f64,
}

/// Cutting edges of a tool, divided into short pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Cutter {
    pieces: Vec<EdgePiece>,
    /// Angles of the teeth about the tool's own axis.
    teeth_rad: Vec<f64>,
    /// Offset of the tool's axis from the spindle's, before it turns.
    eccentricity_mm: Vector2<f64>,
}

/// Reason why a cutter cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeError {
    /// A dimension is not a number, is negative, or does not fit another one.
    Dimensions,
    /// There are no teeth, or no pieces along an edge.
    Nothing,
    /// A list has not as many values as there are teeth.
    Count {
        /// Number of teeth.
        teeth: usize,
        /// Number of values.
        given: usize,
    },
    /// The angles between the teeth are not positive, or do not add up to a full turn.
    Pitch,
    /// A changed radius would move a piece to the axis or beyond it.
    Radius {
        /// Tooth of the piece.
        tooth: usize,
    },
}

impl EdgePiece {
    /// Width of cut when the whole piece is engaged, mm. (1)
    pub fn width_mm(&self) -> f64 {
        self.rise_mm / libm::sin(self.lead_rad)
    }

    /// Whether the outward normal points straight down: an edge on the tool's end, whose width of cut is that of its engaged part.
    pub fn is_end(&self) -> bool {
        self.lead_rad == 0.0
    }

    /// Angle of the piece when M3 has turned the spindle by `turned_rad`. (2)
    pub fn angle_at_rad(&self, turned_rad: f64) -> f64 {
        self.angle_rad - turned_rad
    }

    /// Position of the piece's middle, mm in the tool frame, when M3 has turned the spindle by `turned_rad`.
    pub fn place_mm(&self, turned_rad: f64) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.angle_at_rad(turned_rad));
        Vector3::new(self.radius_mm * cos, self.radius_mm * sin, self.height_mm)
    }

    /// Cutting directions of the piece when M3 has turned the spindle by `turned_rad`.
    pub fn directions(&self, turned_rad: f64) -> Directions {
        let (sin, cos) = libm::sincos(self.angle_at_rad(turned_rad));
        let (sin_lead, cos_lead) = libm::sincos(self.lead_rad);
        let side = f64::from(self.side.advance());
        Directions {
            motion: Vector3::new(sin, -cos, 0.0),                                          // (3)
            normal: Vector3::new(side * cos * sin_lead, side * sin * sin_lead, -cos_lead), // (4)
            along: Vector3::new(side * cos * cos_lead, side * sin * cos_lead, sin_lead),   // (5)
        }
    }
}

impl Cutter {
    /// Edges of an end mill; each tooth is divided into pieces as `pieces` says.
    ///
    /// # Errors
    /// The dimensions are not those of an end mill, or there are no teeth or pieces.
    pub fn end_mill(mill: &EndMill, pieces: Pieces) -> Result<Self, EdgeError> {
        let radius_mm = mill.diameter_mm / 2.0;
        let fits = mill.corner_mm <= radius_mm && libm::fabs(mill.helix_rad) < FRAC_PI_2;
        let meridian = Meridian {
            side: Edge::Outer,
            radius_mm,
            corner_mm: mill.corner_mm,
            height_mm: mill.height_mm,
            lag_rad_per_mm: libm::tan(mill.helix_rad) / radius_mm, // (6)
        };
        let of_tooth = meridian.pieces(pieces).filter(|_| fits).ok_or(EdgeError::Dimensions)?;
        Cutter::new(mill.teeth, |_| &of_tooth)
    }

    /// Edges of the ring of a cup mill; each insert is divided into pieces as `pieces` says.
    ///
    /// # Errors
    /// The corners are wider than the ring, the dimensions are not those of a ring, or there are no inserts or pieces.
    pub fn ring(ring: &Ring, pieces: Pieces) -> Result<Self, EdgeError> {
        let fits = ring.inner_radius_mm + 2.0 * ring.corner_mm <= ring.outer_radius_mm;
        let of_side = |side, radius_mm| {
            let (corner_mm, height_mm) = (ring.corner_mm, ring.height_mm);
            let meridian = Meridian { side, radius_mm, corner_mm, height_mm, lag_rad_per_mm: 0.0 };
            meridian.pieces(pieces).filter(|_| fits).ok_or(EdgeError::Dimensions)
        };
        let outer = of_side(Edge::Outer, ring.outer_radius_mm)?;
        let inner = of_side(Edge::Inner, ring.inner_radius_mm)?;
        Cutter::new(2 * ring.active_teeth, |tooth| if tooth % 2 == 0 { &outer } else { &inner })
    }

    /// A cutter with teeth at equal angles, tooth 0 along x, each with its pieces.
    fn new<'a>(teeth: usize, of_tooth: impl Fn(usize) -> &'a Vec<EdgePiece>) -> Result<Self, EdgeError> {
        let teeth_rad: Vec<f64> = (0..teeth).map(|tooth| TAU * tooth as f64 / teeth as f64).collect();
        let mut pieces = Vec::new();
        for (tooth, tooth_rad) in teeth_rad.iter().enumerate() {
            let placed = |piece: &EdgePiece| EdgePiece { tooth, angle_rad: piece.angle_rad + tooth_rad, ..*piece };
            pieces.extend(of_tooth(tooth).iter().map(placed));
        }
        if pieces.is_empty() {
            return Err(EdgeError::Nothing);
        }
        Ok(Cutter { pieces, teeth_rad, eccentricity_mm: Vector2::zeros() })
    }

    /// Pieces of all edges, tooth by tooth, each tooth from the tip upwards.
    pub fn pieces(&self) -> &[EdgePiece] {
        &self.pieces
    }

    /// Number of teeth.
    pub fn teeth(&self) -> usize {
        self.teeth_rad.len()
    }

    /// Distance from the spindle's axis to the farthest edge piece, mm.
    pub fn reach_mm(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.radius_mm).fold(0.0, f64::max)
    }

    /// Largest depth of rake faces, mm, that reach neither the tool's axis nor, on a ring, the edges on its other side: half of that
    /// distance.
    pub fn rake_max_mm(&self) -> f64 {
        let [outer_mm, inner_mm] = [Edge::Outer, Edge::Inner].map(|side| {
            let of_side = self.pieces.iter().filter(move |piece| piece.side == side).map(|piece| piece.radius_mm);
            of_side.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], mm| [least.min(mm), most.max(mm)])
        });
        (outer_mm[0] - inner_mm[1]) / 2.0
    }

    /// Sets the angles between the teeth: entry n is the angle from tooth n to the next one, the last entry that back to tooth 0.
    ///
    /// # Errors
    /// The number of angles differs from the number of teeth, or they are not positive or do not add up to a full turn.
    pub fn with_pitch(mut self, pitches_rad: &[f64]) -> Result<Self, EdgeError> {
        self.one_each(pitches_rad)?;
        let whole = libm::fabs(pitches_rad.iter().sum::<f64>() - TAU) <= TURN_TOLERANCE_RAD;
        if !(whole && pitches_rad.iter().all(|pitch_rad| *pitch_rad > 0.0)) {
            return Err(EdgeError::Pitch);
        }
        let mut angle_rad = 0.0;
        let moved: Vec<f64> = (0..self.teeth())
            .map(|tooth| {
                let by_rad = angle_rad - self.teeth_rad[tooth];
                angle_rad += pitches_rad[tooth];
                by_rad
            })
            .collect();
        self.teeth_rad.iter_mut().zip(&moved).for_each(|(tooth_rad, by_rad)| *tooth_rad += by_rad);
        self.change(|piece| piece.angle_rad += moved[piece.tooth])
    }

    /// Adds to the radii of all pieces of each tooth the entry of that tooth.
    ///
    /// # Errors
    /// The number of entries differs from the number of teeth, or an entry moves an edge to the axis or beyond it.
    pub fn with_offsets(self, offsets_mm: &[f64]) -> Result<Self, EdgeError> {
        self.one_each(offsets_mm)?;
        self.change(|piece| piece.radius_mm += offsets_mm[piece.tooth])
    }

    /// Sets the runout: distance of the tool's axis from the spindle's, and its direction before the spindle turns.
    ///
    /// # Errors
    /// The runout moves an edge to the spindle's axis.
    pub fn with_runout(mut self, eccentricity_mm: f64, direction_rad: f64) -> Result<Self, EdgeError> {
        let (sin, cos) = libm::sincos(direction_rad);
        let before_mm = self.eccentricity_mm;
        self.eccentricity_mm = Vector2::new(cos, sin) * eccentricity_mm;
        self.shift(self.eccentricity_mm - before_mm);
        self.checked()
    }

    fn one_each(&self, values: &[f64]) -> Result<(), EdgeError> {
        let (teeth, given) = (self.teeth(), values.len());
        if teeth == given { Ok(()) } else { Err(EdgeError::Count { teeth, given }) }
    }

    /// Changes every piece, in coordinates of the tool's own axis.
    fn change(mut self, change: impl Fn(&mut EdgePiece)) -> Result<Self, EdgeError> {
        self.shift(-self.eccentricity_mm);
        self.pieces.iter_mut().for_each(change);
        self.shift(self.eccentricity_mm);
        self.checked()
    }

    /// Moves all pieces; their normals still point along the radius, with an error of the eccentricity over the radius.
    fn shift(&mut self, by_mm: Vector2<f64>) {
        if by_mm == Vector2::zeros() {
            return;
        }
        for piece in &mut self.pieces {
            let (sin, cos) = libm::sincos(piece.angle_rad);
            let radial_mm = piece.radius_mm + by_mm.x * cos + by_mm.y * sin;
            let across_mm = by_mm.y * cos - by_mm.x * sin;
            piece.radius_mm = libm::copysign(libm::hypot(radial_mm, across_mm), radial_mm);
            piece.angle_rad += libm::atan(across_mm / radial_mm);
        }
    }

    fn checked(self) -> Result<Self, EdgeError> {
        match self.pieces.iter().find(|piece| !(piece.radius_mm > 0.0 && piece.angle_rad.is_finite())) {
            Some(piece) => Err(EdgeError::Radius { tooth: piece.tooth }),
            None => Ok(self),
        }
    }
}

impl fmt::Display for EdgeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EdgeError::Dimensions => write!(f, "the dimensions are not those of a cutter"),
            EdgeError::Nothing => write!(f, "a cutter needs teeth, and each tooth pieces"),
            EdgeError::Count { teeth, given } => write!(f, "{teeth} teeth need one value each, not {given}"),
            EdgeError::Pitch => write!(f, "pitches are positive angles that make up a full turn"),
            EdgeError::Radius { tooth } => write!(f, "tooth {tooth} would lie on the spindle's axis"),
        }
    }
}

impl std::error::Error for EdgeError {}
