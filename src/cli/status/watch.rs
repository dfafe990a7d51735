//! `gaiter status --watch`: the screen of `gaiter status`, anew each second.

use std::io::{self, Write};
use std::time::Duration;

use rustix::process;
use tokio::runtime::{Builder, Runtime};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::task::spawn_blocking;
use tokio::time::sleep;

use super::{Look, table};
use crate::cli::args::AskArgs;
use crate::cli::ask::{self, AskFault};
use crate::cli::paint::{self, painted};
use crate::cli::screen::{self, Size};
use crate::cli::{Exit, complain, shown};

/// How often the station is asked.
const EVERY: Duration = Duration::from_secs(1);

/// To the other screen of the terminal, so that nothing of the first is lost; no cursor, and no line
/// goes on in the next.
const ENTER: &str = "\x1b[?1049h\x1b[?25l\x1b[?7l";

/// Back again.
const LEAVE: &str = "\x1b[?7h\x1b[?25h\x1b[?1049l";

/// From the upper left corner; the rest of a line; the rest of the screen.
const HOME: &str = "\x1b[H";
const LINE_REST: &str = "\x1b[K\r\n";
const SCREEN_REST: &str = "\x1b[J";

/// The last line, so that nobody has to guess.
const HINT: &str = "renewed every second; Ctrl-C ends";

/// Shows the status until a signal ends it, or nobody reads any more.
pub fn watch(args: &AskArgs) -> Exit {
    let runtime = match Builder::new_current_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => return failed(&error),
    };
    let ended = runtime.block_on(run(args));
    // A question that is not answered yet is not waited for.
    Runtime::shutdown_background(runtime);
    ended.unwrap_or_else(|error| failed(&error))
}

fn failed(error: &io::Error) -> Exit {
    complain(format_args!("gaiter: the status cannot be shown: {error}"));
    Exit::Io
}

async fn run(args: &AskArgs) -> io::Result<Exit> {
    let mut signals = Signals::new()?;
    let place = Place::of(args)?;
    loop {
        let asked = args.clone();
        let look = tokio::select! {
            look = spawn_blocking(move || Look::take(&asked)) => look.map_err(io::Error::other)?,
            () = signals.end() => return Ok(Exit::Done),
        };
        if let Err(fault @ AskFault::Config(_)) = &look {
            drop(place);
            return Ok(ask::refused(args, fault));
        }
        match place.show(look.as_ref()) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(Exit::Done),
            Err(error) => return Err(error),
        }
        match signals.next().await {
            Next::Look => {}
            Next::Stop => place.stopped()?,
            Next::End => return Ok(Exit::Done),
        }
    }
}

/// The signals that end it, that stop it for a while (Ctrl-Z), and that tell of another size of the
/// terminal.
struct Signals {
    interrupt: Signal,
    terminate: Signal,
    stop: Signal,
    resize: Signal,
}

/// What comes after a look.
enum Next {
    /// Another.
    Look,
    /// Nothing until somebody lets it go on.
    Stop,
    /// Nothing.
    End,
}

impl Signals {
    fn new() -> io::Result<Signals> {
        Ok(Signals {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
            stop: signal(SignalKind::from_raw(process::Signal::TSTP.as_raw()))?,
            resize: signal(SignalKind::window_change())?,
        })
    }

    async fn end(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }

    /// Waits until it is time for the next look, or the terminal has another size, or a signal says
    /// otherwise.
    async fn next(&mut self) -> Next {
        tokio::select! {
            () = sleep(EVERY) => Next::Look,
            _ = self.resize.recv() => Next::Look,
            _ = self.stop.recv() => Next::Stop,
            _ = self.interrupt.recv() => Next::End,
            _ = self.terminate.recv() => Next::End,
        }
    }
}

/// Where it is shown.
enum Place {
    /// A terminal, renewed in place; left again whatever ends the watch.
    Screen(Entered),
    /// One text after the other.
    Pipe,
    /// One JSON object a line.
    Program,
}

