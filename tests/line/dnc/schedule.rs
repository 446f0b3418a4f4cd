//! Faults of a line, and reduction of a failing schedule to the smallest one that fails.

use fastrand::Rng;

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The nth character to the control is lost, comes twice, comes with these bits turned, has no stop bit.
    TxLost(usize),
    TxTwice(usize),
    TxFlip(usize, u8),
    TxBreak(usize),
    /// The nth character and those behind it come so many ms late.
    TxLate(usize, u64),
    /// From the nth on, noise in the place of characters.
    TxNoise(usize, Vec<u8>),
    /// The nth character from the control: DC1 and DC3.
    RxLost(usize),
    RxTwice(usize),
    RxFlip(usize, u8),
    RxLate(usize, u64),
    /// Before everything.
    Garbage(Vec<u8>),
    /// The line is dead from the nth character on.
    Cut(usize),
    /// The nth write takes half.
    Short(usize),
}

/// Faults of one run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Schedule(pub Vec<Fault>);

/// The rows of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The way back: DC1 and DC3 lost, twice, late, corrupted.
    Signals,
    /// Noise before the start.
    Garbage,
    /// The line is cut.
    Cut,
    /// Short writes.
    Short,
    /// A character without stop bits.
    Break,
    /// Characters on the way to the control that are late.
    Late,
    /// Several of these at once.
    Several,
    /// One bit of a character.
    OneBit,
    /// One bit of several characters.
    BitsApart,
    /// Two bits of a character.
    TwoBits,
    /// A character lost.
    Lost,
    /// A character twice.
    Twice,
    /// Two characters lost within ten.
    TwoLost,
    /// 2 to 16 characters of noise.
    Burst,
}

pub const KINDS: [Kind; 14] = [
    Kind::Signals,
    Kind::Garbage,
    Kind::Cut,
    Kind::Short,
    Kind::Break,
    Kind::Late,
    Kind::Several,
    Kind::OneBit,
    Kind::BitsApart,
    Kind::TwoBits,
    Kind::Lost,
    Kind::Twice,
    Kind::TwoLost,
    Kind::Burst,
];

impl Kind {
    /// Whether the line itself shows the fault: no character to the control is corrupted without a trace.
    pub fn is_of_the_line(self) -> bool {
        self <= Kind::Several
    }

    /// A schedule of this kind for a program of so many characters.
    pub fn draw(self, random: &mut Rng, len: usize) -> Schedule {
        // Never in the label, which a control reads unchecked: see docs/dnc.md.
        let mut at = || random.usize(2..len);
        let first = at();
        let bit = |random: &mut Rng| 1_u8 << random.u8(..8);
        let noise = |random: &mut Rng, most: usize| (0..random.usize(2..=most)).map(|_| random.u8(..)).collect();
        Schedule(match self {
            Kind::Signals => (0..random.usize(1..4)).map(|_| signal(random)).collect(),
            Kind::Garbage => vec![Fault::Garbage(noise(random, 64))],
            Kind::Cut => vec![Fault::Cut(first)],
            Kind::Short => (0..random.usize(1..20)).map(|_| Fault::Short(random.usize(1..100))).collect(),
            Kind::Break => vec![Fault::TxBreak(first)],
            Kind::Late => (0..random.usize(1..4)).map(|_| late(random, len)).collect(),
            Kind::Several => {
                let kinds = [Kind::Signals, Kind::Garbage, Kind::Cut, Kind::Short, Kind::Late];
                let chosen = kinds.into_iter().filter(|_| random.bool()).collect::<Vec<_>>();
                chosen.into_iter().flat_map(|kind| kind.draw(random, len).0).collect()
            }
            Kind::BitsApart => {
                (0..random.usize(2..6)).map(|_| Fault::TxFlip(random.usize(2..len), bit(random))).collect()
            }
            Kind::OneBit => vec![Fault::TxFlip(first, bit(random))],
            Kind::TwoBits => {
                let one = bit(random);
                let other = std::iter::repeat_with(|| bit(random)).find(|other| *other != one).unwrap_or(1);
                vec![Fault::TxFlip(first, one | other)]
            }
            Kind::Lost => vec![Fault::TxLost(first)],
            Kind::Twice => vec![Fault::TxTwice(first)],
            Kind::TwoLost => vec![Fault::TxLost(first), Fault::TxLost(first + random.usize(1..10))],
            Kind::Burst => vec![Fault::TxNoise(first, noise(random, 16))],
        })
    }
}

fn late(random: &mut Rng, len: usize) -> Fault {
    Fault::TxLate(random.usize(2..len), [1, 16, 100, 1_000][random.usize(..4)])
}

fn signal(random: &mut Rng) -> Fault {
    let at = random.usize(..8);
    match random.u8(..4) {
        0 => Fault::RxLost(at),
        1 => Fault::RxTwice(at),
        2 => Fault::RxFlip(at, random.u8(..8)),
        _ => Fault::RxLate(at, [1, 16, 100, 1_000][random.usize(..4)]),
    }
}

/// Leaves out faults as long as the rest still fails.
pub fn shrink(schedule: &Schedule, fails: impl Fn(&Schedule) -> bool) -> Schedule {
    let mut least = schedule.clone();
    let mut at = 0;
    while at < least.0.len() {
        let mut fewer = least.clone();
        fewer.0.remove(at);
        if fails(&fewer) {
            least = fewer;
        } else {
            at += 1;
        }
    }
    least
}

#[test]
fn a_failing_schedule_shrinks_to_what_makes_it_fail() {
    let mut schedule = Schedule((0..30).map(Fault::Short).collect());
    schedule.0.insert(7, Fault::TxLost(5));
    schedule.0.insert(21, Fault::RxLost(1));
    let fails = |schedule: &Schedule| schedule.0.contains(&Fault::TxLost(5)) && schedule.0.contains(&Fault::RxLost(1));
    assert_eq!(shrink(&schedule, fails).0, [Fault::TxLost(5), Fault::RxLost(1)]);
}
