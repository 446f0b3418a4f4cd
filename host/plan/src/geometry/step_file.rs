//! Faces of a STEP file (AP203, AP214, AP242), chosen by name or colour: B-spline faces as meshes, and the radii of a hub.
//!
//! Source: ISO 10303-42 and -46. Faces are read up to the borders of their surfaces:
//! their trimming curves are not, so a blade's surfaces may reach below the hub and above the tip, but not beyond the blade's edges.

use std::collections::BTreeSet;

use thiserror::Error;

use crate::vector::Point;
use arcfeed_units::{LengthUnit, MM_PER_M};

use super::blade::RotorAxis;
use super::blisk::Revolution;
use super::generatrix::joined;
use super::point_file::ReadError;
use super::solid_fault::SolidFault;
use super::step_spline::Spline;
use super::step_text::{Part, Records, Value, numbers, records, reference, references};
use super::surface_mesh::SurfaceMesh;

/// Reason why a STEP file cannot be read, or does not have the faces of a rotor.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StepFault {
    /// The text is no STEP file.
    #[error(transparent)]
    Text(#[from] ReadError),
    /// No face has this name or colour.
    #[error("no face is called `{name}`, and none has that colour; the file knows: {known}")]
    NoFace {
        /// Name or colour that the part file gives.
        name: String,
        /// Names and colours in the STEP file.
        known: String,
    },
    /// A face of a blade is not a B-spline surface.
    #[error(
        "face #{face} is a {found}; a blade's faces are read as B-splines: export the surfaces as NURBS, or the blade as STL"
    )]
    NotSpline {
        /// Number of the face's record in the STEP file.
        face: u64,
        /// Type of its surface.
        found: String,
    },
    /// A face of a hub is of a type from which no generatrix is read.
    #[error(
        "face #{face} of the hub is a {found}; cylinders, cones and B-splines are read: give the hub as a curve file, `hub = \"hub.curve\"`"
    )]
    HubFace {
        /// Number of the face's record in the STEP file.
        face: u64,
        /// Type of its surface.
        found: String,
    },
    /// The record of this number is not complete.
    #[error("record #{0} is not complete; export the file anew")]
    Record(u64),
    /// The file is an assembly that moves its parts.
    #[error("the file is an assembly that moves its parts; export the part alone")]
    Moved,
    /// The file has several units, or none that is known.
    #[error("the file's length unit is not clear; export it in millimetres or inches")]
    Unit,
    /// The faces of the hub are no surface about the rotor's axis.
    #[error(transparent)]
    Hub(#[from] SolidFault),
}

/// Faces of a STEP file, for the shape of a rotor.
pub struct StepFile {
    records: Records,
    unit_mm: f64,
    axis: RotorAxis,
}

/// Types that stand between a product and its shape.
const PRODUCT_CHAIN: [&str; 4] = [
    "PRODUCT_DEFINITION_FORMATION",
    "PRODUCT_DEFINITION",
    "PRODUCT_DEFINITION_SHAPE",
    "SHAPE_DEFINITION_REPRESENTATION",
];

impl StepFile {
    /// Reads a file of a rotor about `axis`.
    ///
    /// # Errors
    /// The text is no STEP file, an assembly, or has no clear unit.
    pub fn read(text: &str, axis: RotorAxis) -> Result<Self, StepFault> {
        let records = records(text)?;
        let file = StepFile { unit_mm: unit_mm(&records)?, records, axis };
        if file.moves() { Err(StepFault::Moved) } else { Ok(file) }
    }

    /// Mesh of the faces with these names or colours.
    ///
    /// # Errors
    /// A face is not there, or no B-spline.
    pub fn mesh(&self, names: &[String]) -> Result<SurfaceMesh, StepFault> {
        let mut mesh = SurfaceMesh::default();
        for face in self.faces(names)? {
            let (number, parts) = self.surface(face)?;
            let rows = self.sampled(number, parts)?;
            mesh.add_rows(&rows.ok_or_else(|| StepFault::NotSpline { face, found: type_name(parts) })?);
        }
        Ok(mesh)
    }

