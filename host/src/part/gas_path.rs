//! Inner and outer end of a rotor's gas path: a radius, a curve file, or a surface about the axis as an STL file.

use std::path::Path;

use arcfeed_plan::geometry::blisk::{Blank, Revolution};
use arcfeed_plan::geometry::curves;
use arcfeed_plan::geometry::point_file::PointFileFrame;
use arcfeed_plan::geometry::solid;
use toml::Spanned;

use super::PartError;
use super::geometry_files::{FileContext, in_file, read, read_mesh, whole};
use crate::job::{Quantity, at, length_mm};

/// Two keys of which one gives an end of the gas path.
pub(super) struct GasPathEntry<'e> {
    /// Names of the keys.
    pub(super) names: [&'static str; 2],
    /// File.
    pub(super) file: &'e Option<Spanned<String>>,
    /// Radius of a cylinder.
    pub(super) radius: &'e Option<Spanned<Quantity>>,
}

impl GasPathEntry<'_> {
    /// Complaint that neither key is there.
    pub(super) fn missing<T>(&self, table: &Spanned<T>) -> PartError {
        let [file, radius] = self.names;
        at(table, &format!("give `{radius}`, or a curve or STL file as `{file}`")).into()
    }
}

/// Cylinder through the blank.
pub(super) fn cylinder(radius_mm: f64, blank: &Blank) -> Revolution {
    Revolution { profile_mm: blank.faces_mm.map(|z| [z, radius_mm]).to_vec() }
}

/// Generatrix between the blank's faces, and whether its file begins at low z; `None` if neither key is there.
pub(super) fn gas_path(
    entry: &GasPathEntry<'_>,
    frame: &PointFileFrame,
    context: &FileContext<'_>,
) -> Result<Option<(Revolution, bool)>, PartError> {
    let [_, name] = entry.names;
    let (found, from_low_z) = match (entry.file, entry.radius) {
        (None, None) => return Ok(None),
        (None, Some(radius)) => (cylinder(length_mm(radius, context.unit, name)?, context.blank), true),
        (Some(file), None) if is_stl(file) => {
            let mesh = read_mesh(file, frame, context.folder)?;
            let found = solid::hub(&mesh).map_err(|fault| whole(file, context.folder, &fault.to_string()))?;
            (found, true)
        }
        (Some(file), None) => curves::revolution(&read(file, context.folder)?, frame)
            .map_err(|error| in_file(file, context.folder, &error))?,
        (Some(file), Some(_)) => {
            let message = format!("give `{}` or `{name}`, not both", entry.names[0]);
            return Err(at(file, &message).into());
        }
    };
    Ok(Some((Revolution { profile_mm: found.between(context.blank.faces_mm) }, from_low_z)))
}

fn is_stl(file: &Spanned<String>) -> bool {
    Path::new(file.as_ref()).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("stl"))
}
