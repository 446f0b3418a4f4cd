//! Passes of the teeth: each from where a tooth meets material to where it leaves it, with its thickest chip.

use arcfeed_kinematics::vector::Vector;
use arcfeed_model::tool::Edge;

use super::load_statistics::CHIP_MIN_MM;
use super::trail::BlockRef;

/// Finished pass of a tooth through the material: from where it entered to where it left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToothPass {
    /// Tooth, counted from 0.
    pub tooth: usize,
    /// Whether the tooth cuts on the outer or on the inner cutting circle.
    pub side: Edge,
    /// Block in which the tooth left the material.
    pub block: BlockRef,
    /// Time of the thickest chip, s.
    pub at_s: f64,
    /// Thickest chip of the pass.
    pub chip_mm: f64,
    /// Largest force of all teeth across the tool's axis during the pass.
    pub bending_n: f64,
    /// Largest torque of all teeth during the pass.
    pub torque_n_m: f64,
    /// Tip of the tool at the thickest chip, in the workpiece's coordinates.
    pub tip_mm: Vector,
}

/// One step of the tool, with the loads of all teeth in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassStep {
    /// Block to which the step belongs.
    pub block: BlockRef,
    /// Time of the step, s.
    pub at_s: f64,
    /// Position of the tool's tip, in the workpiece's coordinates.
    pub tip_mm: Vector,
    /// Force of all teeth across the tool's axis.
    pub bending_n: f64,
    /// Torque of all teeth.
    pub torque_n_m: f64,
}

/// Tracks the passes of the teeth through the material. Keeps its state between calls.
#[derive(Clone, Debug)]
pub struct ToothPasses {
    /// Cutting circle of each tooth.
    sides: Vec<Edge>,
    /// Pass of each tooth that is in the material.
    open: Vec<Option<ToothPass>>,
    /// Passes that the last step ended.
    ended: Vec<ToothPass>,
    /// Ended passes that the caller has not taken yet, if passes are recorded.
    recorded: Option<Vec<ToothPass>>,
}

impl ToothPasses {
    /// Tracker with all teeth out of the material; `sides` has the cutting circle of each tooth.
    pub fn new(sides: Vec<Edge>) -> Self {
        ToothPasses { open: vec![None; sides.len()], sides, ended: Vec::new(), recorded: None }
    }

    /// Begins to record finished passes for [`ToothPasses::take`].
    pub fn record(&mut self) {
        self.recorded.get_or_insert_default();
    }

    /// Takes the finished passes that were recorded since the last call.
    pub fn take(&mut self) -> Vec<ToothPass> {
        self.recorded.as_mut().map_or(Vec::new(), std::mem::take)
    }

    /// Processes a step with the chip of each tooth; returns the passes that it ends.
    pub fn advance(&mut self, step: &PassStep, chips_mm: &[f64]) -> &[ToothPass] {
        let PassStep { block, at_s, tip_mm, bending_n, torque_n_m } = *step;
        self.ended.clear();
        for (tooth, ((open, side), chip_mm)) in self.open.iter_mut().zip(&self.sides).zip(chips_mm).enumerate() {
            if *chip_mm < CHIP_MIN_MM {
                self.ended.extend(open.take().map(|pass| ToothPass { block, ..pass }));
                continue;
            }
            let pass = open.get_or_insert(ToothPass {
                tooth,
                side: *side,
                block,
                at_s,
                chip_mm: *chip_mm,
                bending_n,
                torque_n_m,
                tip_mm,
            });
            if *chip_mm > pass.chip_mm {
                (pass.chip_mm, pass.at_s, pass.tip_mm) = (*chip_mm, at_s, tip_mm);
            }
            pass.bending_n = pass.bending_n.max(bending_n);
            pass.torque_n_m = pass.torque_n_m.max(torque_n_m);
        }
        if let Some(recorded) = &mut self.recorded {
            recorded.extend(&self.ended);
        }
        &self.ended
    }

    /// Takes all teeth out of the material and drops their unfinished passes.
    pub fn lift(&mut self) {
        self.open.fill(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(at_s: f64, bending_n: f64) -> PassStep {
        let block = BlockRef { count: at_s as u32, sequence: None, rule: None, is_rapid: false };
        PassStep { block, at_s, tip_mm: [at_s, 0.0, 0.0], bending_n, torque_n_m: bending_n / 10.0 }
    }

    #[test]
    fn a_pass_has_its_thickest_chip_with_its_place_and_the_largest_loads() {
        let mut passes = ToothPasses::new(vec![Edge::Outer, Edge::Inner]);
        passes.record();
        for (at_s, bending_n, chips_mm) in
            [(1.0, 9.0, [0.0, 0.0]), (2.0, 5.0, [0.1, 0.0]), (3.0, 7.0, [0.3, 0.0]), (4.0, 8.0, [0.2, 0.05])]
        {
            assert!(passes.advance(&step(at_s, bending_n), &chips_mm).is_empty());
        }
        let ended = passes.advance(&step(5.0, 20.0), &[0.0, 0.05]).to_vec();
        let PassStep { block, .. } = step(5.0, 0.0);
        let (tooth, side, tip_mm) = (0, Edge::Outer, [3.0, 0.0, 0.0]);
        let wanted = ToothPass { tooth, side, block, at_s: 3.0, chip_mm: 0.3, bending_n: 8.0, torque_n_m: 0.8, tip_mm };
        assert_eq!(ended, [wanted]);
        passes.lift();
        assert!(passes.advance(&step(6.0, 0.0), &[0.0, 0.0]).is_empty(), "an unfinished pass does not count");
        assert_eq!((passes.take(), passes.take()), (ended, Vec::new()));
    }
}