    /// Generatrix of the faces with these names or colours.
    ///
    /// # Errors
    /// A face is not there, or no surface about the rotor's axis that is read.
    pub fn hub(&self, names: &[String]) -> Result<Revolution, StepFault> {
        let mut points = Vec::new();
        for face in self.faces(names)? {
            let (number, parts) = self.surface(face)?;
            match parts.first().map(|part| part.name.as_str()) {
                // Their generatrix is straight: the corners of the face are its ends.
                Some("CYLINDRICAL_SURFACE" | "CONICAL_SURFACE") => points.extend(self.corners(face)?),
                _ => {
                    let rows = self.sampled(number, parts)?;
                    let rows = rows.ok_or_else(|| StepFault::HubFace { face, found: type_name(parts) })?;
                    points.extend(rows.into_iter().flatten());
                }
            }
        }
        let places = points.iter().map(|point| [point.z, libm::hypot(point.x, point.y)]).collect();
        Ok(joined(places)?)
    }

    fn faces(&self, names: &[String]) -> Result<BTreeSet<u64>, StepFault> {
        let mut found = BTreeSet::new();
        for name in names {
            let of_name = self.faces_of(name);
            if of_name.is_empty() {
                return Err(StepFault::NoFace { name: name.clone(), known: self.known_names() });
            }
            found.extend(of_name);
        }
        Ok(found)
    }

    /// Faces below the records with this name, and faces with this colour.
    fn faces_of(&self, name: &str) -> BTreeSet<u64> {
        let mut starts: Vec<u64> = Vec::new();
        for (number, parts) in &self.records {
            let [part] = parts.as_slice() else { continue };
            if part.name == "STYLED_ITEM" {
                let has_it =
                    self.reached(&[*number]).iter().any(|at| self.colour(*at).is_some_and(|colour| colour == name));
                starts.extend(part.values.get(2).and_then(reference).filter(|_| has_it));
            } else if is_named(part) && part.values.first() == Some(&Value::Text(name.to_owned())) {
                starts.extend(if part.name == "PRODUCT" { self.shapes_of(*number) } else { vec![*number] });
            }
        }
        let is_face = |number: &u64| self.is_a(*number, "ADVANCED_FACE");
        self.reached(&starts).into_iter().filter(is_face).collect()
    }

    /// Records that give a product its shape.
    fn shapes_of(&self, product: u64) -> Vec<u64> {
        PRODUCT_CHAIN.iter().fold(vec![product], |owners, name| {
            let refers = |parts: &[Part]| {
                parts.iter().any(|part| {
                    part.name.starts_with(name) && references(&part.values).iter().any(|at| owners.contains(at))
                })
            };
            self.records.iter().filter(|(_, parts)| refers(parts)).map(|(number, _)| *number).collect()
        })
    }

    /// Records that others refer to, with these themselves.
    fn reached(&self, starts: &[u64]) -> BTreeSet<u64> {
        let mut found = BTreeSet::new();
        let mut open = starts.to_vec();
        while let Some(number) = open.pop() {
            if found.insert(number) {
                let parts = self.records.get(&number).into_iter().flatten();
                open.extend(parts.flat_map(|part| references(&part.values)));
            }
        }
        found
    }

    fn known_names(&self) -> String {
        let parts = self.records.values().flatten();
        let named = parts.filter(|part| is_named(part)).filter_map(|part| match part.values.first() {
            Some(Value::Text(name)) if !name.trim().is_empty() => Some(name.clone()),
            _ => None,
        });
        let colours = self.records.keys().filter_map(|number| self.colour(*number));
        let names: BTreeSet<String> = named.chain(colours).collect();
        names.into_iter().take(20).collect::<Vec<_>>().join(", ")
    }

    /// Colour as `rgb(255,0,0)`, or its name in the standard.
    fn colour(&self, number: u64) -> Option<String> {
        let part = self.records.get(&number)?.first()?;
        match (part.name.as_str(), part.values.as_slice()) {
            ("DRAUGHTING_PRE_DEFINED_COLOUR", [Value::Text(name)]) => Some(name.clone()),
            ("COLOUR_RGB", [_, Value::Number(red), Value::Number(green), Value::Number(blue)]) => {
                let [red, green, blue] = [red, green, blue].map(|share| libm::round(share * 255.0));
                Some(format!("rgb({red},{green},{blue})"))
            }
            _ => None,
        }
    }

    fn is_a(&self, number: u64, name: &str) -> bool {
        self.records.get(&number).is_some_and(|parts| parts.iter().any(|part| part.name == name))
    }

    fn surface(&self, face: u64) -> Result<(u64, &[Part]), StepFault> {
        let values = self.records.get(&face).and_then(|parts| parts.first()).map(|part| &part.values);
        let number = values.and_then(|values| values.get(2)).and_then(reference).ok_or(StepFault::Record(face))?;
        self.records.get(&number).map(|parts| (number, parts.as_slice())).ok_or(StepFault::Record(number))
    }

