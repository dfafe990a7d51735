//! The nodes of a VRML scene, as far as they carry or place points.

use nalgebra::{Matrix4, Point3};

/// Deepest nesting of nodes. Scenes of scanners and modellers have ten levels or fewer.
pub(super) const DEPTH_MAX: usize = 100;

/// Number of a node in its scene.
pub(super) type NodeId = usize;

/// A node.
#[derive(Debug)]
pub(super) enum Node {
    /// Holds other nodes.
    Group {
        children: Vec<NodeId>,
        /// Where it puts them.
        matrix: Option<Box<Matrix4<f64>>>,
        /// Whether what happens within stays within.
        is_closed: bool,
        /// The one child that counts, where not all do.
        choice: Option<i64>,
    },
    /// Places what follows it (VRML 1).
    Placement(Box<Matrix4<f64>>),
    /// Points for what follows it (VRML 1), or for the node that holds it.
    Coordinates(Vec<Point3<f64>>),
    /// Polygons over points: indices, -1 ends a polygon.
    Faces { coordinates: Option<NodeId>, corners: Vec<i32>, line: usize },
    /// Points alone: so many (-1 all) from an index on.
    Points { coordinates: Option<NodeId>, start: i64, count: i64, line: usize },
    /// Neither carries nor places points.
    Other,
}

/// All nodes; the last one holds the others.
#[derive(Debug)]
pub(super) struct Scene {
    pub nodes: Vec<Node>,
}
