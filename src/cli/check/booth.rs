//! The ports of the booth and the addresses of the page: as the running station has them; without one, whether they
//! are there.

use std::net::{SocketAddr, TcpListener};
use std::path::Path;

use gaiter_flow::trigger::PortState;

use super::row::{Row, Verdict};
use crate::config::Config;
use crate::config::port::{InputPlace, SerialPlace};
use crate::config::trigger::ReaderPlace;
use crate::station::operator::control::status::Status;

/// A row for each port that the configuration names and that can be looked for, and for each address.
pub(super) fn rows(config: &Config, running: Option<&Status>) -> Vec<Row> {
    match running {
        Some(status) => of_station(status),
        None => ports(config).into_iter().chain(addresses(config)).collect(),
    }
}

/// What the running station reports about its ports, and about addresses that it could not open.
fn of_station(status: &Status) -> Vec<Row> {
    let ports = status.triggers.iter().map(|(port, of)| {
        let why = of.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
        let state = PortState::ALL.into_iter().find(|state| state.word() == of.state);
        let is_sound = state.is_some_and(|state| !state.is_fault());
        let verdict = if is_sound { Verdict::Ok } else { Verdict::Warn };
        Row::at("port", port, verdict, format!("the station has it as {}{why}", of.state))
    });
    let taken = status.complaints.iter().filter(|of| of.complaint.code == "page-unavailable");
    let taken = taken.map(|of| Row::at("address", "page", Verdict::Warn, of.message.clone()));
    ports.chain(taken).collect()
}

/// The ports at a path. Those that are found by a device's name are looked for by the station alone.
fn ports(config: &Config) -> Vec<Row> {
    let trigger = &config.trigger;
    let serial =
        trigger.serial.as_ref().map(|of| ("trigger.serial.port", path_of_serial(&of.line.place)));
    let keys = trigger.keys.as_ref().map(|of| ("trigger.keys.device", path_of_input(&of.device)));
    let reader = trigger.reader.as_ref().map(|of| {
        let path = match &of.at {
            ReaderPlace::Serial(line) => path_of_serial(&line.place),
            ReaderPlace::Keys(device) => path_of_input(device),
        };
        ("patient.reader.port", path)
    });
    let ports = [serial, keys, reader].into_iter().flatten();
    let ports = ports.filter_map(|(key, path)| Some((key, path?)));
    ports
        .map(|(key, path)| match path.exists() {
            true => Row::ok("port", path, format!("is there ({key})")),
            false => {
                let detail = format!("is not there: plug it in, or see {key}");
                Row::at("port", path.display(), Verdict::Warn, detail)
            }
        })
        .collect()
}

fn path_of_serial(place: &SerialPlace) -> Option<&Path> {
    match place {
        SerialPlace::Path(path) => Some(path),
        SerialPlace::Usb(_) => None,
    }
}

fn path_of_input(place: &InputPlace) -> Option<&Path> {
    match place {
        InputPlace::Path(path) => Some(path),
        InputPlace::Name(_) => None,
    }
}

/// The addresses of the page, which the station must be able to take.
fn addresses(config: &Config) -> Vec<Row> {
    let all = [("status.listen", config.status.listen), ("network in [page]", config.page.network)];
    all.into_iter().filter_map(|(key, address)| Some(address_row(key, address?))).collect()
}

fn address_row(key: &str, address: SocketAddr) -> Row {
    match TcpListener::bind(address) {
        Ok(_) => Row::at("address", address, Verdict::Ok, format!("is free ({key})")),
        Err(fault) => {
            let detail = format!(
                "cannot be taken ({key}): {fault}; unless gaiter.socket holds it for the station, ss -ltnp names \
                 the program"
            );
            Row::at("address", address, Verdict::Warn, detail)
        }
    }
}
