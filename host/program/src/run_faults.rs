//! Collection of the faults found while a program is interpreted: each once for its place, reported in the main
//! program's file.

use std::collections::BTreeSet;

use arcfeed_nc::alarm::Fault;
use arcfeed_nc::block::Reading;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::settings::Settings;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_nc_macro::step::PlainBlock;

use super::Diagnostic;
use super::contour_check::{ContourCheck, ContourFinding};
use super::library::Folder;

/// Most places for which faults are reported.
const FAULTS_MAX: usize = 200;

/// Collector of the faults found while a program is interpreted, each with its place.
pub struct RunFaults<'a> {
    /// Lines of the main program's file.
    pub texts: Vec<&'a [u8]>,
    /// Folder of the called programs; `None` without one.
    pub folder: Option<&'a Folder>,
    /// Errors and warnings in the order in which they were found.
    pub list: Vec<Diagnostic>,
    contours: ContourCheck<usize>,
    reported: BTreeSet<(Option<u32>, u32, u16)>,
}

impl<'a> RunFaults<'a> {
    /// Collector without faults, for a control with these settings; `texts` are the files of the program.
    pub fn new(texts: Vec<&'a [u8]>, folder: Option<&'a Folder>, settings: &Settings) -> Self {
        let (contours, reported) = (ContourCheck::new(settings), BTreeSet::new());
        RunFaults { texts, folder, list: Vec::new(), contours, reported }
    }

    /// Reads a block; adds its fault and returns `None` if it has one.
    pub fn read(&mut self, reader: &mut Reader, block: &PlainBlock, reading: Reading) -> Option<InterpretedLine> {
        match reader.read(&block.text) {
            Ok(understood) => {
                let line = in_main(block.place, &block.calls).line as usize;
                let of_contour = self.contours.add(&understood, reader, line);
                self.add_contour(of_contour);
                if understood.lacks_feed() && self.is_new(0, block.place) {
                    let text = self.text(block.place);
                    self.list.push(Diagnostic::of_missing_feed(block.place.line as usize, text, reading));
                }
                Some(understood)
            }
            Err(fault) => {
                self.stop_contour();
                self.add(block.in_source(fault), block.place, &block.calls, b"");
                None
            }
        }
    }

    /// Ends the check of the present contour.
    pub fn stop_contour(&mut self) {
        let of_contour = self.contours.stop();
        self.add_contour(of_contour);
    }

    /// Adds a finding in a contour, at its line in the main program's file.
    fn add_contour(&mut self, finding: Option<ContourFinding<usize>>) {
        let Some(finding) = finding else { return };
        let text = |line: usize| self.texts.get(line.saturating_sub(1)).copied().unwrap_or_default();
        let diagnostic = finding.diagnostic(|line| (line.max(1), text(line)));
        let place = SourceLine { library: None, line: diagnostic.line as u32 };
        if self.is_new(diagnostic.column as u16, place) {
            self.list.push(diagnostic);
        }
    }

    fn is_new(&mut self, column: u16, place: SourceLine) -> bool {
        self.reported.len() < FAULTS_MAX && self.reported.insert((place.library, place.line, column))
    }

    fn text(&self, place: SourceLine) -> &'a [u8] {
        self.texts.get((place.line as usize).saturating_sub(1)).copied().unwrap_or_default()
    }

    /// Adds a fault. A fault in a program of the library is reported at the call in the main program's file that led to
    /// it.
    pub fn add(&mut self, fault: Fault, place: SourceLine, calls: &[SourceLine], message: &[u8]) {
        if !self.is_new(fault.column, place) {
            return;
        }
        let own = in_main(place, calls);
        let fault_in_main = if place.library.is_none() { fault } else { Fault { column: 0, ..fault } };
        let mut diagnostic = Diagnostic::of_fault((own.line as usize).max(1), self.text(own), fault_in_main);
        if !message.is_empty() {
            diagnostic.message = format!("{}: {}", diagnostic.message, message.escape_ascii());
        }
        if place.library.is_some() {
            let (file, column) = (file_of(self.folder, place), fault.column.max(1));
            diagnostic.message = format!("in {file}:{}:{column}: {}", place.line, diagnostic.message);
        } else if let Some(call) = calls.last() {
            diagnostic.message = format!("{} (called from line {})", diagnostic.message, call.line);
        }
        self.list.push(diagnostic);
    }
}

/// Line of the main program's file for a place: for a place in the library, the line of the call that led there.
pub fn in_main(place: SourceLine, calls: &[SourceLine]) -> SourceLine {
    let call = || calls.iter().rev().find(|call| call.library.is_none()).copied().unwrap_or_default();
    if place.library.is_none() { place } else { call() }
}

/// Name of the library's file that contains a line.
pub fn file_of(folder: Option<&Folder>, place: SourceLine) -> String {
    let number = place.library.unwrap_or_default();
    let file = folder.and_then(|folder| folder.file(number));
    file.map_or(format!("O{number}"), |path| path.display().to_string())
}
