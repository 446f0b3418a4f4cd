//! Feeds that hold although a board is lost, against a machine that goes on.

use arcfeed::adapt::held_feeds::{SentMove, held};
use arcfeed_law::table::Table;
use arcfeed_law::{FeedLaw, Place};
use arcfeed_model::knots::Knot;
use arcfeed_units::{Mm, MmPerTooth};
use fastrand::Rng;

const TEETH_PER_S: f64 = 40.0;

fn feed_mm_per_s(table: &Table, at_mm: f64) -> f64 {
    let place = Place { center_mm: [0.0; 2], motion: [0.0; 2], towards: [0.0; 2], travelled_mm: at_mm as f32 };
    f64::from(table.demand(&place).expect("a demand").path_mm_per_tooth) * TEETH_PER_S
}

/// Feeds from 1 mm/s up to `most` mm/s, in equal parts of 30 mm.
fn law(random: &mut Rng, most: f64) -> Table {
    let (parts, mut feed) = (random.usize(1..=31), 1.0);
    let knot = |at: usize| -> Knot {
        if random.u8(..5) == 0 {
            feed = 1.0 + (most - 1.0) * random.f64() * f64::from(random.u8(..2));
        }
        (Mm(30.0 * at as f32 / parts as f32), MmPerTooth((feed / TEETH_PER_S) as f32))
    };
    Table::new(&(0..=parts).map(knot).collect::<Vec<_>>()).expect("a table")
}

#[test]
fn wherever_the_board_is_lost_the_feed_stays_below_that_of_the_law() {
    let mut random = Rng::with_seed(26);
    let (mut raised, mut places) = (0, 0);
    for _ in 0..400 {
        let (most, slew) = (1.0 + 3.0 * random.f64(), 20.0 + 400.0 * random.f64());
        let law = law(&mut random, most);
        let sent = SentMove {
            feed_mm_per_min: 60.0 * (1.0 - 1e-6),
            feed_max_mm_per_min: 60.0 * most,
            teeth_per_min: TEETH_PER_S * 60.0,
            length_mm: 30.0,
            slew_percent_per_s: slew,
        };
        let held = held(&law, &sent).expect("a table");
        for lost_mm in (0..300).map(|at| f64::from(at) * 0.1) {
            let (mut at_mm, mut feed) = (lost_mm, feed_mm_per_s(&held, lost_mm).min(most));
            raised += i32::from(feed > 1.01);
            places += 1;
            // The machine goes on: the override holds, then falls.
            for step in 0.. {
                assert!(
                    at_mm >= 30.0 || feed <= feed_mm_per_s(&law, at_mm) * (1.0 + 1e-6),
                    "{lost_mm}: {at_mm} {feed}"
                );
                if feed <= 1.0 {
                    break;
                }
                assert!(at_mm < 30.0, "{lost_mm}: {feed} behind the end");
                at_mm += feed * 1e-3;
                if step >= 330 {
                    feed = (feed - slew / 100.0 * 1e-3).max(1.0);
                }
            }
        }
    }
    println!("{raised} of {places} places above the sent feed");
    assert!(raised > places / 20, "{raised} of {places}");
}
