//! Messages over a connection (PS3.7 and PS3.8): C-ECHO, C-STORE, and C-FIND in an archive of images or a worklist.
//!
//! A connection is anything that reads and writes. The caller opens it, sets its time limits, and ends the association:
//! by [`release`], or after a fault by [`abort`], with a shorter limit than for the call itself. Each call is one
//! association.

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
pub use self::association::{abort, release};
pub use self::fault::{DimseFault, TitleFault};
use super::dataset::{Dataset, text_of};
use super::{DicomObject, Listed, NotStored, SopClass, Study};

/// The longest title of an application, characters (AE).
const TITLE_MOST: usize = 16;

/// The most objects of a series that are listed: those of ours have some tens.
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

/// What a server has answered to a query.
#[derive(Debug)]
pub struct Found {
    /// The answers.
    pub answers: Vec<InMemDicomObject>,
    /// How many further ones cannot be read.
    pub unreadable: usize,
}

/// Whether the server answers (C-ECHO), and lets the station search for studies.
///
/// # Errors
/// See [`DimseFault`].
pub fn reach<S: Read + Write>(stream: S, titles: &Titles) -> Result<(), DimseFault> {
    let classes = [uids::VERIFICATION, Model::Study.class()];
    let mut association = Association::open(stream, titles, &classes)?;
    association.echo()?;
    let query = at_level("STUDY").text(tags::PATIENT_ID, NOBODY).text(tags::STUDY_INSTANCE_UID, "");
    association.find(Model::Study.class(), &query.0, LISTED_MOST)?;
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
) -> Result<Found, DimseFault> {
    let mut association = Association::open(stream, titles, &[model.class()])?;
    let found = association.find(model.class(), query, most)?;
    let all = found.len();
    let answers: Vec<InMemDicomObject> = found.into_iter().flatten().collect();
    Ok(Found { unreadable: all - answers.len(), answers })
}

/// What the server has of a record in its study. It is asked for the objects of each series that the record may have in
/// its first `turns` turns: not every server searches across series (PS3.4, C.4.1.2.2), and others may have any number of
/// objects in the study.
///
/// # Errors
/// If an answer cannot be read or lacks a UID; else see [`DimseFault`].
pub fn listed<S: Read + Write>(
    stream: S,
    titles: &Titles,
    study: &Study,
    turns: u32,
) -> Result<Vec<Listed>, DimseFault> {
    let mut association = Association::open(stream, titles, &[Model::Study.class()])?;
    let mut listed = of_series(&mut association, study, &study.series(SopClass::Withdrawal, 0))?;
    for series in study.record_series(turns) {
        listed.extend(of_series(&mut association, study, &series)?);
    }
    Ok(listed)
}

/// What the server has of a series.
fn of_series<S: Read + Write>(
    association: &mut Association<S>,
    study: &Study,
    series: &str,
) -> Result<Vec<Listed>, DimseFault> {
    let query = at_level("IMAGE")
        .text(tags::STUDY_INSTANCE_UID, study.uid())
        .text(tags::SERIES_INSTANCE_UID, series)
        .text(tags::SOP_INSTANCE_UID, "")
        .text(tags::SOP_CLASS_UID, "");
    let found = association.find(Model::Study.class(), &query.0, LISTED_MOST)?;
    let read = |of: Result<InMemDicomObject, DimseFault>| -> Result<Listed, DimseFault> {
        let of = of?;
        let class = required(&of, tags::SOP_CLASS_UID)?;
        let uid = required(&of, tags::SOP_INSTANCE_UID)?;
        Ok(Listed { class, series: series.to_owned(), uid })
    };
    found.into_iter().map(read).collect()
}

/// Sends an object (C-STORE). Returns why the server does not store it; `None` if it does, or has it.
///
/// # Errors
/// See [`DimseFault`]; the object may be stored then.
pub fn store<S: Read + Write>(
    stream: S,
    titles: &Titles,
    object: &DicomObject,
) -> Result<Option<NotStored>, DimseFault> {
    // Every server knows the second: one that accepts neither does not judge the object.
    let classes = [object.class().uid(), uids::VERIFICATION];
    let mut association = Association::open(stream, titles, &classes)?;
    Ok(association.store(object)?.and_then(NotStored::for_reason))
}

/// The beginning of a query at a level of studies.
fn at_level(level: &str) -> Dataset {
    Dataset::new().text(tags::QUERY_RETRIEVE_LEVEL, level)
}

/// A UID that an answer must have.
fn required(found: &InMemDicomObject, tag: Tag) -> Result<String, DimseFault> {
    text_of(found, tag).filter(|text| !text.is_empty()).ok_or(DimseFault::Missing(tag))
}
