//! Elements of a PLY file → points and triangles, from any source of their numbers.

use nalgebra::Point3;

use super::super::fault::{ScanFault, SourcePosition};
use super::super::weld::Unwelded;
use super::header::{Element, Header, Kind, Meaning, Scalar, Shape};

/// One record of an element: the reader's current position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<'a> {
    pub element: &'a Element,
    /// 1-based number within its element.
    pub number: usize,
}

/// A source that yields the numbers of a file one after the other.
pub(super) trait Values {
    /// Begins the next record.
    fn begin(&mut self, record: Record) -> Result<(), ScanFault>;
    /// The next number as a finite coordinate.
    fn coordinate(&mut self, kind: Scalar, record: Record) -> Result<f64, ScanFault>;
    /// The next number as an integer.
    fn whole(&mut self, kind: Scalar, record: Record) -> Result<i64, ScanFault>;
    /// Skips `count` numbers.
    fn skip(&mut self, kind: Scalar, count: usize, record: Record) -> Result<(), ScanFault>;
    /// Ends the record.
    fn end(&mut self, record: Record) -> Result<(), ScanFault>;
    /// The place of the last number read.
    fn place(&self, record: Record) -> SourcePosition;
}

/// Reads all elements: faces as fans, strips as triangles.
///
/// # Errors
/// The first fault, with its place.
pub(super) fn mesh(header: &Header, mut values: impl Values) -> Result<Unwelded, ScanFault> {
    let vertices = header.elements.iter().find(|element| element.kind == Kind::Vertex);
    let mut reader = Reader {
        vertex_count: vertices.map_or(0, |element| element.count),
        points: Vec::new(),
        triangles: Vec::new(),
        corners: Vec::new(),
    };
    // An element without properties takes up no space, so its count may be anything.
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        for number in 1..=element.count {
            reader.record(&mut values, Record { element, number })?;
        }
    }
    Ok((reader.points, reader.triangles))
}

struct Reader {
    /// Number of vertices that the header announces; faces may precede them.
    vertex_count: usize,
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// The corners of the current face.
    corners: Vec<u32>,
}

impl Reader {
    fn record(&mut self, values: &mut impl Values, record: Record) -> Result<(), ScanFault> {
        values.begin(record)?;
        let mut point = Point3::origin();
        for property in &record.element.properties {
            match (property.meaning, property.shape) {
                (Meaning::Axis(axis), Shape::One(kind)) => {
                    point[axis] = values.coordinate(kind, record)?;
                }
                (Meaning::Corners, Shape::List { count, item }) => {
                    let count = length(values, count, record)?;
                    self.polygon(values, item, count, record)?;
                }
                (_, Shape::One(kind)) => values.skip(kind, 1, record)?,
                (_, Shape::List { count, item }) => {
                    let count = length(values, count, record)?;
                    values.skip(item, count, record)?;
                }
            }
        }
        if record.element.kind == Kind::Vertex {
            self.points.push(point);
        }
        values.end(record)
    }

    fn polygon(
        &mut self,
        values: &mut impl Values,
        item: Scalar,
        count: usize,
        record: Record,
    ) -> Result<(), ScanFault> {
        let is_strip = record.element.kind == Kind::Strip;
        self.corners.clear();
        for _ in 0..count {
            let index = values.whole(item, record)?;
            // In strips, -1 ends one strip and begins the next.
            if is_strip && index == -1 {
                self.strip();
                continue;
            }
            let within = usize::try_from(index).is_ok_and(|index| index < self.vertex_count);
            let corner = u32::try_from(index).ok().filter(|_| within);
            let Some(corner) = corner else {
                let what = format!("{index} is no vertex: there are {}", self.vertex_count);
                return Err(ScanFault::Malformed { place: values.place(record), what });
            };
            self.corners.push(corner);
        }
        if is_strip {
            self.strip();
        } else {
            self.fan();
        }
        Ok(())
    }

    /// The triangles of a polygon around its first corner.
    fn fan(&mut self) {
        if let [first, rest @ ..] = self.corners.as_slice() {
            self.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        }
    }

    /// The triangles of a strip, in which consecutive triangles share an edge.
    fn strip(&mut self) {
        self.triangles.extend(self.corners.windows(3).map(|part| [part[0], part[1], part[2]]));
        self.corners.clear();
    }
}

/// The length of a list, read as an integer.
pub(super) fn length(
    values: &mut impl Values,
    kind: Scalar,
    record: Record,
) -> Result<usize, ScanFault> {
    let count = values.whole(kind, record)?;
    usize::try_from(count).map_err(|_| {
        let what = format!("a list of {count} numbers");
        ScanFault::Malformed { place: values.place(record), what }
    })
}
