//! A stack as large as that of a program's first thread; a page would give it 1 MB.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family.contains("wasm")) {
        println!("cargo:rustc-cdylib-link-arg=-zstack-size=8388608");
    }
}
