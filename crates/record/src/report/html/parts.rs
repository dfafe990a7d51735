//! The parts of the page, from the most important figures to the origin of the record.

use gaiter_language::Language;
use gaiter_leg::Side;

use super::markup::{element, figure, foreign, held_words, section, wide, words};
use crate::picture::figures::DrawnFigure;
use crate::picture::svg;
use crate::report::age::Age;
use crate::report::content::{
    Fact, LevelRow, Note, Section, SheetRow, Table, TableRow, Verdict, VerdictPart,
};
use crate::report::document::{PaperLink, Sheet, View};
use crate::report::{Head, ReportFigure};
use crate::shown::escaped;

/// The patient, and when the scan was taken.
pub(super) fn header(head: &Head, paper: Option<&PaperLink>) -> String {
    let class = if head.is_vouched { " class=\"kind\"" } else { " class=\"kind alarm\"" };
    let title = words("p", class, &head.title);
    let patient = format!("<h1>{}</h1>", foreign(&head.patient));
    let taken = format!("<p class=\"taken\">{}</p>", foreign(&head.taken));
    let link = |paper: &PaperLink| {
        let link = words("a", &format!(" href=\"{}\"", escaped(&paper.address)), &paper.words);
        element("p", " class=\"screen-only\"", &link)
    };
    let paper = paper.map(link).unwrap_or_default();
    element("header", "", &[title, patient, taken, paper].join("\n"))
}

/// What matters most, a sentence a line, below the headings of its parts. What to do comes first.
pub(super) fn verdict(of: &Verdict) -> String {
    let mut first = of.kind.map(|_| " class=\"first\"");
    let part = |part: &VerdictPart| {
        let heading = part.heading.as_ref().map(|of| words("h2", "", of)).unwrap_or_default();
        let sentences = part.sentences.iter();
        let sentences = sentences.map(|of| held_words("p", first.take().unwrap_or_default(), of));
        element("div", "", &(heading + &sentences.collect::<String>()))
    };
    let parts: String = of.parts.iter().map(part).collect();
    let kind = of.kind.map(|kind| format!(" {}", kind.word())).unwrap_or_default();
    element("div", &format!(" class=\"verdict{kind}\""), &parts)
}

/// A picture below a heading.
pub(super) fn picture(id: &str, title: &str, drawn: &DrawnFigure, caption: &str) -> String {
    let inside = svg::embedded(drawn.name, &drawn.picture, &drawn.marks)
        + &held_words("figcaption", "", caption);
    section(id, title, &element("figure", &format!(" class=\"{}\"", drawn.name), &inside))
}

/// The place of the interactive 3D view.
pub(super) fn view(id: &str, of: &View, language: Language) -> String {
    let whose = of.whose.as_ref().map(|whose| format!(" – {}", foreign(whose)));
    let title = escaped(&of.title) + &whose.unwrap_or_default();
    let heading = element("h2", &format!(" id=\"{id}\""), &title);
    let text = of.text.as_ref().map(|text| held_words("p", " class=\"aside\"", text));
    let no_script = words("p", "", language.text("report.pictures.no_script"));
    let place = element("div", " id=\"view-place\"", &no_script);
    let inside = heading + &text.unwrap_or_default() + &place;
    let inside = element("section", &format!(" aria-labelledby=\"{id}\""), &inside);
    element("div", " class=\"screen-only\"", &inside)
}

/// Doubts and findings.
pub(super) fn notes(id: &str, of: &Section<Note>, summary: &str, language: Language) -> String {
    let entries: String = of.entries.iter().map(|entry| note(entry, language)).collect();
    let list = match entries.as_str() {
        "" => held_words("p", "", summary),
        entries => element("ul", " class=\"notes\"", entries),
    };
    section(id, &of.title, &list)
}

fn note(note: &Note, language: Language) -> String {
    let place = if note.place.is_empty() { String::new() } else { foreign(&note.place) + " · " };
    let heading = format!(
        "<h3>{}<span class=\"place\">{place}</span>{}</h3>",
        words("span", " class=\"weight\"", &note.weight_words),
        words("bdi", "", &note.title)
    );
    // A message that is not available in the page's language is shown in the record's own.
    let is_foreign = note.is_message_english && language.tag() != "en";
    let lang = if is_foreign { " lang=\"en\"" } else { "" };
    let message = match note.message.as_str() {
        "" => String::new(),
        message => held_words("p", &format!(" class=\"message\"{lang}"), message),
    };
    let meaning = note.meaning.as_ref().map(|meaning| held_words("p", "", meaning));
    let action = note.action.as_ref().map(|action| held_words("p", " class=\"action\"", action));
    let inside = [Some(heading), Some(message), meaning, action].into_iter().flatten();
    element(
        "li",
        &format!(" class=\"{}\"", note.weight.word()),
        &inside.collect::<Vec<_>>().join("\n"),
    )
}

