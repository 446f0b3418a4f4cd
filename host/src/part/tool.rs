//! `[cutter]` of a part file: the cup mill.

use arcfeed_plan::cutter::CupMill;
use arcfeed_units::LengthUnit;
use toml::Spanned;

use super::schema::CutterTable;
use crate::job::{Complaint, at, length_mm};

/// Cup mill from the `[cutter]` table of a part file; fails at the first faulty value.
pub fn build(entry: &CutterTable, unit: LengthUnit) -> Result<CupMill, Complaint> {
    let outer_radius_mm = length_mm(&entry.outer_radius, unit, "outer_radius")?;
    let inner_radius_mm = length_mm(&entry.inner_radius, unit, "inner_radius")?;
    let insert_radius_mm = entry.insert_radius.as_ref().to_mm(unit);
    let cavity_depth_mm = length_mm(&entry.cavity_depth, unit, "cavity_depth")?;
    let height_mm = length_mm(&entry.height, unit, "height")?;
    let width_mm = outer_radius_mm - inner_radius_mm;
    if width_mm <= 0.0 {
        return Err(at(&entry.inner_radius, "inner_radius must be less than outer_radius"));
    }
    if !(0.0..=width_mm / 2.0).contains(&insert_radius_mm) {
        let message = format!("insert_radius must be 0 to half the ring's width, which is {width_mm:.3} mm");
        return Err(at(&entry.insert_radius, &message));
    }
    if cavity_depth_mm <= insert_radius_mm {
        return Err(at(&entry.cavity_depth, "cavity_depth must be more than insert_radius: the cup is hollow"));
    }
    if cavity_depth_mm >= height_mm {
        return Err(at(&entry.cavity_depth, "cavity_depth must be less than height: the cup has a back"));
    }
    let holder_mm = entry.holder.iter().map(|cylinder| {
        let of_mm = cylinder.as_ref().map(|value| value.to_mm(unit));
        let is_one = of_mm.iter().all(|value| *value > 0.0 && *value < 1e5);
        if is_one {
            Ok(of_mm)
        } else {
            Err(at(cylinder, "a cylinder of the holder is [radius, length], both positive"))
        }
    });
    Ok(CupMill {
        outer_radius_mm,
        inner_radius_mm,
        insert_radius_mm,
        cavity_depth_mm,
        height_mm,
        holder_mm: holder_mm.collect::<Result<_, _>>()?,
        active_teeth: teeth(&entry.active_teeth)?,
    })
}

/// Number of teeth from a part file; fails if it is 0.
pub fn teeth(entry: &Spanned<u16>) -> Result<u16, Complaint> {
    match *entry.as_ref() {
        0 => Err(at(entry, "a tool needs at least one tooth")),
        teeth => Ok(teeth),
    }
}
