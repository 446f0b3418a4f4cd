//! The feed at the contact over random programs: contacts, axes and mills of any kind.

use arcfeed_plan::finish::contact::{Contact, Orientation};
use arcfeed_plan::finish::feed::ContactFeed;
use arcfeed_plan::finish::mill::FinishMill;
use arcfeed_plan::finish::passes::PassPoint;
use arcfeed_plan::vector::{Point, Vector};

fn random_vector(random: &mut fastrand::Rng) -> Vector {
    Vector::from_fn(|_, _| random.f64() - 0.5)
}

fn random_mill(random: &mut fastrand::Rng) -> FinishMill {
    let radius_mm = 0.5 + 10.0 * random.f64();
    let corner_radius_mm = radius_mm * if random.bool() { 1.0 } else { 0.05 + 0.9 * random.f64() };
    FinishMill { radius_mm, corner_radius_mm, length_mm: 20.0, neck_mm: vec![], holder_mm: vec![], teeth: 2 }
}

/// A point a little further than the last, with another normal and another axis: also rolls on one point, and moves of a micrometre.
fn next(random: &mut fastrand::Rng, mill: &FinishMill, last: &Contact) -> Option<PassPoint> {
    let way_mm = [0.0, 1e-3, 0.1, 1.0][random.usize(0..4)];
    let point = last.point + random_vector(random) * way_mm;
    let normal = last.normal + random_vector(random) * [0.0, 0.01, 0.3][random.usize(0..3)];
    let contact = Contact::new(point, &normal, &random_vector(random))?;
    let orientation = Orientation { tilt_rad: 1.5 * random.f64(), yaw_rad: 6.0 * random.f64() };
    Some(PassPoint { contact, location: mill.at(&contact, contact.axis(&orientation)) })
}

#[test]
fn neither_contact_nor_end_is_faster_than_its_bound_on_any_program() {
    let mut random = fastrand::Rng::with_seed(27);
    let (mut moves, mut raised, mut lowest_share) = (0, 0, f64::INFINITY);
    for _ in 0..2_000 {
        let mill = random_mill(&mut random);
        let (target_mm_per_min, max_raise_ratio) = (10.0 + 2_000.0 * random.f64(), 1.0 + 3.0 * random.f64());
        let max_mm_per_min = max_raise_ratio * target_mm_per_min;
        let feed = ContactFeed { target_mm_per_min, max_raise_ratio, max_mm_per_min };
        let start = Contact::new(Point::origin(), &random_vector(&mut random), &random_vector(&mut random));
        let Some(start) = start else { continue };
        let mut from = PassPoint { contact: start, location: mill.at(&start, start.normal) };
        for _ in 0..20 {
            let Some(to) = next(&mut random, &mill, &from.contact) else { continue };
            let f = feed.tip_mm_per_min(&mill, &from, &to);
            let tip_mm = (to.location.tip - from.location.tip).norm();
            let minutes = tip_mm / f;
            // The ball's centre, or the middle of the corner's circle, lies on the axis at the height of the corner's radius.
            let pivots = [&from, &to].map(|at| at.location.tip + at.location.axis * mill.corner_radius_mm);
            let (contact_mm, pivot_mm) =
                ((to.contact.point - from.contact.point).norm(), (pivots[1] - pivots[0]).norm());
            moves += 1;
            // F has thousandths and is at least one: of a tip that all but stands the bounds are below it.
            if f > 0.0015 {
                assert!(contact_mm / minutes <= target_mm_per_min * (1.0 + 1e-9), "contact {contact_mm} in {minutes}");
                assert!(pivot_mm / minutes <= max_mm_per_min * (1.0 + 1e-9), "end {pivot_mm} in {minutes}");
            }
            assert!(f <= max_mm_per_min, "{f} {max_mm_per_min}");
            // Rounded down to a thousandth, it is no lower than the lowest of the three.
            let least = (target_mm_per_min * tip_mm / contact_mm).min(max_mm_per_min * tip_mm / pivot_mm);
            assert!(f >= least.min(max_mm_per_min) - 0.001_001 || f <= 0.001, "{f} {least}");
            raised += usize::from(f > target_mm_per_min);
            lowest_share = lowest_share.min(f / target_mm_per_min);
            from = to;
        }
    }
    println!("{moves} moves, F above the target on {raised}, at least {lowest_share:.1e} of it");
    assert!(moves > 30_000 && raised > 1_000);
}
