//! Programs to send: short, of every kind of block that the simulated control takes from its line.

use arcfeed::dnc::restored_state::PowerOn;
use arcfeed::dnc::transmission::{Transmission, Wire};
use arcfeed_control::ControlSettings;
use arcfeed_control::code::{TapeCode, with_even_parity};
use arcfeed_control::line::{LineSettings, SenderParity};
use arcfeed_control::tape::TapeSettings;
use arcfeed_nc::block::Reading;
use arcfeed_nc::settings::{Preset, Settings, Tables};
use arcfeed_units::{LengthUnit, Micros, Nm};
use fastrand::Rng;

/// Check of received characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Check {
    /// Nothing.
    None,
    /// Even parity, as on every line of seven bits.
    Parity,
    /// Parity, and an even number of characters in every block.
    ParityAndTv,
}

/// A program of random moves that a control executes in a few seconds, also where one of its characters is another.
pub fn random(rng: &mut Rng, blocks: usize) -> String {
    of_kinds(rng, blocks, 8)
}

/// The same among cycles, work offsets, tool lengths and G52; there a corrupted feed may take an hour.
pub fn random_with_offsets(rng: &mut Rng, blocks: usize) -> String {
    of_kinds(rng, blocks, 11)
}

fn of_kinds(random: &mut Rng, blocks: usize, kinds: u8) -> String {
    let mut text = String::from("%\nO1\nG21G90G94G17\nT3M6\nS2000M3\nG0X0Y0Z5.\nM8\nG1Z-1.F3000.\n");
    let mut x = 0;
    for block in 0..blocks {
        x += random.i64(1..40);
        let place = format!("{}.{}", x / 10, x % 10);
        text += &match random.u8(..kinds) {
            0 => format!("N{}G1X{place}Y{}.F{}.\n", 10 * block + 10, random.u8(..9), 1_000 + 100 * random.u32(..30)),
            1 => format!("X{place}\n"),
            2 => format!("G0Z5.\nX{place}\nG1Z-1.\n"),
            3 => format!("G3X{place}Y0R50.\nG1\n"),
            4 => "(A COMMENT)\n".into(),
            5 => format!("G91\nY1.\nY-1.\nG90X{place}\n"),
            6 => format!("G93G1X{place}F{}.\nG94F2000.\n", 100 + random.u32(..200)),
            7 => format!("G4P{}\nM9\nX{place}\nM8\n", random.u8(1..30)),
            8 => format!("G0Z5.\nG81X{place}Z-{}.R2.F2000.\nY1.\nG80\nG1Z-1.F3000.\n", random.u8(1..4)),
            9 => format!("G0Z5.\nG5{}\nG0X{place}Y1.\nG1Z-1.\n", random.u8(4..7)),
            _ => format!("G0Z5.\nG43H{}\nG0Z6.\nG52X{}.\nX{place}\nG1Z-1.\n", random.u8(1..3), random.u8(..3)),
        };
    }
    text + "G0Z5.\nM30\n%\n"
}

/// A text on the wire.
pub fn wire(check: Check) -> Wire {
    let iso: fn(u8) -> Option<u8> = |byte| byte.is_ascii().then(|| with_even_parity(byte));
    let ascii: fn(u8) -> Option<u8> = |byte| byte.is_ascii().then_some(byte);
    Wire {
        encode: if check == Check::None { ascii } else { iso },
        filters: false,
        tv_check: check == Check::ParityAndTv,
    }
}

/// Offsets that no program of ours writes, and none is another's.
fn tables() -> Tables {
    let mut tables = Tables::default();
    for (index, system) in tables.systems.iter_mut().take(6).enumerate() {
        system.linear = [10.0, -20.0, 3.0].map(|mm| Nm::from_mm(mm * index as f64));
    }
    for (index, [geometry, _]) in tables.lengths.iter_mut().take(3).enumerate() {
        *geometry = Nm::from_mm(40.0 + index as f64);
    }
    tables
}

/// The control that these programs are for, as the interpreter has it.
pub fn power_on() -> PowerOn {
    let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
    PowerOn { settings, tables: tables() }
}

pub fn transmission(text: &str, check: Check) -> Transmission {
    let source = |at: usize| 1 + text.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
    Transmission::new(text.as_bytes(), source, &wire(check)).unwrap_or_else(|refusals| panic!("{refusals:?}\n{text}"))
}

/// A control that checks so, with a buffer small enough to fill.
pub fn control(check: Check, baudrate: u32) -> ControlSettings {
    let settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    let code = if check == Check::None { TapeCode::Ascii } else { TapeCode::Iso };
    let tape = TapeSettings { code: Some(code), tv_check: check == Check::ParityAndTv, ..settings.line.tape };
    let line = LineSettings {
        baudrate,
        sender: SenderParity::None,
        buffer: 192,
        xoff_below: 48,
        xon_above: 144,
        tape,
        ..settings.line
    };
    ControlSettings { line, tables: tables(), operator_restart: Some(Micros::from_ms(50)), ..settings }
}

/// The blocks that a control must execute; the program number, which does nothing, apart.
pub fn blocks(sent: &Transmission) -> Vec<Vec<u8>> {
    let lines = (1..sent.lines().len()).filter(|index| sent.is_block(*index));
    let texts = lines.map(|index| sent.line_text(index).unwrap_or_default());
    of_code(texts.map(|text| text.strip_suffix(b"\n").unwrap_or(text).to_vec()))
}

/// The blocks without the program number.
pub fn of_code(blocks: impl Iterator<Item = Vec<u8>>) -> Vec<Vec<u8>> {
    blocks.filter(|block| !block.starts_with(b"O")).collect()
}
