//! Ordering again: exactly, or with the changes since the last order.

#![allow(clippy::unwrap_used)]

use gaiter_record::order::{Again, Order, OrderRef, ReorderFault, Row, State, read};
use gaiter_record::{Record, json, rounding};
use gaiter_sizes::Garment;

use super::{ID, RECORD, SCANNED, garment};

fn last() -> Order {
    let order_ref = OrderRef::new("A-0077", &SCANNED).unwrap();
    let order = Order::from_record(&SCANNED, &garment(), Some(&order_ref), 1.0);
    // As it lies in the folder of the record.
    read(&json(&order).unwrap()).unwrap()
}

fn row<'a>(order: &'a Order, side: &str, point: &str) -> &'a Row {
    let mut rows = order.rows.iter();
    rows.find(|row| row.counts && row.side.word() == side && row.point == point).unwrap()
}

/// A later scan: every girth of the right leg is 5 mm larger.
fn later() -> Record {
    let mut record = SCANNED.clone();
    record.scan.sha256 = "fedcba9876543210".repeat(4);
    let right = record.legs.iter_mut().find(|leg| leg.side == "right").unwrap();
    right.landmarks.values_mut().for_each(|found| found.girth_tape_mm += 5.0);
    record
}

#[test]
fn an_exact_reorder_has_the_figures_of_the_last_order_whatever_the_record_has_now() {
    let last = last();
    let again = Order::exact(&last, &later(), &garment(), None).unwrap();
    assert_eq!(again.rows, last.rows);
    assert_eq!((&again.scan, &again.open), (&last.scan, &last.open));
    let reorder = again.reorder.as_ref().unwrap();
    assert_eq!((reorder.is, reorder.last_ref.as_deref()), (Again::Exact, Some("A-0077")));
    assert_eq!(again.order_ref, None);
    // It can be ordered again itself.
    let third = read(&json(&again).unwrap()).unwrap();
    assert_eq!(Order::exact(&third, &later(), &garment(), None).unwrap().rows, last.rows);
}

#[test]
fn a_reorder_with_changes_has_the_last_figures_and_the_differences_beside_its_own() {
    let again = Order::with_changes(&last(), &later(), &garment(), None, 1.0).unwrap();
    let of = row(&again, "right", "B");
    let (girth, last) = (of.girth.as_ref().unwrap(), of.last.as_ref().unwrap());
    assert_eq!((girth.mm, last.girth.unwrap().mm), (Some(217.5), 212.5));
    assert_eq!(last.girth.unwrap().change_mm, Some(5.0));
    // Both scans with 0.4 mm of their own, and 1 mm of the scanner each.
    let u95_mm = rounding::MARGIN_SDS * (2.0 * (0.16 + 1.0_f64)).sqrt();
    assert!((last.girth.unwrap().change_u95_mm.unwrap() - u95_mm).abs() < 2e-3);
    let left = row(&again, "left", "B").last.as_ref().unwrap().girth.unwrap();
    assert_eq!(left.change_mm, Some(0.0));
    assert!(again.reorder.unwrap().taken_otherwise.is_empty());
}

#[test]
fn a_figure_that_is_not_sure_in_one_of_the_orders_has_no_difference() {
    let again = Order::with_changes(&last(), &RECORD, &garment(), None, 1.0).unwrap();
    // The last order lacked the left B1, which a person has set since.
    assert_eq!(row(&again, "left", "B1").last.as_ref().unwrap().girth, None);
    // A person noted that the left D cannot be measured.
    let gone = row(&again, "left", "D");
    assert_eq!(gone.girth.as_ref().unwrap().is, State::NotMeasurable);
    let last = gone.last.as_ref().unwrap().girth.unwrap();
    assert_eq!((last.mm, last.change_mm), (351.0, None));
}

#[test]
fn two_scans_that_were_taken_otherwise_have_no_differences_and_say_what_differs() {
    let mut record = later();
    record.made_by.method.insert("posture".to_owned(), "lying".to_owned());
    record.made_by.method.insert("tape".to_owned(), "vertical".to_owned());
    let again = Order::with_changes(&last(), &record, &garment(), None, 1.0).unwrap();
    let otherwise = &again.reorder.as_ref().unwrap().taken_otherwise;
    assert!(otherwise.contains(&"posture".to_owned()) && otherwise.contains(&"tape".to_owned()));
    let last = row(&again, "right", "B").last.as_ref().unwrap().girth.unwrap();
    assert_eq!((last.mm, last.change_mm), (212.5, None));
}

#[test]
fn a_leg_that_the_new_scan_lacks_is_open_with_its_last_figures() {
    let mut record = later();
    record.legs.retain(|leg| leg.side == "right");
    let again = Order::with_changes(&last(), &record, &garment(), None, 1.0).unwrap();
    let of = row(&again, "left", "B");
    assert_eq!(of.girth.as_ref().unwrap().is, State::NotMeasured);
    assert_eq!(of.last.as_ref().unwrap().girth.unwrap().mm, 214.5);
    assert!(again.open.iter().any(|open| open.side.word() == "left" && open.form_box == "cB"));
}

#[test]
fn the_order_of_another_patient_is_never_repeated() {
    let mut other = later();
    other.patient.as_mut().unwrap().id = "4712".to_owned();
    let exact = Order::exact(&last(), &other, &garment(), None);
    assert_eq!(exact.unwrap_err(), ReorderFault::OtherPatient);
    let changes = Order::with_changes(&last(), &other, &garment(), None, 1.0);
    assert_eq!(changes.unwrap_err(), ReorderFault::OtherPatient);
    // A record without a patient can be of anybody.
    other.patient = None;
    let exact = Order::exact(&last(), &other, &garment(), None);
    assert_eq!(exact.unwrap_err(), ReorderFault::NoPatient);
    // The order itself does not tell the id.
    assert!(!String::from_utf8(json(&last()).unwrap()).unwrap().contains(ID));
}

#[test]
fn another_garment_or_another_form_is_ordered_anew() {
    let other = Garment::named("AG").unwrap();
    let fault = Order::exact(&last(), &later(), &other, None).unwrap_err();
    let expected = ReorderFault::OtherGarment { last: "AD".to_owned(), now: "AG".to_owned() };
    assert_eq!(fault, expected);
    let text = include_str!("../../../sizes/garments/AD.toml");
    let form = Garment::read(text.replace("round_girths_mm = 1", "round_girths_mm = 5").as_bytes());
    let fault = Order::exact(&last(), &later(), &form.unwrap(), None).unwrap_err();
    assert_eq!(fault, ReorderFault::OtherForm("AD".to_owned()));
}
