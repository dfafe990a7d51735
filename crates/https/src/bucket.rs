//! A bucket of an S3-compatible store of objects.

use gaiter_record::sha256;
use http::header::{AUTHORIZATION, CONTENT_LENGTH, HOST, IF_NONE_MATCH};
use http::{Method, Request, Response, StatusCode, Uri};
use jiff::Timestamp;

use super::HttpsClient;
use super::endpoint::{Endpoint, Secret};
use super::fault::HttpFault;
use super::secret;
use super::signature::{Signer, escaped};

/// How many keys a store is asked for at a time; none gives more.
const PAGE_KEYS: &str = "1000";

/// How much of what a store says of a fault is told, characters.
const SAID_MOST: usize = 200;

/// The headers that a request is signed with besides `host`.
const CONTENT_SHA256: &str = "x-amz-content-sha256";
const DATE: &str = "x-amz-date";

/// Where a bucket is, and who asks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BucketPlace {
    /// The store's address without a slash at its end: `https://s3.clinic.example`.
    pub address: String,
    pub bucket: String,
    /// The region; stores that have none take any word.
    pub region: String,
    /// The id of the access key.
    pub key_id: String,
    /// The access key.
    pub secret: Secret,
}

#[derive(Debug)]
pub struct Bucket {
    place: BucketPlace,
    client: HttpsClient,
}

/// What became of an object that was to be put where none is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PutNew {
    /// It is there now.
    Stored,
    AlreadyThere,
}

/// An object in a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    pub key: String,
    /// Its entity tag, which is another one after each PUT of other bytes; `None` where the store tells none.
    pub tag: Option<String>,
}

/// Some objects of a bucket.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// The objects, in the order of their keys.
    pub objects: Vec<Listed>,
    /// Whether there are more behind the last.
    pub is_more: bool,
}

/// Why a store does not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum BucketFault {
    /// It gave no answer, or could not be asked.
    #[error(transparent)]
    Http(#[from] HttpFault),
    /// The words of the access cannot be sent.
    #[error("the address, the bucket or the key's id hold what cannot be sent")]
    Words,
    /// It answers otherwise.
    #[error("the store of objects answers {status}: {said}")]
    Status {
        status: u16,
        /// Its text.
        said: String,
    },
}

impl Bucket {
    /// A bucket that is asked by this client.
    pub fn new(place: BucketPlace, client: HttpsClient) -> Bucket {
        Bucket { place, client }
    }

    /// Puts an object, in place of any that is there.
    ///
    /// # Errors
    /// See [`BucketFault`].
    pub fn put(&self, key: &str, bytes: Vec<u8>) -> Result<(), BucketFault> {
        let answer = self.ask(Method::PUT, key, "", None, bytes)?;
        if answer.status().is_success() { Ok(()) } else { Err(refused(&answer)) }
    }

    /// Puts an object where none is. A store that does not know the condition puts it in any case.
    ///
    /// # Errors
    /// See [`BucketFault`].
    pub fn put_new(&self, key: &str, bytes: Vec<u8>) -> Result<PutNew, BucketFault> {
        let answer = self.ask(Method::PUT, key, "", Some("*"), bytes)?;
        match answer.status() {
            StatusCode::PRECONDITION_FAILED => Ok(PutNew::AlreadyThere),
            status if status.is_success() => Ok(PutNew::Stored),
            _ => Err(refused(&answer)),
        }
    }

    /// The bytes of an object; `None` if there is none.
    ///
    /// # Errors
    /// See [`BucketFault`].
    pub fn get(&self, key: &str) -> Result<Option<Vec<u8>>, BucketFault> {
        Ok(self.found(Method::GET, key)?.map(Response::into_body))
    }

    /// The length of an object, bytes; `None` if there is none.
    ///
    /// # Errors
    /// See [`BucketFault`].
    pub fn length(&self, key: &str) -> Result<Option<u64>, BucketFault> {
        let Some(answer) = self.found(Method::HEAD, key)? else { return Ok(None) };
        let length = answer.headers().get(CONTENT_LENGTH).and_then(|length| length.to_str().ok());
        let length = length.and_then(|length| length.parse().ok());
        length.map(Some).ok_or_else(|| refused(&answer))
    }

    /// Removes an object, if it is there.
    ///
    /// # Errors
    /// See [`BucketFault`].
    pub fn remove(&self, key: &str) -> Result<(), BucketFault> {
        self.found(Method::DELETE, key).map(drop)
    }

    /// The objects whose keys have this beginning and come after another; after none if that is empty.
    ///
    /// # Errors
    /// See [`BucketFault`].
    pub fn list(&self, prefix: &str, after: &str) -> Result<Page, BucketFault> {
        let mut query =
            format!("list-type=2&max-keys={PAGE_KEYS}&prefix={}", escaped(prefix, false));
        if !after.is_empty() {
            query.push_str(&format!("&start-after={}", escaped(after, false)));
        }
        let answer = self.ask(Method::GET, "", &query, None, Vec::new())?;
        let text = String::from_utf8_lossy(answer.body());
        if !answer.status().is_success() || !text.contains("<ListBucketResult") {
            return Err(refused(&answer));
        }
        Ok(page(&text))
    }

    /// The answer about an object; `None` if there is none.
    fn found(&self, method: Method, key: &str) -> Result<Option<Response<Vec<u8>>>, BucketFault> {
        let answer = self.ask(method, key, "", None, Vec::new())?;
        match answer.status() {
            StatusCode::NOT_FOUND => Ok(None),
            status if status.is_success() => Ok(Some(answer)),
            _ => Err(refused(&answer)),
        }
    }

