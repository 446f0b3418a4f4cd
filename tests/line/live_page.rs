//! `stream --web`: the live page of a real sender before several clients, one of which never reads; the key, hosts and
//! origins; and the commands, of which an abort is a Ctrl-C.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use arcfeed_tests::{Ended, Running, Scratch, run, wait_for};
use serde_json::Value;

const JOB: &str = "examples/ibr-slot/job.toml";
const BROWSERS: usize = 5;
/// Characters a control takes after DC3.
const AFTER_DC3_MAX: u64 = 10;
/// Snapshots a second that the page promises.
const UPDATES_PER_S: f64 = 20.0;
/// Rate of the pseudo-terminal in wall time: ten characters last 11 ms, in which a busy computer still reacts to a DC3.
const RATE: &str = "9600";

/// Address of a page that arcfeed serves.
#[derive(Clone, Debug)]
pub struct Page {
    host: String,
    /// Path with the key.
    pub path: String,
}

/// Snapshots that a client got, with the time of each since it asked: the first may be read late on a busy computer.
pub type Seen = Vec<(Duration, Value)>;

impl Page {
    /// Page that a running sender has printed.
    pub fn of(stream: &Running) -> Self {
        let url = wait_for("the page's address", || {
            let said = stream.said();
            Some(said.split_once("live page: ")?.1.split_once('\n')?.0.to_owned())
        });
        Page::at(&url)
    }

    /// Page at an address.
    pub fn at(url: &str) -> Self {
        let address = url.strip_prefix("http://").expect("an address");
        let (host, path) = address.split_once('/').expect("an address with a key");
        Page { host: host.to_owned(), path: format!("/{path}") }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).expect("the page is served");
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a socket can wait");
        stream
    }

    /// Status and body of the answer to a request as it is written here.
    fn raw(&self, request: &str) -> (u16, String) {
        let mut stream = self.connect();
        stream.write_all(request.as_bytes()).expect("the server takes it");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        let status = answer.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        (status, answer.split_once("\r\n\r\n").map_or(String::new(), |(_, body)| body.to_owned()))
    }

    /// Answer to a GET.
    pub fn get(&self, path: &str, fields: &str) -> (u16, String) {
        self.raw(&format!("GET {path} HTTP/1.1\r\nHost: {}\r\n{fields}\r\n", self.host))
    }

    fn command(&self, word: &str, fields: &str) -> (u16, String) {
        self.post("command", word, fields)
    }

    /// Answer to a POST; the path follows the key.
    pub fn post(&self, path: &str, body: &str, fields: &str) -> (u16, String) {
        let (key, host, length) = (&self.path, &self.host, body.len());
        self.raw(&format!(
            "POST {key}{path} HTTP/1.1\r\nHost: {host}\r\n{fields}Content-Length: {length}\r\n\r\n{body}"
        ))
    }

    /// Asks for the events.
    fn watch(&self) -> TcpStream {
        let mut stream = self.connect();
        write!(stream, "GET {}events HTTP/1.1\r\nHost: {}\r\n\r\n", self.path, self.host).expect("a request");
        stream
    }

    /// Reads all snapshots to the last.
    pub fn browser(&self) -> JoinHandle<Seen> {
        let (asked, stream) = (Instant::now(), self.watch());
        std::thread::spawn(move || {
            let mut seen = Seen::new();
            for line in BufReader::new(stream).lines().map_while(Result::ok) {
                if let Some(data) = line.strip_prefix("data: ") {
                    seen.push((asked.elapsed(), serde_json::from_str(data).expect("JSON")));
                }
            }
            seen
        })
    }

    /// Next state of the sender that is asked for.
    fn wait_for_state(&self, state: &str) {
        let lines = BufReader::new(self.watch()).lines().map_while(Result::ok);
        let found = lines.filter_map(|line| serde_json::from_str::<Value>(line.strip_prefix("data: ")?).ok());
        let mut states = found.map(|snapshot| snapshot["state"].clone());
        assert!(states.any(|now| now == state), "the sender ended before it was {state}");
    }
}

fn report(ended: &Ended) -> Value {
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let line = ended.out.lines().find(|line| line.starts_with('{')).expect("JSON");
    serde_json::from_str(line).expect("JSON")
}

/// Least fraction of the snapshots that a client gets on the busiest computer.
const SHARE_MIN: f64 = 0.5;

/// Fraction of its time by which this computer wakes a thread too late that waits for one period of the updates after the other.
struct Lateness {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<f64>,
}

impl Lateness {
    fn start() -> Self {
        let (period, stop) = (Duration::from_secs_f64(1.0 / UPDATES_PER_S), Arc::new(AtomicBool::new(false)));
        let (asked, began) = (Arc::clone(&stop), Instant::now());
        let thread = std::thread::spawn(move || {
            let mut count = 0_u32;
            while !asked.load(Ordering::Relaxed) {
                std::thread::sleep(period);
                count += 1;
            }
            1.0 - (period * count).as_secs_f64() / began.elapsed().as_secs_f64()
        });
        Lateness { stop, thread }
    }

