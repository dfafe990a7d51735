//! What the parts of a paper are, for those who have it read to them: its tree of headings,
//! paragraphs, tables and figures (ISO 32000-1, 14.7 and 14.8).

use pdf_writer::types::{StructRole, TableHeaderScope};
use pdf_writer::{Finish, Name, Pdf, Ref, TextStr};

/// An element by its place in the tree.
pub(super) type ElementIndex = usize;

/// The whole paper.
pub(super) const ROOT: ElementIndex = 0;

struct Element {
    role: StructRole,
    parent: Option<ElementIndex>,
    /// What is said instead of it.
    alt: Option<String>,
    /// Columns of a table that a cell stands in.
    span: usize,
    children: Vec<Child>,
}

enum Child {
    Element(ElementIndex),
    /// What is drawn on a page, by the page's number and its own there.
    Drawn(usize, i32),
}

/// The tree.
pub(super) struct Tags {
    elements: Vec<Element>,
    /// The element of each thing drawn, page by page.
    drawn: Vec<Vec<ElementIndex>>,
}

impl Tags {
    pub(super) fn new() -> Tags {
        let root = Element {
            role: StructRole::Document,
            parent: None,
            alt: None,
            span: 1,
            children: Vec::new(),
        };
        Tags { elements: vec![root], drawn: Vec::new() }
    }

    /// A new element at the end of another.
    pub(super) fn add(&mut self, parent: ElementIndex, role: StructRole) -> ElementIndex {
        let index = self.elements.len();
        self.elements.push(Element {
            role,
            parent: Some(parent),
            alt: None,
            span: 1,
            children: Vec::new(),
        });
        self.elements[parent].children.push(Child::Element(index));
        index
    }

    /// A figure with what is said instead of it.
    pub(super) fn add_figure(&mut self, alt: &str) -> ElementIndex {
        let index = self.add(ROOT, StructRole::Figure);
        self.elements[index].alt = Some(alt.to_owned());
        index
    }

    /// A cell that stands in so many columns.
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

    /// The number on a page of the next thing that is drawn of an element, and its role's name.
    pub(super) fn draw(&mut self, element: ElementIndex, page: usize) -> (i32, Name<'static>) {
        self.drawn.resize_with(self.drawn.len().max(page + 1), Vec::new);
        let number = self.drawn[page].len() as i32;
        self.drawn[page].push(element);
        self.elements[element].children.push(Child::Drawn(page, number));
        (number, self.elements[element].role.to_name())
    }

    /// Count of objects that the tree needs.
    pub(super) fn len(&self) -> usize {
        self.elements.len()
    }

    /// The elements of what is drawn on a page, in the order of their numbers.
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
