//! Requests of the page.

use std::io;
use std::sync::Arc;

use super::input::FormValues;
use super::workspace::{PageFile, Workspace};
use crate::report::page::viewer::start_page;
use crate::web::reply::Reply;
use crate::web::request::Request;
use crate::web::server::Site;

/// Largest program, bytes.
const PROGRAM_MAX: usize = 64 << 20;
/// Largest job and largest form, bytes.
const TEXT_MAX: usize = 1 << 20;

/// The page, over a workspace.
pub struct ViewSite(pub Arc<Workspace>);

impl Site for ViewSite {
    fn respond(&self, mut request: Request) -> io::Result<()> {
        let workspace = &self.0;
        match (request.is_post, request.path.as_str()) {
            (false, "") => request.reply(&Reply::html(start_page().as_bytes())),
            (false, "state") => self.state(request),
            (false, "report") => self.file(request, PageFile::Report),
            (false, "adapted") => self.file(request, PageFile::Adapted),
            (false, "job") => self.file(request, PageFile::Job),
            (true, "stop") => {
                workspace.stop();
                request.reply(&Reply::text("202 Accepted", ""))
            }
            (true, "program" | "init" | "run") => {
                if !workspace.begin() {
                    return request
                        .reply(&Reply::text("409 Conflict", "another run is under way: wait for it, or stop it"));
                }
                let done = self.work(&mut request);
                // Before the answer: the page may send its next request as soon as it has it.
                workspace.end();
                match done? {
                    Ok(()) => self.state(request),
                    Err(fault) => request.reply(&Reply::text("400 Bad Request", &fault)),
                }
            }
            _ => request.reply(&Reply::text("404 Not Found", "there is no such page")),
        }
    }
}

impl ViewSite {
    /// Does what is asked; `Err` inside: a fault of the request.
    fn work(&self, request: &mut Request) -> io::Result<Result<(), String>> {
        let body = request.body(if request.path == "program" { PROGRAM_MAX } else { TEXT_MAX })?;
        match request.path.as_str() {
            "program" => self.0.take(&request.query, &body)?,
            "init" => match serde_json::from_slice::<FormValues>(&body) {
                Ok(values) => self.0.propose(&values),
                Err(error) => return Ok(Err(error.to_string())),
            },
            _ => self.0.adapt_with(&String::from_utf8_lossy(&body))?,
        }
        Ok(Ok(()))
    }

    fn state(&self, request: Request) -> io::Result<()> {
        let state = serde_json::to_vec(&self.0.state())?;
        request.reply(&Reply { status: "200 OK", kind: "application/json", file_name: None, body: &state })
    }

    fn file(&self, request: Request, output: PageFile) -> io::Result<()> {
        let Ok((bytes, name)) = self.0.read(output) else {
            return request.reply(&Reply::text("404 Not Found", "there is none yet"));
        };
        match output {
            PageFile::Report => request.reply(&Reply::html(&bytes)),
            _ => {
                let kind = "text/plain; charset=utf-8";
                request.reply(&Reply { status: "200 OK", kind, file_name: Some(name), body: &bytes })
            }
        }
    }
}
