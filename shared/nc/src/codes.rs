//! Effect of G words on the modal state.

use super::address::check_sign;
use super::alarm::{Alarm, Fault, NotModelled};
use super::frame::CoordinateRotation;
use super::modal::{CompensationSide, Cycle, FeedMode, Modal, MotionKind, Plane, Polar};
use super::settings::ArcCenters;
use super::word::Word;
use arcfeed_units::{LengthUnit, MicroDeg, Nm};

/// One-shot G codes: effective only in their block, whose axis words are not a move along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum OneShot {
    /// No such code.
    #[default]
    No,
    /// G4.
    Dwell,
    /// G8.
    LookAhead,
    /// G10.
    Data,
    /// G28, G30.
    Reference(u8),
    /// G68.2 to G68.4: recorded, not modelled; G22 and G23: without effect.
    Tracked,
    /// G50.1.
    MirrorOff,
    /// G51.
    Scale,
    /// G51.1.
    Mirror,
    /// G52.
    Local,
    /// G53.
    Machine,
    /// G54.1.
    AdditionalSystem,
    /// G5.
    HighSpeed,
    /// G5.1.
    Smoothing,
    /// G68.
    Rotate,
    /// G92.
    Preset,
    /// G92.1.
    PresetBack,
}

impl Modal {
    /// Applies one G word.
    pub(super) fn apply_g(&mut self, word: &Word) -> Result<OneShot, Fault> {
        check_sign(word)?;
        let improper = Fault::alarm(Alarm::ImproperGCode, word.column);
        let tenths = word.number.as_tenths().ok_or(improper)?;
        match tenths {
            170 => self.set_plane(Plane::Xy, word)?,
            180 => self.set_plane(Plane::Zx, word)?,
            190 => self.set_plane(Plane::Yz, word)?,
            200 => self.unit = LengthUnit::Inch,
            210 => self.unit = LengthUnit::Mm,
            900 => self.absolute = true,
            910 => self.absolute = false,
            930 => self.set_feed_mode(FeedMode::InverseTime),
            940 => self.set_feed_mode(FeedMode::PerMinute),
            950 => self.set_feed_mode(FeedMode::PerRevolution),
            730 | 740 | 760 | 810..=870 | 890 if tenths % 10 == 0 => self.set_cycle((tenths / 10) as u8),
            800 => self.cycle = None,
            980 => self.returns_to_r = false,
            990 => self.returns_to_r = true,
            540..=590 if tenths % 10 == 0 => self.system = ((tenths - 540) / 10) as u16,
            // Exact stop, corner override, tapping and cutting mode, end of data input, the end of polar interpolation
            // and of a modal call, which begin nowhere here, and S in rev/min do not change the path.
            90 | 110 | 131 | 670 | 970 => {}
            610..=640 if tenths % 10 == 0 => {}
            _ => return self.apply_rarer_g(tenths, word).ok_or(improper)?,
        }
        Ok(OneShot::No)
    }

    /// `None` for codes that the control does not have.
    fn apply_rarer_g(&mut self, tenths: i64, word: &Word) -> Option<Result<OneShot, Fault>> {
        let mut one_shot = OneShot::No;
        match tenths {
            40 => one_shot = OneShot::Dwell,
            50 => one_shot = OneShot::HighSpeed,
            51 => one_shot = OneShot::Smoothing,
            80 => one_shot = OneShot::LookAhead,
            100 => one_shot = OneShot::Data,
            150 => self.polar = None,
            160 => self.polar = Some(self.polar_position()),
            // The axis words of stored stroke limits are no move.
            220 | 230 => one_shot = OneShot::Tracked,
            280 | 300 => one_shot = OneShot::Reference((tenths / 10) as u8),
            400 => self.compensate(None),
            410 => self.compensate(Some(CompensationSide::Left)),
            420 => self.compensate(Some(CompensationSide::Right)),
            430 | 440 | 434 | 490 => {
                self.follows_tool_center = tenths == 434;
                self.length_sign = match tenths {
                    490 => 0,
                    440 => -1,
                    _ => 1,
                };
            }
            500 => self.end_scaling(510),
            510 => one_shot = OneShot::Scale,
            501 => one_shot = OneShot::MirrorOff,
            511 => one_shot = OneShot::Mirror,
            682..=684 => {
                self.unmodelled = tenths as u16;
                one_shot = OneShot::Tracked;
            }
            520 => one_shot = OneShot::Local,
            530 => one_shot = OneShot::Machine,
            541 => one_shot = OneShot::AdditionalSystem,
            680 => one_shot = OneShot::Rotate,
            690 => {
                self.unmodelled = 0;
                self.rotate(None::<CoordinateRotation>);
            }
            901 | 911 if self.arc_centers != ArcCenters::FromStart => {
                self.arc_centers = if tenths == 901 { ArcCenters::Absolute } else { ArcCenters::Incremental };
            }
            920 => one_shot = OneShot::Preset,
            921 => one_shot = OneShot::PresetBack,
            _ if is_fanuc_g(tenths) => {
                let code = u16::try_from(tenths).ok()?;
                return Some(Err(Fault::not_modelled(NotModelled::GCode(code), word.column)));
            }
            _ => return None,
        }
        Some(Ok(one_shot))
    }

    #[inline]
    pub(super) fn set_motion(&mut self, kind: MotionKind) {
        self.motion = kind;
        self.cycle = None;
    }

    fn compensate(&mut self, side: Option<CompensationSide>) {
        self.starts_up ^= self.compensation.is_some() != side.is_some();
        self.compensation = side;
    }

    fn set_plane(&mut self, plane: Plane, word: &Word) -> Result<(), Fault> {
        if plane != self.plane && self.compensation.is_some() {
            return Err(Fault::alarm(Alarm::PlaneUnderCompensation, word.column));
        }
        self.plane = plane;
        Ok(())
    }

    fn set_feed_mode(&mut self, mode: FeedMode) {
        if mode != self.feed_mode {
            self.feed = None;
        }
        self.feed_mode = mode;
    }

    /// The initial level is that of the first cycle since G80.
    fn set_cycle(&mut self, code: u8) {
        let (.., normal) = self.plane.axes();
        let level = self.position.linear.get(normal).copied().unwrap_or(Nm(0));
        let cycle = self.cycle.unwrap_or(Cycle { initial: level, ..Cycle::default() });
        self.cycle = Some(Cycle { code, ..cycle });
    }

    fn polar_position(&self) -> Polar {
        let (first, second, _) = self.plane.axes();
        let at = |index: usize| self.program.linear.get(index).map_or(0.0, |axis| axis.0 as f64);
        let (x, y) = (at(first), at(second));
        let degrees = libm::atan2(y, x).to_degrees();
        Polar {
            radius: Nm(libm::round(libm::hypot(x, y)) as i64),
            pole: [Nm(0); 2],
            angle: MicroDeg::from_deg(degrees),
        }
    }
}

/// Whether a 16i/30i milling control has this G code (in tenths); any other code is PS0010.
fn is_fanuc_g(tenths: i64) -> bool {
    let whole = tenths / 10;
    match tenths % 10 {
        0 => matches!(whole, 0..=5 | 7..=11 | 15..=23 | 25..=33 | 37..=69 | 73..=76 | 80..=99),
        _ => matches!(
            tenths,
            51 | 54 | 61 | 62 | 71 | 121 | 131 | 401..=406 | 411..=416 | 421..=426 | 431 | 434 | 435 | 501 | 511 | 531 | 536
                | 541 | 542 | 544 | 682..=684 | 691 | 921
        ),
    }
}
