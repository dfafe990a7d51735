//! The crowd: a hostile user of the machine who takes every connection that can be had, says nothing on
//! it, says it slowly, or says what nobody understands.

use std::fs;
use std::io::{ErrorKind, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::runtime::Builder;
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout_at};

use crate::chance::Chance;
use crate::field::Field;
use crate::plan::{Event, follow, seconds, weighed};

/// So many connections at a time.
const MOST: usize = 700;

/// Whoever is sent away comes again within this time.
const AGAIN: Duration = Duration::from_secs(1);

/// How somebody in the crowd behaves.
#[derive(Debug, Clone, Copy)]
pub enum Habit {
    /// Says nothing.
    Idle,
    /// Says a request, a byte a second.
    Slow,
    /// Says half of a request.
    Half,
    /// Says what is no request.
    Garbage,
    /// Says a head that never ends.
    Huge,
    /// Asks for the page and does not read it.
    Deaf,
    /// Asks for what never ends and does not read it.
    Stream,
    /// Says that a body comes, and sends next to none of it.
    Body,
    /// Asks, reads the answer, asks again, as fast as it goes.
    Greedy,
}

impl Habit {
    /// Whether he reads what is answered, or at least sees that the connection has ended.
    fn reads(self) -> bool {
        !matches!(self, Habit::Deaf | Habit::Stream)
    }
}

/// So many of a habit, for a time.
#[derive(Debug, Clone, Copy)]
pub struct Burst {
    habit: Habit,
    count: usize,
    lasts: Duration,
}

pub fn draw(chance: &mut Chance) -> Burst {
    let habits = [
        (3, Habit::Idle),
        (3, Habit::Slow),
        (2, Habit::Half),
        (2, Habit::Garbage),
        (2, Habit::Huge),
        (2, Habit::Deaf),
        (2, Habit::Stream),
        (1, Habit::Body),
        (1, Habit::Greedy),
    ];
    let habit = weighed(chance, &habits);
    // Every other time all that can be had.
    let count = if chance.below(2) == 0 { MOST } else { 1 + chance.below(MOST) };
    Burst { habit, count, lasts: seconds(chance, 1.0, 14.0) }
}

/// Besieges the page's port.
pub fn besiege(field: &Field, events: Vec<Event<Burst>>) {
    let runtime = Builder::new_current_thread().enable_all().build().unwrap();
    follow(field, events, |burst, chance| {
        let Burst { habit, lasts, .. } = burst;
        // A few who ask as fast as they are answered take all there is.
        let count = if let Habit::Greedy = habit { burst.count.min(8) } else { burst.count };
        field.tell(format_args!("{count} connections {habit:?} for {lasts:.1?}"));
        jostle_at_the_socket(field, chance);
        let until = Instant::now() + lasts.min(field.left());
        let crowd = Arc::new(Crowd { port: field.port, habit, until, had: AtomicUsize::new(0) });
        runtime.block_on(async {
            let mut members = JoinSet::new();
            for _ in 0..count {
                members.spawn(member(Arc::clone(&crowd), Chance(chance.below(1 << 40) as u64)));
            }
            while members.join_next().await.is_some() {}
        });
        let had = crowd.had.load(Ordering::Relaxed);
        field.tell(format_args!("the crowd goes, which had {had} connections"));
    });
}

/// Those who come together.
struct Crowd {
    port: u16,
    habit: Habit,
    until: Instant,
    /// Connections that they had in all.
    had: AtomicUsize,
}

/// One of the crowd, who comes again when he is sent away.
async fn member(crowd: Arc<Crowd>, mut chance: Chance) {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, crowd.port));
    while Instant::now() < crowd.until {
        if let Ok(Ok(stream)) = timeout_at(crowd.until.into(), TcpStream::connect(address)).await {
            crowd.had.fetch_add(1, Ordering::Relaxed);
            let _ = timeout_at(crowd.until.into(), crowd.stay(stream, &mut chance)).await;
        }
        if let Habit::Greedy = crowd.habit {
            continue;
        }
        sleep(AGAIN.mul_f64(chance.unit())).await;
    }
}

