//! `gaiter status --watch`: the screen of `gaiter status`, refreshed every second.

use std::io::{self, Write};
use std::time::Duration;

use gaiter_language::Language;
use rustix::process;
use tokio::runtime::{Builder, Runtime};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::task::spawn_blocking;
use tokio::time::sleep;

use super::{Look, table};
use crate::cli::args::AskArgs;
use crate::cli::ask::{self, AskFault};
use crate::cli::terminal::paint::{self, painted};
use crate::cli::terminal::screen::{self, Size};
use crate::cli::{Exit, complain, shown};

/// How often the station is queried.
const EVERY: Duration = Duration::from_secs(1);

/// Switches to the alternate screen of the terminal, so that nothing of the main one is lost, hides the
/// cursor, and turns line wrap off.
const ENTER: &str = "\x1b[?1049h\x1b[?25l\x1b[?7l";

/// Restores all that.
const LEAVE: &str = "\x1b[?7h\x1b[?25h\x1b[?1049l";

/// Moves to the upper left corner; clears the rest of a line; clears the rest of the screen.
const HOME: &str = "\x1b[H";
const LINE_REST: &str = "\x1b[K\r\n";
const SCREEN_REST: &str = "\x1b[J";

/// Shows the status until a signal ends it or the reader has gone away.
pub fn watch(args: &AskArgs) -> Exit {
    let runtime = match Builder::new_current_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => return failed(&error),
    };
    let ended = runtime.block_on(run(args));
    // A request without an answer yet is not waited for.
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
    let language = ask::language(&args.config);
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
        match place.show(look.as_ref(), language) {
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

/// The signals that end the watch, that stop it for a while (Ctrl-Z), and that report a new size of the
/// terminal.
struct Signals {
    interrupt: Signal,
    terminate: Signal,
    stop: Signal,
    resize: Signal,
}

/// What follows after a look.
enum Next {
    /// Another look.
    Look,
    /// Stop until the process is continued.
    Stop,
    /// The end.
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

    /// Waits until it is time for the next look, the size of the terminal changes, or another signal
    /// arrives.
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

/// Where the status is shown.
enum Place {
    /// A terminal, redrawn in place. The alternate screen is left however the watch ends.
    Screen(Entered),
    /// Plain text, one look after the other.
    Pipe,
    /// One JSON object per line.
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

    /// Stops the process. In the meantime the shell has its own screen.
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

    fn show(&self, look: Result<&Look, &AskFault>, language: Language) -> io::Result<()> {
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
                let text = format!("{}\n", text(look, language, columns));
                let mut out = anstream::stdout().lock();
                out.write_all(text.as_bytes()).and_then(|()| out.flush())
            }
            Place::Screen(_) => {
                let Some(size) = screen::size() else {
                    return Err(io::ErrorKind::BrokenPipe.into());
                };
                let text = text(look, language, Some(size.columns));
                let colours = anstream::AutoStream::choice(&io::stdout());
                match colours {
                    anstream::ColorChoice::Never => write(&frame(
                        &anstream::adapter::strip_str(&text).to_string(),
                        language,
                        size,
                    )),
                    _ => write(&frame(&text, language, size)),
                }
            }
        }
    }
}

/// Stops this process until it is continued, as Ctrl-Z does without a handler.
fn stop() -> io::Result<()> {
    Ok(process::kill_process(process::getpid(), process::Signal::STOP)?)
}

/// The text of a look, or why there is none.
fn text(look: Result<&Look, &AskFault>, language: Language, columns: Option<usize>) -> String {
    match look {
        Ok(look) => table(look, language, columns),
        Err(fault) => {
            let [not_ready, to_do] =
                ["terminal.not_ready", "terminal.do"].map(|key| language.text(key));
            let hint =
                fault.hint(language).map_or(String::new(), |hint| format!("    {to_do}: {hint}\n"));
            let fault =
                painted(paint::BAD, format_args!("{not_ready}: {}", shown(fault.said(language))));
            format!("{fault}\n{hint}")
        }
    }
}

/// Fits a text to one screen. Lines that do not fit are counted, not dropped silently.
fn frame(text: &str, language: Language, size: Size) -> String {
    let room = size.lines.saturating_sub(1);
    let lines: Vec<&str> = text.lines().collect();
    let fits = if lines.len() <= room { lines.len() } else { room.saturating_sub(1) };
    let mut frame = HOME.to_owned();
    for line in &lines[..fits] {
        frame.push_str(line);
        frame.push_str(LINE_REST);
    }
    if fits < lines.len() {
        let count = lines.len() - fits;
        frame += &language.filled("terminal.watch.more", &[("count", &count)]);
        frame += LINE_REST;
    }
    frame + language.text("terminal.watch.hint") + "\x1b[K" + SCREEN_REST
}

fn write(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush())
}

/// The alternate screen of the terminal, which is left on drop.
struct Entered;

impl Drop for Entered {
    fn drop(&mut self) {
        // If the write fails, nobody is looking at the terminal.
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
        const HINT: &str = "refreshed every second; Ctrl-C ends";
        let frame = |text, size| super::frame(text, Language::En, size);
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