/// The measuring sheet with both legs beside it, and what a person fills in on paper.
pub(super) fn sheet(id: &str, of: &Sheet) -> String {
    let (levels, columns) = (&of.levels, &of.levels.columns);
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
    let table = wide(id, &element("table", " class=\"levels\"", &inside));
    let key = std::iter::once(&levels.key);
    let below =
        key.chain(&levels.by_hand).chain(&levels.doubts).chain(&levels.tilted).chain(&of.see_sizes);
    let below: String = below.map(|text| held_words("p", " class=\"aside\"", text)).collect();
    let below = age(&of.age) + &below;
    let legs = of.legs.as_ref().map(|drawn| {
        let marks = svg::embedded(drawn.name, &drawn.picture, &drawn.marks);
        element("figure", " class=\"sheet\"", &marks)
    });
    let sheet = table + &legs.unwrap_or_default() + &below + &open_fields(&of.open);
    section(id, &levels.title, &sheet)
}

fn level(row: &LevelRow) -> String {
    let name = words("b", "", &row.level) + " " + &words("span", " class=\"place\"", &row.place);
    let mut cells = format!("<th scope=\"row\">{name}</th>");
    for leg in &row.legs {
        if leg.girth.is_missing() {
            // One reason for both columns.
            cells += &words("td", " colspan=\"2\" class=\"missing\"", &leg.girth.value);
        } else {
            cells += &figure(&leg.girth, "");
            cells += &figure(&leg.height, "");
        }
        cells += if row.has_height { BOXES } else { ONE_BOX };
    }
    element("tr", if row.is_needed { " class=\"needed\"" } else { "" }, &cells)
}

/// A length, which has one figure a leg.
fn length(row: &SheetRow) -> String {
    let of_leg = |of: &ReportFigure| figure(of, " colspan=\"2\"") + ONE_BOX;
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
fn open_fields(open: &Section) -> String {
    let names: String = open.entries.iter().map(|name| words("li", "", name)).collect();
    let title = words("h3", "", &open.title);
    element("div", " class=\"open print-only\"", &(title + &element("ul", "", &names)))
}

/// What few readers need: closed, and not printed while it is.
pub(super) fn appendix(title: &str, blocks: &str) -> String {
    element("details", " class=\"appendix\"", &(words("summary", "", title) + blocks))
}

/// The buttons for printing.
pub(super) fn tools(language: Language) -> String {
    let text = |key| language.text(key);
    let print = words("button", " type=\"button\" id=\"print\"", text("report.print.button"));
    let only = format!(
        "<label><input type=\"checkbox\" id=\"first-only\"> {}</label>",
        escaped(text("report.print.first_only"))
    );
    element("p", " class=\"tools screen-only\"", &(print + &only))
}

/// A table below its heading.
pub(super) fn table(id: &str, of: &Table) -> String {
    let head: String = of.columns.iter().map(|text| words("th", " scope=\"col\"", text)).collect();
    let head = element("thead", "", &element("tr", "", &head));
    let row = |row: &TableRow| {
        let figures: String = row.figures.iter().map(|of| figure(of, "")).collect();
        element("tr", "", &(words("th", " scope=\"row\"", &row.head) + &figures))
    };
    let body = element("tbody", "", &of.rows.iter().map(row).collect::<String>());
    let aside = |text: &Option<String>, class: &str| {
        let text = text.as_ref().map(|text| held_words("p", &format!(" class=\"{class}\""), text));
        text.unwrap_or_default()
    };
    let class = if of.is_dense() { " class=\"dense\"" } else { "" };
    let table = wide(id, &element("table", class, &(head + &body)));
    let inside = aside(&of.explanation, "aside") + &table + &aside(&of.below, "aside below");
    section(id, &of.title, &inside)
}

/// A heading with paragraphs.
pub(super) fn entries(id: &str, of: &Section) -> String {
    let paragraphs: String =
        of.entries.iter().map(|text| held_words("li", "", text) + "\n").collect();
    section(id, &of.title, &element("ul", " class=\"plain\"", &paragraphs))
}

/// A heading with facts.
pub(super) fn facts(id: &str, of: &Section<Fact>) -> String {
    let fact = |fact: &Fact| {
        let inside = words("dt", "", &fact.name) + &format!("<dd>{}</dd>", foreign(&fact.value));
        element("div", "", &inside)
    };
    let facts: String = of.entries.iter().map(fact).collect();
    section(id, &of.title, &element("dl", " class=\"facts\"", &facts))
}
