//! An order as a file for a maker or a shop system, by its mapping.

use gaiter_sizes::Point;
use gaiter_sizes::mapping::{
    BodyPart, Cell, Column, Csv, Dated, Encoding, Fact, Layout, Mapping, Named, Of, Rounding, Rows,
    Which,
};
use jiff::civil::DateTime;

use super::place::{Part, place};
use super::{LastFigure, Order, OrderFigure, OrderSide, OrderedScan, Row, SCAN_AGE, State};
use crate::cells::{BYTE_ORDER_MARK, guarded, kept, line};
use crate::gdt::Charset;

/// The file of an order. The patient's id is only in it if the mapping asks for it.
pub fn mapped(order: &Order, mapping: &Mapping, patient: Option<&str>) -> Vec<u8> {
    let of = Mapped { order, mapping, patient };
    let rows = of.rows();
    match mapping.layout {
        Layout::Csv(csv) => of.table(&rows, csv),
        Layout::Json => of.objects(&rows).into_bytes(),
    }
}

/// The name of the file of an order: ASCII, and never by a patient.
pub fn mapped_name(order: &Order, mapping: &Mapping) -> String {
    mapping.file_name.filled(Named {
        id: &mapping.id,
        scan: &order.scan.reference,
        date: local(&order.scan).map(DateTime::date),
        garment: &order.garment.name,
        order_ref: order.order_ref.as_deref(),
    })
}

/// When a scan was taken by the clock at the scanner; by UTC if that clock is not known.
fn local(scan: &OrderedScan) -> Option<DateTime> {
    Some(scan.acquired.as_ref()?.local().datetime())
}

struct Mapped<'a> {
    order: &'a Order,
    mapping: &'a Mapping,
    patient: Option<&'a str>,
}

/// A row of the file.
#[derive(Clone, Default)]
struct OfRow<'a> {
    side: Option<OrderSide>,
    /// The row of the order, for a row per level or box.
    row: Option<&'a Row>,
    level: String,
    /// The name of the box, and its part of the row.
    form_box: Option<(String, Part)>,
}

/// The content of a cell.
enum CellContent {
    /// A figure, written by the mapping.
    Number(String),
    /// A text of the mapping itself, or a day as it writes them.
    Own(String),
    /// A text from elsewhere.
    Words(String),
}

