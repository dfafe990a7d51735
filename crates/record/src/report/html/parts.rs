//! The parts of the page, from the most important figures to the origin of the record.

use gaiter_leg::Side;

use super::markup::{element, escaped, figure, foreign, said, section, wide, words};
use crate::picture::figures::{Figure as Drawn, SHEET};
use crate::picture::svg;
use crate::report::age::Age;
use crate::report::content::{Content, LevelRow, Note, Section, SheetRow, Table, Weight};
use crate::report::document::{PaperLink, VerdictPart};
use crate::report::{Figure, Head, Mark};

/// The patient, and when the scan was taken.
pub(super) fn header(content: &Content) -> String {
    let class = if content.is_vouched { " class=\"kind\"" } else { " class=\"kind alarm\"" };
    let title = words("p", class, &content.title);
    let patient = format!("<h1>{}</h1>", foreign(&content.patient));
    let taken = format!("<p class=\"taken\">{}</p>", foreign(&content.taken));
    element("header", "", &[title, patient, taken].join("\n"))
}

/// The head of a report of blocks.
pub(super) fn document_header(head: &Head, paper: Option<&PaperLink>) -> String {
    let title = words("p", " class=\"kind\"", &head.title);
    let patient = format!("<h1>{}</h1>", foreign(&head.patient));
    let taken = format!("<p class=\"taken\">{}</p>", foreign(&head.taken));
    let link = |paper: &PaperLink| {
        let link = words("a", &format!(" href=\"{}\"", escaped(&paper.address)), &paper.words);
        element("p", " class=\"screen-only\"", &link)
    };
    let paper = paper.map(link).unwrap_or_default();
    element("header", "", &[title, patient, taken, paper].join("\n"))
}

/// What matters most, a sentence a line, below the headings of its parts.
pub(super) fn verdict_of(parts: &[VerdictPart]) -> String {
    let part = |part: &VerdictPart| {
        let heading = part.heading.as_ref().map(|of| words("h2", "", of)).unwrap_or_default();
        let sentences = part.sentences.iter().map(|sentence| said("p", "", sentence));
        element("div", "", &(heading + &sentences.collect::<String>()))
    };
    element("div", " class=\"verdict\"", &parts.iter().map(part).collect::<String>())
}

/// A picture below a heading.
pub(super) fn titled(id: &str, title: &str, drawn: &Drawn, caption: &str) -> String {
    let inside =
        svg::embedded(drawn.name, &drawn.picture, &drawn.marks) + &said("figcaption", "", caption);
    section(id, title, &element("figure", &format!(" class=\"{}\"", drawn.name), &inside))
}

/// The place of the interactive 3D view of a report of blocks.
pub(super) fn view_of(title: &str, text: &str) -> String {
    let text = said("p", " class=\"aside\"", text);
    let place = element("div", " id=\"view-place\"", "");
    let heading = words("h2", " id=\"view\"", title);
    let inside = element("section", " aria-labelledby=\"view\"", &(heading + &text + &place));
    element("div", " class=\"screen-only\"", &inside)
}

/// What is to be done before the patient dresses.
pub(super) fn verdict(content: &Content) -> String {
    let [first, rest @ ..] = content.verdict.sentences.as_slice() else { return String::new() };
    let rest: String = rest.iter().map(|sentence| said("p", "", sentence)).collect();
    let class = format!(" class=\"verdict {}\"", content.verdict.kind.word());
    element("div", &class, &(said("p", " class=\"first\"", first) + &rest))
}

/// Doubts and findings.
pub(super) fn notes(content: &Content) -> String {
    let entries: String = content.notes.entries.iter().map(|entry| note(content, entry)).collect();
    let list = match entries.as_str() {
        "" => said("p", "", &content.summary),
        entries => element("ul", " class=\"notes\"", entries),
    };
    section("notes", &content.notes.title, &list)
}

fn note(content: &Content, note: &Note) -> String {
    let class = match note.weight {
        Weight::Error => "error",
        Weight::Warning => "warning",
        Weight::Info => "info",
    };
    let place = if note.place.is_empty() { String::new() } else { foreign(&note.place) + " · " };
    let heading = format!(
        "<h3>{}<span class=\"place\">{place}</span>{}</h3>",
        words("span", " class=\"weight\"", &note.weight_words),
        words("bdi", "", &note.title)
    );
    // A message that is not available in the page's language is shown in the record's own.
    let is_foreign = note.is_message_english && content.language.tag() != "en";
    let lang = if is_foreign { " lang=\"en\"" } else { "" };
    let message = match note.message.as_str() {
        "" => String::new(),
        message => said("p", &format!(" class=\"message\"{lang}"), message),
    };
    let meaning = note.meaning.as_ref().map(|meaning| said("p", "", meaning));
    let action = note.action.as_ref().map(|action| said("p", " class=\"action\"", action));
    let inside = [Some(heading), Some(message), meaning, action].into_iter().flatten();
    element("li", &format!(" class=\"{class}\""), &inside.collect::<Vec<_>>().join("\n"))
}

