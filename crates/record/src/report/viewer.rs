//! The 3D view of a record's legs for pages: own WebGL code without libraries or network access. Its
//! parts form one script, which has the words of a language before it.

use std::collections::BTreeMap;

use gaiter_language::Language;

/// The script without words. `gaiterViewer.mount(element, record, {patient})` shows the legs of a
/// `record.json` in an element; `patient` is the id as the page shows it, if it does.
pub const VIEWER: &str = concat!(
    include_str!("viewer/1_constants.js"),
    include_str!("viewer/2_reading.js"),
    include_str!("viewer/3_geometry.js"),
    include_str!("viewer/4_tape.js"),
    include_str!("viewer/5_camera.js"),
    include_str!("viewer/6_gpu.js"),
    include_str!("viewer/7_labels.js"),
    include_str!("viewer/8_inputs.js"),
    include_str!("viewer/9_page.js"),
);

/// The script with the words of a language, some of which are replaced by others.
///
/// # Errors
/// If the words cannot be written as JSON.
pub fn viewer(
    language: Language,
    others: &[(&'static str, String)],
) -> Result<String, serde_json::Error> {
    let mut words: BTreeMap<&str, &str> = language.table("viewer").collect();
    words.insert("point", language.decimal_sign());
    words.insert("tag", language.tag());
    words.extend(others.iter().map(|(key, text)| (*key, text.as_str())));
    // `<` could end the script's element.
    let words = serde_json::to_string(&words)?.replace('<', "\\u003c");
    Ok(format!("globalThis.gaiterViewerWords = {words};\n{VIEWER}"))
}
