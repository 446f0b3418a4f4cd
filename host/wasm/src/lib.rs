#![doc = include_str!("../README.md")]
//!
//! The interface is that of C, without pointers into Rust's data but these two: the page writes a request where `request`
//! says, calls `answer`, and reads the answer where `reply` says. A worker of the page calls them, one at a time
//! (`host/web/src/worker.ts`).
//!
//! ```text
//! request   GET or POST, path, query, each with a line feed behind it; then the body
//! reply     status, type, name for a download, each with a line feed behind it; then the body
//! ```
#![cfg(target_family = "wasm")]

use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

use arcfeed::clock;
use arcfeed::commands::view::site::ViewSite;
use arcfeed::commands::view::workspace::Workspace;

#[allow(unsafe_code, reason = "a function of the page, without arguments")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Time of the page, ms.
    safe fn now_ms() -> f64;
}

static SITE: LazyLock<Option<ViewSite>> = LazyLock::new(|| {
    clock::set(|| now_ms());
    Some(ViewSite(Arc::new(Workspace::new(Path::new("/")).ok()?)))
});

static REQUEST: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static REPLY: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// Reserves memory for a request of this many bytes; returns its address, to which the page writes the request.
#[allow(unsafe_code, reason = "the page calls it by this name")]
#[unsafe(no_mangle)]
pub extern "C" fn request(bytes: usize) -> *mut u8 {
    let mut request = locked(&REQUEST);
    request.clear();
    request.resize(bytes, 0);
    request.as_mut_ptr()
}

/// Processes the request that the page has written; returns the length of the reply in bytes.
#[allow(unsafe_code, reason = "the page calls it by this name")]
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    let reply = respond(&std::mem::take(&mut *locked(&REQUEST))).unwrap_or_else(|| b"400 Bad Request\n\n\n".to_vec());
    let bytes = reply.len();
    *locked(&REPLY) = reply;
    bytes
}

/// Address of the reply to the last request, for the page to read.
#[allow(unsafe_code, reason = "the page calls it by this name")]
#[unsafe(no_mangle)]
pub extern "C" fn reply() -> *const u8 {
    locked(&REPLY).as_ptr()
}

fn respond(request: &[u8]) -> Option<Vec<u8>> {
    let mut parts = request.splitn(4, |byte| *byte == b'\n');
    let mut word = || std::str::from_utf8(parts.next()?).ok();
    let [method, path, query] = [word()?, word()?, word()?];
    let body = parts.next()?;
    let reply = SITE.as_ref()?.reply(method == "POST", [path, query], |_| Ok(body.to_vec())).ok()?;
    let mut bytes = format!("{}\n{}\n{}\n", reply.status, reply.kind, reply.file_name.unwrap_or_default()).into_bytes();
    bytes.extend_from_slice(&reply.body);
    Some(bytes)
}

fn locked(bytes: &Mutex<Vec<u8>>) -> MutexGuard<'_, Vec<u8>> {
    bytes.lock().unwrap_or_else(PoisonError::into_inner)
}
