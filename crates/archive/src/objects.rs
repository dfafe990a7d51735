//! The bucket of the archive, as the archive asks it.

use std::time::Duration;

use gaiter_https::{Bucket, BucketFault, HttpsClient, Listed};

use crate::config::ArchiveConfig;

/// For a whole exchange: the largest objects take some seconds.
const EXCHANGE_MOST: Duration = Duration::from_secs(60);

/// The longest object, bytes: crops have a few million.
const OBJECT_MOST: u64 = 256 << 20;

/// The bucket that the configuration names.
pub fn bucket(config: &ArchiveConfig) -> Bucket {
    let client = HttpsClient::new(config.objects_tls.clone(), None, EXCHANGE_MOST);
    Bucket::new(config.objects.clone(), client.with_answers_up_to(OBJECT_MOST))
}

/// Goes through all objects whose keys have this beginning, a page at a time.
///
/// # Errors
/// Those of the store, and of `each`.
pub fn each_page<E: From<BucketFault>>(
    bucket: &Bucket,
    prefix: &str,
    mut each: impl FnMut(&[Listed]) -> Result<(), E>,
) -> Result<(), E> {
    let mut after = String::new();
    loop {
        let page = bucket.list(prefix, &after)?;
        each(&page.objects)?;
        match page.objects.last() {
            Some(last) if page.is_more => after.clone_from(&last.key),
            _ => return Ok(()),
        }
    }
}
