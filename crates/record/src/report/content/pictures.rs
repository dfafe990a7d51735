//! The texts around the pictures.

use super::{Caption, PictureWords, Report};

impl Report<'_> {
    pub(super) fn picture_words(&self) -> PictureWords {
        PictureWords {
            title: self.text("report.pictures.title"),
            appendix: self.text("report.pictures.appendix"),
            captions: self.captions(),
            view: self.text("report.pictures.view"),
            no_script: self.text("report.pictures.no_script"),
        }
    }

    fn captions(&self) -> Vec<Caption> {
        let names = ["views", "girths", "differences", "sections", "fit", "error"];
        let caption = |name| {
            let word = |part| self.language.find(&format!("report.caption.{name}.{part}"));
            let word = |part| word(part).unwrap_or(name).to_owned();
            Caption { name, title: word("title"), text: word("text") }
        };
        names.map(caption).into()
    }
}