impl<'a> Mapped<'a> {
    fn rows(&self) -> Vec<OfRow<'a>> {
        match self.mapping.rows {
            Rows::Order => vec![OfRow::default()],
            Rows::Leg => {
                let legs = self.order.sides().into_iter().filter(|side| *side != OrderSide::Body);
                legs.map(|side| OfRow { side: Some(side), ..OfRow::default() }).collect()
            }
            Rows::Level => self.levels(),
            Rows::Point => self.boxes(),
        }
    }

    /// A row per level: those of the mapping's points, or those of the form.
    fn levels(&self) -> Vec<OfRow<'a>> {
        let Some(points) = &self.mapping.points else {
            let counting = self.order.rows.iter().filter(|row| row.counts);
            return counting
                .map(|row| OfRow {
                    side: Some(row.side),
                    row: Some(row),
                    level: row.point.clone(),
                    form_box: None,
                })
                .collect();
        };
        let mut rows: Vec<OfRow<'a>> = Vec::new();
        for (side, point) in self.of_sides(points) {
            let (level, _) = place(point);
            if !rows.iter().any(|of| of.side == Some(side) && of.level == level) {
                let row = self.order.counting(side, &level);
                rows.push(OfRow { side: Some(side), row, level, form_box: None });
            }
        }
        rows
    }

    /// A row per box: those of the mapping's points, or those of the form, in their order.
    fn boxes(&self) -> Vec<OfRow<'a>> {
        if let Some(points) = &self.mapping.points {
            let row = |(side, point): (OrderSide, Point)| {
                let (level, part) = place(point);
                let row = self.order.counting(side, &level);
                OfRow { side: Some(side), row, level, form_box: Some((point.to_string(), part)) }
            };
            return self.of_sides(points).into_iter().map(row).collect();
        }
        let mut rows: Vec<OfRow<'a>> = Vec::new();
        for side in self.order.sides() {
            for name in &self.order.garment.boxes {
                rows.extend(self.of_form_box(side, name));
            }
        }
        rows
    }

    fn of_form_box(&self, side: OrderSide, name: &str) -> Option<OfRow<'a>> {
        let mut rows = self.order.rows.iter().filter(|row| row.counts && row.side == side);
        rows.find_map(|row| {
            let is_its = |part: &Part| row.part(*part).is_some_and(|of| of.form_box == name);
            let part = [Part::Girth, Part::Length].into_iter().find(is_its)?;
            let form_box = Some((name.to_owned(), part));
            Some(OfRow { side: Some(side), row: Some(row), level: row.point.clone(), form_box })
        })
    }

    /// Points with each side that they are on.
    fn of_sides(&self, points: &[Point]) -> Vec<(OrderSide, Point)> {
        let sides = self.order.sides();
        let is_of = |side: OrderSide, point: &Point| {
            matches!(point, Point::Beyond(_)) == (side == OrderSide::Body)
        };
        let of_side = |side: OrderSide| {
            points.iter().copied().filter(move |point| is_of(side, point)).map(move |of| (side, of))
        };
        let legs = sides.into_iter().filter(|side| *side != OrderSide::Body);
        legs.chain([OrderSide::Body]).flat_map(of_side).collect()
    }

    fn content(&self, column: &Column, of: &OfRow<'_>) -> CellContent {
        match &column.cell {
            Cell::Text(text) => CellContent::Own(text.clone()),
            Cell::Fact(Fact::Side) => CellContent::Own(self.side_word(of.side)),
            Cell::Fact(fact) => CellContent::Words(self.fact(*fact, of)),
            Cell::Date(dated, format) => {
                let last = self.order.reorder.as_ref().map(|reorder| &reorder.last_scan);
                let at = match dated {
                    Dated::Scan => local(&self.order.scan),
                    Dated::Last => last.and_then(local),
                    Dated::HoldsUntil => self.order.holds_until.map(|day| day.at(0, 0, 0, 0)),
                };
                CellContent::Own(at.map(|at| guarded(&format.text(at))).unwrap_or_default())
            }
            Cell::Figure(which, what) => self.figure_cell(self.figure(*which, of), *what),
        }
    }

    fn side_word(&self, side: Option<OrderSide>) -> String {
        let [right, left, body] = &self.mapping.sides;
        match side {
            None => String::new(),
            Some(OrderSide::Right) => right.clone(),
            Some(OrderSide::Left) => left.clone(),
            Some(OrderSide::Body) => body.clone(),
        }
    }

    fn fact(&self, fact: Fact, of: &OfRow<'_>) -> String {
        let Order { order_ref, reorder, garment, scan, record, posture, basis, .. } = self.order;
        let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
        let reorder = reorder.as_ref();
        match fact {
            Fact::OrderRef => text(order_ref.as_deref()),
            Fact::Reorder => text(reorder.map(|of| of.is.word())),
            Fact::LastRef => text(reorder.and_then(|of| of.last_ref.as_deref())),
            Fact::ScanRef => scan.reference.clone(),
            Fact::LastScanRef => text(reorder.map(|of| of.last_scan.reference.as_str())),
            Fact::Garment => garment.name.clone(),
            Fact::Station => text(record.station.as_deref()),
            Fact::Posture => text(posture.as_deref()),
            Fact::Basis => basis.clone(),
            Fact::PatientId => text(self.patient),
            Fact::Side => self.side_word(of.side),
            Fact::Level => of.level.clone(),
            Fact::Point => of.form_box.as_ref().map(|(name, _)| name.clone()).unwrap_or_default(),
            Fact::EditedBy => text(of.row.and_then(|row| row.edited_by.as_deref())),
            Fact::Reason => text(of.row.and_then(|row| row.reason.as_deref())),
        }
    }

    /// A figure with its row and part.
    fn figure<'r>(&'r self, which: Which, of: &OfRow<'r>) -> Option<(&'r Row, Part)> {
        match which {
            Which::Girth => of.row.map(|row| (row, Part::Girth)),
            Which::Length => of.row.map(|row| (row, Part::Length)),
            Which::Box => of.row.zip(of.form_box.as_ref().map(|(_, part)| *part)),
            Which::At(at, point) => {
                let side = match at {
                    Some(BodyPart::Right) => OrderSide::Right,
                    Some(BodyPart::Left) => OrderSide::Left,
                    Some(BodyPart::Body) => OrderSide::Body,
                    None => of.side?,
                };
                let (level, part) = place(point);
                self.order.counting(side, &level).map(|row| (row, part))
            }
        }
    }

    fn figure_cell(&self, at: Option<(&Row, Part)>, what: Of) -> CellContent {
        let figures = &self.mapping.figures;
        let figure = at.and_then(|(row, part)| row.part(part));
        let written = figure.filter(|figure| self.writes(figure.is));
        let number = |mm: Option<f64>, rounding: Rounding| match mm {
            Some(mm) => CellContent::Number(figures.text(mm, rounding)),
            None => CellContent::Own(String::new()),
        };
        let last = at.and_then(|(row, part)| last(row, part));
        match what {
            Of::Figure => match written.and_then(|figure| figure.mm) {
                Some(mm) => CellContent::Number(figures.text(mm, figures.rounding)),
                None => CellContent::Own(self.instead(figure)),
            },
            // Rounded up, so that it never looks smaller than it is.
            Of::U95 => number(written.and_then(|figure| figure.u95_mm), Rounding::Up),
            Of::Method => {
                let way = written.and_then(|figure| figure.method);
                CellContent::Words(way.map(|way| way.word()).unwrap_or_default().to_owned())
            }
            Of::Flag => {
                let state = figure.map(|figure| figure.is).filter(|is| *is != State::Measured);
                let has_figure = figure.is_some_and(|figure| figure.mm.is_some());
                let age = (has_figure && self.order.is_of_an_old_scan()).then_some(SCAN_AGE);
                let flags: Vec<&str> = state.map(State::word).into_iter().chain(age).collect();
                CellContent::Words(flags.join(" "))
            }
            Of::Last => {
                number(last.filter(|of| self.writes(of.is)).map(|of| of.mm), figures.rounding)
            }
            Of::Change => number(last.and_then(|of| of.change_mm), Rounding::Nearest),
        }
    }

    /// Whether a figure of this kind is written.
    fn writes(&self, is: State) -> bool {
        let instead = &self.mapping.instead;
        match is {
            State::Estimated => instead.writes_estimated,
            State::Doubtful => instead.writes_doubtful,
            is => is.is_sure(),
        }
    }

    /// What is written in the place of a figure.
    fn instead(&self, figure: Option<&OrderFigure>) -> String {
        let instead = &self.mapping.instead;
        let text = match figure.map(|figure| figure.is) {
            Some(State::Estimated) => &instead.estimated,
            Some(State::Doubtful) => &instead.doubtful,
            _ => &instead.missing,
        };
        text.clone()
    }

    fn table(&self, rows: &[OfRow<'_>], csv: Csv) -> Vec<u8> {
        let Csv { separator, quotes_all, line_end, encoding, has_header, is_spreadsheet } = csv;
        let columns = &self.mapping.columns;
        let mut text = String::new();
        if has_header {
            let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
            text += &line(&names, separator, quotes_all, line_end.text());
        }
        for row in rows {
            let cells = columns.iter().map(|column| match self.content(column, row) {
                CellContent::Number(text) | CellContent::Own(text) => text,
                CellContent::Words(text) if is_spreadsheet => kept(&text),
                CellContent::Words(text) => guarded(&text),
            });
            text += &line(&cells.collect::<Vec<_>>(), separator, quotes_all, line_end.text());
        }
        match encoding {
            Encoding::Utf8 => text.into_bytes(),
            Encoding::Utf8Bom => format!("{BYTE_ORDER_MARK}{text}").into_bytes(),
            Encoding::Cp1252 => in_cp1252(&text),
        }
    }

    fn objects(&self, rows: &[OfRow<'_>]) -> String {
        let objects: Vec<String> = rows.iter().map(|row| self.object(row)).collect();
        match self.mapping.rows {
            Rows::Order => objects.concat() + "\n",
            _ => format!("[\n{}\n]\n", objects.join(",\n")),
        }
    }

    /// A row as an object with the keys in the order of the columns. What is not known is null; a figure is a
    /// number where its decimal sign is that of JSON.
    fn object(&self, row: &OfRow<'_>) -> String {
        let is_json_number = self.mapping.figures.sign == '.';
        let fields = self.mapping.columns.iter().map(|column| {
            let value = match self.content(column, row) {
                CellContent::Number(text) if is_json_number => text,
                CellContent::Number(text) | CellContent::Own(text) | CellContent::Words(text) => {
                    if text.is_empty() {
                        "null".to_owned()
                    } else {
                        quoted(&text)
                    }
                }
            };
            format!("  {}: {value}", quoted(&column.name))
        });
        format!("{{\n{}\n}}", fields.collect::<Vec<_>>().join(",\n"))
    }
}

/// The last order's figure of a row.
fn last(row: &Row, part: Part) -> Option<LastFigure> {
    let last = row.last.as_ref()?;
    match part {
        Part::Girth => last.girth,
        Part::Length => last.length,
    }
}

/// A text as JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A text in code page 1252. A letter that the code page lacks is written as its number, so that no name
/// becomes another.
fn in_cp1252(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    for letter in text.chars() {
        if !Charset::Cp1252.push(letter, &mut bytes) {
            bytes.extend(format!("[U+{:04X}]", u32::from(letter)).bytes());
        }
    }
    bytes
}
