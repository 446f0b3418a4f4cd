//! Plunge law: feed of a move that descends along the tool's axis, or at an angle to it.
//!
//! On the end of a tool a chip is as thick as the path per edge, whatever the engaged width. Torque and power do depend on
//! the width: with the force per width f(h) of a chip h thick, the path per tooth s, z teeth on each side and Z on the
//! end, the sine S and the cosine C of the angle from the plane across the axis, and the moments of the engaged section
//! (`engagement/sections.rs`):
//!
//! ```text
//! chip    s <= a                                                                     (1)
//! torque  f(s z S / Z) * end + f(s C) * side <= min(T, P / (2 pi n))                 (2)
//! entry   s <= a / 2 in the air, and while the section of a plunge grows             (3)
//! exit    s <= a / 2 in the last millimetre of a plunge                              (4)
//! floor   end >= that of the whole end there, if the way down ends with it           (6)
//! ```
//!
//! On a ramp an edge passes a place at the radius r later than the one before by more than a pitch, because the tool has
//! moved across its axis meanwhile. Its chip is thicker by the ratio
//!
//! ```text
//! q = s C z / (2 pi r)                                                               (5)
//! ```
//!
//! at most. So (2) has s C (1 + q) on the side, and on the end the moment with r + q r in place of r, for the material as
//! near to the axis as its moment allows: end + s C z / (2 pi) sqrt(2 end Z). Otherwise no chip is thicker than the path per
//! tooth.
//!
//! At a joint of two descending moves the first tooth cuts what both have left. During this tooth the chip on the
//! end lies between those of both moves, as does the one in front of each edge of a side. So (2) holds with the larger path
//! of both moves if it holds for each with the moments of the joint, and with the larger S and the larger C of both:
//! both keep the limit of the joint within a path per tooth of it.
//!
//! A plunge may end below the flat bottoms that its neighbours have left at other tilts. There its section grows to the whole
//! end within less than a dexel, so (6) does not rely on the map. Levels of a ring are parallel: it has no such floor.
//!
//! In (2) both moments are the largest over a turn, so T and
//! P hold for every tooth, not only in the mean. On the end of a ring all inserts count: thin chips have the larger specific
//! force. With the mean moment Z area / (2 pi) and f = kc h, (2) is the torque kc F area / (2 pi n) and the power kc area F.
//!
//! Source: own; docs/laws.md#plunge.

use std::f64::consts::TAU;

use arcfeed_law::table::Table;
use arcfeed_model::knots::{Knot, TABLE_KNOTS_MAX};
use arcfeed_model::tool::Tool;
use arcfeed_units::{MM_PER_M, Mm, MmPerTooth, Nm, S_PER_MIN};

use crate::engagement::sections::{MappedDescent, MappedJoint, MappedSection, TangentialForce};

/// Share of the chip at entry and exit. (3), (4)
const GENTLE_RATIO: f64 = 0.5;
/// Length of the exit. (4)
const EXIT_MM: f64 = 1.0;
/// Share of the largest moment within the tool's diameter at which a section counts as grown. (3)
const GROWN_RATIO: f64 = 0.9;
/// Halvings in the search for the path per tooth.
const HALVINGS: usize = 48;
/// Reduction of the table's values, which are stored as f32.
const F32_RATIO: f64 = 1.0 - 1e-6;

/// Numbers of cutting edges that pass a point in one turn of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edges {
    /// z: number of edges on each side (cutting circle) of the tool.
    pub side: f64,
    /// Z: number of edges on the end of the tool.
    pub end: f64,
}

impl Edges {
    /// Numbers for this tool. On a cup mill the inserts of both circles reach across the end, so both count there.
    pub fn of(tool: &Tool) -> Self {
        let side = f64::from(tool.active_teeth());
        Edges { side, end: if matches!(tool, Tool::CupMill(_)) { 2.0 * side } else { side } }
    }
}

/// Angle between a move and the plane square to the tool's axis, by its sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inclination {
    /// S: sine of the angle; 1 for a plunge.
    pub sine_ratio: f64,
    /// C: cosine of the angle; 0 for a plunge.
    pub cosine_ratio: f64,
}

