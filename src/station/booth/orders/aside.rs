//! Orders that were refused: `orders-refused/<hash>/` in the state folder holds the file's bytes as
//! `order.gdt` and the reason as `reason.json`.

use std::fs;
use std::io;
use std::path::Path;

use jiff::Timestamp;
use serde_json::json;

use crate::store::{durable, sums};

/// The folder of refused orders in the state folder.
const FOLDER: &str = "orders-refused";

/// Stores an order durably with its reason. An order that is already stored stays unchanged.
pub fn keep(state_dir: &Path, bytes: &[u8], code: &str, message: &str) -> io::Result<()> {
    let all = state_dir.join(FOLDER);
    durable::make_folder_once(&all)?;
    durable::sync_folder(state_dir)?;
    let name = sums::scan_id(bytes).short().to_owned();
    let (place, staged) = (all.join(&name), all.join(format!(".{name}")));
    if place.is_dir() && fs::read(place.join("order.gdt"))? == bytes {
        return Ok(());
    }
    durable::remove_folder(&staged)?;
    durable::make_folder(&staged)?;
    let reason = json!({
        "schema": "gaiter.order-refused/1",
        "code": code,
        "message": message,
        "at": Timestamp::now(),
        "gaiter": env!("CARGO_PKG_VERSION"),
    });
    durable::write_new(&staged.join("order.gdt"), bytes)?;
    durable::write_new(&staged.join("reason.json"), format!("{reason:#}\n").as_bytes())?;
    durable::sync_folder(&staged)?;
    durable::rename_new(&staged, &place)?;
    durable::sync_folder(&all)
}
