//! `[store.archive]`: an archive of many stations.

use gaiter_https::{BucketPlace, TlsFiles};
use gaiter_record::archive::StationId;
use http::Uri;

use super::{address, secret, set_without};
use crate::config::parse::{self, Absent, Found, Reader, What, is_bare, or_none};
use crate::config::words::Words;
use crate::store::archive::{ArchivePlace, CropChoice};

/// `[store.archive]`: an archive that gets every named record.
#[derive(Debug, Clone)]
pub struct ArchiveStoreConfig {
    /// Where it is, and who writes there.
    pub place: ArchivePlace,
    /// How much of a body leaves the house.
    pub crop: CropChoice,
}

/// `store.archive.crop`
const CROPS: Words<CropChoice> = &[("legs", CropChoice::Legs), ("whole", CropChoice::Whole)];

/// Reads the keys of `[store.archive]`. Without an address the section is off.
pub(in crate::config) fn archive(reader: &mut Reader) -> Option<ArchiveStoreConfig> {
    use Absent::Default;
    let base = reader.text("store.archive.address", Default(""), or_none(bucket_address));
    let bucket = reader.text("store.archive.bucket", Default(""), or_none(bare));
    let region = reader.value("store.archive.region", "us-east-1", bare)?;
    let station = reader.text("store.archive.station", Default(""), or_none(station));
    let key_id = reader.text("store.archive.key_id", Default(""), or_none(bare));
    let key = reader.text("store.archive.key", Default(""), or_none(secret));
    let site_key = reader.text("store.archive.site_key", Default(""), or_none(secret));
    let crop = reader.value("store.archive.crop", "legs", parse::word(CROPS))?;
    let authorities = or_none(parse::full_path);
    let authorities = reader.value("store.archive.authorities", "", authorities)?;
    let Found { value: address, at } = base.and_then(parse::if_set)?;
    let (bucket, station, key_id) = (bucket?.value, station?.value, key_id?.value);
    let (key, site_key) = (key?.value, site_key?.value);
    // All missing keys are reported at once.
    let needed = [
        ("store.archive.bucket", bucket.is_some()),
        ("store.archive.station", station.is_some()),
        ("store.archive.key_id", key_id.is_some()),
        ("store.archive.key", key.is_some()),
        ("store.archive.site_key", site_key.is_some()),
    ];
    for (missing, _) in needed.into_iter().filter(|(_, has)| !has) {
        reader.note(at.clone(), "store.archive.address", set_without(missing));
    }
    let place = ArchivePlace {
        bucket: BucketPlace { address, bucket: bucket?, region, key_id: key_id?, secret: key? },
        tls: TlsFiles { authorities, own: None },
        station: station?,
        site_key: site_key?,
    };
    Some(ArchiveStoreConfig { place, crop })
}

/// The address of a store of objects. The bucket is its path.
fn bucket_address(text: &str) -> Result<String, What> {
    let base = address(text)?;
    match base.parse::<Uri>().is_ok_and(|uri| uri.path().len() <= 1) {
        true => Ok(base),
        false => {
            let hint = "write it without a path: the bucket has a key of its own";
            Err(What::not_a(text, "a valid address of a store of objects", hint))
        }
    }
}

/// A name that is sent as it is.
fn bare(text: &str) -> Result<String, What> {
    match is_bare(text) {
        true => Ok(text.to_owned()),
        false => {
            let hint = "letters, digits, -, _ and ., as in \"gaiter-archive\"";
            Err(What::not_a(text, "a valid bare name", hint))
        }
    }
}

/// The name of a station among those of the archive.
fn station(text: &str) -> Result<StationId, What> {
    StationId::parse(text).map_err(|_| parse::not_a_station_id(text))
}
