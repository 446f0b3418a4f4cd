//! Draws the screen.

use arcfeed_units::LengthUnit;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph, Sparkline};

use super::view::{Command, View};
use crate::dnc::State;

/// Width of the figures beside the program.
const FIGURES: u16 = 36;
/// Least size; below it only keys and state are shown.
const SIZE_MIN: (u16, u16) = (64, 14);
/// Upper end of the strip, %; larger values are cut off.
const STRIP_TOP: u64 = 200;
/// Most rows of a note.
const NOTE_ROWS: usize = 3;

/// Draws the view.
pub fn render(frame: &mut Frame<'_>, view: &View) {
    if frame.area().width < SIZE_MIN.0 || frame.area().height < SIZE_MIN.1 {
        let small = format!("too small: {} x {} characters at least", SIZE_MIN.0, SIZE_MIN.1);
        let lines = vec![keys_line(view), Line::raw(view.words()), Line::raw(small)];
        return frame.render_widget(Paragraph::new(lines), frame.area());
    }
    let words_of_note = note(view, usize::from(frame.area().width));
    let note_rows = words_of_note.len() as u16;
    let [one, strip] = [1, 4].map(Constraint::Length);
    let rows = [one, Constraint::Min(3), strip, one, one, Constraint::Length(note_rows), one];
    let [head, middle, strip, state, alarm, note, keys] = Layout::vertical(rows).areas(frame.area());
    let [program, figures] = Layout::horizontal([Constraint::Min(20), Constraint::Length(FIGURES)]).areas(middle);
    frame.render_widget(bold(format!(" {}", view.title)), head);
    draw_program(frame, program, view);
    draw_figures(frame, figures, view);
    draw_strip(frame, strip, view);
    let style = if view.state == State::Held { Style::new().fg(Color::Yellow) } else { Style::new() };
    frame.render_widget(Line::styled(format!(" {}", view.words()), style.add_modifier(Modifier::BOLD)), state);
    let (words, colour) = match &view.machine.alarm {
        Some(words) => (format!(" ALARM {words}{}", place(view)), Color::Red),
        None if view.executed.is_some() && !view.is_least => (format!(" no alarm{}", place(view)), Color::Reset),
        None => (" alarms: look at the control, its line does not report them".into(), Color::Reset),
    };
    frame.render_widget(Line::styled(words, Style::new().fg(colour)), alarm);
    frame.render_widget(Paragraph::new(words_of_note), note);
    frame.render_widget(keys_line(view), keys);
}

/// Position and feed behind the alarm, if the machine reports them.
fn place(view: &View) -> String {
    let digits = if view.unit == LengthUnit::Inch { 4 } else { 3 };
    let position = view.position().map_or(String::new(), |[x, y, z]| {
        // Adding zero takes the sign off a zero.
        let [x, y, z] = [x, y, z].map(|at| libm::round(at * 1e4) / 1e4 + 0.0);
        format!("   X{x:.digits$} Y{y:.digits$} Z{z:.digits$}")
    });
    position + &view.feed().map_or(String::new(), |feed| format!("   F{feed:.1}"))
}

/// Warning, or note from before the start, wrapped to the width.
fn note(view: &View, width: usize) -> Vec<Line<'static>> {
    let style = if view.warning.is_some() { Style::new().fg(Color::Red) } else { Style::new().fg(Color::Yellow) };
    let mut rows: Vec<String> = Vec::new();
    for word in view.note().unwrap_or_default().split_whitespace() {
        match rows.last_mut().filter(|row| row.chars().count() + 1 + word.chars().count() < width) {
            Some(row) => *row += &format!(" {word}"),
            None => rows.push(format!(" {word}")),
        }
    }
    rows.into_iter().take(NOTE_ROWS).map(|row| Line::styled(row, style)).collect()
}

/// The keys, or the question that waits for one.
fn keys_line(view: &View) -> Line<'static> {
    let question = match view.question {
        None => return Line::raw(" space h: hold sending   r: resume   q Ctrl-C: abort"),
        Some(Command::Abort) => " ABORT after the block under way? y: yes, any other key: no",
        Some(Command::Resume) => " RESUME sending? The machine may move. y: yes, any other key: no",
        Some(Command::Hold) => " HOLD sending? y: yes, any other key: no",
    };
    Line::styled(question, Style::new().add_modifier(Modifier::REVERSED))
}

