//! The state of the archive as metrics for Prometheus, in the OpenMetrics text format. Labels are names of stations and
//! of methods only.

use std::fmt;
use std::sync::atomic::AtomicU64;

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::Registry;

use super::{MethodRow, StationRow, Status};

/// The content type of the text, for HTTP.
pub(super) const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

type Labels = [(&'static str, String); 1];

/// A figure of a station: its metric, what it says, and where it is. What is not known is left out.
type Figure = (&'static str, &'static str, fn(&StationRow) -> Option<f64>);

const OF_STATION: [Figure; 9] = [
    ("station_silent_seconds", "Time since its last heartbeat", |of| count(of.silent_s)),
    ("station_ready", "1 while it takes scans", |of| of.is_ready.map(|is| f64::from(u8::from(is)))),
    (
        "station_oldest_undelivered_seconds",
        "How long the oldest scan waits for the archive",
        |of| count(of.oldest_undelivered_s),
    ),
    ("station_scans_today", "Scans of today", |of| count(of.scans_today)),
    ("station_refused_today", "Scans of today that could not be used", |of| {
        count(of.refused_today)
    }),
    ("station_refused_share", "The share of these on the 30 days before", |of| of.refused_share),
    (
        "station_phantom_bias_millimetres",
        "Mean of measured minus known girths in the last check",
        |of| of.phantom_bias_mm,
    ),
    ("station_phantom_drift_millimetres", "The bias, less its mean on the 30 days before", |of| {
        of.phantom_drift_mm
    }),
    ("station_scans", "Its scans in the archive", |of| count(Some(of.scans))),
];

/// Name, help, and the figure of a method.
type OfMethod = (&'static str, &'static str, fn(&MethodRow) -> i64);

const OF_METHOD: [OfMethod; 5] = [
    ("results", "Scans with a result", |of| of.results),
    ("results_refused", "Scans that cannot be measured", |of| of.refused),
    ("jobs_waiting", "Scans that are to be measured", |of| of.waiting),
    ("jobs_claimed", "Scans that a worker has claimed, or that are put off", |of| of.claimed),
    ("dead_letters", "Scans on which measuring failed for good", |of| of.dead),
];

impl Status {
    /// The metrics.
    ///
    /// # Errors
    /// None known: writing to memory does not fail.
    pub(super) fn metrics(&self) -> Result<String, fmt::Error> {
        let mut registry = Registry::with_prefix("gaiter_archive");
        for (name, help, number) in [
            ("scans", "Scans in the archive", self.scans),
            ("workers", "Workers that have claimed scans", self.workers.len() as i64),
        ] {
            let gauge = Gauge::<f64, AtomicU64>::default();
            gauge.set(number as f64);
            registry.register(name, help, gauge);
        }
        for (name, help, figure) in OF_METHOD {
            let of_each = self.methods.iter();
            let of_each = of_each.map(|of| ([("method", of.method.clone())], figure(of) as f64));
            family(&mut registry, name, help, of_each);
        }
        for (name, help, figure) in OF_STATION {
            let of_each = self.stations.iter().filter_map(|of| Some((of, figure(of)?)));
            let of_each = of_each.map(|(of, value)| ([("station", of.station.clone())], value));
            family(&mut registry, name, help, of_each);
        }
        let mut text = String::new();
        encode(&mut text, &registry)?;
        Ok(text)
    }
}

fn count(number: Option<i64>) -> Option<f64> {
    number.map(|number| number as f64)
}

fn family(
    registry: &mut Registry,
    name: &str,
    help: &str,
    rows: impl Iterator<Item = (Labels, f64)>,
) {
    let family = Family::<Labels, Gauge<f64, AtomicU64>>::default();
    for (labels, value) in rows {
        family.get_or_create(&labels).set(value);
    }
    registry.register(name, help, family);
}