    fn end(self) -> f64 {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().expect("it only waits")
    }
}

/// Snapshots that clients beside a sender got.
#[derive(Default)]
struct Watched {
    clients: Vec<Seen>,
    /// The computer's [`Lateness`] meanwhile.
    late: f64,
}

/// Runs a sender beside five clients and one that never reads; answers its end, and what the five saw.
fn with_browsers(stream: Running) -> (Ended, Watched) {
    let page = Page::of(&stream);
    // Its receive buffer stays as it is until the end.
    let _never_reads = page.watch();
    let browsers: Vec<JoinHandle<Seen>> = (0..BROWSERS).map(|_| page.browser()).collect();
    let lateness = Lateness::start();
    let ended = stream.end();
    let late = lateness.end();
    let clients = browsers.into_iter().map(|browser| browser.join().expect("a client")).collect();
    (ended, Watched { clients, late })
}

/// Every client saw nearly every snapshot, at the promised rate, and the last one. A thread that a busy computer wakes a period too late
/// misses a snapshot: the sender's, then the client's in the server.
fn check_updates(Watched { clients, late }: &Watched) {
    for browser in clients {
        let [first, .., last] = browser.as_slice() else { panic!("no updates: {browser:?}") };
        let number = |snapshot: &Value| snapshot["number"].as_u64().expect("a number");
        let made = number(&last.1) - number(&first.1);
        let (got, span_s) = (browser.len() as u64 - 1, last.0.as_secs_f64());
        println!("{got} of {made} snapshots in {span_s:.2} s: {:.1} a second, late {late:.3}", got as f64 / span_s);
        assert!(last.1["is_over"] == true && browser.windows(2).all(|pair| number(&pair[0].1) < number(&pair[1].1)));
        // The last one does not wait for its turn. A computer that is busy makes fewer.
        let (most, share) = (UPDATES_PER_S * span_s, (0.9 - 2.0 * late).max(SHARE_MIN));
        assert!(
            made as f64 <= most + 3.0 && made as f64 >= most / 2.0 && got as f64 >= made as f64 * share,
            "{got} of {made} in {span_s} s, threads late by {late:.3} of the time"
        );
    }
}

#[test]
fn browsers_on_a_simulated_line_change_no_figure_and_see_position_line_and_chip() {
    let scratch = Scratch::new("live-sim");
    let slowly = ["stream", JOB, "--port", "sim:", "--baudrate", "2400", "--json", "--speed", "10"];
    let without = report(&Running::start(&scratch, "without", &slowly).end());
    let (ended, seen) = with_browsers(Running::start(&scratch, "with", &[&slowly[..], &["--web"]].concat()));
    let with = report(&ended);
    for figures in ["link", "cycle_time_s", "chip_load", "override", "blocks_executed"] {
        assert_eq!(with[figures], without[figures], "{figures}");
    }
    println!("line: {}", with["link"]);
    check_updates(&seen);
    let snapshots = seen.clients[0].iter().map(|(_, snapshot)| snapshot);
    // N144 runs about the centre that I and J give from the end of N142, on the radius 4.43706 in.
    let on_arc: Vec<&Value> =
        snapshots.filter(|now| now["block"].as_str().is_some_and(|b| b.starts_with("N144G3"))).collect();
    assert!(!on_arc.is_empty(), "the block was under way for seconds");
    for now in on_arc {
        let [x, y] = [0, 1].map(|axis| now["position"][axis].as_f64().expect("a position"));
        let radius = libm::hypot(x - 0.2495, y - 8.3369);
        // The axes reach the arc after the control has begun it: they lag.
        assert!((radius - 4.43706).abs() < 5e-3 && now["line"] == 19, "{radius}: {now}");
        assert!(
            now["feed"].as_f64() > Some(0.0) && now["override_percent"].is_u64() && now["board"].is_null(),
            "{now}"
        );
    }
}

#[test]
fn browsers_on_a_line_in_wall_time_leave_flow_control_and_machine_as_they_are() {
    let scratch = Scratch::new("live-pty");
    let serve = ["serve", JOB, "--pty", "--once", "--json", "--speed", "10", "--baudrate", RATE];
    let measure = |name: &str, flags: &[&str]| {
        let mut server = Running::start(&scratch, &format!("serve-{name}"), &serve);
        let port = server.line("port: ");
        let journal = scratch.path(name);
        let fixed = ["stream", JOB, "--port", &port, "--baudrate", RATE, "--journal", &journal, "--json"];
        let stream = Running::start(&scratch, name, &[&fixed[..], flags].concat());
        let (sent, seen) = if flags.is_empty() { (stream.end(), Watched::default()) } else { with_browsers(stream) };
        assert_eq!(sent.code, Some(0), "{}", sent.err);
        (report(&server.end()), seen)
    };
    let (without, _) = measure("without", &[]);
    let (with, seen) = measure("with", &["--web"]);
    println!("without browsers: {}\nwith: {}", without["link"], with["link"]);
    for figures in ["cycle_time_s", "chip_load", "override", "blocks_executed"] {
        assert_eq!(with[figures], without[figures], "{figures}");
    }
    assert!(with["link"]["max_bytes_after_xoff"].as_u64() <= Some(AFTER_DC3_MAX), "{}", with["link"]);
    check_updates(&seen);
    let journal = seen.clients[0][0].1["journal"].as_str().map(str::to_owned);
    assert!(journal.is_some_and(|path| path.ends_with("with")), "{}", seen.clients[0][0].1);
}