fn bold<'a>(text: String) -> Line<'a> {
    Line::styled(text, Style::new().add_modifier(Modifier::BOLD))
}

/// Draws the lines around the executed one.
fn draw_program(frame: &mut Frame<'_>, area: Rect, view: &View) {
    let title = match view.executed {
        Some(_) if view.is_least => " > executed, by reports: at least   * sent ",
        Some(_) => " > executed block   * sent ",
        None => " * sent; executed: unknown ",
    };
    let frame_around = Block::bordered().title(title);
    let inner = frame_around.inner(area);
    frame.render_widget(frame_around, area);
    let (height, all) = (usize::from(inner.height), &view.program.lines);
    let first = view.center().saturating_sub(height / 2).min(all.len().saturating_sub(height));
    let lines = all.iter().enumerate().skip(first).take(height).map(|(index, (source, text))| {
        let (mark, style) = if Some(index) == view.executed {
            ('>', Style::new().add_modifier(Modifier::REVERSED))
        } else if index == view.sent {
            ('*', Style::new().add_modifier(Modifier::BOLD))
        } else if index < view.sent {
            (' ', Style::new())
        } else {
            (' ', Style::new().add_modifier(Modifier::DIM))
        };
        let number = if *source == 0 { "ours".into() } else { source.to_string() };
        Line::styled(format!("{mark}{number:>6}  {text}"), style)
    });
    frame.render_widget(Paragraph::new(lines.collect::<Vec<_>>()), inner);
}

fn draw_figures(frame: &mut Frame<'_>, area: Rect, view: &View) {
    let (lamp, colour) = match (view.state, view.is_taken) {
        (_, None) => ("no DC1 yet", Color::Yellow),
        (State::Held, _) => ("held by us", Color::Yellow),
        (_, Some(true)) => ("DC1: it takes characters", Color::Green),
        (_, Some(false)) => ("DC3: it takes none", Color::Red),
    };
    let total = view.program.characters();
    let percent = 100 * view.characters / total.max(1);
    let or_unknown = |known: Option<String>| known.unwrap_or_else(|| "unknown".into());
    let machine = &view.machine;
    let mut lines = vec![Line::from(vec![Span::styled(" ● ", Style::new().fg(colour)), Span::raw(lamp)])];
    let most = if view.is_least { "at most " } else { "" };
    let at_least = if view.executed.is_some() { "about" } else { "at least" };
    lines.extend(
        [
            ("sent", format!("{} of {total}, {percent} %", view.characters)),
            ("at control", or_unknown(view.at_control().map(|chars| format!("{most}{chars} characters")))),
            ("stops", format!("{} times", view.xoffs)),
            ("damaged", or_unknown(view.damaged.map(|count| format!("{count} from the control")))),
            ("override", or_unknown(machine.override_percent.map(|percent| format!("{percent} %")))),
            ("chip", or_unknown(machine.chip_ratio.map(|ratio| format!("{:.1} % of target", 1e2 * ratio)))),
            ("elapsed", time(view.elapsed_s)),
            ("left", format!("{at_least} {}", time(view.left_s))),
        ]
        .map(|(name, value)| Line::raw(format!(" {name:<11}{value}"))),
    );
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(" line and machine ")), area);
}

fn draw_strip(frame: &mut Frame<'_>, area: Rect, view: &View) {
    let title = match (view.has_chips, view.strip.is_empty()) {
        (true, _) => " chip, % of the target: 0 to 200, empty where none is measured ",
        (false, false) => " override, %: 0 to 200 ",
        (false, true) => " override and chip: unknown ",
    };
    let shown = usize::from(area.width.saturating_sub(2));
    let latest = view.strip.iter().copied().skip(view.strip.len().saturating_sub(shown));
    let strip = Sparkline::default().data(latest.collect::<Vec<_>>()).max(STRIP_TOP);
    frame.render_widget(strip.block(Block::bordered().title(title)), area);
}

fn time(s: f64) -> String {
    let s = libm::round(s) as u64;
    if s < 3_600 {
        format!("{}:{:02}", s / 60, s % 60)
    } else {
        format!("{}:{:02}:{:02}", s / 3_600, s / 60 % 60, s % 60)
    }
}

