//! Nodes of a scene → points and triangles, each in its place in the scene.

use std::mem::swap;

use nalgebra::{Matrix4, Point3};

use super::super::fault::{ScanFault, SourcePosition, malformed};
use super::super::weld::Unwelded;
use super::scene::{DEPTH_MAX, Node, NodeId};

/// How often the points and corners of a file may be repeated through `USE`, on average. No scan
/// contains a leg eight times, but a scene made to exhaust the memory doubles with every level.
const EXPANSION_MAX: usize = 8;

/// Maximum number of visited nodes, counting those of repeated groups each time.
const VISITS_MAX: usize = 100_000;

/// The geometry of a scene's nodes, of which the last contains the others. If the scene has faces, points without faces are
/// removed later.
///
/// # Errors
/// [`ScanFault::Malformed`] with the line of the node whose indices are wrong, or for a scene that
/// repeats itself too often.
pub(super) fn geometry(nodes: &[Node]) -> Result<Unwelded, ScanFault> {
    let count = |of: fn(&Node) -> usize| nodes.iter().map(of).sum::<usize>();
    let written_points = count(|node| match node {
        Node::Coordinates(points) => points.len(),
        _ => 0,
    });
    let written_corners = count(|node| match node {
        Node::Faces { corners, .. } => corners.len(),
        _ => 0,
    });
    let mut walk = Walk {
        nodes,
        points: Vec::new(),
        triangles: Vec::new(),
        placed: None,
        visits_left: VISITS_MAX,
        points_left: EXPANSION_MAX.saturating_mul(written_points),
        corners_left: EXPANSION_MAX.saturating_mul(written_corners),
    };
    let mut state = State { matrix: Matrix4::identity(), coordinates: None, is_clockwise: false };
    walk.visit(nodes.len() - 1, &mut state, 0)?;
    Ok((walk.points, walk.triangles))
}

/// The state that applies to a node.
#[derive(Debug, Clone, Copy)]
struct State {
    matrix: Matrix4<f64>,
    /// The points of VRML 1, which precede the node that uses them.
    coordinates: Option<NodeId>,
    /// Whether faces are clockwise as seen from outside (VRML 1).
    is_clockwise: bool,
}

struct Walk<'a> {
    nodes: &'a [Node],
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// The last points placed, with their matrix and their first index, because several face sets
    /// often use the same points.
    placed: Option<(NodeId, Matrix4<f64>, u32)>,
    visits_left: usize,
    points_left: usize,
    corners_left: usize,
}

impl Walk<'_> {
    fn visit(&mut self, id: NodeId, state: &mut State, depth: usize) -> Result<(), ScanFault> {
        self.visits_left = less(self.visits_left, 1)?;
        if depth > 2 * DEPTH_MAX {
            return Err(beyond_measure());
        }
        match &self.nodes[id] {
            Node::Group { children, matrix, is_closed, choice } => {
                let outer = *state;
                state.matrix *= **matrix;
                let counts = |index: usize| choice.is_none_or(|chosen| chosen == index as i64);
                let counting = children.iter().enumerate().filter(|(index, _)| counts(*index));
                for (_, &child) in counting {
                    self.visit(child, state, depth + 1)?;
                }
                if *is_closed {
                    *state = outer;
                }
            }
            Node::Placement(matrix) => state.matrix *= **matrix,
            Node::Coordinates(_) => state.coordinates = Some(id),
            Node::Hints { is_clockwise } => state.is_clockwise = *is_clockwise,
            Node::Faces { coordinates, corners, is_clockwise, line } => {
                self.corners_left = less(self.corners_left, corners.len())?;
                if let Some(coordinates) = coordinates.or(state.coordinates) {
                    let before = self.triangles.len();
                    self.faces(coordinates, corners, *line, state.matrix)?;
                    if *is_clockwise || state.is_clockwise {
                        self.triangles[before..].iter_mut().for_each(|[_, b, c]| swap(b, c));
                    }
                } else if !corners.is_empty() {
                    return Err(malformed(*line, "an IndexedFaceSet without points"));
                }
            }
            Node::Points { coordinates, start, count, line } => {
                if let Some(id) = coordinates.or(state.coordinates) {
                    self.cloud(id, [*start, *count], *line, state.matrix)?;
                }
            }
            Node::Other => {}
        }
        Ok(())
    }

    fn faces(
        &mut self,
        coordinates: NodeId,
        corners: &[i32],
        line: usize,
        matrix: Matrix4<f64>,
    ) -> Result<(), ScanFault> {
        let Node::Coordinates(own) = &self.nodes[coordinates] else { return Ok(()) };
        let first = match self.placed {
            Some((id, at, first)) if id == coordinates && at == matrix => first,
            _ => {
                let first = self.place(own, line, matrix)?;
                self.placed = Some((coordinates, matrix, first));
                first
            }
        };
        for polygon in corners.split(|&corner| corner == -1) {
            if let Some(wrong) = polygon.iter().find(|&&corner| corner as usize >= own.len()) {
                let count = own.len();
                let what = format!("an IndexedFaceSet names point {wrong}; there are {count}");
                return Err(malformed(line, what));
            }
            if let [start, rest @ ..] = polygon {
                let fan = rest.windows(2).map(|pair| [*start, pair[0], pair[1]]);
                self.triangles.extend(fan.map(|fan| fan.map(|corner| first + corner as u32)));
            }
        }
        Ok(())
    }

    /// The points of a `PointSet` from `start` on: `count` of them, or all for -1.
    fn cloud(
        &mut self,
        coordinates: NodeId,
        [start, count]: [i64; 2],
        line: usize,
        matrix: Matrix4<f64>,
    ) -> Result<(), ScanFault> {
        let Node::Coordinates(own) = &self.nodes[coordinates] else { return Ok(()) };
        let from = usize::try_from(start).ok().and_then(|start| own.get(start..));
        let part = from.and_then(|rest| match count {
            -1 => Some(rest),
            count => rest.get(..usize::try_from(count).ok()?),
        });
        let what = "a PointSet of points that are not there";
        self.place(part.ok_or_else(|| malformed(line, what))?, line, matrix)?;
        Ok(())
    }

    /// Transforms points into the scene and returns the index of the first.
    fn place(
        &mut self,
        points: &[Point3<f64>],
        line: usize,
        matrix: Matrix4<f64>,
    ) -> Result<u32, ScanFault> {
        self.points_left = less(self.points_left, points.len())?;
        let first = u32::try_from(self.points.len()).map_err(|_| beyond_measure())?;
        if matrix == Matrix4::identity() {
            self.points.extend_from_slice(points);
            return Ok(first);
        }
        let placed = points.iter().map(|point| matrix.transform_point(point));
        self.points.extend(placed);
        let placed = &self.points[first as usize..];
        match placed.iter().flat_map(|point| point.iter()).find(|value| !value.is_finite()) {
            Some(_) => Err(malformed(line, "a transform moves points beyond all numbers")),
            None => Ok(first),
        }
    }
}

fn less(left: usize, by: usize) -> Result<usize, ScanFault> {
    left.checked_sub(by).ok_or_else(beyond_measure)
}

fn beyond_measure() -> ScanFault {
    let what = "the scene repeats its parts beyond measure; export one plain mesh".to_owned();
    ScanFault::Malformed { place: SourcePosition::Unknown, what }
}
