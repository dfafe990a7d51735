//! A name that nobody hears leaves nobody certain: a reader's port or the folder of orders is away while
//! the next patient is named there, or the station itself is stopped. The real program, with button and reader
//! on pseudo-terminals.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use rig::booth::{At, Room};
use rig::{Daemon, pty};
use rustix::process::{Pid, Signal, kill_process};
use support::coarse_body;

/// A station with a button and a reader that listens to both.
fn listening(settle: &str) -> (Room, pty::Box, Daemon) {
    let room = Room::with_button("[patient.reader]\nport = \"AT/reader\"\n");
    room.booth
        .reconfigure(|config| config.replace("settle = \"0s\"", &format!("settle = \"{settle}\"")));
    let reader = pty::Box::behind(&room.booth.path("reader"));
    let station = room.start();
    wait_for_reader(&room, &["open"]);
    (room, reader, station)
}

#[track_caller]
fn wait_for_reader(room: &Room, states: &[&str]) {
    let state = || room.status()["triggers"]["reader"]["state"].clone();
    room.booth.wait_for("the reader", || states.iter().any(|word| state() == **word));
}

/// Reads a card and waits until it is heard.
#[track_caller]
fn card(room: &Room, reader: &mut pty::Box, id: &str) {
    let before = room.heard("named");
    reader.sends(format!("{id}\r\n").as_bytes());
    room.booth.wait_for("the card", || room.heard("named") > before);
}

/// How often somebody who was certain is certain no more.
fn unheard(room: &Room) -> usize {
    room.booth.log().matches("event=\"name-unheard\"").count()
}

/// The port of the reader goes away.
#[track_caller]
fn unplug(room: &Room, reader: pty::Box) {
    let before = unheard(room);
    drop(reader);
    fs::remove_file(room.booth.path("reader")).unwrap();
    wait_for_reader(room, &["absent"]);
    room.booth.wait_for("the doubt", || unheard(room) > before);
}

/// The button is pressed and a body scanned, which is held.
#[track_caller]
fn scan_is_held(room: &mut Room, code: &str) {
    room.press();
    let body = coarse_body(1);
    room.write("a.obj", &body);
    room.wait_for_taken(&body);
    assert_eq!(room.held(), [code], "{}", room.booth.log());
    assert_eq!(room.booth.records(), []);
}

#[test]
fn a_card_that_is_read_while_the_readers_port_is_away_leaves_the_one_before_in_doubt() {
    let (mut room, mut reader, station) = listening("0s");
    card(&room, &mut reader, "1001");
    unplug(&room, reader);
    // 1002 reads a card here, and nothing hears it.
    let _reader = pty::Box::behind(&room.booth.path("reader"));
    wait_for_reader(&room, &["open"]);
    scan_is_held(&mut room, "press-unheard");
    assert!(station.stop().success());
}

#[test]
fn a_card_that_is_read_while_the_readers_port_settles_leaves_the_one_before_in_doubt() {
    let (mut room, mut reader, station) = listening("5s");
    card(&room, &mut reader, "1001");
    unplug(&room, reader);
    let mut reader = pty::Box::behind(&room.booth.path("reader"));
    wait_for_reader(&room, &["settling", "open"]);
    reader.sends(b"1002\r\n");
    wait_for_reader(&room, &["open"]);
    scan_is_held(&mut room, "press-unheard");
    assert!(station.stop().success());
}

#[test]
fn an_order_that_is_written_out_of_reach_leaves_the_one_before_in_doubt() {
    let mut room = Room::with_button(&At::orders("before-press"));
    let station = room.start();
    room.order("1001");
    fs::rename(room.booth.path("orders"), room.booth.path("away")).unwrap();
    room.booth.wait_for("the doubt", || unheard(&room) > 0);
    assert!(room.booth.log().contains("event=\"orders-out-of-reach\""));
    room.write_order("away", "1002");
    scan_is_held(&mut room, "press-unheard");
    assert!(station.stop().success());
}

#[test]
fn an_order_that_is_read_only_after_its_press_makes_two_candidates() {
    let orders = At::orders("before-press").replace("quiet = \"100ms\"", "quiet = \"3s\"");
    let mut room = Room::with_button(&orders);
    let station = room.start();
    room.order("1001");
    room.write_order("orders", "1002");
    room.press();
    room.booth.wait_for("the order", || room.orders_taken() == 2);
    let body = coarse_body(1);
    room.write("a.obj", &body);
    room.wait_for_taken(&body);
    assert_eq!(room.held(), ["capture-ambiguous"]);
    assert_eq!(room.booth.records(), []);
    assert!(station.stop().success());
}

#[test]
fn what_is_pressed_and_read_while_the_station_is_stopped_is_not_certain() {
    let (mut room, mut reader, station) = listening("0s");
    card(&room, &mut reader, "1001");
    let (pressed, named) = (room.heard("pressed"), room.heard("named"));
    let pid = Pid::from_raw(station.id().cast_signed()).unwrap();
    kill_process(pid, Signal::STOP).unwrap();
    room.push_button();
    reader.sends(b"1002\r\n");
    sleep(Duration::from_secs(3));
    kill_process(pid, Signal::CONT).unwrap();
    room.booth.wait_for("both", || room.heard("pressed") > pressed && room.heard("named") > named);
    room.booth.wait_for("the sleep", || room.booth.log().contains("event=\"booth-slept\""));
    room.wait_for_look();
    let body = coarse_body(1);
    room.write("a.obj", &body);
    room.wait_for_taken(&body);
    // Whichever the station hears first: the press was not certain, or it was for either.
    let held = room.held();
    assert!(held == ["press-unheard"] || held == ["capture-ambiguous"], "{held:?}");
    assert_eq!(room.booth.records(), []);
    assert!(station.stop().success());
}
