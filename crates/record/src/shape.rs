//! The shape of a leg in `record.json`, from which the pictures of reports and pages are drawn. It is
//! coarser than what was measured. To measure, use the CAD files of the surface.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_leg::features::feature::curvatures;
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::surface::error_map::ErrorMap;
use gaiter_leg::surface::shape::{COLUMNS, Shape};
use gaiter_leg::{LegReport, LevelSection};
use nalgebra::{Point3, Vector3};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::rounding::{degrees, mm, per_mm, unit};

/// Number of angles of an outline: every third degree.
const OUTLINE_ANGLES: usize = 120;

/// Unit of coordinates, mm. A leg of 3 m fits.
const POINT_UNIT_MM: f64 = 0.1;

/// Unit of distances from the surface, mm.
const ERROR_UNIT_MM: f64 = 0.01;

/// Marks a place that was not seen.
const UNSEEN: i16 = i16::MIN;

/// The leg's axis with the frame of its sections: unit vectors in the body frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AxisFigures {
    /// Where the axis meets the floor.
    pub foot_mm: [f64; 3],
    /// Up along the axis.
    pub direction: [f64; 3],
    /// To the front: angle 0° of a section.
    pub front: [f64; 3],
    /// To the leg's lateral side: angle 90°.
    pub lateral: [f64; 3],
}

/// The axes to which the sections of a leg are square.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AxesFigures {
    /// Of the shank: up to 0.30 of the stature.
    pub shank: LineFigures,
    /// Of the thigh: from 0.38 of the stature on. Null if it was not seen; then all sections are square to
    /// the shank.
    pub thigh: Option<LineFigures>,
    /// Angle between the two; null like `thigh`.
    pub bend_deg: Option<f64>,
}

/// A line in the body frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LineFigures {
    /// A point on it.
    pub through_mm: [f64; 3],
    /// Unit vector along it, upwards.
    pub direction: [f64; 3],
}

/// The outline of the section at a level: a point lies at
/// centre + radius · (cos angle · front + sin angle · lateral).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct OutlineFigures {
    /// The section's centre, body frame.
    pub centre_mm: [f64; 3],
    /// Unit vector in its plane to the front.
    pub front: [f64; 3],
    /// Unit vector in its plane to the lateral side.
    pub lateral: [f64; 3],
    /// The fitted radius at −180°, −177°, … 177°.
    pub radius_mm: Vec<f64>,
    /// The curvature by which feature points are found, at the same angles, positive where convex.
    pub curvature_per_mm: Vec<f64>,
    /// Angles of the scan's own points on the plane, ascending.
    pub scan_angle_deg: Vec<f64>,
    /// The distances of these points from the centre.
    pub scan_radius_mm: Vec<f64>,
}

/// A leg's shape in the body frame.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ShapeFigures {
    /// The measured skin.
    pub skin: GridFigures,
    /// The skin of the foot, below the lowest row; null if the scan has no triangles there.
    pub foot: Option<MeshFigures>,
    /// The surface with its error; null if there is none.
    pub surface: Option<SurfaceGridFigures>,
    /// A share of the scan's own points.
    pub scan: CloudFigures,
}

/// Points in rows from the bottom up, at equal angles around the leg, −180° first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GridFigures {
    /// Number of rows.
    pub rows: usize,
    /// Number of points around the leg.
    pub columns: usize,
    /// x, y, z of each in 0.1 mm, row by row; −32768 where the skin does not close.
    pub points: Packed,
}

/// A surface in rows from the bottom up, at equal angles around the leg, −180° first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SurfaceGridFigures {
    /// Number of rows.
    pub rows: usize,
    /// Number of points around the leg.
    pub columns: usize,
    /// x, y, z of each in 0.1 mm, row by row.
    pub points: Packed,
    /// Mean distance of the scan's points outside the surface, in 0.01 mm; −32768 if none was seen.
    pub error: Packed,
}

/// Triangles, coarser than the scan's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MeshFigures {
    /// x, y, z of each point in 0.1 mm.
    pub points: Packed,
    /// The indices of each triangle's three points, counted from 0.
    pub triangles: Packed,
}

/// Points in no particular order.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CloudFigures {
    /// x, y, z of each in 0.1 mm.
    pub points: Packed,
}

