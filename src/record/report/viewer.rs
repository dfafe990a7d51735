//! The 3D view of a record's legs for pages: own WebGL code without libraries or network access. Its
//! parts form one script.

/// `gaiterViewer.mount(element, record, {language})` shows the legs of a `record.json` in an element.
pub const VIEWER: &str = concat!(
    include_str!("viewer/1_words.js"),
    include_str!("viewer/2_reading.js"),
    include_str!("viewer/3_geometry.js"),
    include_str!("viewer/4_camera.js"),
    include_str!("viewer/5_gpu.js"),
    include_str!("viewer/6_page.js"),
);
