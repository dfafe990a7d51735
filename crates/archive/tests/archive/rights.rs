//! What the key of a station can do, on a store that holds to rights, set up as docs/archive.md says.

use std::process::Command;

use crate::place::{Place, Ports, crop, send};
use crate::servers::{beside, ceph, database, python};

const SCANS: usize = 2;

#[test]
#[ignore = "needs PostgreSQL and Ceph, run by .ci/run"]
fn a_stolen_station_key_adds_and_no_more_and_what_it_adds_is_measured() {
    let ceph = ceph();
    let place = Place::on(Ports { store: ceph.port, database: database().port });
    let mut tries = Command::new(python());
    let address = format!("http://127.0.0.1:{}", ceph.port);
    tries.arg(beside("stolen_key.py")).arg(address).arg(place.bucket_name());
    let tried = tries.output().unwrap();
    assert!(tried.status.success(), "{}", String::from_utf8_lossy(&tried.stderr));
    // From here on the bucket keeps versions, and takes a second PUT for a new one.
    place.renew(0);
    let station = place.bucket_of("booth-1", ceph.port);
    for scan in (0..SCANS).chain(0..SCANS) {
        send(&station, &crop(scan)).unwrap();
    }
    place.verb(&["index", "--once"]);
    place.verb(&["work", "--until-empty"]);
    assert_eq!(place.wrong(SCANS), Vec::<String>::new());
}
