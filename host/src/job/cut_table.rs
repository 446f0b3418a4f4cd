//! `[[cut]]` as serde reads it. [`super::rules`] checks the values.

use serde::Deserialize;
use toml::Spanned;

use super::quantity::Quantity;

/// `[[cut]]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CutTable {
    pub rotation: Option<RotationWord>,
    pub moves: Option<MovesWord>,
    pub direction: Option<DirectionWord>,
    pub side: Spanned<SideWord>,
    pub stock: Option<Spanned<StockTable>>,
    pub radial_depth: Option<Spanned<Quantity>>,
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    pub table: Option<Spanned<Vec<Spanned<[Quantity; 2]>>>>,
    pub n: Option<Spanned<[i64; 2]>>,
    pub z: Option<Spanned<[Quantity; 2]>>,
    pub lines: Option<Spanned<String>>,
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