impl Inclination {
    /// Move along the tool's axis.
    pub const PLUNGE: Inclination = Inclination { sine_ratio: 1.0, cosine_ratio: 0.0 };

    /// Inclination with this sine, from 0 to 1.
    pub fn of_sine(sine_ratio: f64) -> Self {
        Inclination { sine_ratio, cosine_ratio: libm::sqrt((1.0 - sine_ratio * sine_ratio).max(0.0)) }
    }
}

/// Plunge law for one tool at one spindle speed: limits of the feed along the tool's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialLaw {
    /// a: target chip thickness, the largest path per tooth, mm.
    pub feed_per_tooth_mm: f64,
    /// Numbers of edges that pass in one turn.
    pub edges: Edges,
    /// Outer diameter of the tool, mm.
    pub diameter_mm: f64,
    /// Tangential cutting force of the material per width of cut, as a function of the chip thickness.
    pub force: TangentialForce,
    /// Largest torque at the tool's speed, N m: the lower one of the spindle's torque limit and its power divided by the angular speed.
    pub torque_max_n_m: f64,
    /// Least moment of the end where the way down ends: that of all edges over their whole length. (6)
    pub floor_mm2: f64,
}

/// Moment of all edges of a tool's end in material over their whole length; 0 for a ring. (6)
pub fn floor_mm2(tool: &Tool) -> f64 {
    match tool {
        Tool::CupMill(_) => 0.0,
        Tool::EndMill(mill) => {
            let radius_mm = Nm::to_mm(mill.radius);
            Edges::of(tool).end * radius_mm * radius_mm / 2.0
        }
    }
}

/// Largest torque at a spindle speed, N m, by the spindle's limits of torque and power; infinite without limits.
pub fn torque_max_n_m(torque_n_m: Option<f64>, power_w: Option<f64>, rev_per_min: f64) -> f64 {
    let by_power = power_w.map_or(f64::INFINITY, |power_w| power_w / (TAU * rev_per_min / S_PER_MIN));
    by_power.min(torque_n_m.unwrap_or(f64::INFINITY))
}

impl AxialLaw {
    /// Largest torque within a turn, N m, for a path of the tool per tooth in a section of tool and material (left side of (2)).
    pub fn torque_n_m(&self, path_mm: f64, section: &MappedSection, inclination: Inclination) -> f64 {
        let Inclination { sine_ratio: sine, cosine_ratio: cosine } = inclination;
        let Edges { side: side_edges, end: end_edges } = self.edges;
        let across_mm = path_mm * cosine;
        let late_mm = across_mm * side_edges / TAU; // (5)
        let end_mm2 = section.end_mm2 + late_mm * libm::sqrt(2.0 * section.end_mm2 * end_edges);
        let end = self.force.n_per_mm(path_mm * side_edges * sine / end_edges) * end_mm2;
        let side_mm = across_mm * (1.0 + late_mm / (self.diameter_mm / 2.0));
        let side = if section.side_mm2 > 0.0 { self.force.n_per_mm(side_mm) * section.side_mm2 } else { 0.0 };
        (end + side) / MM_PER_M
    }

    /// Largest path per tooth, at most `most_mm`, with which the torque stays within its limit, mm; `None` if no feed does.
    pub fn path_mm(&self, most_mm: f64, section: &MappedSection, inclination: Inclination) -> Option<f64> {
        let is_kept = |path_mm: f64| self.torque_n_m(path_mm, section, inclination) <= self.torque_max_n_m;
        if is_kept(most_mm) {
            return Some(most_mm);
        }
        let (mut low_mm, mut high_mm) = (0.0, most_mm);
        for _ in 0..HALVINGS {
            let middle_mm = (low_mm + high_mm) / 2.0;
            *(if is_kept(middle_mm) { &mut low_mm } else { &mut high_mm }) = middle_mm;
        }
        (low_mm > 0.0).then_some(low_mm)
    }

