//! `[phantom]`: the body of known girths that is scanned as a daily check.

use std::time::Duration;

use gaiter_leg::phantom::Phantom;

use super::capture::PatientConfig;
use super::parse::{self, Absent, Reader, What};

/// `[phantom]`: the daily check.
#[derive(Debug, Clone, PartialEq)]
pub struct PhantomConfig {
    /// An export whose file name begins with this is a scan of the phantom.
    pub name: String,
    /// Its girths.
    pub phantom: Phantom,
    /// The largest difference from a known girth that counts as none, mm.
    pub tolerance_mm: f64,
    /// How often it should be scanned.
    pub every: Duration,
}

/// Reads the keys of the section; no phantom without `girths`. An id of a patient must not look like the
/// phantom's name.
pub(super) fn config(
    reader: &mut Reader,
    patient: Option<&PatientConfig>,
) -> Option<PhantomConfig> {
    use Absent::{Default, Nothing};
    let example = Nothing("8:50.3, 17:50.3, 33:31.4, 42:31.4");
    let girths = reader.text("phantom.girths", example, |text| {
        let hint = r#"in cm: "35.2" for a cylinder, or girths at heights: "10:35.2, 30:38.1""#;
        text.parse::<Phantom>().map_err(|fault| What::own(fault.to_string(), hint))
    });
    let name = reader.text("phantom.name", Default("PHANTOM"), phantom_name);
    let tolerance_mm =
        reader.value("phantom.tolerance", "2mm", parse::distance_in("0.5mm"..="20mm"))?;
    let every = reader.value("phantom.every", "24h", parse::duration_in("1h"..="720h"))?;
    if let (Some(_), Some(name), Some(patient)) = (&girths, &name, patient)
        && patient.pattern.is_match(&name.value)
    {
        let message = format!("patient.pattern accepts \"{}\" as a patient's id", name.value);
        let what = What::own(message, "choose a name that no patient's id can be");
        reader.note(name.at.clone(), "phantom.name", what);
    }
    Some(PhantomConfig { phantom: girths?.value, name: name?.value, tolerance_mm, every })
}

/// Letters, digits, `-` and `_`: what a scanner's software lets a person type as a name.
fn phantom_name(text: &str) -> Result<String, What> {
    let fits = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if text.len() < 3 || !text.chars().all(fits) {
        let message = format!("\"{text}\" cannot be the name of the phantom");
        return Err(What::own(message, "at least 3 letters (a-z, A-Z), digits, - and _"));
    }
    Ok(text.to_owned())
}