    /// Corners of a face.
    fn corners(&self, face: u64) -> Result<Vec<Point>, StepFault> {
        let vertices = self.reached(&[face]).into_iter().filter(|number| self.is_a(*number, "VERTEX_POINT"));
        vertices
            .map(|vertex| {
                let values = &self.records[&vertex][0].values;
                self.point(values.get(1).and_then(reference).ok_or(StepFault::Record(vertex))?)
            })
            .collect()
    }

    fn point(&self, number: u64) -> Result<Point, StepFault> {
        let part = self.records.get(&number).and_then(|parts| parts.first());
        let place = part.filter(|part| part.name == "CARTESIAN_POINT").and_then(|part| part.values.get(1));
        match place.map(numbers).as_deref() {
            Some([x, y, z]) => Ok(self.axis.to_part([x, y, z].map(|value| value * self.unit_mm))),
            _ => Err(StepFault::Record(number)),
        }
    }

    /// Rows of points of a B-spline surface; `None` if it is another one.
    fn sampled(&self, number: u64, parts: &[Part]) -> Result<Option<Vec<Vec<Point>>>, StepFault> {
        let Some(spline) = Spline::of(parts) else { return Ok(None) };
        let spline = spline.ok_or(StepFault::Record(number))?;
        let mut points = Vec::new();
        for row in &spline.net {
            points.push(row.iter().map(|at| self.point(*at)).collect::<Result<Vec<_>, _>>()?);
        }
        spline.grid(&points).map(Some).ok_or(StepFault::Record(number))
    }

    /// A part of the assembly is not where it was drawn.
    fn moves(&self) -> bool {
        let placement = |value: &Value| -> Option<Vec<Vec<f64>>> {
            let part = self.records.get(&reference(value)?)?.first()?;
            let of = |at: u64| self.records.get(&at)?.first()?.values.get(1).map(numbers);
            references(&part.values).into_iter().map(of).collect()
        };
        let transforms = self.records.values().flatten().filter(|part| part.name == "ITEM_DEFINED_TRANSFORMATION");
        transforms.map(|part| &part.values[..]).any(|values| match values {
            [.., from, to] => placement(from) != placement(to),
            _ => true,
        })
    }
}

/// Millimetres per unit of the file.
fn unit_mm(records: &Records) -> Result<f64, StepFault> {
    let mut found: Vec<f64> = Vec::new();
    for parts in records.values().filter(|parts| parts.iter().any(|part| part.name == "LENGTH_UNIT")) {
        let part = |name: &str| parts.iter().find(|part| part.name == name);
        let unit_mm = match (part("SI_UNIT"), part("CONVERSION_BASED_UNIT")) {
            (_, Some(conversion)) => match conversion.values.first() {
                Some(Value::Text(name)) if name.to_uppercase().starts_with("INCH") => Some(LengthUnit::Inch.mm()),
                Some(Value::Text(name)) if name.to_uppercase().starts_with("MILLI") => Some(1.0),
                _ => None,
            },
            (Some(si), None) => match si.values.first() {
                Some(Value::Word(prefix)) if prefix == "MILLI" => Some(1.0),
                Some(Value::Word(prefix)) if prefix == "CENTI" => Some(10.0),
                Some(Value::Absent) => Some(MM_PER_M),
                _ => None,
            },
            _ => None,
        };
        found.push(unit_mm.ok_or(StepFault::Unit)?);
    }
    // A conversion-based unit refers to the metre, or the millimetre, that it is given in.
    let inch = found.iter().copied().find(|unit| *unit == LengthUnit::Inch.mm());
    let same = found.windows(2).all(|pair| pair[0] == pair[1]);
    inch.or_else(|| found.first().copied().filter(|_| same)).ok_or(StepFault::Unit)
}

/// Types whose first parameter is a name that a person gives.
fn is_named(part: &Part) -> bool {
    matches!(
        part.name.as_str(),
        "ADVANCED_FACE"
            | "PRODUCT"
            | "OPEN_SHELL"
            | "CLOSED_SHELL"
            | "MANIFOLD_SOLID_BREP"
            | "SHELL_BASED_SURFACE_MODEL"
    )
}

fn type_name(parts: &[Part]) -> String {
    parts.first().map_or_else(String::new, |part| part.name.clone())
}