/// The measuring sheet with both legs beside it, and what a person fills in on paper.
pub(super) fn levels(content: &Content, drawn: &[Drawn]) -> String {
    let (levels, columns) = (&content.levels, &content.levels.columns);
    let column = |text: &str| words("th", " scope=\"col\"", text);
    let legs: String = Side::FROM_FRONT
        .into_iter()
        .zip(&columns.legs)
        .map(|(side, leg)| {
            let attributes = format!(" scope=\"colgroup\" colspan=\"4\" class=\"{}\"", side.word());
            words("th", &attributes, leg)
        })
        .collect();
    let first = words("th", " scope=\"col\" rowspan=\"2\"", &columns.level) + &legs;
    let open = |text: &String| words("th", " scope=\"col\" class=\"by-hand\"", text);
    let by_hand: String = columns.by_hand.iter().map(open).collect();
    let of_leg = column(&columns.girth) + &column(&columns.height) + &by_hand;
    let head = element("tr", "", &first) + &element("tr", "", &of_leg.repeat(2));
    let rows: String = levels.rows.iter().map(level).collect();
    let lengths: String = levels.lengths.iter().map(length).collect();
    let groups = "<colgroup><col></colgroup><colgroup span=\"4\"></colgroup>\
                  <colgroup span=\"4\"></colgroup>";
    let head = groups.to_owned() + &element("thead", "", &head);
    let inside = head + &element("tbody", "", &(rows + &lengths));
    let table = wide("levels", &element("table", " class=\"levels\"", &inside));
    let key = std::iter::once(&levels.key);
    let see_sizes = content.sizes.as_ref().and_then(|of| of.see.as_ref());
    let below =
        key.chain(&levels.by_hand).chain(&levels.doubts).chain(&levels.tilted).chain(see_sizes);
    let below: String = below.map(|text| said("p", " class=\"aside\"", text)).collect();
    let below = age(&content.age) + &below;
    let legs = drawn.iter().find(|drawn| drawn.name == SHEET).map(|drawn| {
        let marks = svg::embedded(drawn.name, &drawn.picture, &drawn.marks);
        element("figure", " class=\"sheet\"", &marks)
    });
    let sheet = table + &legs.unwrap_or_default() + &below + &open_fields(content);
    section("levels", &levels.title, &sheet)
}

fn level(row: &LevelRow) -> String {
    let name = words("b", "", &row.level) + " " + &words("span", " class=\"place\"", &row.place);
    let mut cells = format!("<th scope=\"row\">{name}</th>");
    for leg in &row.legs {
        if leg.girth.is_missing() {
            // One reason for both columns.
            cells += &words("td", " colspan=\"2\" class=\"missing\"", &leg.girth.value);
        } else {
            cells += &figure(&leg.girth);
            cells += &figure(&leg.height);
        }
        cells += if row.has_height { BOXES } else { ONE_BOX };
    }
    element("tr", if row.is_needed { " class=\"needed\"" } else { "" }, &cells)
}

/// A length, which has one figure a leg.
fn length(row: &SheetRow) -> String {
    let of_leg = |of: &Figure| {
        let class = if of.is_missing() { " class=\"missing\"" } else { "" };
        let margin = of.margin.as_ref().map(|margin| format!(" ± {margin}")).unwrap_or_default();
        let sign = match of.mark {
            Mark::Doubtful => " ?",
            Mark::ByHand => "\u{a0}*",
            _ => "",
        };
        let shown = format!("{}{margin}{sign}", of.value);
        words("td", &format!(" colspan=\"2\"{class}"), &shown) + ONE_BOX
    };
    let cells: String = row.figures.iter().map(of_leg).collect();
    element("tr", "", &(words("th", " scope=\"row\"", &row.head) + &cells))
}

/// How old the scan is: until when it holds for an order, and in a browser how old it is today.
fn age(age: &Age) -> String {
    let Some(counted) = &age.counted else { return words("p", " class=\"aside\"", &age.until) };
    let attributes = format!(
        " id=\"age\" class=\"aside\" data-taken=\"{}\" data-most=\"{}\" data-fresh=\"{}\" data-old=\"{}\"",
        counted.taken,
        counted.most.0,
        escaped(&counted.fresh),
        escaped(&counted.old),
    );
    words("p", &attributes, &age.until)
}

/// The cells that are left open on paper: for a girth and a height, or for one figure.
const BOXES: &str = "<td class=\"by-hand\"></td><td class=\"by-hand\"></td>";
const ONE_BOX: &str = "<td class=\"by-hand\" colspan=\"2\"></td>";

/// The fields of an order that a scan cannot give, for paper.
fn open_fields(content: &Content) -> String {
    let names: String = content.open.names.iter().map(|name| words("li", "", name)).collect();
    let title = words("h3", "", &content.open.title);
    element("div", " class=\"open print-only\"", &(title + &element("ul", "", &names)))
}

/// The pictures for every reader.
pub(super) fn pictures(content: &Content, drawn: &[&Drawn]) -> String {
    section("pictures", &content.pictures.title, &captioned(content, drawn))
}

