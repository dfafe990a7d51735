//! The parts of the page, from the most important figures to the origin of the record.

use super::markup::{element, escaped, figure, foreign, section, wide, words};
use crate::leg::Side;
use crate::record::picture::figures::Figure as Drawn;
use crate::record::picture::svg;
use crate::record::report::content::{
    Content, LevelFigures, LevelRow, Note, Section, Table, Weight,
};
use crate::record::report::{Figure, Mark};

/// The patient, and when the scan was taken.
pub(super) fn header(content: &Content) -> String {
    let class = if content.is_vouched { " class=\"kind\"" } else { " class=\"kind alarm\"" };
    let title = words("p", class, &content.title);
    let patient = format!("<h1>{}</h1>", foreign(&content.patient));
    let taken = format!("<p class=\"taken\">{}</p>", foreign(&content.taken));
    element("header", "", &[title, patient, taken].join("\n"))
}

/// The girths at B, B1, C and D in large letters, the right leg on the left.
pub(super) fn key_figures(content: &Content) -> String {
    let rows = || content.levels.rows.iter().filter(|row| row.is_sought);
    let leg = |(index, side): (usize, Side)| {
        let entries: String = rows().map(|row| key_figure(row, &row.legs[index])).collect();
        let heading = words("h3", "", &content.levels.columns.legs[index]);
        let class = format!(" class=\"leg {}\"", side.word());
        element("div", &class, &format!("{heading}\n{}", element("dl", "", &entries)))
    };
    let legs: String = Side::FROM_FRONT.into_iter().enumerate().map(leg).collect();
    let summary = words("a", " href=\"#notes\"", &content.summary);
    let summary = element("p", " class=\"summary\"", &summary);
    section("key", &content.key, &(element("div", " class=\"legs\"", &legs) + &summary))
}

fn key_figure(row: &LevelRow, of: &LevelFigures) -> String {
    let name = format!("<dt>{} {}</dt>", words("b", "", &row.level), words("span", "", &row.place));
    let value = |value: &Figure| {
        let before = if value.mark == Mark::Estimated { "~" } else { "" };
        let unit = if value.is_missing() { "" } else { " <span class=\"unit\">cm</span>" };
        let margin = value
            .margin
            .as_ref()
            .map(|margin| format!(" <span class=\"margin\">±&nbsp;{}</span>", escaped(margin)));
        let doubt =
            if value.mark == Mark::Doubtful { "<span class=\"mark\"> ?</span>" } else { "" };
        let class = if value.is_missing() { "missing" } else { "value" };
        format!(
            "<dd><span class=\"{class}\">{before}{}</span>{unit}{}{doubt}</dd>",
            escaped(&value.value),
            margin.unwrap_or_default()
        )
    };
    element("div", "", &format!("{name}{}", value(&of.girth)))
}

/// Doubts and findings.
pub(super) fn notes(content: &Content) -> String {
    let entries: String = content.notes.entries.iter().map(|entry| note(content, entry)).collect();
    let list = match entries.as_str() {
        "" => words("p", "", &content.summary),
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
        message => words("p", &format!(" class=\"message\"{lang}"), message),
    };
    let meaning = note.meaning.as_ref().map(|meaning| words("p", "", meaning));
    let action = note.action.as_ref().map(|action| words("p", " class=\"action\"", action));
    let inside = [Some(heading), Some(message), meaning, action].into_iter().flatten();
    element("li", &format!(" class=\"{class}\""), &inside.collect::<Vec<_>>().join("\n"))
}

