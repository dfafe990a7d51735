//! The archive on a real PostgreSQL and a real store of objects, moto. `.ci/run` installs them. By hand:
//!
//! ```text
//! apt-get install postgresql
//! python3 -m venv /tmp/venv && /tmp/venv/bin/pip install 'moto[server]' boto3 pyarrow
//! GAITER_PYTHON=/tmp/venv/bin/python cargo test -p gaiter-archive --test archive -- --include-ignored
//! ```

#![allow(clippy::unwrap_used)]

mod everyday;
mod gate;
mod kill;
mod place;
mod questions;
mod servers;
