//! The structure of a PDF for screen readers: its tree of headings, paragraphs, tables and figures
//! (ISO 32000-1, 14.7 and 14.8).

use pdf_writer::types::{StructRole, TableHeaderScope};
use pdf_writer::{Finish, Name, Pdf, Ref, TextStr};

/// An element, by its index in the tree.
pub(super) type ElementIndex = usize;

/// The whole document.
pub(super) const ROOT: ElementIndex = 0;

struct Element {
    role: StructRole,
    parent: Option<ElementIndex>,
    /// Alternative text.
    alt: Option<String>,
    /// How many columns of a table a cell spans.
    span: usize,
    children: Vec<Child>,
}

impl Element {
    fn new(role: StructRole, parent: Option<ElementIndex>) -> Element {
        Element { role, parent, alt: None, span: 1, children: Vec::new() }
    }
}

enum Child {
    Element(ElementIndex),
    /// Content on a page, by the number of the page and its own number there.
    Drawn(usize, i32),
}

/// The structure tree.
pub(super) struct Tags {
    elements: Vec<Element>,
    /// The element of each piece of content, page by page.
    drawn: Vec<Vec<ElementIndex>>,
}

impl Tags {
    pub(super) fn new() -> Tags {
        Tags { elements: vec![Element::new(StructRole::Document, None)], drawn: Vec::new() }
    }

    /// Adds a new element as the last child of another.
    pub(super) fn add(&mut self, parent: ElementIndex, role: StructRole) -> ElementIndex {
        let index = self.elements.len();
        self.elements.push(Element::new(role, Some(parent)));
        self.elements[parent].children.push(Child::Element(index));
        index
    }

    /// Adds a figure with its alternative text.
    pub(super) fn add_figure(&mut self, alt: &str) -> ElementIndex {
        let index = self.add(ROOT, StructRole::Figure);
        self.elements[index].alt = Some(alt.to_owned());
        index
    }

    /// Adds a cell that spans this many columns.
    pub(super) fn add_cell(
        &mut self,
        row: ElementIndex,
        role: StructRole,
        span: usize,
    ) -> ElementIndex {
        let index = self.add(row, role);
        self.elements[index].span = span;
        index
    }

    /// The number on a page for the next piece of content of an element, and the name of its role.
    pub(super) fn draw(&mut self, element: ElementIndex, page: usize) -> (i32, Name<'static>) {
        self.drawn.resize_with(self.drawn.len().max(page + 1), Vec::new);
        let number = self.drawn[page].len() as i32;
        self.drawn[page].push(element);
        self.elements[element].children.push(Child::Drawn(page, number));
        (number, self.elements[element].role.to_name())
    }

    /// Number of objects that the tree needs.
    pub(super) fn len(&self) -> usize {
        self.elements.len()
    }

    /// The elements of the content of a page, in the order of their numbers.
    pub(super) fn drawn_on(&self, page: usize) -> &[ElementIndex] {
        self.drawn.get(page).map_or(&[], Vec::as_slice)
    }

    /// Writes all elements as the objects `refs` below the tree's root.
    pub(super) fn write(&self, pdf: &mut Pdf, root: Ref, refs: &[Ref], pages: &[Ref]) {
        for (element, id) in self.elements.iter().zip(refs) {
            let mut written = pdf.struct_element(*id);
            written.kind(element.role);
            written.parent(element.parent.map_or(root, |parent| refs[parent]));
            if let Some(alt) = &element.alt {
                written.alt(TextStr(alt));
            }
            if matches!(element.role, StructRole::TH | StructRole::TD) {
                let mut attributes = written.attributes();
                let mut table = attributes.push().table();
                if element.role == StructRole::TH {
                    table.scope(TableHeaderScope::Column);
                }
                table.col_span(element.span as i32);
            }
            let mut children = written.children();
            for child in &element.children {
                match child {
                    Child::Element(index) => {
                        children.struct_element(refs[*index]);
                    }
                    Child::Drawn(page, number) => {
                        children.marked_content_ref().page(pages[*page]).marked_content_id(*number);
                    }
                }
            }
            children.finish();
        }
    }
}
