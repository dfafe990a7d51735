//! The 3D view of a record's legs, for pages: our own WebGL without library or network. Its parts are
//! one script.

/// `gaiterViewer.mount(element, record, {language})` fills an element with the view of a `record.json`.
pub const VIEWER: &str = concat!(
    include_str!("viewer/1_words.js"),
    include_str!("viewer/2_reading.js"),
    include_str!("viewer/3_geometry.js"),
    include_str!("viewer/4_camera.js"),
    include_str!("viewer/5_gpu.js"),
    include_str!("viewer/6_page.js"),
);
