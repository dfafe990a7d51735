//! The nodes of a VRML scene that carry or place points.

use nalgebra::{Matrix4, Point3};

/// Maximum nesting depth of nodes. Scenes of scanners and modellers have ten levels or fewer.
pub(super) const DEPTH_MAX: usize = 100;

/// Index of a node in its scene.
pub(super) type NodeId = usize;

#[derive(Debug)]
pub(super) enum Node {
    /// Contains other nodes.
    Group {
        children: Vec<NodeId>,
        /// The placement of its children.
        matrix: Box<Matrix4<f64>>,
        /// Whether state changes inside it end with it.
        is_closed: bool,
        /// The only child that is used; `None` if all are.
        choice: Option<i64>,
    },
    /// Places the nodes after it (VRML 1).
    Placement(Box<Matrix4<f64>>),
    /// Points for the nodes after it (VRML 1), or for the node that contains it.
    Coordinates(Vec<Point3<f64>>),
    /// Polygons over points: indices, -1 ends a polygon; clockwise ones are turned round.
    Faces { coordinates: Option<NodeId>, corners: Vec<i32>, is_clockwise: bool, line: usize },
    /// How the faces after it are written (VRML 1).
    Hints { is_clockwise: bool },
    /// Points without faces: `count` of them (-1 for all) from index `start` on.
    Points { coordinates: Option<NodeId>, start: i64, count: i64, line: usize },
    /// Neither carries nor places points.
    Other,
}
