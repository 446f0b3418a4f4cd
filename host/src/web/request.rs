//! Requests that the server accepts: read with bounds, checked for key, host and origin before anything is answered.

use std::io::{self, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use super::reply::Reply;

/// Longest head of a request.
const HEAD_MAX: usize = 8 * 1024;
/// Most header fields of a request.
const FIELDS_MAX: usize = 64;
/// Longest time until the head of a request has arrived.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// Most bytes, and longest time, for what a browser still sends after an answer that did not need it.
const LEFT_MAX: usize = 1 << 20;
const LEFT_TIME: Duration = Duration::from_millis(500);

/// Request with the correct key, from a page of this server or from a program that is not a browser.
#[derive(Debug)]
pub struct Request {
    /// The method is POST; otherwise GET.
    pub is_post: bool,
    /// Path after the key, without the query.
    pub path: String,
    /// Query, without `?`.
    pub query: String,
    /// Length of the body.
    length: usize,
    /// Beginning of the body, which came with the head.
    begin: Vec<u8>,
    stream: TcpStream,
}

/// Address and key of a server, by which requests are admitted.
#[derive(Debug)]
pub struct Gate {
    /// Address and port at which the server listens.
    pub address: SocketAddr,
    /// Random key, which must be the first part of each path.
    pub key: String,
}

/// Head of a request, as it came.
#[derive(Debug, Default)]
struct Head {
    method: String,
    target: String,
    /// `Host`, unless it is missing or there are several.
    host: Option<String>,
    origin: Option<String>,
    length: Option<usize>,
    is_chunked: bool,
}

impl Gate {
    /// Reads the head of a request and checks it. A request that is refused is answered here.
    ///
    /// # Errors
    /// The request is no HTTP, is refused, or its sender is gone.
    pub fn admit(&self, mut stream: TcpStream) -> io::Result<Request> {
        let refused = |stream: &mut TcpStream, status: &'static str, why: &str| {
            Reply::text(status, why).write(stream)?;
            close(stream)?;
            Err(io::Error::other(status))
        };
        let Some((head, begin)) = read_head(&mut stream)? else {
            return refused(&mut stream, "400 Bad Request", "this is no request that arcfeed reads");
        };
        let path = match self.check(&head) {
            Ok(path) => path,
            Err(why) => return refused(&mut stream, "403 Forbidden", why),
        };
        if !matches!(head.method.as_str(), "GET" | "POST") || head.is_chunked {
            return refused(&mut stream, "405 Method Not Allowed", "GET and POST with a Content-Length are read here");
        }
        let (path, query) = path.split_once('?').unwrap_or((path, ""));
        let (path, query) = (path.to_owned(), query.to_owned());
        Ok(Request { is_post: head.method == "POST", path, query, length: head.length.unwrap_or(0), begin, stream })
    }

    /// Path after the key of a request that may be answered; otherwise the reason.
    fn check<'h>(&self, head: &'h Head) -> Result<&'h str, &'static str> {
        let host = head.host.as_deref().filter(|host| self.is_own(host));
        let host = host.ok_or("write the server's address as a number, or localhost: other hosts are refused")?;
        if head.origin.as_ref().is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
            return Err("requests from pages of other origins are refused");
        }
        let (key, path) = head.target.strip_prefix('/').and_then(|path| path.split_once('/')).unwrap_or_default();
        if !are_equal(key.as_bytes(), self.key.as_bytes()) {
            return Err("the key of this session is missing: open the address that arcfeed has printed");
        }
        Ok(path)
    }

    /// Whether a host is this server by number, or `localhost` if it listens there.
    fn is_own(&self, host: &str) -> bool {
        let own = self.address.ip();
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        let is_named = match name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>() {
            Ok(ip) => ip == own || own.is_unspecified(),
            Err(_) => name.eq_ignore_ascii_case("localhost") && (own.is_loopback() || own.is_unspecified()),
        };
        is_named && port == Some(self.address.port())
    }
}

