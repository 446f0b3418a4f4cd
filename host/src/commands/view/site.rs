//! Answers to the requests of the page: from browsers to the server, or from the page to the arcfeed inside it
//! (`host/wasm`).

use std::io;
use std::sync::Arc;

use super::input::FormValues;
use super::workspace::{PageFile, Workspace};
use crate::report::page::viewer::start_page;
use crate::web::reply::Reply;

/// Largest program, bytes.
const PROGRAM_MAX: usize = 64 << 20;
/// Largest job and largest form, bytes.
const TEXT_MAX: usize = 1 << 20;

/// The page `arcfeed view` with its requests, over a workspace.
pub struct ViewSite(pub Arc<Workspace>);

#[cfg(not(target_family = "wasm"))]
impl crate::web::server::Site for ViewSite {
    fn respond(&self, mut request: crate::web::request::Request) -> io::Result<()> {
        let [path, query] = [request.path.clone(), request.query.clone()];
        let reply = self.reply(request.is_post, [&path, &query], |max| request.body(max))?;
        request.reply(&reply)
    }
}

impl ViewSite {
    /// Answers a request for a path with a query. `body` reads the posted data, at most as many bytes as its argument
    /// says.
    ///
    /// # Errors
    /// The browser is gone, or the disk is full.
    pub fn reply(
        &self,
        is_post: bool,
        [path, query]: [&str; 2],
        body: impl FnOnce(usize) -> io::Result<Vec<u8>>,
    ) -> io::Result<Reply<'static>> {
        let workspace = &self.0;
        match (is_post, path) {
            (false, "") => Ok(Reply::html(start_page().into_bytes())),
            (false, "state") => self.state(),
            (false, "report") => Ok(self.file(PageFile::Report)),
            (false, "adapted") => Ok(self.file(PageFile::Adapted)),
            (false, "job") => Ok(self.file(PageFile::Job)),
            (true, "stop") => {
                workspace.stop();
                Ok(Reply::text("202 Accepted", ""))
            }
            (true, "program" | "init" | "run") => {
                if !workspace.begin() {
                    return Ok(Reply::text("409 Conflict", "another run is under way: wait for it, or stop it"));
                }
                let done = self.work([path, query], body);
                // Before the answer: the page may send its next request as soon as it has it.
                workspace.end();
                match done? {
                    Ok(()) => self.state(),
                    Err(fault) => Ok(Reply::text("400 Bad Request", fault)),
                }
            }
            _ => Ok(Reply::text("404 Not Found", "there is no such page")),
        }
    }

    /// Does what is asked; `Err` inside: a fault of the request.
    fn work(
        &self,
        [path, query]: [&str; 2],
        body: impl FnOnce(usize) -> io::Result<Vec<u8>>,
    ) -> io::Result<Result<(), String>> {
        let body = body(if path == "program" { PROGRAM_MAX } else { TEXT_MAX })?;
        match path {
            "program" => self.0.take(query, &body)?,
            "init" => match serde_json::from_slice::<FormValues>(&body) {
                Ok(values) => {
                    let _known = self.0.propose(&values);
                }
                Err(error) => return Ok(Err(error.to_string())),
            },
            _ => self.0.adapt_with(&String::from_utf8_lossy(&body))?,
        }
        Ok(Ok(()))
    }

    fn state(&self) -> io::Result<Reply<'static>> {
        let body = serde_json::to_vec(&self.0.state())?.into();
        Ok(Reply { status: "200 OK", kind: "application/json", file_name: None, body })
    }

    fn file(&self, output: PageFile) -> Reply<'static> {
        let Ok((bytes, name)) = self.0.read(output) else {
            return Reply::text("404 Not Found", "there is none yet");
        };
        match output {
            PageFile::Report => Reply::html(bytes),
            _ => {
                let kind = "text/plain; charset=utf-8";
                Reply { status: "200 OK", kind, file_name: Some(name), body: bytes.into() }
            }
        }
    }
}
