//! The kill matrix where the store of objects checks what it is sent and keeps it on a disk; and the store killed.

use crate::gate::Stop;
use crate::kill::{Of, Stopped, Verb, few, killed_everywhere, sent_over_cut_lines};
use crate::place::{Place, Ports};
use crate::servers::{ceph, database};

#[test]
#[ignore = "needs PostgreSQL and Ceph, run by .ci/run"]
fn worker_indexer_and_lines_may_end_at_any_point() {
    let ceph = ceph();
    let place = Place::on(Ports { store: ceph.port, database: database().port });
    killed_everywhere(&place, Verb::Work, Of::Store);
    killed_everywhere(&place, Verb::Index, Of::Store);
    sent_over_cut_lines(&place);
}

#[test]
#[ignore = "needs PostgreSQL and Ceph, run by .ci/run"]
fn a_store_killed_at_any_point_loses_nothing() {
    let mut ceph = ceph();
    let place = Place::on(Ports { store: ceph.port, database: database().port });
    for verb in [Verb::Work, Verb::Index] {
        for stop in [Stop::Before, Stop::After] {
            let stopped = Stopped { verb, of: Of::Store, stop };
            stopped.at_pieces(few(), &place, |gate, running| {
                ceph.kill();
                gate.resume();
                verb.goes_on(&place, running);
            });
        }
    }
}
