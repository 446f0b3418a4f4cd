/// `pocket_engagement`.
pub mod pocket_engagement {
    use super::*;
    #[unsafe(link_section = ".recorded_run")]
    static TEXT: [u8; include_bytes!("pocket_engagement.nc").len()] = *include_bytes!("pocket_engagement.nc");
    /// Adapted program of the run.
    pub const PROGRAM: &[u8] = &TEXT;
    /// The job, its rules still to be added.
    pub const fn job() -> Job {
        Job { unit: Mm, ceiling: FeedCeiling { max_feed: Some(MmPerMin(6000.0)), max_raise_ratio: 2.0 }, tools: Tools::one(ToolSetup {
            tool: Tool::EndMill(EndMill { radius: Nm(5000000), teeth: 4 }), number: Some(1), axis: ToolAxis::Z, spindle: RevPerMin(8000.0),
            speed_source: SpeedSource::Program, law: LawKind::Engagement,
            feed_per_tooth: MmPerTooth(0.06), follows_program: false }),
            policy: SafeBase, limits: OverrideLimits { min_percent: 10, max_percent: 200, step_percent: 1, slew_up_percent_per_s: 50.0, slew_down_percent_per_s: 200.0 }, machine: MachineLimits { linear: [None, None, None], rotary: [None, None, None], arc_clamp: None },
            rules: heapless::Vec::new(), knots: Knots::new() }
    }
    /// Adds its rules.
    #[inline(never)]
    pub fn add_rules(job: &mut Job) {
        let _room = job.rules.push(CutRule { tool: 0, moves: Moves::Arcs(Ccw), work: Work::Mill { side: Inside, radial_depth: Nm(1000000) }, feed_per_tooth: None, table: None, sequence: Some((140, 200)), level: None });
        let _room = job.rules.push(CutRule { tool: 0, moves: Moves::Arcs(Cw), work: Work::Mill { side: Outside, radial_depth: Nm(1000000) }, feed_per_tooth: None, table: None, sequence: None, level: None });
        let _room = job.rules.push(CutRule { tool: 0, moves: Moves::Arcs(Ccw), work: Work::Mill { side: Slot, radial_depth: Nm(0) }, feed_per_tooth: Some(MmPerTooth(0.05)), table: None, sequence: Some((440, 440)), level: None });
        let _room = job.rules.push(CutRule { tool: 0, moves: Moves::Lines, work: Work::Mill { side: Inside, radial_depth: Nm(1000000) }, feed_per_tooth: None, table: None, sequence: Some((130, 210)), level: None });
    }
    /// The job with its rules, for stacks that have room for it.
    pub fn whole_job() -> Job {
        let mut job = job();
        add_rules(&mut job);
        job
    }
    #[unsafe(link_section = ".recorded_run")]
    static BLOCKS: [Block; 21] = [
        Block { first_tick: 0, rule: None, segment: Some(Segment { sequence: Some(100), start: Pose { linear: [Nm(0), Nm(0), Nm(0)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(0)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: Missing, path: Rapid }) },
        Block { first_tick: 396, rule: None, segment: Some(Segment { sequence: Some(110), start: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(0)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(2000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: Missing, path: Rapid }) },
        Block { first_tick: 508, rule: None, segment: Some(Segment { sequence: Some(120), start: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(2000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(500000000)), path: Line }) },
        Block { first_tick: 1354, rule: Some(3), segment: Some(Segment { sequence: Some(130), start: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(42000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Line }) },
        Block { first_tick: 2099, rule: Some(0), segment: Some(Segment { sequence: Some(140), start: Pose { linear: [Nm(42000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(45000000), Nm(-17000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(1966300000)), path: Arc(Arc { plane: Xy, turn: Ccw, center: [Nm(42000000), Nm(-17000000)], from: [Nm(0), Nm(-3000000)], to: [Nm(3000000), Nm(0)] }) }) },
        Block { first_tick: 2243, rule: Some(3), segment: Some(Segment { sequence: Some(150), start: Pose { linear: [Nm(45000000), Nm(-17000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(45000000), Nm(27000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Line }) },
        Block { first_tick: 3084, rule: Some(0), segment: Some(Segment { sequence: Some(160), start: Pose { linear: [Nm(45000000), Nm(27000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(42000000), Nm(30000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(1966300000)), path: Arc(Arc { plane: Xy, turn: Ccw, center: [Nm(42000000), Nm(27000000)], from: [Nm(3000000), Nm(0)], to: [Nm(0), Nm(3000000)] }) }) },
        Block { first_tick: 3228, rule: Some(3), segment: Some(Segment { sequence: Some(170), start: Pose { linear: [Nm(42000000), Nm(30000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(-42000000), Nm(30000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Line }) },
        Block { first_tick: 4819, rule: Some(0), segment: Some(Segment { sequence: Some(180), start: Pose { linear: [Nm(-42000000), Nm(30000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(-45000000), Nm(27000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(1966300000)), path: Arc(Arc { plane: Xy, turn: Ccw, center: [Nm(-42000000), Nm(27000000)], from: [Nm(0), Nm(3000000)], to: [Nm(-3000000), Nm(0)] }) }) },
        Block { first_tick: 4962, rule: Some(3), segment: Some(Segment { sequence: Some(190), start: Pose { linear: [Nm(-45000000), Nm(27000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(-45000000), Nm(-17000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Line }) },
        Block { first_tick: 5803, rule: Some(0), segment: Some(Segment { sequence: Some(200), start: Pose { linear: [Nm(-45000000), Nm(-17000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(-42000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(1966300000)), path: Arc(Arc { plane: Xy, turn: Ccw, center: [Nm(-42000000), Nm(-17000000)], from: [Nm(-3000000), Nm(0)], to: [Nm(0), Nm(-3000000)] }) }) },
        Block { first_tick: 5947, rule: Some(3), segment: Some(Segment { sequence: Some(210), start: Pose { linear: [Nm(-42000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Line }) },
        Block { first_tick: 6883, rule: None, segment: Some(Segment { sequence: Some(300), start: Pose { linear: [Nm(5000000), Nm(-20000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(0), Nm(-10000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Line }) },
        Block { first_tick: 7182, rule: Some(1), segment: Some(Segment { sequence: Some(310), start: Pose { linear: [Nm(0), Nm(-10000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(0), Nm(-10000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(3200000000)), path: Arc(Arc { plane: Xy, turn: Cw, center: [Nm(0), Nm(5000000)], from: [Nm(0), Nm(-15000000)], to: [Nm(0), Nm(-15000000)] }) }) },
        Block { first_tick: 9036, rule: None, segment: Some(Segment { sequence: Some(400), start: Pose { linear: [Nm(0), Nm(-10000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(0), Nm(-10000000), Nm(10000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: Missing, path: Rapid }) },
        Block { first_tick: 9363, rule: None, segment: Some(Segment { sequence: Some(410), start: Pose { linear: [Nm(0), Nm(-10000000), Nm(10000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(100000000), Nm(0), Nm(10000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: Missing, path: Rapid }) },
        Block { first_tick: 10245, rule: None, segment: Some(Segment { sequence: Some(420), start: Pose { linear: [Nm(100000000), Nm(0), Nm(10000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(100000000), Nm(0), Nm(2000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: Missing, path: Rapid }) },
        Block { first_tick: 10473, rule: None, segment: Some(Segment { sequence: Some(430), start: Pose { linear: [Nm(100000000), Nm(0), Nm(2000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(100000000), Nm(0), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(500000000)), path: Line }) },
        Block { first_tick: 11315, rule: Some(2), segment: Some(Segment { sequence: Some(440), start: Pose { linear: [Nm(100000000), Nm(0), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(125000000), Nm(25000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: PerMinute(Nm(1600000000)), path: Arc(Arc { plane: Xy, turn: Ccw, center: [Nm(100000000), Nm(25000000)], from: [Nm(0), Nm(-25000000)], to: [Nm(25000000), Nm(0)] }) }) },
        Block { first_tick: 12822, rule: None, segment: Some(Segment { sequence: Some(500), start: Pose { linear: [Nm(125000000), Nm(25000000), Nm(-5000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, end: Pose { linear: [Nm(125000000), Nm(25000000), Nm(50000000)], rotary: [MicroDeg(0), MicroDeg(0), MicroDeg(0)] }, feed: Missing, path: Rapid }) },
        Block { first_tick: 13475, rule: None, segment: None },
    ];
    #[unsafe(link_section = ".recorded_run")]
    static TICKS: [u8; 80862] = *include_bytes!("pocket_engagement.bin");
    /// Its run.
    pub const EXAMPLE: Example = Example { blocks: &BLOCKS, ticks: &TICKS };
}
