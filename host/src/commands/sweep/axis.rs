//! Axis of a campaign (`sweep`): a name whose value differs from run to run, its possible values, and the choice for each run.
//!
//! Random values come from SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014),
//! seeded by the campaign's seed, the name and the number of the run: they depend on nothing else.

use crate::trace::table::Kind;

/// Increment of SplitMix64.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// 2^-53: distance of the numbers in [0, 1) that a draw gives.
const DRAW_STEP: f64 = 1.0 / (1_u64 << 53) as f64;

/// Key of the job, or value in the port's URL, that differs from run to run.
#[derive(Clone, Debug)]
pub struct SweepAxis {
    /// Key of the job, or name of a placeholder in a URL.
    pub name: String,
    /// Byte offset of the name in the sweep file.
    pub offset: usize,
    /// Possible values.
    pub values: Values,
    /// Rule by which a run gets one of the values.
    pub choice: Choice,
}

/// Value as written in the sweep file, with its place.
#[derive(Clone, Debug)]
pub struct Literal {
    /// Value in TOML, on one line.
    pub text: String,
    /// Byte offset in the sweep file.
    pub offset: usize,
}

/// Possible values of an axis.
#[derive(Clone, Debug)]
pub enum Values {
    /// List of values, in this order.
    Listed(Vec<Literal>),
    /// Whole numbers, both ends included.
    Whole {
        /// Smallest value.
        from: i64,
        /// Largest value.
        to: i64,
    },
    /// Real numbers from `from` to `to`: `steps` numbers at equal distances, both ends included, or random ones below `to`.
    Real {
        /// Smallest value.
        from: f64,
        /// Largest value; random values stay below it.
        to: f64,
        /// Number of values; of no use for random ones.
        steps: u64,
    },
}

/// Rule by which a run gets a value of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Every value is combined with every value of the other axes.
    Grid {
        /// Number of successive runs that have the same value.
        every: u64,
    },
    /// The value has the same place in its list as the values of the other lists.
    List {
        /// Number of successive runs that have the same value.
        every: u64,
    },
    /// A random value for each run.
    Random {
        /// Seed of the campaign.
        seed: u64,
    },
}

impl Values {
    /// Number of possible values.
    pub fn len(&self) -> u64 {
        match self {
            Values::Listed(values) => values.len() as u64,
            Values::Whole { from, to } => to.abs_diff(*from).saturating_add(1),
            Values::Real { steps, .. } => *steps,
        }
    }

    fn nth(&self, index: u64) -> String {
        match self {
            Values::Listed(values) => values.get(index as usize).map_or(String::new(), |value| value.text.clone()),
            Values::Whole { from, .. } => from.saturating_add_unsigned(index).to_string(),
            Values::Real { from, to, steps } => {
                let part = index as f64 / steps.saturating_sub(1).max(1) as f64;
                real(from + (to - from) * part)
            }
        }
    }
}

impl SweepAxis {
    /// Value of the axis for the run with this number, in TOML.
    pub fn literal(&self, run: u64) -> String {
        let index = run - 1;
        match self.choice {
            Choice::Grid { every } | Choice::List { every } => self.values.nth(index / every % self.values.len()),
            Choice::Random { seed } => {
                let draw = draw(seed ^ crate::checksum::fingerprint(self.name.as_bytes()), index);
                match self.values {
                    Values::Real { from, to, .. } => real(from + (to - from) * (draw >> 11) as f64 * DRAW_STEP),
                    _ => self.values.nth(((u128::from(draw) * u128::from(self.values.len())) >> 64) as u64),
                }
            }
        }
    }

    /// Values that are checked before a campaign starts, each with its place: all values of a list, the ends of a range.
    pub fn probes(&self) -> Vec<Literal> {
        let end = |text: String| Literal { text, offset: self.offset };
        match &self.values {
            Values::Listed(values) => values.clone(),
            Values::Whole { from, to } => [from, to].map(|whole| end(whole.to_string())).into(),
            Values::Real { from, to, .. } => [from, to].map(|number| end(real(*number))).into(),
        }
    }

    /// Type of the axis's column in the table of results.
    pub fn kind(&self) -> Kind {
        let Values::Listed(values) = &self.values else {
            return if matches!(self.values, Values::Whole { .. }) { Kind::Integer } else { Kind::Number };
        };
        let all = |is_of: &dyn Fn(&str) -> bool| values.iter().all(|value| is_of(&value.text));
        if all(&|text| text.parse::<i64>().is_ok()) {
            Kind::Integer
        } else if all(&|text| text.parse::<f64>().is_ok()) {
            Kind::Number
        } else if all(&|text| text.parse::<bool>().is_ok()) {
            Kind::Flag
        } else {
            Kind::Text
        }
    }
}

/// A number in TOML: with a point or an exponent, and as many digits as are needed to read the same number back.
fn real(number: f64) -> String {
    format!("{number:?}")
}

/// The draw of a run: output `index` of SplitMix64 from this seed.
fn draw(seed: u64, index: u64) -> u64 {
    let state = seed.wrapping_add(GOLDEN.wrapping_mul(index.wrapping_add(1)));
    let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_those_of_the_published_generator() {
        // Its first outputs from the seed 1234567, as in other implementations' tests.
        let draws = [0, 1, 2].map(|index| draw(1_234_567, index));
        assert_eq!(draws, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn ranges_have_their_ends_and_random_values_stay_inside() {
        let axis = |values, choice| SweepAxis { name: "a".into(), offset: 0, values, choice };
        let whole = axis(Values::Whole { from: -1, to: 1 }, Choice::Grid { every: 2 });
        assert_eq!([1, 2, 3, 5, 7].map(|run| whole.literal(run)), ["-1", "-1", "0", "1", "-1"]);
        let real = axis(Values::Real { from: 1.0, to: 2.0, steps: 5 }, Choice::List { every: 1 });
        assert_eq!([1, 2, 5].map(|run| real.literal(run)), ["1.0", "1.25", "2.0"]);
        let drawn = axis(Values::Real { from: 3.0, to: 5.0, steps: 0 }, Choice::Random { seed: 7 });
        let values: Vec<f64> = (1..=1000).map(|run| drawn.literal(run).parse().unwrap()).collect();
        let mean = values.iter().sum::<f64>() / 1000.0;
        assert!(values.iter().all(|value| (3.0..5.0).contains(value)) && (mean - 4.0).abs() < 0.06, "{mean}");
        let die = axis(Values::Whole { from: 1, to: 6 }, Choice::Random { seed: 7 });
        let counts = (1..=6000).fold([0; 6], |mut counts, run| {
            counts[die.literal(run).parse::<usize>().unwrap() - 1] += 1;
            counts
        });
        assert!(counts.iter().all(|count| (850..1150).contains(count)), "{counts:?}");
    }
}
