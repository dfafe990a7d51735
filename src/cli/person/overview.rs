//! The overview of a disclosure, a page for people.

use std::fmt::Display;
use std::path::Path;

use gaiter_flow::patient::person::{OnServer, Person, PersonRecord, WhoseScan};
use gaiter_language::Language;

use crate::cli::terminal::local;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem}\
table{border-collapse:collapse;width:100%;margin:.5rem 0 1.5rem}\
td,th{border:1px solid #999;padding:.25rem .5rem;text-align:left;vertical-align:top;overflow-wrap:anywhere}";

pub(super) fn page(person: &Person, language: Language) -> String {
    let text = |key| escaped(language.text(key));
    let head = language.filled(
        "person.of",
        &[("patient", &person.patient), ("station", &person.station), ("at", &local(person.at))],
    );
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\"><title>{}</title>\
         <style>{STYLE}</style></head>\n<body>\n<h1>{}</h1>\n<p>{}</p>\n<p>{}</p>\n",
        language.tag(),
        text("person.title"),
        text("person.title"),
        escaped(&head),
        text("person.intro"),
    );
    for (title, columns, rows) in sections(person, language) {
        page += &format!("<h2>{}</h2>\n", text(title));
        page += &match rows.is_empty() {
            true => format!("<p>{}</p>\n", text("person.none")),
            false => table(columns, &rows, language),
        };
    }
    page + &format!("<p>{}</p>\n</body></html>\n", text("person.sums"))
}