/// 16-bit integers, low byte first, as base64 (RFC 4648, section 4). This takes a tenth of the space of
/// decimal digits.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Packed(Vec<i16>);

impl Packed {
    /// Points in whole units; those unseen by their sign.
    pub fn points<'a>(points: impl Iterator<Item = Option<&'a Point3<f64>>>) -> Packed {
        let unseen = [UNSEEN; 3];
        let packed =
            |point: &Point3<f64>| [point.x, point.y, point.z].map(|mm| whole(mm, POINT_UNIT_MM));
        Packed(points.flat_map(|point| point.map_or(unseen, packed)).collect())
    }

    /// Errors in whole units; those unseen by their sign.
    pub fn errors(errors: &[Option<f64>]) -> Packed {
        let packed = |error: &Option<f64>| error.map_or(UNSEEN, |mm| whole(mm, ERROR_UNIT_MM));
        Packed(errors.iter().map(packed).collect())
    }

    /// `None` if an index does not fit.
    fn indices(triangles: &[[u16; 3]]) -> Option<Packed> {
        let packed = triangles.iter().flatten().map(|index| i16::try_from(*index).ok());
        packed.collect::<Option<Vec<i16>>>().map(Packed)
    }

    /// The numbers as points, mm; `None` for a point that was not seen. Drops an incomplete triple.
    pub fn as_points(&self) -> Vec<Option<Point3<f64>>> {
        let point = |of: &[i16]| {
            let mm = |at: usize| f64::from(of[at]) * POINT_UNIT_MM;
            (!of.contains(&UNSEEN)).then(|| Point3::new(mm(0), mm(1), mm(2)))
        };
        self.0.chunks_exact(3).map(point).collect()
    }

    /// The numbers as distances from the surface, mm; `None` if not seen.
    pub fn as_errors_mm(&self) -> Vec<Option<f64>> {
        let error = |of: &i16| (*of != UNSEEN).then(|| f64::from(*of) * ERROR_UNIT_MM);
        self.0.iter().map(error).collect()
    }
}

/// A length in whole units: the nearest number that fits and is not [`UNSEEN`].
fn whole(mm: f64, unit_mm: f64) -> i16 {
    (mm / unit_mm).round().clamp(f64::from(UNSEEN + 1), f64::from(i16::MAX)) as i16
}

impl Serialize for Packed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let bytes: Vec<u8> = self.0.iter().flat_map(|number| number.to_le_bytes()).collect();
        serializer.serialize_str(&STANDARD.encode(bytes))
    }
}

#[cfg(test)]
impl schemars::JsonSchema for Packed {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Packed".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "16-bit integers, low byte first, as base64 (RFC 4648, section 4).",
            "type": "string",
            "contentEncoding": "base64"
        })
    }
}

impl<'de> Deserialize<'de> for Packed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Packed, D::Error> {
        let text = String::deserialize(deserializer)?;
        let bytes = STANDARD.decode(text).map_err(D::Error::custom)?;
        let (numbers, rest) = bytes.as_chunks();
        if !rest.is_empty() {
            return Err(D::Error::custom("an odd number of bytes"));
        }
        Ok(Packed(numbers.iter().map(|number| i16::from_le_bytes(*number)).collect()))
    }
}

fn direction(at: &Vector3<f64>) -> [f64; 3] {
    [at.x, at.y, at.z].map(unit)
}

/// The axis of a leg's shank, or of the whole leg.
pub(super) fn axis(axis: &LegAxis) -> AxisFigures {
    let foot = &axis.foot;
    AxisFigures {
        foot_mm: foot.origin.coords.map(mm).into(),
        direction: direction(&foot.normal),
        front: direction(&foot.front),
        lateral: direction(&foot.lateral),
    }
}

/// The axes of shank and thigh.
pub(super) fn axes(axis: &LegAxis) -> AxesFigures {
    let line = |through: &Point3<f64>, along: &Vector3<f64>| LineFigures {
        through_mm: through.coords.map(mm).into(),
        direction: direction(along),
    };
    let thigh = axis.bend.as_ref().map(|bend| &bend.thigh);
    AxesFigures {
        shank: line(&axis.foot.origin, &axis.foot.normal),
        thigh: thigh.map(|thigh| line(&thigh.through, &thigh.direction)),
        bend_deg: axis.bend.as_ref().map(|bend| degrees(bend.angle_deg())),
    }
}

