//! A table of sections as a grid with parameters.

use gaiter::spline::{FitFault, GridData, mean_chord_parameters};
use nalgebra::{Point3, distance};

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

impl SectionTable {
    /// Reads lines `section,x,y,z`, of which the first is a heading; the error is the number of the
    /// first line that is none.
    pub fn parse(text: &str) -> Result<SectionTable, usize> {
        let mut points = Vec::new();
        let mut columns = 0;
        for (number, line) in text.lines().enumerate().skip(1) {
            let words: Vec<f64> = line.split(',').filter_map(|word| word.parse().ok()).collect();
            let [section, x, y, z] = words[..] else { return Err(number + 1) };
            columns += usize::from(section == 0.0);
            points.push(Point3::new(x, y, z));
        }
        Ok(SectionTable { columns, points })
    }

    /// The points with parameters.
    ///
    /// # Errors
    /// As [`mean_chord_parameters`].
    pub fn grid(self) -> Result<Grid, FitFault> {
        let around = mean_chord_parameters(&self.points, self.columns)?;
        let middle = |row: &[Point3<f64>]| {
            Point3::from(
                row.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / row.len() as f64,
            )
        };
        let middles: Vec<_> = self.points.chunks(self.columns).map(middle).collect();
        let mut walked = vec![0.0];
        for pair in middles.windows(2) {
            walked.push(walked[walked.len() - 1] + distance(&pair[0], &pair[1]));
        }
        let whole = walked[walked.len() - 1];
        let along = walked.iter().map(|length| length / whole).collect();
        Ok(Grid { along, around, points: self.points })
    }
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
