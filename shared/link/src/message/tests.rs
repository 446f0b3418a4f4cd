//! Codecs against the schema: payloads built from what the document says, not by the codec; garbage.

use super::field::PAYLOAD_MAX;
use super::schema::{Entry, FieldType, Optional};
use super::*;
use crate::frame;
use arcfeed_model::cut::{ContourSide, CutRule, Moves, RotationCircle, Work};
use arcfeed_model::engaged::{EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, SpeedSource, ToolAxis, ToolSetup, Tools};
use arcfeed_model::knots::{KnotRange, Knots};
use arcfeed_model::machine::{ArcClamp, MachineLimits};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{CupMill, Edge, EndMill, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_units::{DegPerMin, LengthUnit, Mm, MmPerMin, MmPerTooth, Nm, RevPerMin};
use field::{CHUNK_MAX, Chunk, DecodeError, EncodeError};

/// xorshift64: reproducible without a dependency.
pub(super) struct Random(pub u64);

impl Random {
    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A random number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }
}

/// Bytes of a number type by its name; `None` for codes.
fn width(name: &str) -> Option<usize> {
    Some(match name {
        "u8" => 1,
        "u16" | "i16" => 2,
        "u32" => 4,
        "u64" | "i64" | "Q40" | "Q46" | "Q62" => 8,
        _ => return None,
    })
}

/// A valid field as the document describes it.
fn put_field(field: &FieldType, random: &mut Random, payload: &mut Vec<u8>) {
    if field.optional == Optional::Whole && !put_flag(random, payload) {
        return;
    }
    for _ in 0..field.count {
        if field.optional == Optional::Each && !put_flag(random, payload) {
            continue;
        }
        match (field.name, width(field.name)) {
            ("bool", _) => drop(put_flag(random, payload)),
            ("bytes", _) => (0..random.below(CHUNK_MAX + 1)).for_each(|_| payload.push(random.bits() as u8)),
            (_, Some(width)) => (0..width).for_each(|_| payload.push(random.bits() as u8)),
            (codes, None) => {
                let codes: Vec<u8> = codes.split(' ').filter_map(|word| word.parse().ok()).collect();
                payload.push(codes[random.below(codes.len())]);
            }
        }
    }
}

fn put_flag(random: &mut Random, payload: &mut Vec<u8>) -> bool {
    let flag = random.bits() & 1;
    payload.push(flag as u8);
    flag == 1
}

fn payload_of(entry: &Entry, random: &mut Random) -> Vec<u8> {
    let mut payload = Vec::new();
    entry.fields.iter().for_each(|field| put_field(&field.field_type, random, &mut payload));
    payload
}

pub(super) fn encoded(message: &Message) -> Vec<u8> {
    let mut buffer = [0xAA; PAYLOAD_MAX];
    let length = message.encode(&mut buffer).unwrap();
    buffer[..length].to_vec()
}

#[test]
fn what_the_schema_describes_decodes_and_encodes_to_the_same_bytes() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut longest = 0;
    for entry in SCHEMA {
        for _ in 0..2_000 {
            let payload = payload_of(entry, &mut random);
            let message = Message::decode(entry.kind, &payload).unwrap_or_else(|error| panic!("{entry:?}: {error:?}"));
            assert_eq!((message.kind(), encoded(&message)), (entry.kind, payload.clone()), "{}", entry.name);
            longest = longest.max(payload.len());
        }
    }
    println!("{} messages, longest payload {longest} bytes", SCHEMA.len());
    assert!(longest <= PAYLOAD_MAX && PAYLOAD_MAX <= frame::PAYLOAD_MAX);
}

#[test]
fn a_byte_too_few_or_too_many_is_refused() {
    let mut random = Random(7);
    for entry in SCHEMA.iter().filter(|entry| entry.fields.iter().all(|field| field.field_type.name != "bytes")) {
        for _ in 0..50 {
            let mut payload = payload_of(entry, &mut random);
            for short in 0..payload.len() {
                assert_eq!(Message::decode(entry.kind, &payload[..short]), Err(DecodeError::Short), "{}", entry.name);
            }
            payload.push(0);
            assert_eq!(Message::decode(entry.kind, &payload), Err(DecodeError::Long(1)), "{}", entry.name);
        }
    }
}

#[test]
fn kinds_and_names_are_distinguished() {
    for (at, entry) in SCHEMA.iter().enumerate() {
        for other in &SCHEMA[at + 1..] {
            assert!(entry.kind != other.kind && entry.name != other.name, "{} and {}", entry.name, other.name);
        }
    }
    for kind in (0..=255).filter(|kind| SCHEMA.iter().all(|entry| entry.kind != *kind)) {
        assert_eq!(Message::decode(kind, &[]), Err(DecodeError::Kind(kind)));
    }
}

#[test]
fn garbage_is_refused_or_is_what_it_says() {
    let mut random = Random(0xDEAD_BEEF);
    let (mut accepted, mut refused) = (0, 0);
    for _ in 0..400_000 {
        let entry = &SCHEMA[random.below(SCHEMA.len())];
        let mut payload = payload_of(entry, &mut random);
        match random.below(4) {
            0 => payload.truncate(random.below(payload.len() + 1)),
            1 => payload.extend((0..random.below(9)).map(|byte| byte as u8)),
            2 => payload = (0..random.below(200)).map(|_| random.bits() as u8).collect(),
            _ if payload.is_empty() => {}
            _ => {
                let at = random.below(payload.len());
                payload[at] ^= 1 << random.below(8);
            }
        }
        match Message::decode(entry.kind, &payload) {
            Ok(message) => {
                assert_eq!(encoded(&message), payload);
                accepted += 1;
            }
            Err(_) => refused += 1,
        }
    }
    println!("{accepted} accepted, {refused} refused");
    assert!(accepted > 50_000 && refused > 50_000);
}