    /// Table of the permitted path per tooth along a move of this length, from its sections. `sine` is that of the inclination;
    /// `is_plunge` means that the move runs along the axis. `None` if somewhere no feed keeps the torque, or the move has no sections.
    pub fn table(&self, moved: &MappedDescent, length_mm: f64, (sine, is_plunge): (f64, bool)) -> Option<Table> {
        let sections = &moved.sections[..];
        let inclination = Inclination::of_sine(sine);
        let entry_mm = if is_plunge { self.entry_mm(sections) } else { f64::NEG_INFINITY };
        let gentle_from_mm = if is_plunge { length_mm - EXIT_MM } else { f64::INFINITY };
        // Each sample stands for its surroundings up to the neighbours.
        let near = |index: usize| &sections[index.saturating_sub(1)..(index + 2).min(sections.len())];
        let ends_mm = [sections.first()?.at_mm, sections.last()?.at_mm];
        let is_last = moved.joints[1].is_none();
        let values = (0..sections.len()).map(|index| {
            let of = |section: &MappedSection| {
                let is_exit = section.at_mm > gentle_from_mm;
                let is_gentle = section.at_mm <= entry_mm || is_exit;
                let floor_mm2 = if is_exit && is_last { self.floor_mm2 } else { 0.0 };
                let section = &MappedSection { end_mm2: section.end_mm2.max(floor_mm2), ..*section };
                let most_mm = self.feed_per_tooth_mm * if is_gentle { GENTLE_RATIO } else { 1.0 };
                let is_at = |end_mm: &f64| (section.at_mm - end_mm).abs() <= self.feed_per_tooth_mm;
                let joints = ends_mm.iter().zip(&moved.joints).filter(|(end_mm, _)| is_at(end_mm));
                joints
                    .filter_map(|(_, joint)| joint.as_ref())
                    .try_fold(self.path_mm(most_mm, section, inclination)?, |most, joint| self.joint_mm(most, joint))
            };
            near(index).iter().map(of).try_fold(f64::INFINITY, |least, path_mm| Some(least.min(path_mm?)))
        });
        below(
            &sections.iter().map(|section| section.at_mm).zip(values.collect::<Option<Vec<_>>>()?).collect::<Vec<_>>(),
            length_mm,
        )
    }

    /// Largest path per tooth up to `most_mm` that keeps the torque at a joint.
    fn joint_mm(&self, most_mm: f64, joint: &MappedJoint) -> Option<f64> {
        let &MappedJoint { end_mm2, side_mm2, sine_ratio, cosine_ratio } = joint;
        let inclination = Inclination { sine_ratio, cosine_ratio };
        self.path_mm(most_mm, &MappedSection { at_mm: 0.0, end_mm2, side_mm2 }, inclination)
    }

    /// End of the entry: the first place at which the section has its size within the tool's diameter behind the contact;
    /// the end of the move if it meets nothing. (3)
    fn entry_mm(&self, sections: &[MappedSection]) -> f64 {
        let last_mm = sections.last().map_or(0.0, |section| section.at_mm);
        let Some(contact) = sections.iter().position(|section| section.end_mm2 > 0.0) else { return last_mm };
        let ahead = &sections[contact..];
        let is_near = |section: &&MappedSection| section.at_mm <= ahead[0].at_mm + self.diameter_mm;
        let most_mm2 = ahead.iter().take_while(is_near).map(|section| section.end_mm2).fold(0.0, f64::max);
        let grown = ahead.iter().find(|section| section.end_mm2 >= GROWN_RATIO * most_mm2);
        grown.map_or(last_mm, |section| section.at_mm)
    }
}