/// The title of a section, its columns, and its rows as markup.
type Section = (&'static str, &'static [&'static str], Vec<Vec<String>>);

fn sections(person: &Person, language: Language) -> Vec<Section> {
    vec![
        (
            "person.records",
            &["person.taken", "person.revision", "person.folder", "person.set"],
            records(person),
        ),
        (
            "person.scans",
            &["person.seen", "person.scan", "person.whose", "person.delivered"],
            scans(person, language),
        ),
        ("person.others", &["person.file"], others(person)),
        ("person.handed_over", &["person.at", "person.file", "person.scan"], handed_over(person)),
        (
            "person.on_servers",
            &["person.at", "person.server", "person.reference", "person.scan"],
            on_servers(person, language),
        ),
        ("person.elsewhere", &["person.file"], elsewhere(person)),
        ("person.captures", &["person.at", "person.state"], captures(person)),
        ("person.affected", &["person.at", "person.leg"], affected(person, language)),
        (
            "person.history",
            &["person.at", "person.scan", "person.event", "person.detail"],
            history(person),
        ),
    ]
}

fn table(columns: &[&'static str], rows: &[Vec<String>], language: Language) -> String {
    let head: String =
        columns.iter().map(|key| format!("<th>{}</th>", escaped(language.text(key)))).collect();
    let row = |cells: &Vec<String>| {
        let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = rows.iter().map(row).collect();
    format!("<table>\n<tr>{head}</tr>\n{rows}</table>\n")
}

fn records(person: &Person) -> Vec<Vec<String>> {
    let all = person.stores.iter().flat_map(|of| of.records.iter().map(move |record| (of, record)));
    all.map(|(of, record)| {
        let name = name(&record.folder);
        vec![
            record.acquired.as_ref().map_or_else(String::new, |taken| {
                escaped(&taken.local().strftime("%Y-%m-%d %H:%M"))
            }),
            record.revision.map_or_else(String::new, |number| number.to_string()),
            format!(
                "<a href=\"records/{0}/{1}/\">{0}: {1}</a>",
                escaped(&of.store),
                escaped(&name)
            ),
            set(record),
        ]
    })
    .collect()
}

/// What people set in a record.
fn set(record: &PersonRecord) -> String {
    let amendments = record.amendments.iter();
    let lines: Vec<String> = amendments
        .map(|of| escaped(&format!("{}: {} ({}, {})", of.what, of.reason, of.by, local(of.at))))
        .collect();
    lines.join("<br>")
}

fn scans(person: &Person, language: Language) -> Vec<Vec<String>> {
    person
        .scans
        .iter()
        .map(|scan| {
            let deliveries: Vec<String> = scan
                .deliveries
                .iter()
                .map(|of| {
                    let at = of.at.map(local).unwrap_or_default();
                    escaped(&format!("{}: {} {at}", of.store, of.state))
                })
                .collect();
            vec![
                escaped(&local(scan.summary.first_seen)),
                escaped(&format!("{} ({})", scan.sha256, scan.summary.state.word())),
                escaped(language.text(whose(scan.whose))),
                deliveries.join("<br>"),
            ]
        })
        .collect()
}

fn whose(whose: WhoseScan) -> &'static str {
    match whose {
        WhoseScan::Theirs => "person.theirs",
        WhoseScan::Shared => "person.shared",
        WhoseScan::Uncertain => "person.uncertain",
        WhoseScan::TakenBack => "person.taken_back",
    }
}

fn others(person: &Person) -> Vec<Vec<String>> {
    let all = person.stores.iter().flat_map(|of| of.others.iter().map(move |path| (of, path)));
    let mut rows: Vec<Vec<String>> = all
        .map(|(of, path)| {
            let (store, name) = (escaped(&of.store), escaped(&name(path)));
            vec![format!("<a href=\"others/{store}/{name}\">{store}: {name}</a>")]
        })
        .collect();
    rows.extend(person.orders.iter().map(|path| {
        let name = escaped(&name(path));
        vec![format!("<a href=\"orders/{name}/\">{name}</a>")]
    }));
    rows
}

fn handed_over(person: &Person) -> Vec<Vec<String>> {
    let given = person.handed_over.iter();
    given
        .map(|of| vec![escaped(&local(of.at)), shown_path(&of.file), escaped(&of.sha256)])
        .collect()
}

fn on_servers(person: &Person, language: Language) -> Vec<Vec<String>> {
    let row = |of: &OnServer| {
        let store = language.word("page.part.store", &of.store);
        let unknown = || language.text("person.unknown").to_owned();
        let reference = of.reference.clone().unwrap_or_else(unknown);
        vec![
            escaped(&of.at.map(local).unwrap_or_default()),
            escaped(&format!("{store}: {}", of.place)),
            escaped(&match of.is_withdrawn {
                true => format!("{reference} ({})", language.text("person.withdrawn")),
                false => reference,
            }),
            escaped(&of.sha256),
        ]
    };
    person.on_servers.iter().map(row).collect()
}

/// Files that the disclosure has no copy of.
fn elsewhere(person: &Person) -> Vec<Vec<String>> {
    let attachments = person.handed_over.iter().flat_map(|of| &of.attachments);
    let unfetched = person.on_servers.iter().filter_map(|of| of.unfetched.as_ref());
    let all = person.exports.iter().chain(&person.journals).chain(attachments).chain(unfetched);
    all.map(|path| vec![shown_path(path)]).collect()
}

fn captures(person: &Person) -> Vec<Vec<String>> {
    let captures = person.captures.iter();
    captures.map(|of| vec![escaped(&local(of.at)), escaped(&of.state)]).collect()
}

fn affected(person: &Person, language: Language) -> Vec<Vec<String>> {
    let named = person.affected.iter();
    let leg = |word: &str| escaped(language.word("visits.affected", word));
    named.map(|of| vec![escaped(&local(of.at)), leg(&of.affected)]).collect()
}

fn history(person: &Person) -> Vec<Vec<String>> {
    let row = |of: &gaiter_flow::patient::person::PersonEvent| {
        let short = of.scan.get(..8).unwrap_or_default();
        let happened = &of.happened;
        vec![
            escaped(&happened.at),
            escaped(&short),
            escaped(&happened.event),
            escaped(&happened.detail),
        ]
    };
    person.history.iter().map(row).collect()
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn shown_path(path: &Path) -> String {
    escaped(&path.display())
}

/// A text as markup.
fn escaped(text: &(impl Display + ?Sized)) -> String {
    gaiter_record::shown::escaped(&text.to_string())
}
