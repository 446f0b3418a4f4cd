//! Viewer of a run within the page: the path in three dimensions, curves and NC text around one moment (docs/report.md).
//!
//! The program in the page is the bundle `host/web/viewer.js.zlib`, built from the TypeScript beside it. The data are one
//! compressed block:
//!
//! ```text
//! base64( zlib( length of the header as u32, little-endian | header, JSON | columns of the runs | columns of the heights | columns of the solids | text ) )
//! ```

pub mod column;

use miniz_oxide::deflate::compress_to_vec_zlib;
use miniz_oxide::inflate::decompress_to_vec_zlib;
use serde::Serialize;

use self::column::{Column, ColumnHead};
use super::png::base64;

/// Version of the data's layout; it changes when an older viewer cannot read the data.
pub const SCHEMA: u32 = 3;

/// Compression of the data, of 10; higher levels take much longer for 1 % less.
const LEVEL: u8 = 6;

/// The bundle, compressed from 0.7 MB to 0.2 MB.
const SCRIPT: &[u8] = include_bytes!("../../../../web/viewer.js.zlib");
const STYLE: &str = include_str!("../../../../web/viewer.css");
const BODY: &str = include_str!("../../../../web/viewer.html");
const START_SCRIPT: &str = include_str!("../../../../web/start.js");
const START_BODY: &str = include_str!("../../../../web/start.html");
const LIVE_BODY: &str = include_str!("../../../../web/live.html");

/// Nothing is loaded from elsewhere, and nothing is sent.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";
/// Addition for a served page: it gets its data from its own server. Browsers ask for no icon.
const SERVED: [&str; 2] = ["; connect-src 'self'", "<link rel=\"icon\" href=\"data:,\">\n"];

/// Data of the viewer; lengths in the job's unit.
#[derive(Clone, Debug)]
pub struct ViewerData {
    /// Title of the report.
    pub title: String,
    /// Unit of lengths.
    pub unit: &'static str,
    /// Runs: before, then after.
    pub runs: Vec<RunPath>,
    /// Closed outlines of the tools: radius and height above the tip.
    pub tools: Vec<Vec<[f64; 2]>>,
    /// Heights of the stock over the last run, if there is a workpiece.
    pub heights: Option<HeightGrid>,
    /// Solids that stay as they are.
    pub solids: Vec<Solid>,
    /// Findings in order of importance.
    pub findings: Vec<RunFinding>,
    /// Lines of the program, each with its text as sent if that differs.
    pub lines: Vec<[Vec<u8>; 2]>,
    /// Names of the values of the column `purpose`; empty without that column.
    pub purposes: &'static [&'static str],
    /// The page is served, and shows a run that goes on.
    pub is_live: bool,
}

/// Path of a run with the values along it, as columns of equal length.
#[derive(Clone, Debug)]
pub struct RunPath {
    /// `before` or `after`.
    pub name: &'static str,
    /// Columns.
    pub columns: Vec<Column>,
}

/// Heights over the columns and rows of a grid, before a run and at some times of it.
#[derive(Clone, Debug)]
pub struct HeightGrid {
    /// Cells along X.
    pub columns: usize,
    /// Lowest corner.
    pub lowest: [f64; 2],
    /// Edge of a cell.
    pub step: f64,
    /// Heights before the run, row by row from the lowest Y; no value where nothing is left.
    pub heights: Column,
    /// Times of the frames, and the number of changes up to and including each.
    pub frames: [Column; 2],
    /// Cells that change, frame by frame, and their new heights.
    pub changes: [Column; 2],
}

/// Solid body, given by triangles.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Name.
    pub name: &'static str,
    /// X, Y, Z of the vertices.
    pub vertices: [Column; 3],
    /// Three vertices of each triangle, by their indices.
    pub corners: Column,
    /// Values at the vertices, by which the solid can be coloured.
    pub values: Vec<SurfaceValue>,
}

/// Quantity at the vertices of a solid.
#[derive(Clone, Debug)]
pub struct SurfaceValue {
    /// Name for people.
    pub label: &'static str,
    /// Value at each vertex.
    pub column: Column,
}

/// Alarm, warning or note about a block of a run, for the viewer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunFinding {
    /// `alarm`, `warning` or `note`.
    pub severity: &'static str,
    /// `before` or `after`.
    pub run: &'static str,
    /// Number of blocks executed then, including the block.
    pub block: u32,
    /// Machine time, s; `None`: at the beginning of the block.
    #[serde(rename = "at", skip_serializing_if = "Option::is_none")]
    pub at_s: Option<f64>,
    /// Position X, Y, Z that is marked; `None` without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<[f64; 3]>,
    /// Text.
    pub text: String,
}

#[derive(Serialize)]
struct Header<'a> {
    schema: u32,
    title: &'a str,
    unit: &'static str,
    runs: Vec<RunHeader<'a>>,
    tools: &'a [Vec<[f64; 2]>],
    heights: Option<HeightsHeader>,
    solids: Vec<SolidHeader>,
    findings: &'a [RunFinding],
    purposes: &'static [&'static str],
    text_bytes: usize,
}

#[derive(Serialize)]
struct RunHeader<'a> {
    name: &'a str,
    points: usize,
    columns: Vec<ColumnHead>,
}