#[test]
fn a_byte_that_is_no_code_is_refused_by_its_number() {
    let commit = Message::from(table::Request { what: codes::RequestCode::Arm, epoch: 7 });
    let mut payload = encoded(&commit);
    payload[0] = 2;
    assert_eq!(Message::decode(commit.kind(), &payload), Err(DecodeError::Code(2)));
    assert_eq!(commit.encode(&mut [0; 2]), Err(EncodeError::Room));
}

#[test]
fn a_text_longer_than_its_chunk_is_cut_and_an_encoded_one_refused() {
    assert_eq!(Chunk::of(&[7; CHUNK_MAX + 5]).bytes(), [7; CHUNK_MAX]);
    assert_eq!(Message::decode(0x44, &[7; CHUNK_MAX + 5]), Err(DecodeError::Long(5)));
}

fn setup(tool: Tool, law: LawKind) -> ToolSetup {
    ToolSetup::new(tool, RevPerMin(1_000.0), law, MmPerTooth(0.1016))
}

/// A mill and a ring, each with its rules.
pub(super) fn two_tool_job() -> Job {
    let (mut job, ring) = (mill_job(), ring_job());
    job.tools.first_mut().number = Some(12);
    let own =
        ToolSetup { number: Some(3), axis: ToolAxis::Y, speed_source: SpeedSource::Operator, ..*ring.tools.first() };
    job.tools.push(own).unwrap();
    job.rules.extend(ring.rules.into_iter().map(|rule| CutRule { tool: 1, ..rule }));
    job
}

pub(super) fn ring_job() -> Job {
    let (normal, offset_mm) = ([0.6, -0.8], 107.673_123);
    let line = |normal| StockLine { normal, offset_mm, rise_ratio: -0.031_25 };
    let corners = [[0.0, 0.0], [10.5, 0.25], [9.0, 7.0], [-1.0, 6.5]];
    let arcs = |from, to| EngagedInterval::from_degrees(from, to).unwrap();
    let knot = |at, from| EngagedKnot { travelled: Mm(at), outer: arcs(from, 120.5), inner: EngagedInterval::EMPTY };
    let stocks = [
        Stock::half_plane(line(normal)),
        Stock::everywhere(),
        Stock::polygon(&corners).unwrap(),
        Stock::Disc { center_mm: [3.25, -4.5], radius_mm: 100.125 },
        Stock::Engaged(EngagedTable::new(&[knot(0.0, 10.0), knot(2.5, 90.011), knot(7.1, -33.3)]).unwrap()),
    ];
    let rule = |(index, stock): (usize, Stock)| CutRule {
        tool: 0,
        moves: Moves::Rotations(
            if index % 2 == 0 { RotationCircle::Interior } else { RotationCircle::Exterior },
            Turn::Ccw,
        ),
        work: Work::Ring(if index % 3 == 0 { Edge::Outer } else { Edge::Inner }, stock),
        feed_per_tooth: (index == 1).then_some(MmPerTooth(0.0777)),
        table: None,
        sequence: (index == 2).then_some((-1, 152)),
        level: (index == 3).then_some((Nm(-703_580_000), Nm(-1))),
    };
    Job {
        unit: LengthUnit::Inch,
        tools: Tools::one(setup(
            Tool::CupMill(CupMill { outer_radius: Nm(128_576_070), inner_radius: Nm(112_701_324), active_teeth: 10 }),
            LawKind::EngagedArc { both_edges: true },
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::SafeBase,
        limits: OverrideLimits { min_percent: 12, slew_up_percent_per_s: 33.3, ..OverrideLimits::default() },
        machine: MachineLimits {
            linear: [Some(MmPerMin(12_000.0)), None, Some(MmPerMin(9_999.9))],
            rotary: [None, Some(DegPerMin(360.0)), None],
            arc_clamp: Some(ArcClamp { feed: MmPerMin(6_000.0), radius: Mm(5.0), floor: MmPerMin(100.0) }),
        },
        rules: stocks.into_iter().enumerate().map(rule).collect(),
        knots: Knots::new(),
    }
}

pub(super) fn mill_job() -> Job {
    let mut knots = Knots::new();
    let table = |feed| [(Mm(0.0), MmPerTooth(feed)), (Mm(10.0), MmPerTooth(2.0 * feed))];
    let ranges: [KnotRange; 2] = [0.05, 0.06].map(|feed| knots.add(&table(feed)).unwrap());
    let rule = |(side, range)| CutRule {
        tool: 0,
        moves: if side == ContourSide::Slot { Moves::Lines } else { Moves::Arcs(Turn::Cw) },
        work: Work::Mill { side, radial_depth: Nm(1_500_000) },
        feed_per_tooth: None,
        table: Some(range),
        sequence: None,
        level: None,
    };
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(setup(Tool::EndMill(EndMill { radius: Nm(6_000_000), teeth: 4 }), LawKind::Table)),
        policy: FeedPolicy::OverrideOnly,
        machine: MachineLimits::default(),
        rules: [(ContourSide::Slot, ranges[1]), (ContourSide::Inside, ranges[0])].into_iter().map(rule).collect(),
        knots,
        ..ring_job()
    }
}