/// Table whose lines are nowhere above the values around them: the move in equal parts, at whose borders stands the lower
/// of both parts' least values.
fn below(values: &[(f64, f64)], length_mm: f64) -> Option<Table> {
    let parts = (TABLE_KNOTS_MAX - 1).min(values.len());
    let part_of = |at_mm: f64| ((at_mm / length_mm * parts as f64).max(0.0) as usize).min(parts - 1);
    let mut least = vec![f64::INFINITY; parts];
    let mut lower = |[from_mm, to_mm]: [f64; 2], value_mm: f64| {
        least[part_of(from_mm)..=part_of(to_mm)].iter_mut().for_each(|part| *part = part.min(value_mm));
    };
    for pair in values.windows(2) {
        lower([pair[0].0, pair[1].0], pair[0].1.min(pair[1].1));
    }
    let (first, last) = (values.first()?, values.last()?);
    lower([0.0, first.0], first.1);
    lower([last.0, length_mm], last.1);
    let knot = |border: usize| -> Knot {
        let around = &least[border.saturating_sub(1)..(border + 1).min(parts)];
        let path_mm = around.iter().copied().fold(f64::INFINITY, f64::min) * F32_RATIO;
        (Mm((length_mm * border as f64 / parts as f64) as f32), MmPerTooth(path_mm as f32))
    };
    Table::new(&(0..=parts).map(knot).collect::<Vec<_>>()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_law::{FeedLaw, Place};

    fn law(torque_max_n_m: f64) -> AxialLaw {
        let force = TangentialForce { specific_mpa: 2_000.0, exponent_ratio: 0.25, edge_n_per_mm: 0.0 };
        let edges = Edges { side: 4.0, end: 4.0 };
        AxialLaw { feed_per_tooth_mm: 0.1, edges, diameter_mm: 10.0, force, torque_max_n_m, floor_mm2: 0.0 }
    }

    fn moved(sections: &[MappedSection], joints: [Option<MappedJoint>; 2]) -> MappedDescent {
        MappedDescent { line: 1, sequence: None, key: 0, sections: sections.to_vec(), joints }
    }

    fn at(table: &Table, at_mm: f64) -> f64 {
        let place = Place { center_mm: [0.0; 2], motion: [0.0; 2], towards: [0.0; 2], travelled_mm: at_mm as f32 };
        f64::from(table.demand(&place).expect("a demand").path_mm_per_tooth)
    }

    #[test]
    fn entry_and_exit_are_gentle_and_the_torque_is_kept_everywhere() {
        let moment = |at_mm: f64| if at_mm < 5.0 { 0.0 } else { 50.0 * ((at_mm - 5.0) / 3.0).min(1.0) };
        let sections: Vec<MappedSection> = (0..=120)
            .map(|at| f64::from(at) * 0.25)
            .map(|at_mm| MappedSection { at_mm, end_mm2: moment(at_mm), side_mm2: 0.0 })
            .collect();
        for (torque_max_n_m, largest) in [(f64::INFINITY, 0.1), (13.0, 0.0659)] {
            let law = law(torque_max_n_m);
            let table = law.table(&moved(&sections, [None; 2]), 30.0, (1.0, true)).expect("a table");
            let mut most = 0.0_f64;
            for step in 0..=300 {
                let at_mm = f64::from(step) * 0.1;
                let path_mm = at(&table, at_mm);
                most = most.max(path_mm);
                let section = MappedSection { at_mm, end_mm2: moment(at_mm), side_mm2: 0.0 };
                assert!(law.torque_n_m(path_mm, &section, Inclination::PLUNGE) <= torque_max_n_m, "{at_mm}: {path_mm}");
                if at_mm <= 5.0 + 0.9 * 3.0 || at_mm > 29.0 {
                    assert!(path_mm <= 0.05, "{at_mm}: {path_mm}");
                }
            }
            assert!((most / largest - 1.0).abs() < 0.02, "{most} {largest}");
        }
    }

    #[test]
    fn where_the_way_down_ends_the_whole_end_counts() {
        let law = AxialLaw { floor_mm2: 50.0, ..law(4.0) };
        let sections: Vec<MappedSection> =
            (0..=20).map(|at| MappedSection { at_mm: f64::from(at) / 2.0, end_mm2: 10.0, side_mm2: 0.0 }).collect();
        let joint = MappedJoint { end_mm2: 10.0, side_mm2: 0.0, sine_ratio: 1.0, cosine_ratio: 0.0 };
        let last = |joints| at(&law.table(&moved(&sections, joints), 10.0, (1.0, true)).expect("a table"), 10.0);
        let whole = MappedSection { at_mm: 0.0, end_mm2: 50.0, side_mm2: 0.0 };
        assert!((law.torque_n_m(last([None; 2]), &whole, Inclination::PLUNGE) / 4.0 - 1.0).abs() < 1e-5);
        assert!((last([None, Some(joint)]) / 0.05 - 1.0).abs() < 1e-5, "the way down goes on");
    }

    #[test]
    fn a_ramp_has_the_load_of_its_end_and_its_sides_and_no_gentle_parts() {
        let section = MappedSection { at_mm: 0.0, end_mm2: 20.0, side_mm2: 10.0 };
        let law = law(5.0);
        let path_mm = law.path_mm(0.1, &section, Inclination::of_sine(0.6)).expect("a path");
        let late_mm = path_mm * 0.8 * 4.0 / TAU;
        let end = libm::pow(path_mm * 0.6, 0.75) * (20.0 + late_mm * libm::sqrt(160.0));
        let side = libm::pow(path_mm * 0.8 * (1.0 + late_mm / 5.0), 0.75) * 10.0;
        let by_hand = 2_000.0 * (end + side) / 1e3;
        assert!((by_hand - 5.0).abs() < 1e-9, "{by_hand}");
        let sections = [section, MappedSection { at_mm: 8.0, ..section }];
        let table = law.table(&moved(&sections, [None; 2]), 8.0, (0.6, false)).expect("a table");
        assert!((at(&table, 0.0) / path_mm - 1.0).abs() < 2e-6 && at(&table, 0.0) <= path_mm);
    }

    #[test]
    fn a_material_that_rubs_above_the_limit_at_any_feed_has_no_table() {
        let law = AxialLaw {
            force: TangentialForce { edge_n_per_mm: 100.0, exponent_ratio: 0.0, specific_mpa: 1.0 },
            ..law(1.0)
        };
        let section = |at_mm| MappedSection { at_mm, end_mm2: 20.0, side_mm2: 0.0 };
        assert_eq!(law.table(&moved(&[section(0.0), section(8.0)], [None; 2]), 8.0, (1.0, true)), None);
        assert_eq!(law.table(&moved(&[], [None; 2]), 8.0, (1.0, true)), None);
    }

    #[test]
    fn while_a_tooth_passes_from_one_move_into_another_the_torque_is_kept_on_both_sides_of_the_joint() {
        let force = TangentialForce { specific_mpa: 1_000.0, exponent_ratio: 0.3, edge_n_per_mm: 6.0 };
        let law = AxialLaw { force, diameter_mm: 1e9, ..law(4.0) };
        let (end, side) = (25.0, 18.0);
        let section = |at_mm, side_mm2| MappedSection { at_mm, end_mm2: end, side_mm2 };
        let ramp = Inclination::of_sine(0.5);
        let joint = MappedJoint { end_mm2: end, side_mm2: side, sine_ratio: 1.0, cosine_ratio: ramp.cosine_ratio };
        // Without the gentle end of a plunge, which would hide the sum.
        let path = |joints, side, sine: f64, at_mm| {
            let sections: Vec<MappedSection> = (0..=10).map(|at| section(f64::from(at), side)).collect();
            at(&law.table(&moved(&sections, joints), 10.0, (sine, false)).expect("a table"), at_mm)
        };
        // The larger torque while a tooth passes: the end goes over from the one chip to the other, the side begins.
        let torque = |plunge_mm: f64, ramp_mm: f64| {
            let of = |part: f64| {
                let end_mm = plunge_mm * (1.0 - part) + ramp_mm * ramp.sine_ratio * part;
                let side_mm = ramp_mm * ramp.cosine_ratio * part;
                (force.n_per_mm(end_mm) * end + force.n_per_mm(side_mm) * side) / 1e3
            };
            (0..=1000).map(|step| of(f64::from(step) / 1e3)).fold(0.0, f64::max)
        };
        let apart = torque(path([None; 2], 0.0, 1.0, 10.0), path([None; 2], side, 0.5, 0.0));
        let joined = torque(path([None, Some(joint)], 0.0, 1.0, 10.0), path([Some(joint), None], side, 0.5, 0.0));
        assert!(apart > 4.0 * 1.02 && joined <= 4.0, "{apart} {joined}");
        // Away from the joint nothing changes.
        assert_eq!(path([None; 2], side, 0.5, 5.0), path([Some(joint), None], side, 0.5, 5.0));
    }
}
