//! `arcfeed board`: identification, settings, log and reports of a feed board.

mod connection;

#[cfg(feature = "board-log")]
mod log;

mod monitor;

use std::path::PathBuf;

use serde::Serialize;

use arcfeed_link::message::codes::SettingCode;
use arcfeed_link::message::{Message, table};

use super::outcome::{Failure, say};
use crate::board::line::BAUDRATE;
use crate::board::words;
#[cfg(not(feature = "board-log"))]
use crate::features::not_built_in;
use crate::port::url::PortUrl;
use connection::BoardConnection;
use monitor::Monitor;

/// Talk to a feed board: identification, settings, log, reports
///
/// Only one host at a time: a board discards the data of a run when another host connects.
#[derive(Debug, clap::Args)]
pub struct BoardCommand {
    /// The board link: a serial port's name or one of pyserial's URLs (docs/ports.md)
    url: PortUrl,
    /// Rate of the link; 8N1, no flow control
    #[arg(long, default_value_t = BAUDRATE)]
    baudrate: u32,
    #[command(subcommand)]
    what: BoardAction,
}

#[derive(Debug, clap::Subcommand)]
enum BoardAction {
    /// Identification of the board, and the state of its link
    Info {
        /// Print one JSON object (docs/json.md)
        #[arg(long)]
        json: bool,
    },
    /// Change a setting, or list all
    Set {
        /// The setting's name, as listed
        #[arg(requires = "value")]
        name: Option<String>,
        /// Value, in the unit listed
        value: Option<u32>,
    },
    /// Print the board's log as it comes, until Ctrl-C
    Log {
        /// Image that runs on the board, as built: it contains the texts of the messages
        #[arg(long, value_name = "FILE")]
        elf: PathBuf,
    },
    Monitor(Monitor),
}

#[derive(Debug, Serialize)]
struct Info {
    name: String,
    version: String,
    reset: &'static str,
    starts: u32,
    capacity: u16,
    parameter_set: Option<u32>,
    round_trip_us: u32,
    clock_uncertainty_us: Option<u32>,
    clock_drift_ppb: Option<i32>,
    crc_errors: u32,
    retransmissions: u32,
}

impl BoardCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// The board does not answer, or refuses.
    pub fn run(&self) -> Result<(), Failure> {
        match &self.what {
            BoardAction::Info { json } => self.with_connection(|connection| info(connection, *json)),
            BoardAction::Set { name: Some(name), value: Some(value) } => {
                self.with_connection(|connection| set(connection, name, *value))
            }
            BoardAction::Set { .. } => self.with_connection(list),
            #[cfg(feature = "board-log")]
            BoardAction::Log { elf } => self.with_connection(|connection| log::run(elf, connection)),
            #[cfg(not(feature = "board-log"))]
            BoardAction::Log { .. } => Err(Failure::Usage(not_built_in("the decoder of a board's log", "board-log"))),
            BoardAction::Monitor(monitor) => self.with_connection(|connection| monitor.run(connection)),
        }
    }

    /// Connects to the board, runs a command with it and disconnects.
    fn with_connection(
        &self,
        command: impl FnOnce(&mut BoardConnection) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut connection = BoardConnection::open(&self.url, self.baudrate)?;
        command(&mut connection)?;
        connection.close()
    }
}

fn info(connection: &mut BoardConnection, json: bool) -> Result<(), Failure> {
    let info = connection.ask(&table::AskInfo {}.into(), |message| match message {
        Message::Info(info) => Some(info),
        _ => None,
    })?;
    connection.measure_round_trip()?;
    let [major, minor, patch] = info.version;
    let (link, now) = (connection.line().link(), connection.line().now());
    let shown = Info {
        name: String::from_utf8_lossy(info.name.bytes()).into_owned(),
        version: format!("{major}.{minor}.{patch}"),
        reset: words::reset(info.reset),
        starts: info.starts,
        capacity: info.capacity,
        parameter_set: Some(info.set).filter(|set| *set != 0),
        round_trip_us: link.counters().srtt.0,
        clock_uncertainty_us: link.clock().uncertainty(now).map(|span| span.0),
        clock_drift_ppb: link.clock().drift_ppb(),
        crc_errors: link.counters().crc_errors,
        retransmissions: link.counters().retransmissions,
    };
    if json {
        let object = serde_json::to_string(&shown).map_err(|error| Failure::Input(error.to_string()))?;
        say(format_args!("{object}"));
        return Ok(());
    }
    say(format_args!("{} {}", shown.name, shown.version));
    say(format_args!("started {} times, last by {}", shown.starts, shown.reset));
    say(format_args!("holds {} segments ahead", shown.capacity));
    match shown.parameter_set {
        Some(set) => say(format_args!("parameter set {set} in force")),
        None => say(format_args!("no parameters in force")),
    }
    let clock = shown.clock_uncertainty_us.map_or("clock not compared yet".into(), |us| format!("clocks to {us} us"));
    say(format_args!(
        "link: round trip {:.1} ms, {clock}, {} bad frames, {} sent again",
        f64::from(shown.round_trip_us) / 1e3,
        shown.crc_errors,
        shown.retransmissions
    ));
    Ok(())
}

fn list(connection: &mut BoardConnection) -> Result<(), Failure> {
    for setting in SettingCode::ALL {
        let value = connection.ask(&table::AskSetting { setting: *setting }.into(), |message| match message {
            Message::Setting(reported) if reported.setting == *setting => Some(reported.value),
            _ => None,
        })?;
        let (name, unit) = words::setting(*setting);
        say(format_args!("{name:<16}{value:>10} {unit}"));
    }
    Ok(())
}

fn set(connection: &mut BoardConnection, name: &str, value: u32) -> Result<(), Failure> {
    let named = SettingCode::ALL.iter().find(|setting| words::setting(**setting).0 == name);
    let Some(setting) = named else {
        let names: Vec<&str> = SettingCode::ALL.iter().map(|setting| words::setting(*setting).0).collect();
        return Err(Failure::Usage(format!("`{name}` is no setting of a board; there are {}", names.join(", "))));
    };
    let reported = connection.ask(&table::SetSetting { setting: *setting, value }.into(), |message| match message {
        Message::Setting(reported) if reported.setting == *setting => Some(reported.value),
        _ => None,
    })?;
    say(format_args!("{name} is {reported} {}", words::setting(*setting).1));
    Ok(())
}
