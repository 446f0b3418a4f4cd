//! Cargo features: what a plain build leaves out (docs/build.md).

/// Message for a command or option whose feature is not built in.
pub fn not_built_in(part: &str, feature: &str) -> String {
    format!(
        "this arcfeed was built without {part} (cargo feature `{feature}`): build it with `cargo build --release --features full`"
    )
}
