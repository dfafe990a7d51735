//! `kill -9` of worker and indexer at each piece that they send to the store and to the database, before the server has
//! it and before they hear of it: afterwards every scan has one result, none is lost, none is there twice.

use crate::gate::{Gate, Stop};
use crate::place::{Place, wait_for};
use crate::servers::{database, store};

/// Scans in the archive: more than one, so that what was claimed and not begun is there, too.
const SCANS: usize = 2;

/// Fewer points than this and the matrix has not seen the whole way.
const POINTS_LEAST: usize = 4;

/// The server that the gate is before.
#[derive(Debug, Clone, Copy)]
enum Of {
    Store,
    Database,
}

/// Kills the verb at each point in turn, until it ends without having been stopped.
fn killed_everywhere(verb: &[&str], prepare: impl Fn(&Place), recover: impl Fn(&Place)) {
    let place = Place::new();
    for of in [Of::Store, Of::Database] {
        for stop in [Stop::Before, Stop::After] {
            for at in 1.. {
                place.renew(SCANS);
                prepare(&place);
                let (ports, gate) = match of {
                    Of::Store => {
                        let gate = Gate::new(store().port, stop, at);
                        ((gate.port, database().port), gate)
                    }
                    Of::Database => {
                        let gate = Gate::new(database().port, stop, at);
                        ((store().port, gate.port), gate)
                    }
                };
                let mut running = place.start(ports.0, ports.1, verb);
                wait_for("the stop or the end", || gate.has_stopped() || running.has_ended());
                running.kill();
                recover(&place);
                let wrong = place.wrong(SCANS);
                assert!(wrong.is_empty(), "{verb:?}, {stop:?} piece {at} to {of:?}: {wrong:#?}");
                if !gate.has_stopped() {
                    assert!(at > POINTS_LEAST, "{} pieces to {of:?}", gate.pieces());
                    break;
                }
            }
        }
    }
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn a_worker_killed_at_any_point_leaves_one_result_of_each_scan() {
    let prepare = |place: &Place| drop(place.verb(&["index", "--once"]));
    killed_everywhere(&["work", "--until-empty"], prepare, |place| {
        place.time_passes();
        place.verb(&["work", "--until-empty"]);
    });
}

#[test]
#[ignore = "needs PostgreSQL and moto, run by .ci/run"]
fn an_indexer_killed_at_any_point_loses_no_announcement() {
    killed_everywhere(
        &["index", "--once"],
        |_| {},
        |place| {
            place.verb(&["index", "--once"]);
            place.verb(&["work", "--until-empty"]);
        },
    );
}
