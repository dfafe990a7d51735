//! The objects of a PDF: pages, fonts, structure tree, metadata.

use jiff::tz::TimeZone;
use pdf_writer::writers::StructTreeRoot;
use pdf_writer::{Date, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use sha2::{Digest, Sha256};

use super::PdfFault;
use super::letters::{FontRefs, NAMES, packed};
use super::sheet::{SIZE, Sheets, short};
use super::tags::ROOT;
use crate::report::document::Origin;
use crate::report::{Head, Paper};

/// The object numbers.
struct Refs {
    catalog: Ref,
    info: Ref,
    /// The page tree.
    tree: Ref,
    pages: Vec<Ref>,
    /// The content stream of each page.
    contents: Vec<Ref>,
    /// The structure tree.
    tags: Ref,
    elements: Vec<Ref>,
    /// The elements of the content of each page.
    drawn: Vec<Ref>,
    fonts: [FontRefs; 2],
}

impl Refs {
    fn new(sheets: &Sheets) -> Refs {
        let mut last = 0;
        let mut next = || {
            last += 1;
            Ref::new(last)
        };
        let pages = sheets.pages.len();
        Refs {
            catalog: next(),
            info: next(),
            tree: next(),
            pages: (0..pages).map(|_| next()).collect(),
            contents: (0..pages).map(|_| next()).collect(),
            tags: next(),
            elements: (0..sheets.tags.len()).map(|_| next()).collect(),
            drawn: (0..pages).map(|_| next()).collect(),
            fonts: [(); 2].map(|()| FontRefs::new(&mut next)),
        }
    }
}

/// Writes the finished pages as a file.
pub(super) fn bytes(sheets: Sheets, head: &Head, origin: &Origin) -> Result<Vec<u8>, PdfFault> {
    let refs = Refs::new(&sheets);
    let mut pdf = Pdf::new();
    // The id depends on the origin only, so that the same record gives the same file.
    let id = Sha256::digest(&origin.id);
    pdf.set_file_id((id[..16].to_vec(), id[..16].to_vec()));
    write_catalog(&mut pdf, &refs, head);
    write_info(&mut pdf, refs.info, head, origin);
    write_pages(&mut pdf, &refs, sheets.paper);
    write_tags(&mut pdf, &refs, &sheets);
    for (letters, refs) in sheets.letters.iter().zip(&refs.fonts) {
        letters.write(&mut pdf, refs)?;
    }
    for (page, id) in sheets.pages.into_iter().zip(refs.contents) {
        pdf.stream(id, &packed(page.finish().as_slice())).filter(Filter::FlateDecode);
    }
    Ok(pdf.finish())
}

fn write_catalog(pdf: &mut Pdf, refs: &Refs, head: &Head) {
    let mut catalog = pdf.catalog(refs.catalog);
    catalog.pages(refs.tree).lang(TextStr(head.language.tag()));
    catalog.viewer_preferences().display_doc_title(true);
    catalog.mark_info().marked(true);
    catalog.pair(Name(b"StructTreeRoot"), refs.tags);
}

fn write_pages(pdf: &mut Pdf, refs: &Refs, paper: Paper) {
    let [width, height] = paper.size_pt();
    let (left, top) = ((SIZE[0] - width) / 2.0, SIZE[1]);
    let sides = [left, top - height, left + width, top].map(short);
    pdf.pages(refs.tree).kids(refs.pages.iter().copied()).count(refs.pages.len() as i32);
    for (index, (page, content)) in refs.pages.iter().zip(&refs.contents).enumerate() {
        let mut page = pdf.page(*page);
        page.parent(refs.tree)
            .media_box(Rect::new(sides[0], sides[1], sides[2], sides[3]))
            .contents(*content);
        page.struct_parents(index as i32);
        let mut resources = page.resources();
        let mut named = resources.fonts();
        for (name, font) in NAMES.iter().zip(&refs.fonts) {
            named.pair(*name, font.font);
        }
    }
}

fn write_tags(pdf: &mut Pdf, refs: &Refs, sheets: &Sheets) {
    let mut root = pdf.indirect(refs.tags).start::<StructTreeRoot<'_>>();
    root.child(refs.elements[ROOT]);
    root.parent_tree_next_key(refs.pages.len() as i32);
    let mut parents = root.parent_tree();
    let mut entries = parents.nums();
    for (page, drawn) in refs.drawn.iter().enumerate() {
        entries.insert(page as i32, *drawn);
    }
    entries.finish();
    parents.finish();
    root.finish();
    for (page, id) in refs.drawn.iter().enumerate() {
        let drawn = sheets.tags.drawn_on(page).iter().map(|element| refs.elements[*element]);
        pdf.indirect(*id).array().items(drawn);
    }
    sheets.tags.write(pdf, refs.tags, &refs.elements, &refs.pages);
}

fn write_info(pdf: &mut Pdf, id: Ref, head: &Head, origin: &Origin) {
    let title = format!("{} – {}", head.title, head.patient);
    let mut info = pdf.document_info(id);
    info.title(TextStr(&title)).author(TextStr(&origin.author)).creator(TextStr(&origin.made_by));
    info.producer(TextStr("pdf-writer"));
    let Some(at) = origin.at else { return };
    let at = at.to_zoned(TimeZone::UTC);
    let Ok(year) = u16::try_from(at.year()) else { return };
    let part = |of: i8| of.unsigned_abs();
    info.creation_date(
        Date::new(year)
            .month(part(at.month()))
            .day(part(at.day()))
            .hour(part(at.hour()))
            .minute(part(at.minute()))
            .second(part(at.second()))
            .utc_offset_hour(0)
            .utc_offset_minute(0),
    );
}
