//! The watch: somebody asks for the page, its state and the health about once a second, each from a fresh
//! connection, and measures the time to the full answer. Beside the station a listener is asked that
//! answers at once: what it takes is the machine's.

use std::cell::Cell;
use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Mutex;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rig::invariants::Vitals;

use crate::field::Field;

/// No answer may take longer.
const MOST: Duration = Duration::from_secs(2);

/// Nobody waits longer for one.
const GIVEN_UP: Duration = Duration::from_secs(90);

/// A connection that the kernel does not take at once is tried again.
const CONNECTED: Duration = Duration::from_millis(500);

const PACE: Duration = Duration::from_secs(1);

/// What is asked for, and the statuses that are answers: 503 says that the disk does not answer, or that the
/// station changes over to its next generation.
pub const PAGES: [(&str, &[u16]); 3] =
    [("/healthz", &[200, 503]), ("/", &[200, 503]), ("/state", &[200, 503])];

/// An answer, or that there was none.
#[derive(Debug, Clone, Copy)]
struct Sample {
    asked: Duration,
    took: Duration,
    /// Connections that were refused or broken off before it came.
    broken: usize,
}

/// All samples of one page.
#[derive(Debug, Default)]
pub struct Samples {
    of: Mutex<Vec<Sample>>,
    most_held: Mutex<Option<Vitals>>,
}

/// Asks for a page until all is over.
pub fn watch(field: &Field, path: &str, good: &[u16], samples: &Samples) {
    while !field.is_done() {
        let began = Instant::now();
        if let Some(pid) = field.keeper.life().pid {
            samples.weigh(pid);
        }
        if let Some(sample) = probe(field, path, good) {
            samples.of.lock().unwrap().push(sample);
            if sample.took > MOST {
                let Sample { asked, took, broken } = sample;
                field.fault(format_args!(
                    "{path} asked at {:.3} took {:.3} s, {broken} connections broken",
                    asked.as_secs_f64(),
                    took.as_secs_f64()
                ));
            }
        }
        field.wait_for(PACE.saturating_sub(began.elapsed()), || field.is_done());
    }
}

/// The time to a full answer of a station that was ready all the while; none where it was not.
fn probe(field: &Field, path: &str, good: &[u16]) -> Option<Sample> {
    let life = field.keeper.life();
    if !life.is_ready {
        return None;
    }
    let (asked, began, mut broken) = (field.elapsed(), Instant::now(), 0);
    let ready_for = Cell::new(Duration::ZERO);
    let is_same = || {
        let is_same = field.keeper.life() == life && !field.is_done();
        if is_same {
            ready_for.set(began.elapsed());
        }
        is_same
    };
    while is_same() && began.elapsed() < GIVEN_UP {
        match ask(field.port, path, is_same) {
            Some((status, is_whole)) if is_whole && good.contains(&status) => break,
            Some((status, true)) => {
                field.fault(format_args!("{path} was answered with {status}"));
                break;
            }
            _ => {
                broken += 1;
                sleep(Duration::from_millis(20));
            }
        }
    }
    // One that was ready for so long and then killed owed an answer, too.
    let is_answered = is_same();
    let took = ready_for.get();
    (is_answered || took > MOST).then_some(Sample { asked, took, broken })
}

/// Asks once: the status, and whether the answer was whole. None where the connection broke.
fn ask(port: u16, path: &str, goes_on: impl Fn() -> bool) -> Option<(u16, bool)> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let began = Instant::now();
    let mut stream = TcpStream::connect_timeout(&address, CONNECTED).ok()?;
    stream.set_read_timeout(Some(Duration::from_millis(100))).ok()?;
    write!(stream, "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").ok()?;
    let (mut answer, mut piece) = (Vec::new(), vec![0; 65_536]);
    while goes_on() && began.elapsed() < GIVEN_UP {
        match stream.read(&mut piece) {
            Ok(0) => return read(&answer),
            Ok(length) => answer.extend(&piece[..length]),
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            Err(_) => return None,
        }
    }
    None
}

/// Whether the station says of itself that it is well.
pub fn is_healthy(field: &Field) -> bool {
    ask(field.port, "/healthz", || true) == Some((200, true))
}

fn read(answer: &[u8]) -> Option<(u16, bool)> {
    let end = answer.windows(4).position(|part| part == b"\r\n\r\n")?;
    let head = String::from_utf8_lossy(&answer[..end]).to_ascii_lowercase();
    let status = head.split(' ').nth(1)?.parse().ok()?;
    let length = head.lines().find_map(|line| line.strip_prefix("content-length: "))?;
    Some((status, length.trim().parse() == Ok(answer.len() - end - 4)))
}

impl Samples {
    fn weigh(&self, pid: u32) {
        let Some(now) = Vitals::read(pid) else { return };
        let mut most = self.most_held.lock().unwrap();
        let before = most.unwrap_or(now);
        *most = Some(Vitals {
            files: now.files.max(before.files),
            threads: now.threads.max(before.threads),
            resident_kb: now.resident_kb.max(before.resident_kb),
        });
    }

    /// The most that the station has held at a time.
    pub fn most_held(&self) -> Option<Vitals> {
        *self.most_held.lock().unwrap()
    }

    /// One line: how many, the longest, a few quantiles.
    pub fn line(&self, path: &str) -> String {
        let samples = self.of.lock().unwrap();
        let mut took: Vec<f64> = samples.iter().map(|s| 1000.0 * s.took.as_secs_f64()).collect();
        took.sort_by(f64::total_cmp);
        let broken: usize = samples.iter().map(|sample| sample.broken).sum();
        let of = |part: f64| took.get((part * took.len() as f64) as usize).copied();
        let at = |part: f64| of(part).or(took.last().copied()).unwrap_or(f64::NAN);
        let slow = samples.iter().filter(|sample| sample.took > MOST).count();
        format!(
            "{path:10} {:5} answers: half within {:.1} ms, 90 % {:.1}, 99 % {:.1}, all {:.1}; \
             {slow} over {} s, {broken} connections broken",
            took.len(),
            at(0.5),
            at(0.9),
            at(0.99),
            at(1.0),
            MOST.as_secs()
        )
    }
}

/// Asks a listener of our own that answers at once, at the same pace.
pub fn watch_the_machine(field: &Field, samples: &Samples) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    listener.set_nonblocking(true).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !field.is_done() {
                match listener.accept() {
                    Ok((stream, _)) => drop(answer_at_once(stream)),
                    Err(_) => sleep(Duration::from_millis(1)),
                }
            }
        });
        while !field.is_done() {
            let (asked, began) = (field.elapsed(), Instant::now());
            if ask(port, "/", || !field.is_done()).is_some() {
                let sample = Sample { asked, took: began.elapsed(), broken: 0 };
                samples.of.lock().unwrap().push(sample);
            }
            field.wait_for(PACE.saturating_sub(began.elapsed()), || field.is_done());
        }
    });
}

fn answer_at_once(mut stream: TcpStream) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    let mut request = [0; 1024];
    let _ = stream.read(&mut request)?;
    stream.write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n")
}
