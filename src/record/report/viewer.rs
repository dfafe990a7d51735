//! The 3D view of a record's legs for pages: own WebGL code without libraries or network access. Its
//! parts form one script.

/// `gaiterViewer.mount(element, record, {language, patient})` shows the legs of a `record.json` in an
/// element; `patient` is the id as the page shows it, if it does.
pub const VIEWER: &str = concat!(
    include_str!("viewer/1_words.js"),
    include_str!("viewer/2_reading.js"),
    include_str!("viewer/3_geometry.js"),
    include_str!("viewer/4_tape.js"),
    include_str!("viewer/5_camera.js"),
    include_str!("viewer/6_gpu.js"),
    include_str!("viewer/7_labels.js"),
    include_str!("viewer/8_inputs.js"),
    include_str!("viewer/9_page.js"),
);
