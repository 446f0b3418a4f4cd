//! `[[cut]]` as serde reads it. [`super::rules`] checks the values.

use serde::Deserialize;
use toml::Spanned;

use super::quantity::Quantity;

/// `[[cut]]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CutTable {
    /// Cup mill: the arc has the tool's inner or outer radius.
    pub rotation: Option<RotationWord>,
    /// End mill: the rule applies to arcs or to lines only.
    pub moves: Option<MovesWord>,
    /// The rule applies to arcs in this direction only.
    pub direction: Option<DirectionWord>,
    /// Circle of a cup mill that cuts, or side of the contour on which an end mill runs.
    pub side: Spanned<SideWord>,
    /// Limits of the stock, or engaged arcs.
    pub stock: Option<Spanned<StockTable>>,
    /// Radial depth of cut, for the engagement law of end mills.
    pub radial_depth: Option<Spanned<Quantity>>,
    /// Target feed per tooth, in place of that of the law.
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    /// Law `table`: pairs of path along the move and feed per tooth.
    pub table: Option<Spanned<Vec<Spanned<[Quantity; 2]>>>>,
    /// First and last N number of the blocks to which the rule applies.
    pub n: Option<Spanned<[i64; 2]>>,
    /// Lowest and highest Z at which the moves of the rule start.
    pub z: Option<Spanned<[Quantity; 2]>>,
    /// Lines of the program's file to which the rule applies: `"10-40"`, `"12"`.
    pub lines: Option<Spanned<String>>,
    /// Plane of the arcs to which the rule applies.
    pub plane: Option<Spanned<PlaneWord>>,
}

/// Values of `rotation` in `[[cut]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RotationWord {
    Interior,
    Exterior,
}

/// Values of `moves` in `[[cut]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MovesWord {
    Arcs,
    Lines,
}

/// Values of `direction` in `[[cut]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DirectionWord {
    Cw,
    Ccw,
}

/// Values of `plane` in `[[cut]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
pub enum PlaneWord {
    G17,
    G18,
    G19,
}

/// Values of `side` in `[[cut]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SideWord {
    Outer,
    Inner,
    Inside,
    Outside,
    Slot,
}

/// `stock` of `[[cut]]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StockTable {
    pub normal_deg: Option<f64>,
    pub offset: Option<Quantity>,
    pub from: Option<[Quantity; 2]>,
    pub to: Option<[Quantity; 2]>,
    pub rise: Option<f64>,
    pub lines: Option<Vec<(f64, Quantity, f64)>>,
    pub polygon: Option<Vec<[Quantity; 2]>>,
    pub disc: Option<[Quantity; 3]>,
    pub engaged: Option<Spanned<Vec<Spanned<Vec<Quantity>>>>>,
    pub map: Option<Spanned<String>>,
}
