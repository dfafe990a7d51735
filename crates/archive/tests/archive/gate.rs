//! A gate before a server: it lets bytes through, and at one of the pieces that a client sends it stops, before that
//! piece, before what is answered to it, or within it.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// How often a line that is stopped looks whether it goes on.
const GLANCE: Duration = Duration::from_millis(5);

/// Where the gate stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The server does not get the piece.
    Before,
    /// The client does not get an answer to it.
    After,
    /// The server gets half of the piece, and the line is cut. All others are let through.
    Within,
}

/// The state of a gate.
struct State {
    stop: Mutex<Stop>,
    /// Counted from 1; 0 for none.
    at: AtomicUsize,
    pieces: AtomicUsize,
    has_stopped: AtomicBool,
    is_over: AtomicBool,
    is_closed: AtomicBool,
    sent_away: AtomicUsize,
    let_in: Mutex<Vec<Instant>>,
}

/// A gate.
pub struct Gate {
    pub port: u16,
    state: Arc<State>,
}

impl Gate {
    /// A gate before the server at this port, which stops at the `at`th piece.
    pub fn new(server: u16, stop: Stop, at: usize) -> Gate {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let state = Arc::new(State {
            stop: Mutex::new(stop),
            at: AtomicUsize::new(at),
            pieces: AtomicUsize::new(0),
            has_stopped: AtomicBool::new(false),
            is_over: AtomicBool::new(false),
            is_closed: AtomicBool::new(false),
            sent_away: AtomicUsize::new(0),
            let_in: Mutex::default(),
        });
        let shared = Arc::clone(&state);
        thread::spawn(move || {
            for client in listener.incoming().map_while(Result::ok) {
                if shared.is_closed.load(Ordering::SeqCst) {
                    let _ = client.shutdown(Shutdown::Both);
                    shared.sent_away.fetch_add(1, Ordering::SeqCst);
                    continue;
                }
                shared.let_in.lock().unwrap().push(Instant::now());
                // A server that was killed takes nobody.
                let Ok(server) = TcpStream::connect(("127.0.0.1", server)) else { continue };
                let (from, to, state) =
                    (client.try_clone().unwrap(), server.try_clone().unwrap(), Arc::clone(&shared));
                thread::spawn(move || state.to_server(from, to));
                let state = Arc::clone(&shared);
                thread::spawn(move || state.to_client(server, client));
            }
        });
        Gate { port, state }
    }

    /// A gate that stops at nothing.
    pub fn open(server: u16) -> Gate {
        Gate::new(server, Stop::Before, 0)
    }

    pub fn has_stopped(&self) -> bool {
        self.state.has_stopped.load(Ordering::SeqCst)
    }

    /// Stops once more, at the `ahead`th piece from now on.
    pub fn stop_again(&self, stop: Stop, ahead: usize) {
        let state = &self.state;
        *state.stop.lock().unwrap() = stop;
        state.has_stopped.store(false, Ordering::SeqCst);
        state.is_over.store(false, Ordering::SeqCst);
        state.at.store(self.pieces() + ahead, Ordering::SeqCst);
    }

    /// Cuts the lines that were stopped, and lets everything through from now on.
    pub fn resume(&self) {
        self.state.is_over.store(true, Ordering::SeqCst);
    }

    /// Whether clients are sent away from now on; then nothing more of those that are there is let through either.
    pub fn close(&self, is_closed: bool) {
        self.state.is_closed.store(is_closed, Ordering::SeqCst);
    }

    /// How many clients were sent away.
    pub fn sent_away(&self) -> usize {
        self.state.sent_away.load(Ordering::SeqCst)
    }

    /// When the first client was let in since then.
    pub fn first_since(&self, since: Instant) -> Option<Instant> {
        self.state.let_in.lock().unwrap().iter().copied().find(|at| *at >= since)
    }

    /// How many pieces clients have sent.
    pub fn pieces(&self) -> usize {
        self.state.pieces.load(Ordering::SeqCst)
    }
}

impl Drop for Gate {
    fn drop(&mut self) {
        self.resume();
    }
}

impl State {
    /// Whether nobody hears anything: from the stop on, until it goes on.
    fn is_silent(&self) -> bool {
        *self.stop.lock().unwrap() != Stop::Within
            && self.has_stopped.load(Ordering::SeqCst)
            && !self.is_over.load(Ordering::SeqCst)
    }

    fn to_server(&self, mut from: TcpStream, mut to: TcpStream) {
        let mut piece = [0; 1 << 16];
        while let Ok(length @ 1..) = from.read(&mut piece) {
            let is_it =
                self.pieces.fetch_add(1, Ordering::SeqCst) + 1 == self.at.load(Ordering::SeqCst);
            if is_it {
                self.has_stopped.store(true, Ordering::SeqCst);
            }
            let passed = match *self.stop.lock().unwrap() {
                _ if self.is_closed.load(Ordering::SeqCst) => 0,
                Stop::Before if is_it => break,
                Stop::Within if is_it => length / 2,
                Stop::Before | Stop::After | Stop::Within => length,
            };
            if to.write_all(&piece[..passed]).is_err() || passed < length {
                break;
            }
        }
        // The other way stays open for what is still answered.
        let _ = to.shutdown(Shutdown::Write);
    }

    fn to_client(&self, mut from: TcpStream, mut to: TcpStream) {
        let mut piece = [0; 1 << 16];
        let mut was_silent = false;
        while let Ok(length @ 1..) = from.read(&mut piece) {
            was_silent |= self.is_silent();
            if !was_silent && to.write_all(&piece[..length]).is_err() {
                break;
            }
        }
        while self.is_silent() {
            // The client waits for an answer, and is not told that none comes.
            thread::sleep(GLANCE);
        }
        let _ = to.shutdown(Shutdown::Both);
    }
}
