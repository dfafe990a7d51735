//! The query for what is planned at a station (PS3.4, K.6.1.2.2).

use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use jiff::civil::Date;

use crate::UTF_8;
use crate::dataset::Dataset;
use crate::dimse::AeTitle;

/// Asks for what is planned for a station on a day, of a modality or of any. What has no value here, the server fills.
pub fn planned(station: &AeTitle, modality: Option<&str>, day: Date) -> InMemDicomObject {
    let step = Dataset::new()
        .text(tags::MODALITY, modality.unwrap_or_default())
        .text(tags::SCHEDULED_STATION_AE_TITLE, station.as_str())
        .text(tags::SCHEDULED_PROCEDURE_STEP_START_DATE, day.strftime("%Y%m%d").to_string())
        .text(tags::SCHEDULED_PROCEDURE_STEP_START_TIME, "")
        .text(tags::SCHEDULED_PROCEDURE_STEP_ID, "");
    let asked = Dataset::new()
        .text(tags::SPECIFIC_CHARACTER_SET, UTF_8)
        .text(tags::ACCESSION_NUMBER, "")
        .text(tags::PATIENT_NAME, "")
        .text(tags::PATIENT_ID, "")
        .text(tags::ISSUER_OF_PATIENT_ID, "")
        .text(tags::PATIENT_BIRTH_DATE, "")
        .text(tags::PATIENT_SEX, "")
        .text(tags::STUDY_INSTANCE_UID, "")
        .text(tags::REQUESTED_PROCEDURE_DESCRIPTION, "")
        .items(tags::SCHEDULED_PROCEDURE_STEP_SEQUENCE, vec![step]);
    asked.0
}

#[cfg(test)]
mod tests {
    use jiff::civil::date;

    use super::*;
    use crate::dataset::Syntax;

    #[test]
    fn a_query_names_station_day_and_modality_in_the_planned_step() {
        let station = AeTitle::new("LEGSCAN").unwrap();
        let asked = planned(&station, Some("OSS"), date(2026, 11, 28));
        // PS3.5, 7.1.2: the elements of the item, in the order of their tags.
        let step =
            b"\x08\0\x60\0CS\x04\0OSS \x40\0\x01\0AE\x08\0LEGSCAN \x40\0\x02\0DA\x08\x0020261128\
                     \x40\0\x03\0TM\0\0\x40\0\x09\0SH\0\0";
        let bytes = Syntax::ExplicitLittleEndian.encoded(&asked).unwrap();
        assert!(bytes.starts_with(b"\x08\0\x05\0CS\x0a\0ISO_IR 192"));
        assert!(bytes.windows(step.len()).any(|part| part == step));
        let any = Syntax::ExplicitLittleEndian
            .encoded(&planned(&station, None, date(2026, 11, 28)))
            .unwrap();
        assert!(any.windows(8).any(|part| part == b"\x08\0\x60\0CS\0\0"));
    }
}