    /// Sends a signed request; `query` is as it is sent, with its keys in their order.
    fn ask(
        &self,
        method: Method,
        key: &str,
        query: &str,
        if_none_match: Option<&str>,
        body: Vec<u8>,
    ) -> Result<Response<Vec<u8>>, BucketFault> {
        let BucketPlace { address, bucket, region, key_id, secret } = &self.place;
        let path = match key {
            "" => format!("/{bucket}"),
            key => format!("/{bucket}/{}", escaped(key, true)),
        };
        let mark = if query.is_empty() { "" } else { "?" };
        let uri: Uri =
            format!("{address}{path}{mark}{query}").parse().map_err(|_| BucketFault::Words)?;
        let host = Endpoint::from_uri(&uri).map_err(HttpFault::Address)?.authority();
        let secret = secret::read(secret).map_err(HttpFault::from)?;
        let signer = Signer { key_id, secret: &secret, region, at: Timestamp::now() };
        let (date, content) = (signer.date(), sha256(&body));
        let signed = [("host", &*host), (CONTENT_SHA256, &*content), (DATE, &*date)];
        let authorization = signer.authorization(&method, &path, query, &signed, &content);
        let mut request = Request::builder()
            .method(method)
            .uri(uri)
            .header(HOST, host)
            .header(CONTENT_SHA256, content)
            .header(DATE, date)
            .header(AUTHORIZATION, authorization);
        if let Some(tag) = if_none_match {
            request = request.header(IF_NONE_MATCH, tag);
        }
        Ok(self.client.send(request.body(body).map_err(|_| BucketFault::Words)?)?)
    }
}

/// The objects in a list. What could not stand in XML as it is, is in none of our keys; tags are only compared.
fn page(text: &str) -> Page {
    let objects = text.split("<Contents>").skip(1).filter_map(|of| {
        let tag = element(of, "ETag").map(str::to_owned);
        Some(Listed { key: element(of, "Key")?.to_owned(), tag })
    });
    let is_more = text.contains("<IsTruncated>true</IsTruncated>");
    Page { objects: objects.collect(), is_more }
}

/// The text in the first element of this name.
fn element<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!("<{name}>"))?;
    rest.split_once('<').map(|(inner, _)| inner)
}

/// What a store says of a fault: its code and its message, in a line.
fn refused(answer: &Response<Vec<u8>>) -> BucketFault {
    let text = String::from_utf8_lossy(answer.body());
    let said: Vec<&str> =
        ["Code", "Message"].into_iter().filter_map(|name| element(&text, name)).collect();
    let is_plain = |c: &char| !c.is_control();
    let said = said.join(": ").chars().filter(is_plain).take(SAID_MOST).collect();
    BucketFault::Status { status: answer.status().as_u16(), said }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use support::http_server::{answer, serve_answers};

    use super::*;
    use crate::TlsFiles;

    fn bucket(port: u16, secret: &std::path::Path) -> Bucket {
        let place = BucketPlace {
            address: format!("http://127.0.0.1:{port}"),
            bucket: "archive".to_owned(),
            region: "us-east-1".to_owned(),
            key_id: "station".to_owned(),
            secret: Secret::File(secret.to_owned()),
        };
        Bucket::new(place, HttpsClient::new(TlsFiles::default(), None, Duration::from_secs(30)))
    }

    #[test]
    fn an_answer_says_whether_the_object_is_new_there_or_not() {
        let dir = tempfile::tempdir().unwrap();
        let secret = dir.path().join("key");
        std::fs::write(&secret, "word").unwrap();
        let denied = "<Error><Code>AccessDenied</Code><Message>No\nentry</Message></Error>";
        let (port, requests) = serve_answers(vec![
            answer("200 OK", ""),
            answer("412 Precondition Failed", ""),
            answer("403 Forbidden", denied),
        ]);
        let bucket = bucket(port, &secret);
        let put = || bucket.put_new("result/0.1.0+ab/x", b"{}".to_vec());
        assert_eq!(put().unwrap(), PutNew::Stored);
        assert_eq!(put().unwrap(), PutNew::AlreadyThere);
        let fault = put().unwrap_err().to_string();
        assert_eq!(fault, "the store of objects answers 403: AccessDenied: Noentry");
        let request = requests.try_iter().next().unwrap().to_ascii_lowercase();
        assert!(request.starts_with("put /archive/result/0.1.0%2bab/x http/1.1\r\n"), "{request}");
        assert!(request.contains("\r\nif-none-match: *\r\n"), "{request}");
        assert_eq!(request.matches("\r\nhost: ").count(), 1, "{request}");
        assert!(!request.contains("word"), "{request}");
    }

    #[test]
    fn a_list_tells_its_objects_and_whether_there_are_more() {
        let text = "<ListBucketResult><Prefix>inbox/</Prefix><IsTruncated>true</IsTruncated>\
                    <Contents><Key>inbox/a/b</Key><Size>2</Size></Contents>\
                    <Contents><ETag>&quot;0b&quot;</ETag><Key>inbox/c/d</Key></Contents>\
                    </ListBucketResult>";
        let listed = |key: &str, tag: Option<&str>| Listed {
            key: key.to_owned(),
            tag: tag.map(str::to_owned),
        };
        let objects = vec![listed("inbox/a/b", None), listed("inbox/c/d", Some("&quot;0b&quot;"))];
        assert_eq!(page(text), Page { objects, is_more: true });
    }
}
