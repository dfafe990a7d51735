//! What a port of the booth costs and how soon a press is seen, on a real pseudo-terminal.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use gaiter::config;
use gaiter::station::booth::trigger::port::{Port, PortOpener};
use gaiter::station::booth::trigger::{Attendant, Attended, of_config};
use gaiter::station::demo::SimulatedButton;
use gaiter_flow::booth::Signal;
use gaiter_flow::trigger::{Input, PortFault};
use serialport::{SerialPort, TTYPort};

/// How long an idle port is observed.
const IDLE: Duration = Duration::from_secs(30);

/// Most that an idle port may cost, percent of a core.
const IDLE_MOST: f64 = 0.2;

/// Presses that are timed.
const PRESSES: usize = 200;

/// A press must be seen within this.
const SEEN_WITHIN: Duration = Duration::from_millis(20);

pub fn measure() {
    let mut button = SimulatedButton::new().unwrap();
    idle("a line of text", attended(button.port(), "tokens = [\"PRESS\"]"));
    let absent = attended(Path::new("/dev/gaiter/none"), "tokens = [\"PRESS\"]");
    idle("a port that is not there", absent);
    let mut contact = attended(button.port(), "contact = \"cts\"");
    contact.opener = Box::new(WithoutWires(button.port().to_string_lossy().into_owned()));
    idle("a contact, looked at every 50 ms, without the adapter's own transfers", contact);
    latency(&mut button);
}

fn attended(port: &Path, keys: &str) -> Attended {
    let text = format!(
        "[station]\nid = \"b\"\nstate_dir = \"/s\"\n[scanner]\nexport_dirs = [\"/e\"]\n\
         [store.folder]\npath = \"/r\"\n[trigger]\nsettle = \"0s\"\nlock_out = \"0s\"\n\
         [trigger.serial]\nport = \"{}\"\n{keys}\n",
        port.display()
    );
    of_config(&config::load(&text).unwrap().trigger).remove(0)
}

/// Attends a port until it is to end, as the station's thread does.
fn attend(port: Attended, end: &AtomicBool, mut heard_at: impl FnMut(Instant)) {
    let began = Instant::now();
    let clock = || began.elapsed();
    let mut attendant = Attendant::new(port.opener, port.decoder, port.manner, clock());
    let mut heard = Vec::new();
    while !end.load(Ordering::Relaxed) {
        let pause = attendant.turn(&clock, Signal::Ready, &mut heard);
        heard.drain(..).for_each(|_| heard_at(Instant::now()));
        if !pause.is_zero() {
            sleep(pause.min(Duration::from_millis(200)));
        }
    }
}

/// Time that the calling thread has been on a core.
fn on_core() -> Duration {
    let stat = fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    Duration::from_nanos(stat.split_whitespace().next().unwrap().parse().unwrap())
}

fn idle(what: &str, port: Attended) {
    let end = AtomicBool::new(false);
    let took = scope(|threads| {
        let thread = threads.spawn(|| {
            let before = on_core();
            attend(port, &end, |_| ());
            on_core() - before
        });
        sleep(IDLE);
        end.store(true, Ordering::Relaxed);
        thread.join().unwrap()
    });
    let share = 100.0 * took.as_secs_f64() / IDLE.as_secs_f64();
    println!("trigger idle, {what}: {share:.3} % of a core (at most {IDLE_MOST} %)");
}

fn latency(button: &mut SimulatedButton) {
    let port = attended(button.port(), "tokens = [\"PRESS\"]");
    let end = AtomicBool::new(false);
    let (seen, presses) = mpsc::channel();
    let mut times: Vec<Duration> = scope(|threads| {
        threads.spawn(|| attend(port, &end, |at| seen.send(at).unwrap()));
        sleep(Duration::from_millis(500));
        let time = |_| {
            sleep(Duration::from_millis(23));
            let pressed = Instant::now();
            button.press().unwrap();
            presses.recv().unwrap() - pressed
        };
        let times = (0..PRESSES).map(time).collect();
        end.store(true, Ordering::Relaxed);
        times
    });
    times.sort_unstable();
    let ms = |time: Duration| 1000.0 * time.as_secs_f64();
    println!(
        "trigger, from the line's last byte to the press, {PRESSES} presses: median {:.2} ms, worst \
         {:.2} ms (at most {:.0} ms)",
        ms(times[PRESSES / 2]),
        ms(times[PRESSES - 1]),
        ms(SEEN_WITHIN)
    );
}

/// A port whose modem line is asked for, and counts as open where it does not exist: what the asking
/// costs, without an adapter.
struct WithoutWires(String);

impl PortOpener for WithoutWires {
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault> {
        let port = TTYPort::open(&serialport::new(&self.0, 9600)).unwrap();
        Ok(Box::new(OpenWithoutWires { port, sample_next: true }))
    }
}

struct OpenWithoutWires {
    port: TTYPort,
    sample_next: bool,
}

impl Port for OpenWithoutWires {
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault> {
        use std::io::Read;
        self.sample_next = !self.sample_next;
        if !self.sample_next {
            return Ok(Input::Closed(self.port.read_clear_to_send().unwrap_or(false)));
        }
        self.port.set_timeout(timeout).unwrap();
        let read = self.port.read(&mut [0; 256]);
        assert!(read.is_err(), "nothing comes");
        Ok(Input::Nothing)
    }

    fn write(&mut self, _: &[u8]) -> Result<(), PortFault> {
        Ok(())
    }

    fn is_in_place(&mut self) -> Result<(), PortFault> {
        Ok(())
    }
}
