//! What the archive costs beside the measuring: CPU time of a worker and of its database for each scan, against that of
//! measuring it. The process that measures unpacks the scan before and checks its hash; as that is to be done with any
//! scan, wherever it comes from, it is counted apart and on neither side. The store of objects does not count either.
//! On a machine that does nothing else, with PostgreSQL and moto, as the tests of the archive have them; it ends with 1
//! where the limit is missed.
//!
//! ```text
//! GAITER_PYTHON=/tmp/venv/bin/python cargo bench -p gaiter-archive --bench overhead
//! ```

#![allow(clippy::unwrap_used, clippy::print_stdout, dead_code)]

#[path = "../tests/archive/place.rs"]
mod place;
#[path = "../tests/archive/servers.rs"]
mod servers;

use std::fs;
use std::hint::black_box;
use std::process::{self, ExitCode};

use gaiter_leg::{Format, Method, WholeBody, extract};
use gaiter_record::ScanId;
use gaiter_record::archive::{packed, unpacked};
use place::{Place, wait_for};
use support::recorded::body;

/// Enough that one hundredth of a second, in which the system counts, is little.
const SCANS: usize = 60;

/// What must hold.
const OVERHEAD_MOST: f64 = 0.1;

/// How long one of the system's counts is, seconds.
const TICK_S: f64 = 0.01;

/// What the system says of a process.
struct Spent {
    parent: u32,
    is_over: bool,
    own_s: f64,
    children_s: f64,
}

impl Spent {
    /// The line of a process; nothing if it has gone.
    fn of(process: u32) -> Option<Spent> {
        let line = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
        // The name before may hold anything.
        let fields: Vec<&str> = line.rsplit_once(") ")?.1.split(' ').collect();
        let seconds = |at: usize| Some(fields.get(at)?.parse::<f64>().ok()? * TICK_S);
        Some(Spent {
            parent: fields.get(1)?.parse().ok()?,
            is_over: *fields.first()? == "Z",
            own_s: seconds(11)? + seconds(12)?,
            children_s: seconds(13)? + seconds(14)?,
        })
    }
}

/// What a server of databases and all its processes have spent, those that have gone too.
fn of_database(place: &Place) -> f64 {
    // While it is connected, its process is there.
    let mut client = place.client();
    let own: i32 = client.query_one("select pg_backend_pid()", &[]).unwrap().get(0);
    let first = Spent::of(own.cast_unsigned()).unwrap().parent;
    loop {
        let gone_s = Spent::of(first).unwrap().children_s;
        let all = fs::read_dir("/proc").unwrap().filter_map(|entry| {
            let process = entry.ok()?.file_name().to_str()?.parse().ok()?;
            Spent::of(process)
        });
        let living: f64 = all.filter(|spent| spent.parent == first).map(|spent| spent.own_s).sum();
        let server = Spent::of(first).unwrap();
        // Otherwise one has gone meanwhile, and counts twice or not at all.
        if server.children_s == gone_s {
            return server.own_s + gone_s + living;
        }
    }
}

/// What it takes to unpack a scan and to check its hash, so many times.
fn of_unpacking(ply: &[u8]) -> f64 {
    let (bytes, length) = (packed(ply), ply.len() as u64);
    let own_s = || Spent::of(process::id()).unwrap().own_s;
    let before = own_s();
    for _ in 0..SCANS {
        black_box(ScanId::of_bytes(&unpacked(black_box(&bytes), length).unwrap()));
    }
    own_s() - before
}

fn main() -> ExitCode {
    let place = Place::new();
    place.renew(0);
    let whole = extract(&body(1), Format::Obj, &Method::default()).unwrap();
    for number in 0..SCANS {
        let mut crop = whole.crop();
        // Far below all that is measured, and other bytes.
        crop.points[0].x += 1e-9 * number as f64;
        place.announce(&(crop.to_ply(), WholeBody::from_extraction(&whole)));
    }
    place.verb(&["index", "--once"]);
    let before = of_database(&place);
    let worker = place.start(place.ports, &["work", "--until-empty"]);
    // Until it is asked how it ended, the system keeps what it has spent.
    wait_for("the worker's end", || Spent::of(worker.0.id()).is_none_or(|spent| spent.is_over));
    let spent = Spent::of(worker.0.id()).unwrap();
    let database_s = of_database(&place) - before;
    // A scan that is not measured costs less.
    assert_eq!(place.wrong(SCANS), Vec::<String>::new());
    let unpacking_s = of_unpacking(&whole.crop().to_ply());
    let measuring_s = spent.children_s - unpacking_s;
    let overhead = (spent.own_s + database_s) / measuring_s;
    let each_ms = |seconds: f64| seconds / SCANS as f64 * 1e3;
    println!("CPU time for each of {SCANS} scans, ms:");
    println!("{:8.1}  measuring, in its process", each_ms(measuring_s));
    println!("{:8.1}  unpacking before, in the same process", each_ms(unpacking_s));
    println!("{:8.1}  worker", each_ms(spent.own_s));
    println!("{:8.1}  database", each_ms(database_s));
    println!("overhead {:.1} % (at most {:.0} %)", overhead * 100.0, OVERHEAD_MOST * 100.0);
    if overhead <= OVERHEAD_MOST { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