/// The engineering figures, which few readers need: closed, and not printed while they are.
pub(super) fn appendix(content: &Content, drawn: &[&Drawn]) -> String {
    let inside = [
        words("summary", "", &content.pictures.appendix),
        captioned(content, drawn),
        content.slices.as_ref().map(|of| whole_table("slices", of)).unwrap_or_default(),
        entries("surfaces", &content.surfaces),
        landmarks(content),
    ];
    element("details", " class=\"appendix\"", &inside.concat())
}

fn captioned(content: &Content, drawn: &[&Drawn]) -> String {
    drawn.iter().map(|drawn| picture(content, drawn)).collect()
}

/// The buttons for printing.
pub(super) fn tools(content: &Content) -> String {
    let text = |key| content.language.text(key);
    let print = words("button", " type=\"button\" id=\"print\"", text("report.print.button"));
    let only = format!(
        "<label><input type=\"checkbox\" id=\"first-only\"> {}</label>",
        escaped(text("report.print.first_only"))
    );
    element("p", " class=\"tools screen-only\"", &(print + &only))
}

fn picture(content: &Content, drawn: &Drawn) -> String {
    let caption = content.pictures.captions.iter().find(|caption| caption.name == drawn.name);
    let caption = match caption {
        Some(of) => words("b", "", &of.title) + " " + &said("span", "", &of.text),
        None => escaped(&drawn.picture.title),
    };
    let inside = svg::embedded(drawn.name, &drawn.picture, &drawn.marks)
        + &element("figcaption", "", &caption);
    element("figure", &format!(" class=\"{}\"", drawn.name), &inside)
}

/// The place of the interactive 3D view, under a heading that says whose legs it shows.
pub(super) fn view(content: &Content) -> String {
    let sentence = words("p", "", &content.pictures.no_script);
    let place = element("div", " id=\"view-place\"", &sentence);
    let whose = format!("{} – {}", escaped(&content.pictures.view), foreign(&content.patient));
    let heading = element("h2", " id=\"view\"", &whose);
    let inside = element("section", " aria-labelledby=\"view\"", &(heading + &place));
    element("div", " class=\"screen-only\"", &inside)
}

/// Both legs at the same heights, requested heights, volumes.
pub(super) fn tables(content: &Content) -> String {
    let part = |(index, of): (usize, &Table)| whole_table(&format!("table-{index}"), of);
    content.tables.iter().enumerate().map(part).collect()
}

/// The sizes of makers' tables.
pub(super) fn sizes(content: &Content) -> String {
    let Some(of) = &content.sizes else { return String::new() };
    let about: String = of.about.iter().map(|text| said("p", " class=\"aside\"", text)).collect();
    let part = |(index, of): (usize, &Table)| whole_table(&format!("sizes-{index}"), of);
    let tables: String = of.tables.iter().enumerate().map(part).collect();
    let calibre = of.calibre.as_ref().map(|of| entries("calibre", of)).unwrap_or_default();
    let form = whole_table("form", &of.form);
    // Without tables there is only the form.
    let head = match about.is_empty() {
        true => String::new(),
        false => section("sizes", &of.title, &about),
    };
    head + &tables + &calibre + &form
}

pub(super) fn whole_table(id: &str, of: &Table) -> String {
    section(id, &of.title, &table(id, of, ""))
}

/// Every figure of the levels in mm.
pub(super) fn landmarks(content: &Content) -> String {
    let of = &content.landmarks;
    section("landmarks", &of.title, &table("landmarks", of, " class=\"dense\""))
}

fn table(id: &str, of: &Table, attributes: &str) -> String {
    let head: String = of.columns.iter().map(|text| words("th", " scope=\"col\"", text)).collect();
    let head = element("thead", "", &element("tr", "", &head));
    let row = |row: &crate::report::content::TableRow| {
        let figures: String = row.figures.iter().map(figure).collect();
        element("tr", "", &(words("th", " scope=\"row\"", &row.head) + &figures))
    };
    let body = element("tbody", "", &of.rows.iter().map(row).collect::<String>());
    let aside = |text: &Option<String>, class: &str| {
        let text = text.as_ref().map(|text| said("p", &format!(" class=\"{class}\""), text));
        text.unwrap_or_default()
    };
    let table = wide(id, &element("table", attributes, &(head + &body)));
    aside(&of.explanation, "aside") + &table + &aside(&of.below, "aside below")
}

/// A heading with paragraphs.
pub(super) fn entries(id: &str, of: &Section) -> String {
    let paragraphs: String = of.entries.iter().map(|text| said("li", "", text) + "\n").collect();
    section(id, &of.title, &element("ul", " class=\"plain\"", &paragraphs))
}

/// Where the record comes from.
pub(super) fn facts(content: &Content) -> String {
    let fact = |fact: &crate::report::content::Fact| {
        let inside = words("dt", "", &fact.name) + &format!("<dd>{}</dd>", foreign(&fact.value));
        element("div", "", &inside)
    };
    let facts: String = content.facts.iter().map(fact).collect();
    section("facts", &content.origin, &element("dl", " class=\"facts\"", &facts))
}
