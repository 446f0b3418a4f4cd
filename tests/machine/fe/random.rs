//! Numbers without a pattern, the same in every run.

pub fn fractions(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = fastrand::Rng::with_seed(seed);
    move || rng.f64()
}
