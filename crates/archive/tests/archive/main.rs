//! The archive on a real PostgreSQL and on two kinds of stores of objects: moto, which takes whatever it is sent, and
//! Ceph, which checks hashes and rights and keeps its objects on a disk. `.ci/run` installs them. By hand:
//!
//! ```text
//! apt-get install --no-install-recommends postgresql curl ceph-mon ceph-osd radosgw
//! python3 -m venv /tmp/venv && /tmp/venv/bin/pip install 'moto[server]' boto3 pyarrow
//! GAITER_PYTHON=/tmp/venv/bin/python cargo test -p gaiter-archive --test archive -- --include-ignored --skip stations::
//! ```

#![allow(clippy::unwrap_used)]

mod ceph;
mod everyday;
mod gate;
mod kill;
mod place;
mod questions;
mod rights;
mod servers;
mod stations;
