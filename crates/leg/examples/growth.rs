//! What time and memory a scan takes as it grows: a body made denser, every triangle parted into
//! four, up to millions of points, as a mesh and as a bare cloud.
//!
//! `cargo run --release --example growth -- fixtures/scans/f_average_clean.obj.gz [times]`

#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_types,
    clippy::expect_used,
    clippy::print_stdout,
    clippy::unwrap_used
)]

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io::Read;
use std::time::Instant;

use gaiter_leg::{Method, extract};
use gaiter_scan::{Format, Scan, read};
use nalgebra::center;
use peak_alloc::PeakAlloc;

/// Counts the bytes that are held.
#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// How often every triangle is parted where nobody says: 57 000 points become 3.6 million.
const TIMES: usize = 3;

/// Each size is measured this often; the quickest counts.
const RUNS: usize = 3;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().expect("the path of a gzipped OBJ file");
    let times = arguments.next().map_or(TIMES, |word| word.parse().expect("a count"));
    let mut bytes = Vec::new();
    let packed = fs::File::open(path).expect("the scan can be opened");
    flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).expect("the scan is gzipped");
    println!(
        "| scan | points | read s | whole s | CPU s | CPU s per million points | memory MiB | file MiB |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut scan = read(&bytes, Format::Obj).expect("the scan can be read");
    for time in 0..=times {
        row("mesh, OBJ", &obj(&scan), Format::Obj);
        row("cloud, XYZ", &xyz(&scan), Format::Xyz);
        if time < times {
            scan = denser(&scan);
        }
    }
}

/// Reads and measures one export, and prints a row about it.
fn row(what: &str, bytes: &[u8], format: Format) {
    let points = read(bytes, format).expect("it can be read").points.len();
    let [read_s, _] = quickest(|| drop(read(bytes, format)));
    MEMORY.reset_peak_usage();
    let before_mib = MEMORY.current_usage_as_mb();
    let [whole_s, cpu_s] = quickest(|| {
        let found = extract(bytes, format, &Method::default()).expect("it can be measured");
        assert_eq!(found.legs.len(), 2);
    });
    let memory_mib = MEMORY.peak_usage_as_mb() - before_mib;
    let file_mib = bytes.len() as f64 / f64::from(1 << 20);
    let each_s = 1e6 * cpu_s / points as f64;
    println!(
        "| {what} | {points} | {read_s:.3} | {whole_s:.3} | {cpu_s:.3} | {each_s:.2} | {memory_mib:.0} | {file_mib:.0} |"
    );
}

/// The least time and the least processor time of a few runs, seconds.
fn quickest(mut run: impl FnMut()) -> [f64; 2] {
    let one = |_| {
        let (start, before_s) = (Instant::now(), cpu_s());
        run();
        [start.elapsed().as_secs_f64(), cpu_s() - before_s]
    };
    (0..RUNS).map(one).fold([f64::INFINITY; 2], |[a, b], [c, d]| [a.min(c), b.min(d)])
}

/// The processor time that the threads of this process have taken, seconds.
fn cpu_s() -> f64 {
    let threads = fs::read_dir("/proc/self/task").expect("a list of threads");
    let taken_ns = |thread: fs::DirEntry| {
        let text = fs::read_to_string(thread.path().join("schedstat")).expect("a thread's time");
        text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("nanoseconds")
    };
    threads.map(|thread| taken_ns(thread.expect("a thread"))).sum::<f64>() / 1e9
}

/// Every triangle parted into four at the middles of its edges; the middle of an edge is one point.
fn denser(scan: &Scan) -> Scan {
    let mut points = scan.points.clone();
    let mut middles = BTreeMap::new();
    let mut triangles = Vec::with_capacity(4 * scan.triangles.len());
    for &[a, b, c] in &scan.triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            *middles.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                points.push(center(&points[from as usize], &points[to as usize]));
                points.len() as u32 - 1
            })
        });
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Scan { points, triangles }
}

fn obj(scan: &Scan) -> Vec<u8> {
    let mut text = String::new();
    for p in &scan.points {
        writeln!(text, "v {:.4} {:.4} {:.4}", p.x, p.y, p.z).unwrap();
    }
    for [a, b, c] in &scan.triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text.into_bytes()
}

fn xyz(scan: &Scan) -> Vec<u8> {
    let mut text = String::new();
    for p in &scan.points {
        writeln!(text, "{:.4} {:.4} {:.4}", p.x, p.y, p.z).unwrap();
    }
    text.into_bytes()
}