#[test]
fn without_the_key_from_elsewhere_and_without_sense_nothing_is_answered_or_done() {
    let scratch = Scratch::new("live-refused");
    let stream = Running::start(&scratch, "stream", &["stream", JOB, "--port", "sim:", "--json", "--web"]);
    let page = Page::of(&stream);
    let (status, html) = page.get(&page.path, "");
    assert!(status == 200 && html.contains("id=\"live\"") && !html.contains(page.path.trim_matches('/')));
    for path in ["/", "/events", "/command", "/00000000000000000000000000000000/", page.path.trim_end_matches('/')] {
        assert_eq!(page.get(path, "").0, 403, "{path}");
    }
    let own = format!("Origin: http://{}\r\n", page.host);
    let foreign = "Origin: http://arcfeed.example\r\n";
    assert_eq!(page.get(&page.path, foreign).0, 403);
    assert_eq!(page.command("abort", foreign).0, 403);
    assert_eq!(page.command("abort", "Origin: null\r\n").0, 403);
    let elsewhere = format!("GET {} HTTP/1.1\r\nHost: arcfeed.example\r\n\r\n", page.path);
    assert_eq!(page.raw(&elsewhere).0, 403);
    assert_eq!(page.raw("no request at all\r\n\r\n").0, 400);
    assert_eq!(page.raw(&format!("DELETE {} HTTP/1.1\r\nHost: {}\r\n\r\n", page.path, page.host)).0, 405);
    assert_eq!(page.get(&format!("{}command", page.path), "").0, 404);
    for (word, wanted) in [("stop", 400), ("", 400), ("abort-abort-abort-abort", 413), ("resume", 409)] {
        assert_eq!(page.command(word, &own).0, wanted, "{word}");
    }
    // None of these was a command.
    page.wait_for_state("sending");
    stream.interrupt();
    assert_eq!(stream.end().code, Some(130));
    for arguments in [
        &["stream", JOB, "--web", "nowhere"][..],
        &["stream", JOB, "--web", "192.0.2.1:0"],
        &["stream", JOB, "--web", "--port", "linuxcnc:"],
    ] {
        let output = run(arguments);
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && words.contains("--web"), "{arguments:?}: {words}");
    }
}

#[test]
fn a_hold_needs_a_resume_and_an_abort_is_a_ctrl_c() {
    let scratch = Scratch::new("live-commands");
    let start = |name: &str| {
        let journal = scratch.path(&format!("{name}-journal"));
        let arguments = ["stream", JOB, "--port", "sim:", "--baudrate", "600", "--web", "--journal", &journal, "--log"];
        Running::start(&scratch, name, &[&arguments[..], &[&scratch.path(&format!("{name}-log"))]].concat())
    };
    let end = |name: &str, ended: Ended| {
        let journal = std::fs::read_to_string(scratch.path(&format!("{name}-journal"))).expect("a journal");
        let how = journal.lines().last().and_then(|line| line.split_once("reason=")).map(|(_, how)| how.to_owned());
        let words = ended.err.lines().find(|line| line.starts_with("stopped by the operator")).map(str::to_owned);
        let words = words.unwrap_or_else(|| panic!("{}", ended.err));
        (ended.code, how, words.chars().filter(|letter| !letter.is_ascii_digit()).collect::<String>())
    };
    let by_page = start("page");
    let page = Page::of(&by_page);
    page.wait_for_state("sending");
    assert_eq!(page.command("hold", "").0, 202);
    page.wait_for_state("held");
    assert_eq!(page.command("resume", "").0, 202);
    page.wait_for_state("sending");
    assert_eq!(page.command("abort", "").0, 202);
    let by_page = end("page", by_page.end());
    let by_key = start("key");
    Page::of(&by_key).wait_for_state("sending");
    by_key.interrupt();
    assert_eq!(by_page, end("key", by_key.end()));
    assert_eq!((by_page.0, by_page.1.as_deref()), (Some(130), Some("aborted")));
    let log = std::fs::read_to_string(scratch.path("page-log")).expect("a log");
    let places = ["held\n", "resumed\n", "aborted"].map(|event| log.find(event));
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{log}");
}