#[cfg(test)]
mod tests {
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;
    use crate::dnc::transmission::{Transmission, Wire};
    use crate::port::Machine;
    use crate::screen::view::Listing;

    fn view() -> View {
        let moves: String = (1..=20).map(|n| format!("N{n}G1X{n}.F40.\n")).collect();
        let text = format!("%\nO1(PART)\n{moves}M30\n%\n");
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let line = |offset: usize| 1 + text.as_bytes()[..offset].iter().filter(|byte| **byte == b'\n').count();
        let sending = Transmission::new(text.as_bytes(), line, &wire).unwrap();
        let times_s = vec![5.0; sending.lines().len()];
        View::new("part.nc to COM3".into(), Listing::new(&sending, &times_s), 100.0)
    }

    fn picture(view: &View, width: u16, height: u16) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| render(frame, view)).unwrap();
        let buffer = terminal.backend().buffer();
        let row = |y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
        (0..height).map(row).collect()
    }

    #[test]
    fn a_control_that_reports_is_shown_around_what_it_executes() {
        let mut view = view();
        (view.executed, view.sent, view.characters, view.is_taken) = (Some(9), 16, 210, Some(false));
        (view.state, view.xoffs, view.elapsed_s, view.left_s) = (State::Stopped, 3, 61.4, 75.0);
        view.machine = Machine { override_percent: Some(112), chip_ratio: Some(0.993), ..Machine::default() };
        (view.machine.position_mm, view.machine.feed_mm_per_min) = (Some([12.5, -1e-9, -3.0]), Some(412.0));
        (view.strip, view.has_chips) = ([0, 50, 99, 99, 150, 200].into(), true);
        let shown = picture(&view, 72, 20);
        let wanted = include_str!("golden.txt");
        assert_eq!(shown.join("\n") + "\n", wanted, "{}", shown.join("\n"));
    }

    #[test]
    fn unknown_values_are_shown_as_unknown() {
        let mut view = view();
        (view.sent, view.characters, view.is_taken, view.state) = (4, 40, Some(true), State::Held);
        let shown = picture(&view, 72, 20).join("\n");
        for words in [
            "executed: unknown",
            "*     5  N3G1X3.F40.",
            "HELD: sending stopped, the axes NOT",
            "held by us",
            "at least 2:00",
        ] {
            assert!(shown.contains(words), "{words}:\n{shown}");
        }
        assert!(shown.contains("its line does not report") && !shown.contains('>'), "{shown}");
    }

    #[test]
    fn a_question_takes_the_place_of_the_keys_and_an_alarm_is_in_words() {
        let mut view = view();
        view.question = Some(Command::Abort);
        view.machine.alarm = Some("line 3: PS0010 improper G code".into());
        let shown = picture(&view, 72, 20);
        assert!(shown[19].contains("ABORT after the block under way? y: yes"), "{shown:?}");
        assert!(shown[18].contains("ALARM line 3: PS0010"), "{shown:?}");
    }

    #[test]
    fn a_warning_is_shown_in_the_place_of_the_notes_and_takes_three_rows_at_most() {
        let mut view = view();
        (view.notes, view.damaged) = (vec!["note: the line is slow".into()], Some(0));
        let shown = picture(&view, 72, 20);
        assert!(shown[18].contains("note: the line is slow") && shown[6].contains("damaged    0 from"), "{shown:?}");
        (view.warning, view.damaged) = (Some(format!("warning: {}", "damaged characters ".repeat(20))), Some(7));
        let shown = picture(&view, 72, 20);
        assert!(shown[16].contains("warning: damaged") && shown[18].contains("damaged"), "{shown:?}");
        assert!(shown[19].contains("h: hold sending") && !shown.join("").contains("note: the line"), "{shown:?}");
        assert!(shown[6].contains("damaged    7 from the control"), "{shown:?}");
    }

    #[test]
    fn no_terminal_is_too_small() {
        for (width, height) in [(1, 1), (10, 3), (20, 8), (34, 2)] {
            let shown = picture(&view(), width, height);
            assert!(" space h: hold".starts_with(&shown[0][..shown[0].len().min(14)]), "{shown:?}");
        }
    }
}
