//! The formats of scans, and what else a content looks like.

/// A scan format that gaiter reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, text: a mesh, or only points.
    Obj,
    /// Polygon File Format of Stanford, text or binary of either byte order: a mesh or points.
    Ply,
    /// Stereolithography, text or binary: triangles.
    Stl,
    /// VRML 1 and VRML 2 (97), text: a scene of meshes or points.
    Wrl,
    /// Plain points, one per line, text.
    Xyz,
}

impl Format {
    /// The usual ending of files of this format, its name, and what such a file is called in a question.
    fn words(self) -> [&'static str; 3] {
        match self {
            Format::Obj => ["obj", "OBJ", "a Wavefront OBJ"],
            Format::Ply => ["ply", "PLY", "a PLY"],
            Format::Stl => ["stl", "STL", "an STL"],
            Format::Wrl => ["wrl", "VRML", "a VRML scene"],
            Format::Xyz => ["xyz", "XYZ", "a list of points"],
        }
    }

    /// The usual ending of files of this format, without the dot.
    pub fn ending(self) -> &'static str {
        self.words()[0]
    }

    /// The format's name with its article, for use in a question.
    pub(super) fn in_full(self) -> &'static str {
        self.words()[2]
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(self.words()[1])
    }
}

/// The apparent type of a file's content, regardless of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A scan format that gaiter reads.
    Scan(Format),
    /// Text in UTF-16, with its byte order mark.
    Utf16,
    /// A ZIP archive.
    Zip,
    /// A gzip archive, as sometimes used for VRML scenes.
    Gzip,
}

impl std::fmt::Display for Content {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Content::Scan(format) => format.fmt(out),
            Content::Utf16 => out.write_str("UTF-16 text"),
            Content::Zip => out.write_str("a ZIP archive"),
            Content::Gzip => out.write_str("a gzip archive"),
        }
    }
}

impl Content {
    /// The recommended action for such a content.
    pub(super) fn advice(self) -> &'static str {
        match self {
            Content::Scan(_) => "rename the file or mend the exporter",
            Content::Utf16 => "export as ASCII or UTF-8",
            Content::Zip | Content::Gzip => "let the exporter write it unpacked",
        }
    }
}
