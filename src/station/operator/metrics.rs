//! An overview as metrics for Prometheus, in the OpenMetrics text format. No label holds an id, a name
//! or a path: export folders are numbered as in the log, and stores have the names of their kind.

use std::fmt;
use std::sync::atomic::AtomicU64;

use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::Complaint;
use gaiter_flow::facts::{IntakeState, SourceState, TriggerFacts};
use gaiter_flow::trigger::PortState;
use gaiter_flow::words::age;
use gaiter_record::phantom::CheckResult;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::Registry;

use crate::station::overview::Overview;

/// The content type of the text, for HTTP.
pub const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

type Labels<const N: usize> = [(&'static str, String); N];

/// The current metrics.
///
/// # Errors
/// None known: writing to memory does not fail.
pub fn text(overview: &Overview) -> Result<String, fmt::Error> {
    let mut registry = Registry::with_prefix("gaiter");
    of_station(&mut registry, overview);
    of_scans(&mut registry, overview);
    of_sources(&mut registry, overview);
    of_triggers(&mut registry, overview);
    of_phantom(&mut registry, overview);
    let apart = overview.facts.views.apart().map_or(0, |(count, _)| count);
    let help = "Scans of the last 30 on which the cameras' views do not meet";
    gauge(&mut registry, "views_apart_scans", help, apart as f64);
    let mut text = String::new();
    encode(&mut text, &registry)?;
    Ok(text)
}

fn of_station(registry: &mut Registry, overview: &Overview) {
    let Overview { facts, complaints, disk, running, .. } = overview;
    gauge(registry, "up", "1 while the station runs", 1.0);
    let ready = f64::from(overview.is_ready());
    gauge(registry, "ready", "1 while scans become records", ready);
    let running = running.as_secs_f64();
    gauge(registry, "running_seconds", "Time since the station began", running);
    let code = |complaint: &Complaint| ([("code", complaint.code.clone())], 1.0);
    let help = "What prevents the station from being ready";
    family(registry, "complaint", help, overview.faults().map(code));
    let notices = complaints.iter().filter(|complaint| !complaint.is_fault()).map(code);
    family(registry, "notice", "What a person should know", notices);
    let alarms = facts.alarms.keys().map(|code| ([("code", (*code).to_owned())], 1.0));
    family(registry, "alarm", "What an operator must know", alarms);
    let intake = IntakeState::WORDS
        .map(|word| ([("state", word.to_owned())], f64::from(word == facts.intake.word())));
    family(registry, "intake", "1 for the state of the intake", intake);
    if let Some(disk) = disk {
        let help = "Free on the disk of the state folder";
        gauge(registry, "disk_free_bytes", help, disk.free as f64);
        gauge(registry, "disk_size_bytes", "Size of that disk", disk.size as f64);
    }
    let measured = Counter::<u64>::default();
    measured.inc_by(facts.measured);
    registry.register("measured", "Scans measured in this run", measured);
    if let Some(seconds) = facts.last_measurement_s {
        let help = "How long the last measurement took";
        gauge(registry, "last_measurement_seconds", help, seconds);
    }
}

fn of_scans(registry: &mut Registry, overview: &Overview) {
    let Some(tally) = &overview.tally else { return };
    let states = tally.scans.iter();
    let states = states.map(|(state, count)| ([("state", (*state).to_owned())], *count as f64));
    family(registry, "scans", "Scans in the journal by state", states);
    let became = tally.dispositions.iter();
    let became = became.map(|(is, count)| ([("disposition", (*is).to_owned())], *count as f64));
    family(registry, "dispositions", "Scans in the journal by what became of them", became);
    let help = "Scans of which an operator must say whose they are";
    gauge(registry, "scans_held", help, tally.held as f64);
    let help = "Scans whose record is to be taken back";
    gauge(registry, "scans_withdrawing", help, tally.withdrawing as f64);
    let deliveries = tally.deliveries.iter().map(|((store, state), count)| {
        ([("store", store.clone()), ("state", state.clone())], *count as f64)
    });
    family(registry, "deliveries", "Deliveries in the journal by store and state", deliveries);
    // Infinite if the clock was set back, so that an alert fires.
    let waited = |since| age(since, overview.now).map_or(f64::INFINITY, |age| age.as_secs_f64());
    let oldest = overview.oldest().map_or(0.0, |seen| waited(seen.first_seen));
    let help = "How long the oldest scan without a record has waited, 0 if none waits";
    gauge(registry, "oldest_undelivered_seconds", help, oldest);
}

fn of_sources(registry: &mut Registry, overview: &Overview) {
    let none = || Cause::verbatim("");
    let states = [
        SourceState::NotLooked,
        SourceState::Watched,
        SourceState::OutOfReach(none()),
        SourceState::NotMounted(none()),
        SourceState::Taken,
        SourceState::Stalled,
    ];
    let sources = || overview.facts.sources.iter().enumerate();
    let of_all = sources().flat_map(|(place, source)| {
        states.iter().map(move |state| {
            let word = state.word();
            let labels = [("export_dir", place.to_string()), ("state", word.to_owned())];
            (labels, f64::from(word == source.state.word()))
        })
    });
    family(registry, "source", "1 for the state of each export folder", of_all);
    let waiting = sources()
        .map(|(place, source)| ([("export_dir", place.to_string())], source.waiting.len() as f64));
    family(registry, "source_waiting_files", "Files not taken yet", waiting);
    let stores = overview.facts.stores.iter().map(|(store, facts)| {
        ([("store", (*store).to_owned())], f64::from(facts.refusal.is_none()))
    });
    family(registry, "store_takes_records", "1 while the last delivery went well", stores);
}

fn of_triggers(registry: &mut Registry, overview: &Overview) {
    let ports = || overview.facts.triggers.iter();
    let states = ports().flat_map(|(port, trigger)| {
        PortState::ALL.map(|state| {
            let labels = [("port", (*port).to_owned()), ("state", state.word().to_owned())];
            (labels, f64::from(state == trigger.state))
        })
    });
    family(registry, "trigger", "1 for the state of each port of the booth", states);
    let mut count = |name: &str, help: &str, count: fn(&TriggerFacts) -> u64| {
        let family = Family::<Labels<1>, Counter>::default();
        for (port, trigger) in ports() {
            family.get_or_create(&[("port", (*port).to_owned())]).inc_by(count(trigger));
        }
        registry.register(name, help, family);
    };
    count("trigger_presses", "Presses in this run", |trigger| trigger.presses);
    count("trigger_ids", "Ids read in this run", |trigger| trigger.ids);
    count("trigger_garbage", "Bytes or keys that meant nothing", |trigger| trigger.garbage);
}

fn of_phantom(registry: &mut Registry, overview: &Overview) {
    let Some(phantom) = &overview.facts.phantom else { return };
    let due = f64::from(overview.facts.is_phantom_due(overview.now));
    gauge(registry, "phantom_due", "1 while the known body should be scanned", due);
    let Some(last) = phantom.checks.last() else { return };
    let within = f64::from(last.result == CheckResult::Within);
    gauge(registry, "phantom_within", "1 if the last check was within the tolerance", within);
    let help = "When the known body was last scanned, seconds since 1970";
    gauge(registry, "phantom_last_check_seconds", help, last.at.as_second() as f64);
    if let Some(bias_mm) = last.bias_mm {
        let help = "Mean of measured minus known girths in the last check";
        gauge(registry, "phantom_bias_millimetres", help, bias_mm);
    }
}

fn gauge(registry: &mut Registry, name: &str, help: &str, value: f64) {
    let gauge = Gauge::<f64, AtomicU64>::default();
    gauge.set(value);
    registry.register(name, help, gauge);
}

fn family<const N: usize>(
    registry: &mut Registry,
    name: &str,
    help: &str,
    rows: impl IntoIterator<Item = (Labels<N>, f64)>,
) {
    let family = Family::<Labels<N>, Gauge<f64, AtomicU64>>::default();
    for (labels, value) in rows {
        family.get_or_create(&labels).set(value);
    }
    registry.register(name, help, family);
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::time::Duration;

    use jiff::Timestamp;

    use super::*;
    use gaiter_flow::Facts;
    use gaiter_flow::facts::WaitingFile;
    use gaiter_flow::settle::Wait;

    #[test]
    fn metrics_say_how_the_station_is_and_name_no_file() {
        let now = Timestamp::from_second(1_800_000_000).unwrap();
        let mut facts = Facts::new(now, 1);
        facts.sources[0].state = SourceState::OutOfReach("Mustermann".into());
        let file = WaitingFile { wait: Wait::Turn, since: now, overdue: false };
        facts.sources[0].waiting.insert(PathBuf::from("/export/4711_Mustermann.obj"), file);
        facts.measured = 7;
        let port = TriggerFacts { presses: 3, garbage: 12, ..TriggerFacts::new(now) };
        facts.triggers.insert("serial", port);
        let running = Duration::from_secs(60);
        let (tally, disk, complaints) = (None, None, Vec::new());
        let overview = Overview { facts, tally, disk, complaints, running, now };
        let text = text(&overview).unwrap();
        for line in [
            "gaiter_up 1.0",
            "gaiter_ready 1.0",
            "gaiter_measured_total 7",
            "gaiter_source{export_dir=\"0\",state=\"out_of_reach\"} 1.0",
            "gaiter_source{export_dir=\"0\",state=\"watched\"} 0.0",
            "gaiter_source_waiting_files{export_dir=\"0\"} 1.0",
            "gaiter_trigger{port=\"serial\",state=\"not_looked\"} 1.0",
            "gaiter_trigger_presses_total{port=\"serial\"} 3",
            "gaiter_trigger_garbage_total{port=\"serial\"} 12",
            "# EOF",
        ] {
            assert!(text.lines().any(|found| found == line), "no {line} in\n{text}");
        }
        assert!(!text.contains("Mustermann") && !text.contains("4711"), "{text}");
        assert!(!text.contains("gaiter_scans"), "nothing is said of a journal that was not read");
    }
}
