//! The patient's two sides.

use serde::{Deserialize, Serialize};

use crate::figure::{AsFigure, Figure};

word_enum! {
    /// The patient's own side.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    pub enum Side {
        /// Left.
        Left => "left",
        /// Right.
        Right => "right",
    }
}

impl Side {
    /// Both sides, left first.
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];

    /// Both sides in the order of text and drawings: seen from the front, the patient's right is on
    /// the left.
    pub const FROM_FRONT: [Side; 2] = [Side::Right, Side::Left];

    /// +1 for the left, whose lateral side is +X; −1 for the right.
    pub fn lateral_sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }

    /// The other side.
    pub fn other(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }
}

impl AsFigure for Side {
    fn figure(&self) -> Option<Figure> {
        None
    }
}

/// One value for each of the patient's sides.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Sides<T> {
    /// The patient's left.
    pub left: T,
    /// The patient's right.
    pub right: T,
}

impl<T> Sides<T> {
    /// Calls `of` for each side.
    pub fn of_each(mut of: impl FnMut(Side) -> T) -> Sides<T> {
        Sides { left: of(Side::Left), right: of(Side::Right) }
    }

    /// The value of one side.
    pub fn get(&self, side: Side) -> &T {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }

    /// The value of one side, mutable.
    pub fn get_mut(&mut self, side: Side) -> &mut T {
        match side {
            Side::Left => &mut self.left,
            Side::Right => &mut self.right,
        }
    }
}
