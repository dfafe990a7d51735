//! `kill -9` of worker, indexer, database and store of objects, and cut lines, at each piece that worker and indexer send
//! to the store and to the database: before the server has it, before they hear of it, in its midst. Afterwards every
//! scan has one result, none is lost, none is there twice, none is wrong.

use std::env;
use std::time::{Duration, Instant};

use crate::gate::{Gate, Stop};
use crate::place::{Place, Ports, Running, crop, send, wait_for};
use crate::servers::{new_database, store};

/// Scans in the archive: more than one, so that what was claimed and not begun is there, too.
const SCANS: usize = 2;

/// With fewer pieces than this the matrix has not seen the whole way.
const PIECES_LEAST: usize = 4;

/// Where a strike takes seconds, only every so many-th piece is struck where `GAITER_FAULTS` is "few"; the others in other
/// runs, for `GAITER_FAULTS_SEED` says where to begin.
const FEW: usize = 3;

/// How often waiting times run out for a worker that goes on.
const PASSES: Duration = Duration::from_secs(1);

/// Every piece, counted from 1.
fn each() -> impl Iterator<Item = usize> {
    1..
}

/// The pieces at which a strike takes seconds.
pub fn few() -> impl Iterator<Item = usize> {
    let step = if env::var("GAITER_FAULTS").is_ok_and(|asked| asked == "few") { FEW } else { 1 };
    let seed = env::var("GAITER_FAULTS_SEED").ok().and_then(|seed| seed.parse::<usize>().ok());
    (1 + seed.unwrap_or(0) % step..).step_by(step)
}

/// The server that the gate is before.
#[derive(Debug, Clone, Copy)]
pub enum Of {
    Store,
    Database,
}

impl Of {
    fn gate(self, place: &Place, stop: Stop, at: usize) -> Gate {
        let port = match self {
            Of::Store => place.ports.store,
            Of::Database => place.ports.database,
        };
        Gate::new(port, stop, at)
    }

    fn through(self, place: &Place, gate: &Gate) -> Ports {
        match self {
            Of::Store => Ports { store: gate.port, ..place.ports },
            Of::Database => Ports { database: gate.port, ..place.ports },
        }
    }
}

/// What runs while something is killed.
#[derive(Debug, Clone, Copy)]
pub enum Verb {
    Index,
    Work,
}

impl Verb {
    fn args(self) -> &'static [&'static str] {
        match self {
            Verb::Index => &["index", "--once"],
            Verb::Work => &["work", "--until-empty"],
        }
    }

    /// Lets it go on after a server or a line was gone. A worker needs nobody for that; the indexer is started again,
    /// as systemd does.
    pub fn goes_on(self, place: &Place, running: &mut Running) {
        let mut passed = Instant::now();
        wait_for("its end", || {
            if matches!(self, Verb::Work) && passed.elapsed() > PASSES {
                place.time_passes();
                passed = Instant::now();
            }
            running.has_ended()
        });
        match self {
            Verb::Work => (),
            Verb::Index => finish(place),
        }
    }
}

/// Whatever is left is done.
fn finish(place: &Place) {
    place.verb(Verb::Index.args());
    place.time_passes();
    place.verb(Verb::Work.args());
}

/// Where the gate stops a verb.
#[derive(Debug, Clone, Copy)]
pub struct Stopped {
    pub verb: Verb,
    pub of: Of,
    pub stop: Stop,
}

impl Stopped {
    /// Stops the verb at these pieces in turn and lets `strike` do its work, until it ends without having been stopped.
    pub fn at_pieces(
        self,
        pieces: impl Iterator<Item = usize>,
        place: &Place,
        mut strike: impl FnMut(&Gate, &mut Running),
    ) {
        let Stopped { verb, of, stop } = self;
        for at in pieces {
            place.renew(SCANS);
            if matches!(verb, Verb::Work) {
                place.verb(Verb::Index.args());
            }
            let gate = of.gate(place, stop, at);
            let mut running = place.start(of.through(place, &gate), verb.args());
            wait_for("the stop or the end", || gate.has_stopped() || running.has_ended());
            if !gate.has_stopped() {
                assert!(gate.pieces() >= PIECES_LEAST, "{self:?}: {} pieces", gate.pieces());
                break;
            }
            strike(&gate, &mut running);
            let wrong = place.wrong(SCANS);
            assert!(wrong.is_empty(), "{self:?}, piece {at}: {wrong:#?}");
        }
    }
}

/// Kills the verb at each piece that it sends to a server.
pub fn killed_everywhere(place: &Place, verb: Verb, of: Of) {
    for stop in [Stop::Before, Stop::After] {
        Stopped { verb, of, stop }.at_pieces(each(), place, |_, running| {
            running.kill();
            finish(place);
        });
    }
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_worker_killed_at_any_point_leaves_one_result_of_each_scan() {
    let place = Place::new();
    killed_everywhere(&place, Verb::Work, Of::Store);
    killed_everywhere(&place, Verb::Work, Of::Database);
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn an_indexer_killed_at_any_point_loses_no_announcement() {
    let place = Place::new();
    killed_everywhere(&place, Verb::Index, Of::Store);
    killed_everywhere(&place, Verb::Index, Of::Database);
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn lines_that_are_cut_in_the_midst_of_a_piece_lose_nothing() {
    let place = Place::new();
    for verb in [Verb::Work, Verb::Index] {
        for of in [Of::Store, Of::Database] {
            let stopped = Stopped { verb, of, stop: Stop::Within };
            stopped.at_pieces(few(), &place, |_, running| verb.goes_on(&place, running));
        }
    }
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_database_killed_at_any_point_loses_nothing() {
    let mut database = new_database();
    let place = Place::on(Ports { store: store().port, database: database.port });
    for verb in [Verb::Work, Verb::Index] {
        for stop in [Stop::Before, Stop::After] {
            let stopped = Stopped { verb, of: Of::Database, stop };
            stopped.at_pieces(few(), &place, |gate, running| {
                database.kill();
                gate.resume();
                verb.goes_on(&place, running);
            });
        }
    }
}

/// Sends scans over a line that is cut in the midst of each piece in turn, again and again until they are there.
pub fn sent_over_cut_lines(place: &Place) {
    for at in few() {
        place.renew(0);
        let gate = Of::Store.gate(place, Stop::Within, at);
        let bucket = place.bucket_of("key", gate.port);
        for scan in 0..SCANS {
            let scan = crop(scan);
            wait_for("a scan", || send(&bucket, &scan).is_ok());
        }
        finish(place);
        let wrong = place.wrong(SCANS);
        assert!(wrong.is_empty(), "cut at piece {at}: {wrong:#?}");
        if !gate.has_stopped() {
            assert!(gate.pieces() >= PIECES_LEAST, "{} pieces", gate.pieces());
            break;
        }
    }
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_station_whose_line_is_cut_leaves_no_half_object() {
    sent_over_cut_lines(&Place::new());
}
