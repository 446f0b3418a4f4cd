//! Ours and pyserial's, both ways, with pyserial itself: what its URLs mean, its RFC 2217 server, its `socket://`, the
//! format of its spy, the list of its `list_ports`. `cargo xtask test` installs it.
#![cfg(unix)]

mod urls;

mod lines;

mod spy;

#[cfg(target_os = "linux")]
mod list;
