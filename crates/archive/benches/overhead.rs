//! What the archive costs beside the measuring: CPU time of a worker and of its database for each scan, against that of
//! measuring it. The process that measures unpacks the scan before and checks its hash; as that is to be done with any
//! scan, wherever it comes from, it is counted apart and on neither side. The store of objects does not count either.
//! On a machine that does nothing else, with PostgreSQL and moto, as the tests of the archive have them; it ends with 1
//! where the limit is missed. And how many scans one worker and two measure in a second.
//!
//! ```text
//! GAITER_PYTHON=/tmp/venv/bin/python cargo bench --profile dist -p gaiter-archive --bench overhead
//! ```

#![allow(clippy::unwrap_used, clippy::print_stdout, dead_code)]

#[path = "../tests/archive/place.rs"]
mod place;
#[path = "../tests/archive/servers.rs"]
mod servers;

use std::fs;
use std::hint::black_box;
use std::process::{self, ExitCode};
use std::time::{Duration, Instant};

use gaiter_leg::{Extraction, Format, Method, WholeBody, extract};
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

/// A job for each of so many scans, and nothing else.
fn announced(place: &Place, whole: &Extraction) {
    place.renew(0);
    for number in 0..SCANS {
        let mut crop = whole.crop();
        // Far below all that is measured, and other bytes.
        crop.points[0].x += 1e-9 * number as f64;
        place.announce(&(crop.to_ply(), WholeBody::from_extraction(whole)));
    }
    place.verb(&["index", "--once"]);
}

/// What so many workers spend until no job is left, each measuring one scan at a time, and how long it takes them.
fn worked_off(place: &Place, workers: usize) -> (Vec<Spent>, Duration) {
    let started = Instant::now();
    let workers: Vec<_> =
        (0..workers).map(|_| place.start(place.ports, &["work", "--until-empty"])).collect();
    // Until they are asked how they ended, the system keeps what they have spent.
    wait_for("the workers' end", || {
        workers.iter().all(|worker| Spent::of(worker.0.id()).is_none_or(|spent| spent.is_over))
    });
    let took = started.elapsed();
    // A scan that is not measured costs less.
    assert_eq!(place.wrong(SCANS), Vec::<String>::new());
    (workers.iter().map(|worker| Spent::of(worker.0.id()).unwrap()).collect(), took)
}

fn main() -> ExitCode {
    let place = Place::new();
    let whole = extract(&body(1), Format::Obj, &Method::default()).unwrap();
    announced(&place, &whole);
    let before = of_database(&place);
    let (spent, alone) = worked_off(&place, 1);
    let database_s = of_database(&place) - before;
    let [spent] = &spent[..] else { unreachable!() };
    announced(&place, &whole);
    let (_, together) = worked_off(&place, 2);
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
    let a_second = |took: Duration| SCANS as f64 / took.as_secs_f64();
    println!("scans a second: {:.1} by 1 worker, {:.1} by 2", a_second(alone), a_second(together));
    if overhead <= OVERHEAD_MOST { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
