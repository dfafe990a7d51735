//! Messages over a connection (PS3.7 and PS3.8): C-ECHO, C-STORE, and C-FIND in an archive of images or a worklist.
//!
//! A connection is whatever reads and writes; who opens it sets its limits of time. Each call is one association, which
//! is ended by it.

mod association;
mod fault;
mod reading;
#[cfg(test)]
mod tests;

use std::io::{Read, Write};

use dicom_core::Tag;
use dicom_dictionary_std::{tags, uids};
use dicom_object::InMemDicomObject;

use self::association::Association;
pub use self::fault::{DimseFault, TitleFault};
use super::dataset::{Dataset, text_of};
use super::{DicomObject, Listed, NotStored, Study};

/// The longest title of an application, characters (AE).
const TITLE_MOST: usize = 16;

/// The most objects of a study that are listed: ours are some tens, and the study is our own, to which others may add
/// some of theirs.
const LISTED_MOST: usize = 2000;

/// A patient whom no archive knows.
const NOBODY: &str = "gaiter-check";

/// The title of an application (AE title).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AeTitle(String);

impl AeTitle {
    /// A title as it is written.
    ///
    /// # Errors
    /// If it has not 1 to 16 characters of ASCII, a backslash, or a space at an end.
    pub fn new(text: &str) -> Result<AeTitle, TitleFault> {
        let is_plain = |byte: u8| (b' '..=b'~').contains(&byte) && byte != b'\\';
        let is_whole = text.trim_matches(' ') == text && (1..=TITLE_MOST).contains(&text.len());
        match is_whole && text.bytes().all(is_plain) {
            true => Ok(AeTitle(text.to_owned())),
            false => Err(TitleFault),
        }
    }

    /// It as a text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Who asks whom.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Titles {
    /// The station.
    pub calling: AeTitle,
    /// The server.
    pub called: AeTitle,
}

/// What is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// Studies of an archive, their series and objects.
    Study,
    /// What is planned.
    Worklist,
}

impl Model {
    fn class(self) -> &'static str {
        match self {
            Model::Study => uids::STUDY_ROOT_QUERY_RETRIEVE_INFORMATION_MODEL_FIND,
            Model::Worklist => uids::MODALITY_WORKLIST_INFORMATION_MODEL_FIND,
        }
    }
}

/// Whether the server takes an association and answers (C-ECHO).
///
/// # Errors
/// See [`DimseFault`].
pub fn echo<S: Read + Write>(stream: S, titles: &Titles) -> Result<(), DimseFault> {
    let mut association = Association::open(stream, titles, &[uids::VERIFICATION])?;
    association.echo()?;
    association.release();
    Ok(())
}

/// Whether the server answers, and lets the station search for studies.
///
/// # Errors
/// See [`DimseFault`].
pub fn reach<S: Read + Write>(stream: S, titles: &Titles) -> Result<(), DimseFault> {
    let classes = [uids::VERIFICATION, Model::Study.class()];
    let mut association = Association::open(stream, titles, &classes)?;
    association.echo()?;
    let query = at_level("STUDY").text(tags::PATIENT_ID, NOBODY).text(tags::STUDY_INSTANCE_UID, "");
    association.find(Model::Study.class(), &query.0, LISTED_MOST)?;
    association.release();
    Ok(())
}

/// What the server has for a query (C-FIND), up to so many.
///
/// # Errors
/// If there are more; else see [`DimseFault`].
pub fn find<S: Read + Write>(
    stream: S,
    titles: &Titles,
    model: Model,
    query: &InMemDicomObject,
    most: usize,
) -> Result<Vec<InMemDicomObject>, DimseFault> {
    let mut association = Association::open(stream, titles, &[model.class()])?;
    let found = association.find(model.class(), query, most)?;
    association.release();
    Ok(found)
}

/// What the server has of a study: each series is asked for its objects, since not every server searches across them
/// (PS3.4, C.4.1.2.2).
///
/// # Errors
/// If an answer lacks a UID; else see [`DimseFault`].
pub fn listed<S: Read + Write>(
    stream: S,
    titles: &Titles,
    study: &Study,
) -> Result<Vec<Listed>, DimseFault> {
    let class = Model::Study.class();
    let mut association = Association::open(stream, titles, &[class])?;
    let of_study = |level| at_level(level).text(tags::STUDY_INSTANCE_UID, study.uid());
    let query = of_study("SERIES").text(tags::SERIES_INSTANCE_UID, "");
    let mut listed = Vec::new();
    for found in association.find(class, &query.0, LISTED_MOST)? {
        let series = required(&found, tags::SERIES_INSTANCE_UID)?;
        let query = of_study("IMAGE")
            .text(tags::SERIES_INSTANCE_UID, series.as_str())
            .text(tags::SOP_INSTANCE_UID, "")
            .text(tags::SOP_CLASS_UID, "");
        for found in association.find(class, &query.0, LISTED_MOST - listed.len())? {
            let class = required(&found, tags::SOP_CLASS_UID)?;
            let uid = required(&found, tags::SOP_INSTANCE_UID)?;
            listed.push(Listed { class, series: series.clone(), uid });
        }
    }
    association.release();
    Ok(listed)
}

/// Sends objects (C-STORE). Returns those that the server does not store.
///
/// # Errors
/// See [`DimseFault`]; some objects may be stored then.
pub fn store<S: Read + Write>(
    stream: S,
    titles: &Titles,
    objects: &[DicomObject],
) -> Result<Vec<NotStored>, DimseFault> {
    let mut classes: Vec<&'static str> = objects.iter().map(|of| of.class().uid()).collect();
    classes.sort_unstable();
    classes.dedup();
    let mut association = Association::open(stream, titles, &classes)?;
    let mut refused = Vec::new();
    for object in objects {
        refused.extend(association.store(object)?.and_then(NotStored::for_reason));
    }
    association.release();
    Ok(refused)
}

/// The beginning of a query at a level of studies.
fn at_level(level: &str) -> Dataset {
    Dataset::new().text(tags::QUERY_RETRIEVE_LEVEL, level)
}

/// A UID that an answer must have.
fn required(found: &InMemDicomObject, tag: Tag) -> Result<String, DimseFault> {
    text_of(found, tag).filter(|text| !text.is_empty()).ok_or(DimseFault::Missing(tag))
}
