//! All edges of a cutter in the layers of a workpiece: what each has in front of it, and what it takes.
//!
//! What the tool's end takes when it comes into a layer, in a plunge, is no edge's: it goes without chips ([`Bite::sink`]).
//!
//! The cutter's axis stands square to the layers. A piece of an edge meets one layer, and what is in front of it there is what
//! itself, the other teeth, earlier passes and vibration have left: nothing is told by a formula.

use std::fmt;

use arcfeed_shared::tool::Edge;
use nalgebra::Vector2;

use super::edges::{Cutter, EdgePiece};
use super::layers::{Layers, Slice};
use super::material::ChipSection;
use super::rake::{Rake, Wake};

/// Slices and layers may differ by this, which is rounding.
const RISE_TOLERANCE_RATIO: f64 = 1e-9;

/// A cutter at work.
#[derive(Clone, Debug)]
pub struct Bite {
    cutter: Cutter,
    layers: Layers,
    depth_mm: f64,
    /// One a piece, and the layer it was in.
    wakes: Vec<(Option<usize>, Wake)>,
    /// The solid that the edges turn.
    slices: Vec<Slice>,
}

/// Where the cutter is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// The spindle's axis in the plane of the layers.
    pub axis_mm: Vector2<f64>,
    /// Height of the tip.
    pub tip_mm: f64,
    /// How far M3 has turned the spindle.
    pub turned_rad: f64,
}

/// Why a cutter cannot work in these layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BiteError {
    /// A piece of an edge is not as high as a layer: two in one layer would cut it twice, or layers would be left out.
    Slice {
        /// Of the piece.
        rise_mm: f64,
        /// Of a layer.
        layer_mm: f64,
    },
    /// The rake faces have no depth.
    Depth {
        /// As told.
        depth_mm: f64,
    },
}

impl fmt::Display for BiteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BiteError::Slice { rise_mm, layer_mm } => {
                write!(f, "layers of {layer_mm} mm need edges in slices of the same height, not of {rise_mm} mm")
            }
            BiteError::Depth { depth_mm } => write!(f, "rake faces {depth_mm} mm deep take no chip"),
        }
    }
}

impl std::error::Error for BiteError {}

impl Bite {
    /// A cutter in a workpiece; its rake faces reach `depth_mm` behind their edges, further than any chip is thick.
    ///
    /// # Errors
    /// Edges not in slices as high as the layers, or rake faces without depth.
    pub fn new(cutter: Cutter, layers: Layers, depth_mm: f64) -> Result<Self, BiteError> {
        if !(depth_mm > 0.0 && depth_mm.is_finite()) {
            return Err(BiteError::Depth { depth_mm });
        }
        let layer_mm = layers.rise_mm();
        let is_slice = |rise_mm: f64| libm::fabs(rise_mm - layer_mm) <= RISE_TOLERANCE_RATIO * layer_mm;
        if let Some(piece) = cutter.pieces().iter().find(|piece| !is_slice(piece.rise_mm)) {
            return Err(BiteError::Slice { rise_mm: piece.rise_mm, layer_mm });
        }
        let wakes = vec![Default::default(); cutter.pieces().len()];
        let slices = slices(&cutter);
        Ok(Bite { cutter, layers, depth_mm, wakes, slices })
    }

