//! A table of sections as a grid with parameters.

use gaiter_spline::GridData;
use nalgebra::{Point3, Vector3, distance};
use support::metric::mean_chord_parameters;

/// The points of a table, section by section.
pub struct SectionTable {
    /// Points of each section.
    columns: usize,
    points: Vec<Point3<f64>>,
}

/// Points with their parameters.
pub struct Grid {
    /// 0 for the first section to 1 for the last: the share of the way between the middles of the
    /// sections.
    pub along: Vec<f64>,
    /// 0 to below 1, by mean chord lengths.
    pub around: Vec<f64>,
    points: Vec<Point3<f64>>,
}

/// Why a text is no table of sections. Lines count from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableFault {
    /// The heading is missing or another.
    #[error("line 1 is not the heading `section,x,y,z`")]
    NoHeading,
    /// A line does not hold four finite numbers.
    #[error("line {line} is not `section,x,y,z`, four finite numbers: `{text}`")]
    NoPoint {
        /// The line.
        line: usize,
        /// What it says.
        text: String,
    },
    /// Sections have unlike numbers of points.
    #[error("section {section} has {found} points, where the first has {needed}")]
    Uneven {
        /// The section, as the table calls it.
        section: f64,
        /// Its points.
        found: usize,
        /// Those of the first.
        needed: usize,
    },
    /// A surface needs a length.
    #[error("{found} sections, where a surface needs at least 4")]
    TooFewSections {
        /// Sections found.
        found: usize,
    },
}

/// A cubic has four coefficients.
const SECTIONS_MIN: usize = 4;

impl SectionTable {
    /// Reads a heading and lines `section,x,y,z`, mm; the points of a section follow one another.
    ///
    /// # Errors
    /// A [`TableFault`].
    pub fn parse(text: &str) -> Result<SectionTable, TableFault> {
        let mut lines = text.lines().map(str::trim).enumerate();
        // A spreadsheet may put a byte order mark before the heading.
        let heading = lines.next().map(|(_, line)| line.trim_start_matches('\u{feff}'));
        if heading != Some("section,x,y,z") {
            return Err(TableFault::NoHeading);
        }
        let mut points = Vec::new();
        let mut sections: Vec<(f64, usize)> = Vec::new();
        for (index, line) in lines.filter(|(_, line)| !line.is_empty()) {
            let Some([section, x, y, z]) = numbers(line) else {
                return Err(TableFault::NoPoint { line: index + 1, text: line.to_owned() });
            };
            match sections.last_mut() {
                Some((last, count)) if *last == section => *count += 1,
                _ => sections.push((section, 1)),
            }
            points.push(Point3::new(x, y, z));
        }
        let columns = sections.first().map_or(0, |(_, count)| *count);
        if let Some(&(section, found)) = sections.iter().find(|(_, count)| *count != columns) {
            return Err(TableFault::Uneven { section, found, needed: columns });
        }
        if sections.len() < SECTIONS_MIN {
            return Err(TableFault::TooFewSections { found: sections.len() });
        }
        Ok(SectionTable { columns, points })
    }

    /// The points with parameters.
    pub fn grid(self) -> Grid {
        let around = mean_chord_parameters(&self.points, self.columns);
        let middle = |row: &[Point3<f64>]| {
            let sum = row.iter().map(|point| point.coords).sum::<Vector3<f64>>();
            Point3::from(sum / row.len() as f64)
        };
        let middles: Vec<_> = self.points.chunks(self.columns).map(middle).collect();
        let mut walked = vec![0.0];
        for pair in middles.windows(2) {
            walked.push(walked[walked.len() - 1] + distance(&pair[0], &pair[1]));
        }
        // Sections that all lie in one place have no way between them; the fit calls them the same.
        let whole = walked[walked.len() - 1].max(f64::MIN_POSITIVE);
        let along = walked.iter().map(|length| length / whole).collect();
        Grid { along, around, points: self.points }
    }
}

/// The four finite numbers of a line.
fn numbers(line: &str) -> Option<[f64; 4]> {
    let words = line.split(',').map(|word| word.trim().parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = words.map(|word| word.filter(|x| x.is_finite())).collect();
    numbers?.try_into().ok()
}

impl Grid {
    /// The grid as data of a fit.
    pub fn data(&self) -> GridData<'_> {
        GridData { along: &self.along, around: &self.around, points: &self.points }
    }

    /// The points of each section.
    pub fn sections(&self) -> impl Iterator<Item = &[Point3<f64>]> {
        self.points.chunks(self.around.len())
    }
}