impl Place {
    fn of(args: &AskArgs) -> io::Result<Place> {
        if args.json {
            return Ok(Place::Program);
        }
        if !screen::can_renew() {
            return Ok(Place::Pipe);
        }
        let entered = Entered;
        write(ENTER)?;
        Ok(Place::Screen(entered))
    }

    /// Stops; the shell meanwhile has its own screen.
    fn stopped(&self) -> io::Result<()> {
        match self {
            Place::Pipe | Place::Program => stop(),
            Place::Screen(_) => {
                write(LEAVE)?;
                stop()?;
                write(ENTER)
            }
        }
    }

    fn show(&self, look: Result<&Look, &AskFault>) -> io::Result<()> {
        match self {
            Place::Program => {
                let line = match look {
                    Ok(look) => serde_json::to_string(&look.status)?,
                    Err(fault) => fault.json().to_string(),
                };
                write(&format!("{line}\n"))
            }
            Place::Pipe => {
                let columns = screen::size().map(|size| size.columns);
                let text = format!("{}\n", text(look, columns));
                let mut out = anstream::stdout().lock();
                out.write_all(text.as_bytes()).and_then(|()| out.flush())
            }
            Place::Screen(_) => {
                let Some(size) = screen::size() else {
                    return Err(io::ErrorKind::BrokenPipe.into());
                };
                let text = text(look, Some(size.columns));
                let colours = anstream::AutoStream::choice(&io::stdout());
                match colours {
                    anstream::ColorChoice::Never => {
                        write(&frame(&anstream::adapter::strip_str(&text).to_string(), size))
                    }
                    _ => write(&frame(&text, size)),
                }
            }
        }
    }
}

/// Stops this process until it is told to go on, as Ctrl-Z does where nobody catches it.
fn stop() -> io::Result<()> {
    Ok(process::kill_process(process::getpid(), process::Signal::STOP)?)
}

/// The text of a look, or why there is none.
fn text(look: Result<&Look, &AskFault>, columns: Option<usize>) -> String {
    match look {
        Ok(look) => table(look, columns),
        Err(fault) => {
            let hint = fault.hint().map_or(String::new(), |hint| format!("    do: {hint}\n"));
            let fault = painted(paint::BAD, format_args!("not ready: {}", shown(fault)));
            format!("{fault}\n{hint}")
        }
    }
}

/// A text as one screen: what has no room below is counted and not lost silently.
fn frame(text: &str, size: Size) -> String {
    let room = size.lines.saturating_sub(1);
    let lines: Vec<&str> = text.lines().collect();
    let fits = if lines.len() <= room { lines.len() } else { room.saturating_sub(1) };
    let mut frame = HOME.to_owned();
    for line in &lines[..fits] {
        frame.push_str(line);
        frame.push_str(LINE_REST);
    }
    if fits < lines.len() {
        frame.push_str(&format!("… and {} lines more{LINE_REST}", lines.len() - fits));
    }
    frame + HINT + "\x1b[K" + SCREEN_REST
}

fn write(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush())
}

/// The other screen of the terminal, left when this goes.
struct Entered;

impl Drop for Entered {
    fn drop(&mut self) {
        // Where it cannot be written nobody looks.
        let _ = write(LEAVE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(frame: &str) -> String {
        anstream::adapter::strip_str(frame).to_string().replace("\r\n", "\n")
    }

    #[test]
    fn a_text_that_fits_is_shown_whole_and_one_that_does_not_says_so() {
        let size = Size { columns: 80, lines: 5 };
        assert_eq!(plain(&frame("a\nb\nc\nd\n", size)), format!("a\nb\nc\nd\n{HINT}"));
        let cut = format!("a\nb\nc\n… and 2 lines more\n{HINT}");
        assert_eq!(plain(&frame("a\nb\nc\nd\ne\n", size)), cut);
        assert_eq!(
            plain(&frame("a\n", Size { lines: 1, ..size })),
            format!("… and 1 lines more\n{HINT}")
        );
    }
}