#[derive(Serialize)]
struct HeightsHeader {
    columns: usize,
    lowest: [f64; 2],
    step: f64,
    cells: usize,
    column: ColumnHead,
    frames: FramesHeader,
}

#[derive(Serialize)]
struct FramesHeader {
    count: usize,
    changes: usize,
    columns: Vec<ColumnHead>,
}

#[derive(Serialize)]
struct SolidHeader {
    name: &'static str,
    vertices: usize,
    corners: usize,
    columns: Vec<ColumnHead>,
    values: Vec<ValueHeader>,
}

#[derive(Serialize)]
struct ValueHeader {
    label: &'static str,
    column: ColumnHead,
}

/// Page that takes a program and shows its report, for a server. `cargo xtask web` writes the same one with arcfeed inside it.
pub fn start_page() -> String {
    let [connects, icon] = SERVED;
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>arcfeed</title>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}{connects}; frame-src 'self'\">\n{icon}<style>\n{STYLE}</style>\n</head>\n\
         <body class=\"start\">\n{START_BODY}<script>\n{START_SCRIPT}</script>\n</body>\n</html>\n"
    )
}

/// Text of the bundle.
fn script() -> String {
    let bundle = decompress_to_vec_zlib(SCRIPT).ok().and_then(|bundle| String::from_utf8(bundle).ok());
    bundle.expect("the bundle is compressed text (`the_bundle_is_that_of_its_sources`)")
}

impl ViewerData {
    /// The viewer as HTML: one part for the head of the page, one for its body.
    pub fn html(&self) -> [String; 2] {
        let ([connects, icon], live) = if self.is_live { (SERVED, LIVE_BODY) } else { Default::default() };
        let head = format!(
            "<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}{connects}\">\n{icon}<style>\n{STYLE}</style>\n"
        );
        let data = base64(&compress_to_vec_zlib(&self.bytes(), LEVEL));
        let script = script();
        let body = format!(
            "{live}{BODY}<script type=\"text/plain\" id=\"arcfeed-data\">{data}</script>\n<script>\n{script}</script>\n"
        );
        [head, body]
    }

    fn bytes(&self) -> Vec<u8> {
        let text = self.text();
        let header = Header {
            schema: SCHEMA,
            title: &self.title,
            unit: self.unit,
            runs: self.runs.iter().map(RunPath::header).collect(),
            tools: &self.tools,
            heights: self.heights.as_ref().map(HeightGrid::header),
            solids: self.solids.iter().map(Solid::header).collect(),
            findings: &self.findings,
            purposes: self.purposes,
            text_bytes: text.len(),
        };
        let header = serde_json::to_vec(&header).unwrap_or_default();
        let mut bytes = (header.len() as u32).to_le_bytes().to_vec();
        bytes.extend(header);
        self.runs.iter().flat_map(|run| &run.columns).for_each(|column| column.write(&mut bytes));
        self.heights.iter().flat_map(HeightGrid::columns).for_each(|column| column.write(&mut bytes));
        self.solids.iter().flat_map(Solid::columns).for_each(|column| column.write(&mut bytes));
        bytes.extend(text);
        bytes
    }

    /// Lines, each after a line feed; behind a unit separator the text as sent, its blocks between record separators.
    fn text(&self) -> Vec<u8> {
        let mut text = Vec::new();
        for [line, sent] in &self.lines {
            text.push(b'\n');
            text.extend(line.iter().filter(|byte| !byte.is_ascii_control()));
            if sent != line {
                text.push(b'\x1F');
                text.extend(
                    sent.iter()
                        .map(|byte| if *byte == b'\n' { b'\x1E' } else { *byte })
                        .filter(|byte| *byte == b'\x1E' || !byte.is_ascii_control()),
                );
            }
        }
        String::from_utf8_lossy(&text).into_owned().into_bytes()
    }
}

impl RunPath {
    fn header(&self) -> RunHeader<'_> {
        let columns = self.columns.iter().map(|column| column.head).collect();
        RunHeader { name: self.name, points: self.columns.first().map_or(0, Column::len), columns }
    }
}

impl HeightGrid {
    fn header(&self) -> HeightsHeader {
        let HeightGrid { columns, lowest, step, ref heights, ref frames, ref changes } = *self;
        let columns_of_frames = frames.iter().chain(changes).map(|column| column.head).collect();
        let frames = FramesHeader { count: frames[0].len(), changes: changes[0].len(), columns: columns_of_frames };
        HeightsHeader { columns, lowest, step, cells: heights.len(), column: heights.head, frames }
    }

    fn columns(&self) -> impl Iterator<Item = &Column> {
        std::iter::once(&self.heights).chain(&self.frames).chain(&self.changes)
    }
}

impl Solid {
    fn header(&self) -> SolidHeader {
        let columns = self.vertices.iter().chain([&self.corners]).map(|column| column.head).collect();
        let values = self.values.iter().map(|value| ValueHeader { label: value.label, column: value.column.head });
        let (vertices, corners) = (self.vertices[0].len(), self.corners.len());
        SolidHeader { name: self.name, vertices, corners, columns, values: values.collect() }
    }

    fn columns(&self) -> impl Iterator<Item = &Column> {
        let values = self.values.iter().map(|value| &value.column);
        self.vertices.iter().chain(std::iter::once(&self.corners)).chain(values)
    }
}
