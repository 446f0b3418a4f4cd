//! Answers of the server.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::net::TcpStream;

/// Fields of every answer: the address with the key goes nowhere, and no other page shows this one in a frame.
const FIELDS: &str = "Connection: close\r\nCache-Control: no-store\r\nReferrer-Policy: no-referrer\r\n\
                      X-Content-Type-Options: nosniff\r\nX-Frame-Options: SAMEORIGIN\r\nCross-Origin-Resource-Policy: same-origin\r\n";

/// Complete answer of the server to a request.
#[derive(Clone, Debug)]
pub struct Reply<'b> {
    /// HTTP status code with its text.
    pub status: &'static str,
    /// Media type of the body.
    pub kind: &'static str,
    /// Name under which a browser saves the body; `None`: the browser shows it.
    pub file_name: Option<String>,
    /// Body.
    pub body: Cow<'b, [u8]>,
}

impl<'b> Reply<'b> {
    /// Answer with an HTML page.
    pub fn html(body: impl Into<Cow<'b, [u8]>>) -> Self {
        Reply { status: "200 OK", kind: "text/html; charset=utf-8", file_name: None, body: body.into() }
    }

    /// Answer with this status and a sentence as plain text.
    pub fn text(status: &'static str, body: impl Into<String>) -> Self {
        Reply { status, kind: "text/plain; charset=utf-8", file_name: None, body: body.into().into_bytes().into() }
    }

    /// Writes the whole answer.
    ///
    /// # Errors
    /// The browser has closed the connection, or accepts no data.
    pub fn write(&self, stream: &mut TcpStream) -> io::Result<()> {
        let Reply { status, kind, file_name, body } = self;
        let mut head =
            format!("HTTP/1.1 {status}\r\n{FIELDS}Content-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
        if let Some(name) = file_name {
            let _in_memory = write!(head, "Content-Disposition: attachment; filename=\"{name}\"\r\n");
        }
        head += "\r\n";
        stream.write_all(head.as_bytes())?;
        stream.write_all(body)
    }
}

/// Begins an answer whose events follow, each as it happens.
///
/// # Errors
/// The browser is gone, or takes nothing.
pub fn begin_events(stream: &mut TcpStream) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.write_all(format!("HTTP/1.1 200 OK\r\n{FIELDS}Content-Type: text/event-stream\r\n\r\n").as_bytes())
}