/// Girths and lengths at all levels.
pub(super) fn levels(content: &Content) -> String {
    let (levels, columns) = (&content.levels, &content.levels.columns);
    let column = |text: &str| words("th", " scope=\"col\"", text);
    let legs: String = Side::FROM_FRONT
        .into_iter()
        .zip(&columns.legs)
        .map(|(side, leg)| {
            let attributes = format!(" scope=\"colgroup\" colspan=\"2\" class=\"{}\"", side.word());
            words("th", &attributes, leg)
        })
        .collect();
    let over = " scope=\"col\" rowspan=\"2\"";
    let first = words("th", over, &columns.level) + &legs + &words("th", over, &columns.difference);
    let second = [&columns.girth, &columns.length, &columns.girth, &columns.length];
    let second: String = second.into_iter().map(|text| column(text)).collect();
    let head = element("tr", "", &first) + &element("tr", "", &second);
    let rows: String = levels.rows.iter().map(level).collect();
    let groups = "<colgroup><col></colgroup><colgroup span=\"2\"></colgroup>\
                  <colgroup span=\"2\"></colgroup><colgroup><col></colgroup>";
    let inside = groups.to_owned() + &element("thead", "", &head) + &element("tbody", "", &rows);
    let table = wide("levels", &element("table", " class=\"levels\"", &inside));
    let below = levels.left_out.iter().chain(&levels.tilted);
    let below: String = below.map(|text| words("p", " class=\"aside\"", text)).collect();
    section("levels", &levels.title, &(table + &below))
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
            cells += &figure(&leg.length);
        }
    }
    cells += &figure(&row.difference);
    element("tr", if row.is_sought { " class=\"sought\"" } else { "" }, &cells)
}

/// The pictures of the method.
pub(super) fn pictures(content: &Content, drawn: &[Drawn]) -> String {
    let missing =
        content.pictures.missing.as_ref().map(|text| words("p", " class=\"aside\"", text));
    let figures: String = drawn.iter().map(|drawn| picture(content, drawn)).collect();
    section("pictures", &content.pictures.title, &(missing.unwrap_or_default() + &figures))
}

fn picture(content: &Content, drawn: &Drawn) -> String {
    let caption = content.pictures.captions.iter().find(|caption| caption.name == drawn.name);
    let caption = match caption {
        Some(of) => words("b", "", &of.title) + " " + &words("span", "", &of.text),
        None => escaped(&drawn.picture.title),
    };
    let inside = svg::embedded(&drawn.picture.title, drawn.picture.size, &drawn.marks)
        + &element("figcaption", "", &caption);
    element("figure", &format!(" class=\"{}\"", drawn.name), &inside)
}

/// The place of the interactive 3D view.
pub(super) fn view(content: &Content) -> String {
    let sentence = words("p", "", &content.pictures.no_script);
    let place = element("div", " id=\"view-place\"", &sentence);
    element("div", " class=\"screen-only\"", &section("view", &content.pictures.view, &place))
}

/// Volumes, requested heights, feet, slices.
pub(super) fn tables(content: &Content) -> String {
    let part = |(index, of): (usize, &Table)| {
        let id = format!("table-{index}");
        section(&id, &of.title, &table(&id, of, ""))
    };
    content.tables.iter().enumerate().map(part).collect()
}

/// Every figure of the levels in mm.
pub(super) fn landmarks(content: &Content) -> String {
    let of = &content.landmarks;
    section("landmarks", &of.title, &table("landmarks", of, " class=\"dense\""))
}

fn table(id: &str, of: &Table, attributes: &str) -> String {
    let head: String = of.columns.iter().map(|text| words("th", " scope=\"col\"", text)).collect();
    let head = element("thead", "", &element("tr", "", &head));
    let row = |row: &crate::record::report::content::TableRow| {
        let figures: String = row.figures.iter().map(figure).collect();
        element("tr", "", &(words("th", " scope=\"row\"", &row.head) + &figures))
    };
    let body = element("tbody", "", &of.rows.iter().map(row).collect::<String>());
    let explanation = of.explanation.as_ref().map(|text| words("p", " class=\"aside\"", text));
    explanation.unwrap_or_default() + &wide(id, &element("table", attributes, &(head + &body)))
}

/// A heading with paragraphs.
pub(super) fn entries(id: &str, of: &Section) -> String {
    let paragraphs: String = of.entries.iter().map(|text| words("li", "", text) + "\n").collect();
    section(id, &of.title, &element("ul", " class=\"plain\"", &paragraphs))
}

/// Where the record comes from.
pub(super) fn facts(content: &Content) -> String {
    let fact = |fact: &crate::record::report::content::Fact| {
        let inside = words("dt", "", &fact.name) + &format!("<dd>{}</dd>", foreign(&fact.value));
        element("div", "", &inside)
    };
    let facts: String = content.facts.iter().map(fact).collect();
    section("facts", &content.origin, &element("dl", " class=\"facts\"", &facts))
}