    /// The cutter.
    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// What is left of the workpiece.
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// Every piece that is in a layer, with the chip in front of it. A piece may be bent away from where it stands, by what `bent` tells.
    pub fn chips<'a>(
        &'a self,
        stand: &'a Stand,
        bent: impl Fn(&EdgePiece) -> Vector2<f64> + 'a,
    ) -> impl Iterator<Item = (&'a EdgePiece, ChipSection)> + 'a {
        self.cutter.pieces().iter().zip(&self.wakes).filter_map(move |(piece, (was_in, wake))| {
            let index = self.layers.index(stand.tip_mm + piece.height_mm)?;
            let fresh = Wake::default();
            let wake = if *was_in == Some(index) { wake } else { &fresh };
            let across_mm = wake.chip_mm(&self.rake(piece, stand, bent(piece)), self.layers.layers().get(index)?);
            // A chip measured across the circle, seen square to the edge.
            let thickness_mm = across_mm * libm::sin(piece.lead_rad);
            Some((piece, ChipSection { thickness_mm, width_mm: piece.width_mm() }))
        })
    }

    /// The cutter goes to its next place, less than a quarter of a turn on; answers what was taken on the way as the rays along
    /// each axis have it, mm3.
    pub fn cut(&mut self, stand: &Stand, bent: impl Fn(&EdgePiece) -> Vector2<f64>) -> [f64; 2] {
        let mut removed_mm3 = [0.0; 2];
        for at in 0..self.wakes.len() {
            let piece = self.cutter.pieces()[at];
            let index = self.layers.index(stand.tip_mm + piece.height_mm);
            let rake = self.rake(&piece, stand, bent(&piece));
            let (was_in, wake) = &mut self.wakes[at];
            if *was_in != index {
                (*was_in, *wake) = (index, Wake::default());
            }
            let rise_mm = self.layers.rise_mm();
            if let Some(layer) = index.and_then(|index| self.layers.layers_mut().get_mut(index)) {
                let area_mm2 = wake.cut(&rake, layer);
                removed_mm3 = [0, 1].map(|axis: usize| removed_mm3[axis] + area_mm2[axis] * rise_mm);
            }
        }
        removed_mm3
    }

    /// Whether any edge is in a layer there.
    pub fn is_in(&self, tip_mm: f64) -> bool {
        self.slices.iter().any(|slice| self.layers.index(tip_mm + slice.height_mm).is_some())
    }

    /// Whether an edge would be in another layer there than where it cut last.
    pub fn changes_layer(&self, tip_mm: f64) -> bool {
        let each = self.cutter.pieces().iter().zip(&self.wakes).take(self.slices.len());
        each.into_iter().any(|(piece, (was_in, _))| *was_in != self.layers.index(tip_mm + piece.height_mm))
    }

    /// Takes everything where the tool stands, without chips.
    pub fn sink(&mut self, stand: &Stand) {
        self.layers.clear(stand.axis_mm, stand.tip_mm, &self.slices);
    }

    /// The tool is out of the cut: what it cut next to is forgotten.
    pub fn lift(&mut self) {
        self.wakes.fill(Default::default());
    }

    fn rake(&self, piece: &EdgePiece, stand: &Stand, bent_mm: Vector2<f64>) -> Rake {
        let (sin, cos) = libm::sincos(piece.angle_at_rad(stand.turned_rad));
        Rake {
            center_mm: stand.axis_mm + bent_mm,
            towards: Vector2::new(cos, sin),
            radius_mm: piece.radius_mm,
            side: piece.side,
            turn_ratio: -1.0,
            depth_mm: self.depth_mm,
        }
    }
}

/// The solid that a cutter's edges turn, from the tip upwards.
///
/// Pieces of the first tooth stand one above the other, and so do those of all others, at the same heights.
pub fn slices(cutter: &Cutter) -> Vec<Slice> {
    let mut slices: Vec<Slice> = Vec::new();
    for piece in cutter.pieces() {
        let found = slices.iter().position(|slice| slice.height_mm == piece.height_mm);
        let index = found.unwrap_or_else(|| {
            slices.push(Slice { height_mm: piece.height_mm, inner_mm: 0.0, outer_mm: 0.0 });
            slices.len() - 1
        });
        let slice = &mut slices[index];
        match piece.side {
            Edge::Outer => slice.outer_mm = slice.outer_mm.max(piece.radius_mm),
            // The innermost of several.
            Edge::Inner if slice.inner_mm == 0.0 => slice.inner_mm = piece.radius_mm,
            Edge::Inner => slice.inner_mm = slice.inner_mm.min(piece.radius_mm),
        }
    }
    slices
}