impl Request {
    /// Reads the body.
    ///
    /// # Errors
    /// It is longer than `max`, which is answered, or its sender is gone.
    pub fn body(&mut self, max: usize) -> io::Result<Vec<u8>> {
        if self.length > max {
            Reply::text("413 Content Too Large", format!("at most {max} bytes are read here"))
                .write(&mut self.stream)?;
            close(&mut self.stream)?;
            return Err(io::Error::other("too large"));
        }
        let mut body = std::mem::take(&mut self.begin);
        body.truncate(self.length);
        let left = (self.length - body.len()) as u64;
        self.stream.set_read_timeout(Some(HEAD_TIME))?;
        (&self.stream).take(left).read_to_end(&mut body)?;
        if body.len() == self.length { Ok(body) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
    }

    /// Answers and closes the connection.
    ///
    /// # Errors
    /// The browser is gone, or takes nothing.
    pub fn reply(mut self, reply: &Reply<'_>) -> io::Result<()> {
        reply.write(&mut self.stream)?;
        close(&mut self.stream)
    }

    /// Connection, for an answer of more than one part.
    pub fn into_stream(self) -> TcpStream {
        self.stream
    }
}

/// Reads the head and what came after it; `None` if it is none.
fn read_head(stream: &mut TcpStream) -> io::Result<Option<(Head, Vec<u8>)>> {
    let (latest, mut bytes) = (Instant::now() + HEAD_TIME, Vec::new());
    let mut buffer = [0; 1_024];
    loop {
        let left = latest.saturating_duration_since(Instant::now());
        stream.set_read_timeout(Some(left.max(Duration::from_millis(1))))?;
        let len = stream.read(&mut buffer)?;
        bytes.extend(&buffer[..len]);
        match parse(&bytes) {
            Ok(Some((head, end))) => return Ok(Some((head, bytes.split_off(end)))),
            Ok(None) if len > 0 && bytes.len() <= HEAD_MAX => {}
            _ => return Ok(None),
        }
    }
}

/// Head and its end, if it is complete.
fn parse(bytes: &[u8]) -> Result<Option<(Head, usize)>, httparse::Error> {
    let mut fields = [httparse::EMPTY_HEADER; FIELDS_MAX];
    let mut request = httparse::Request::new(&mut fields);
    let httparse::Status::Complete(end) = request.parse(bytes)? else { return Ok(None) };
    let of = |text: Option<&str>| text.unwrap_or_default().to_owned();
    let all = |name: &str| {
        let named = request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
        named.map(|field| String::from_utf8_lossy(field.value).into_owned()).collect::<Vec<_>>()
    };
    let one = |name: &str| <[String; 1]>::try_from(all(name)).ok().map(|[value]| value);
    let origin = all("origin");
    let head = Head {
        method: of(request.method),
        target: of(request.path),
        host: one("host"),
        // Several origins are the origin of no page.
        origin: (!origin.is_empty()).then(|| origin.join(" ")),
        length: one("content-length").and_then(|length| length.parse().ok()),
        is_chunked: !all("transfer-encoding").is_empty(),
    };
    Ok(Some((head, end)))
}

/// Takes as long for any key, so that its time says nothing.
fn are_equal(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

/// Ends an answer. What the browser still sends is read: with unread bytes, the end would take the answer back.
fn close(stream: &mut TcpStream) -> io::Result<()> {
    stream.flush()?;
    stream.shutdown(std::net::Shutdown::Write)?;
    stream.set_read_timeout(Some(LEFT_TIME))?;
    let mut left = stream.take(LEFT_MAX as u64);
    let _gone = io::copy(&mut left, &mut io::sink());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gate(address: &str) -> Gate {
        Gate { address: address.parse().unwrap(), key: "0123456789abcdef".into() }
    }

    fn check(gate: &Gate, request: &str) -> Result<String, &'static str> {
        let (head, _) = parse(request.as_bytes()).unwrap().unwrap();
        gate.check(&head).map(str::to_owned)
    }

    #[test]
    fn only_the_key_the_own_host_and_the_own_origin_are_admitted() {
        let own = gate("127.0.0.1:8080");
        let request = |target: &str, fields: &str| check(&own, &format!("GET {target} HTTP/1.1\r\n{fields}\r\n"));
        let host = "Host: 127.0.0.1:8080\r\n";
        assert_eq!(request("/0123456789abcdef/events", host), Ok("events".into()));
        assert_eq!(request("/0123456789abcdef/", "Host: LocalHost:8080\r\n"), Ok(String::new()));
        for target in ["/", "/events", "//events", "/0123456789abcde/", "/0123456789abcdeF/", "/0123456789abcdef"] {
            assert!(request(target, host).is_err_and(|why| why.contains("key")), "{target}");
        }
        for fields in [
            "",
            "Host: arcfeed.example:8080\r\n",
            "Host: 127.0.0.1\r\n",
            "Host: 127.0.0.1:8081\r\n",
            "Host: 127.0.0.2:8080\r\n",
            "Host: 127.0.0.1:8080\r\nHost: 127.0.0.1:8080\r\n",
        ] {
            assert!(request("/0123456789abcdef/", fields).is_err_and(|why| why.contains("host")), "{fields}");
        }
        let with = |origin: &str| request("/0123456789abcdef/", &format!("{host}Origin: {origin}\r\n"));
        assert!(with("http://127.0.0.1:8080").is_ok());
        for origin in
            ["null", "http://localhost:8080", "https://127.0.0.1:8080", "http://127.0.0.1:80", "http://a.example"]
        {
            assert!(with(origin).is_err_and(|why| why.contains("origins")), "{origin}");
        }
    }

    #[test]
    fn a_server_at_every_address_is_reached_by_numbers_only() {
        let open = gate("0.0.0.0:80");
        for (host, is_own) in [
            ("192.168.1.7", true),
            ("192.168.1.7:80", true),
            ("[fe80::1]", true),
            ("localhost", true),
            ("pc.example", false),
            ("192.168.1.7:81", false),
            ("", false),
        ] {
            assert_eq!(open.is_own(host), is_own, "{host}");
        }
        assert!(gate("[::1]:8080").is_own("[::1]:8080") && !gate("192.168.1.7:80").is_own("localhost"));
    }
}
