//! Refusal of a plan, and advice about its ring: the remedy for each reason, as text and as JSON, and what happens to the files of an earlier
//! plan.

use std::path::{Path, PathBuf};

use arcfeed_plan::cup_mill::infeasibility::Infeasible;
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::output::job;
use serde::Serialize;

use crate::console::note;
use crate::part::PASSES_MAX;

/// Smallest fraction of a slot that a plan must remove to be accepted.
pub const SHARE_MIN_RATIO: f64 = 0.01;
/// Fraction of the ring's width: with more room one pass leaves much of the slot.
const NARROW_RATIO: f64 = 0.25;

/// Refusal of a cup-mill plan, as `arcfeed plan cup-mill --json` prints it (docs/json.md).
#[derive(Debug, Serialize)]
pub struct RefusalFigures<'r> {
    /// Always false: there is no plan.
    pub safe: bool,
    /// Reason and remedy, as on stderr.
    pub refused: &'r str,
}

/// Advice for a slot that is much wider than the ring, with one pass planned.
pub fn wider_ring(width_mm: f64, room_mm: f64) -> Option<String> {
    (2.0 * room_mm > NARROW_RATIO * width_mm).then(|| {
        format!(
            "the slot is wider than the ring, and one pass leaves much beside the blades: `passes_max` in [roughing] plans further passes; or, \
             instead of {width_mm:.2} mm, a ring of this middle radius may be up to {:.2} mm wide along this axis, and `--widths` plans and proves \
             wider ones",
            width_mm + 2.0 * room_mm
        )
    })
}

/// Reason why there is no plan, with the smallest change of part or tool that would help, if it is known.
pub fn with_remedy(why: &Infeasible, cutter: &CupMill) -> String {
    let width_mm = cutter.outer_radius_mm - cutter.inner_radius_mm;
    let remedy = match why {
        Infeasible::Shallow { needed_mm, .. } => format!("; `cavity_depth` must be {needed_mm:.2} mm at least"),
        Infeasible::TooNarrow { missing_mm, .. } if *missing_mm < width_mm => format!(
            "; of these radii about one middle, a ring {:.2} mm wide is the widest that may pass ({width_mm:.2} mm now): try a larger \
             `inner_radius`, a smaller `outer_radius` or `allowance`, or `--widths` with such a ring",
            width_mm - missing_mm
        ),
        Infeasible::TooNarrow { .. } => {
            "; no ring about this middle radius passes: fewer or less twisted blades, or another cutter".into()
        }
        Infeasible::NoBase { .. } => "; try a narrower ring, or `axis = \"roomiest\"`".into(),
        Infeasible::NoFloor => "; try a smaller ring, or a smaller `allowance`".into(),
        _ => String::new(),
    };
    format!("{why}{remedy}")
}

/// Message for a plan that removes next to nothing (below [`SHARE_MIN_RATIO`]); `None` if it removes more.
pub fn idle(share_ratio: f64) -> Option<String> {
    (share_ratio < SHARE_MIN_RATIO).then(|| {
        format!(
            "the ring takes {:.2} % of a slot: this slot is far wider than the ring, or out of its reach; take another cutter, or a tool that \
             mills pockets",
            100.0 * share_ratio
        )
    })
}

/// Folder of a pass, from 1: that of the plan, or one in it.
pub fn pass_folder(folder: &Path, pass: usize) -> PathBuf {
    if pass > 1 { folder.join(format!("pass-{pass}")) } else { folder.into() }
}

/// Renames the programs and the jobs of an earlier plan in the folder of a refused one, from this pass on, so that none is taken for
/// new.
pub fn set_aside(folder: &Path, first_pass: usize) {
    (first_pass..=PASSES_MAX as usize).for_each(|pass| set_pass_aside(&pass_folder(folder, pass)));
}

fn set_pass_aside(folder: &Path) {
    let job = folder.join("job.toml");
    let Ok(text) = std::fs::read_to_string(&job) else { return };
    if !text.starts_with(job::FIRST_WORDS) {
        return;
    }
    let program =
        text.lines().find_map(|line| line.strip_prefix("program = ")).map(|name| folder.join(name.trim_matches('"')));
    for path in [Some(job), program].into_iter().flatten() {
        let old = path.with_added_extension("old");
        if std::fs::rename(&path, &old).is_ok() {
            note(format_args!("{}: of an earlier plan, renamed to {}", path.display(), old.display()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_plan_leaves_no_program_of_an_earlier_one_under_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| std::fs::write(at(name), text).unwrap();
        write("job.toml", "# a job of a person\nprogram = \"a.nc\"\n");
        write("a.nc", "%\n");
        set_aside(folder.path(), 1);
        assert!(at("job.toml").exists() && at("a.nc").exists());
        write("job.toml", &format!("{}: ...\nunits = \"mm\"\nprogram = \"a.nc\"\n", job::FIRST_WORDS));
        set_aside(folder.path(), 1);
        assert!(!at("job.toml").exists() && !at("a.nc").exists());
        assert!(at("job.toml.old").exists() && at("a.nc.old").exists());
        set_aside(&at("none"), 1);
    }

    #[test]
    fn a_ring_much_narrower_than_the_slot_gets_the_width_that_passes() {
        assert!(wider_ring(16.0, 5.25).is_some_and(|hint| hint.contains("26.50 mm")));
        assert!(wider_ring(16.0, 1.9).is_none());
    }

    #[test]
    fn a_refusal_names_the_amount_that_helps() {
        let cutter = CupMill {
            outer_radius_mm: 128.0,
            inner_radius_mm: 112.0,
            insert_radius_mm: 0.5,
            cavity_depth_mm: 20.0,
            height_mm: 40.0,
            holder_mm: Vec::new(),
            active_teeth: 10,
        };
        let shallow = with_remedy(&Infeasible::Shallow { cavity_mm: 20.0, needed_mm: 28.25 }, &cutter);
        assert!(shallow.ends_with("`cavity_depth` must be 28.25 mm at least"), "{shallow}");
        let narrow = with_remedy(&Infeasible::TooNarrow { missing_mm: 3.5, place: "between".into() }, &cutter);
        assert!(narrow.contains("12.50 mm wide") && narrow.contains("3.5 mm missing between"), "{narrow}");
        assert!(idle(0.0004).is_some_and(|text| text.contains("0.04 %")) && idle(0.5).is_none());
    }
}
