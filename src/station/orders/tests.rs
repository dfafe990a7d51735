//! Refused orders lie where a person finds them, whole and with the reason.

use std::fs;

use super::*;

#[test]
fn a_refused_order_is_kept_once_with_its_bytes_and_reason() {
    let dir = tempfile::tempdir().unwrap();
    let order = b"01380006302\r\nM\xfcller\r\n";
    for _ in 0..2 {
        aside::keep(dir.path(), order, "order-line-malformed", "line 2 …").unwrap();
    }
    aside::keep(dir.path(), b"", "order-empty", "it is empty").unwrap();
    let folder = dir.path().join("orders-refused");
    let kept: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(kept.len(), 2, "{kept:?}");
    let whole = kept.iter().find(|place| fs::read(place.join("order.gdt")).unwrap() == order);
    let reason = fs::read_to_string(whole.unwrap().join("reason.json")).unwrap();
    let reason: serde_json::Value = serde_json::from_str(&reason).unwrap();
    assert_eq!(reason["code"], "order-line-malformed");
    assert_eq!(reason["schema"], "gaiter.order-refused/1");
}

#[test]
fn half_a_kept_order_does_not_hinder_the_next_attempt() {
    let dir = tempfile::tempdir().unwrap();
    aside::keep(dir.path(), b"x", "order-not-gdt", "").unwrap();
    let folder = dir.path().join("orders-refused");
    let place = fs::read_dir(&folder).unwrap().next().unwrap().unwrap().path();
    let staged = folder.join(format!(".{}", place.file_name().unwrap().to_str().unwrap()));
    fs::rename(&place, &staged).unwrap();
    fs::remove_file(staged.join("reason.json")).unwrap();
    aside::keep(dir.path(), b"x", "order-not-gdt", "").unwrap();
    assert!(place.join("reason.json").exists() && !staged.exists());
}

#[test]
fn an_order_is_removed_only_in_the_state_that_was_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gdt");
    fs::write(&path, "old").unwrap();
    let mask = crate::flow::Mask::new("*.gdt").unwrap();
    let seen = look::look(dir.path(), &mask, &Pulse::default()).unwrap();
    let read = seen[&path].stamp;
    fs::write(&path, "newer").unwrap();
    look::remove(&path, read).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "newer");
    let seen = look::look(dir.path(), &mask, &Pulse::default()).unwrap();
    for _ in 0..2 {
        look::remove(&path, seen[&path].stamp).unwrap();
        assert!(!path.exists());
    }
}