/// The outline of a level's section.
pub(super) fn outline(leg: &LegAxis, at: &LevelSection) -> OutlineFigures {
    let section = &at.section;
    let plane = leg.plane(section.along_mm);
    OutlineFigures {
        centre_mm: plane.point(&section.centre).coords.map(mm).into(),
        front: direction(&plane.front),
        lateral: direction(&plane.lateral),
        radius_mm: section.curve.radii(OUTLINE_ANGLES, None).into_iter().map(mm).collect(),
        curvature_per_mm: curvatures(section, OUTLINE_ANGLES).into_iter().map(per_mm).collect(),
        scan_angle_deg: at.scan.iter().map(|point| degrees(point.angle_deg)).collect(),
        scan_radius_mm: at.scan.iter().map(|point| mm(point.radius_mm)).collect(),
    }
}

/// A leg's shape.
pub(super) fn shape(report: &LegReport) -> ShapeFigures {
    let Shape { skin, foot, surface, scan } = &report.shape;
    let place = |row: &'_ Option<Vec<Point3<f64>>>, j: usize| row.as_ref().map(|row| row[j]);
    let places: Vec<Option<Point3<f64>>> =
        skin.iter().flat_map(|row| (0..COLUMNS).map(move |j| place(row, j))).collect();
    let grid = |rows: &Vec<Vec<Point3<f64>>>, map: &ErrorMap| SurfaceGridFigures {
        rows: rows.len(),
        columns: COLUMNS,
        points: Packed::points(rows.iter().flatten().map(Some)),
        error: Packed::errors(&map.outside_mm),
    };
    let map = report.surface.as_ref().map(|surface| &surface.error_map);
    ShapeFigures {
        skin: GridFigures {
            rows: skin.len(),
            columns: COLUMNS,
            points: Packed::points(places.iter().map(Option::as_ref)),
        },
        foot: foot.as_ref().and_then(|foot| {
            Some(MeshFigures {
                points: Packed::points(foot.points.iter().map(Some)),
                triangles: Packed::indices(&foot.triangles)?,
            })
        }),
        surface: surface.as_ref().zip(map).map(|(rows, map)| grid(rows, map)),
        scan: CloudFigures { points: Packed::points(scan.iter().map(Some)) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_points_read_back_to_half_a_unit_and_the_unseen_stay_unseen() {
        let points = [Some(Point3::new(-123.449, 0.05, 1999.96)), None];
        let packed = Packed::points(points.iter().map(Option::as_ref));
        let text = serde_json::to_string(&packed).unwrap();
        let back: Packed = serde_json::from_str(&text).unwrap();
        assert_eq!(back, packed);
        let [Some(seen), None] = back.as_points()[..] else { panic!("{back:?}") };
        assert!((seen - Point3::new(-123.4, 0.1, 2000.0)).norm() < 1e-9, "{seen}");
    }

    #[test]
    fn an_index_that_does_not_fit_gives_no_triangles() {
        assert_eq!(Packed::indices(&[[0, 1, 32_767]]), Some(Packed(vec![0, 1, 32_767])));
        assert_eq!(Packed::indices(&[[0, 1, 32_768]]), None);
    }

    #[test]
    fn bytes_are_the_least_first_and_base64_is_that_of_the_standard() {
        // 1 and −2 are 01 00 FE FF; RFC 4648 writes them AQD+/w==.
        assert_eq!(serde_json::to_string(&Packed(vec![1, -2])).unwrap(), "\"AQD+/w==\"");
        for text in ["\"AQD+\"", "\"AQ D\"", "\"AQD+/w\"", "7"] {
            assert!(serde_json::from_str::<Packed>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_too_far_away_is_the_farthest_and_not_unseen() {
        assert_eq!((whole(-9e9, 0.1), whole(9e9, 0.1)), (-32767, 32767));
        assert_eq!(Packed::errors(&[Some(-0.126), None]).as_errors_mm(), [Some(-0.13), None]);
    }
}