impl Crowd {
    /// Behaves until the connection ends.
    async fn stay(&self, mut stream: TcpStream, chance: &mut Chance) -> std::io::Result<()> {
        let (mut answer, mut said) = (vec![0; 4096], 0);
        stream.write_all(&beginning(self.habit, self.port, chance)).await?;
        loop {
            tokio::select! {
                read = stream.read(&mut answer), if self.habit.reads() => {
                    if read? == 0 {
                        return Ok(());
                    }
                }
                () = sleep(Duration::from_secs(1)) => {
                    // The other side takes no more than it likes.
                    if let Err(error) = stream.try_write(&further(self.habit, said))
                        && error.kind() != ErrorKind::WouldBlock
                    {
                        return Err(error);
                    }
                    said += 1;
                }
            }
        }
    }
}

/// What is said at once.
fn beginning(habit: Habit, port: u16, chance: &mut Chance) -> Vec<u8> {
    let get = |path: &str| format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    match habit {
        Habit::Idle | Habit::Slow => Vec::new(),
        Habit::Greedy => get("/state").into_bytes(),
        Habit::Half => b"GET /state HTTP/1.1\r\nHo".to_vec(),
        Habit::Garbage => (0..2000).map(|_| chance.below(256) as u8).collect(),
        Habit::Huge => b"GET / HTTP/1.1\r\n".to_vec(),
        Habit::Deaf => get(if chance.below(2) == 0 { "/" } else { "/state" }).into_bytes(),
        Habit::Stream => get("/stream").into_bytes(),
        Habit::Body => {
            let head = format!("POST /ask HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n");
            format!("{head}Content-Length: 1000000000\r\n\r\n{{").into_bytes()
        }
    }
}

/// What is said every second.
fn further(habit: Habit, said: usize) -> Vec<u8> {
    let slow = b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Long: aaaaaaaaaaaaaaaaaaaaaaaaaaaaa";
    match habit {
        Habit::Slow => vec![slow[said % slow.len()]],
        Habit::Huge => b"X-Huge: aaaaaaaaaaaaaaaaaaaaaaaa\r\n".repeat(500),
        Habit::Body => b" ".to_vec(),
        _ => Vec::new(),
    }
}

/// Garbage and silence on the control socket, where others than the station's user may reach it at all.
fn jostle_at_the_socket(field: &Field, chance: &mut Chance) {
    let state = field.booth.path("disk/state");
    let socket = state.join("control.sock");
    let mode = |path| fs::symlink_metadata(path).map_or(0, |found| found.permissions().mode());
    if mode(state) & 0o001 == 0 || mode(socket.clone()) & 0o002 == 0 {
        return;
    }
    field.tell("others may reach the control socket");
    for _ in 0..20 {
        let Ok(mut stream) = UnixStream::connect(&socket) else { return };
        let _ = stream.set_nonblocking(true);
        let _ = stream.write(&beginning(Habit::Garbage, 0, chance));
    }
}

/// How long a station that is on its way out may take to be gone.
const GOING: Duration = Duration::from_secs(5);

/// Tries to have the page's port for himself, while the station is up and has said that it is ready.
/// Whoever has it could show the operator a page of his own. A station that ends gives its port away, so
/// only one that lives on has lost it.
pub fn steal_the_port(field: &Field) {
    let (mut tried, mut had, mut lost) = (0_u64, 0_u64, false);
    while field.goes_on() {
        // It is given back at once: what the station makes of that is its own affair.
        let had_from = field.keeper.while_up(|pid| {
            let has = TcpListener::bind(("127.0.0.1", field.port)).is_ok();
            (has && is_alive(pid)).then_some(pid)
        });
        tried += u64::from(had_from.is_some());
        match had_from.flatten() {
            Some(pid) => {
                let from = field.elapsed().as_secs_f64();
                had += 1;
                let is_gone = field.wait_for(GOING, || !is_alive(pid));
                if !is_gone && !lost {
                    field.fault(format_args!("anybody could have the port from {from:.3} on"));
                }
                lost = !is_gone;
            }
            None => lost = false,
        }
        thread::sleep(Duration::from_millis(1));
    }
    println!("the page's port was tried {tried} times and had {had} times");
}

/// Whether a process runs: one that has ended by itself gives its port away.
fn is_alive(pid: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let state = stat.rsplit_once(") ").and_then(|(_, rest)| rest.chars().next());
    state.is_some_and(|state| !matches!(state, 'Z' | 'X'))
}
