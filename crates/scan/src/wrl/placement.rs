//! The placement of a transform's contents, as a matrix.

use nalgebra::{Matrix4, Rotation3, Unit, Vector3};

/// Fields of transforms, by name.
pub(super) struct Fields<'a>(pub &'a [(&'static str, Vec<f64>)]);

impl Fields<'_> {
    /// The numbers of a field, or the default if the node does not set it.
    ///
    /// # Errors
    /// The field's name if it has a different number of values.
    pub(super) fn get<const N: usize>(
        &self,
        name: &'static str,
        default: [f64; N],
    ) -> Result<[f64; N], &'static str> {
        match self.0.iter().rfind(|(field, _)| *field == name) {
            Some((_, numbers)) => numbers.as_slice().try_into().map_err(|_| name),
            None => Ok(default),
        }
    }
}

/// The matrix of a `Transform`, or of VRML 1's `Translation`, `Rotation`, `Scale` and
/// `MatrixTransform`, which have a subset of its fields:
/// T · C · R · SR · S · SR⁻¹ · C⁻¹ (ISO/IEC 14772-1, 6.52).
///
/// # Errors
/// The name of an invalid field.
pub(super) fn matrix(fields: &Fields) -> Result<Matrix4<f64>, &'static str> {
    const NO_TURN: [f64; 4] = [0.0, 0.0, 1.0, 0.0];
    let move_by = |by: [f64; 3]| Matrix4::new_translation(&Vector3::from(by));
    let by = fields.get("translation", [0.0; 3])?;
    let center = fields.get("center", [0.0; 3])?;
    let turn = rotation(fields.get("rotation", NO_TURN)?);
    let scale_turn = rotation(fields.get("scaleOrientation", NO_TURN)?);
    // VRML 1 calls it `scaleFactor`.
    let scale = fields.get("scale", fields.get("scaleFactor", [1.0; 3])?)?;
    let scale = Matrix4::new_nonuniform_scaling(&Vector3::from(scale));
    let whole = move_by(by)
        * move_by(center)
        * turn
        * scale_turn
        * scale
        * scale_turn.transpose()
        * move_by(center.map(|value| -value));
    Ok(whole * own(fields)?)
}

/// The matrix of a `MatrixTransform`: it multiplies points from the right, so its last row is the
/// translation.
fn own(fields: &Fields) -> Result<Matrix4<f64>, &'static str> {
    let identity = Matrix4::identity();
    let mut rows = [0.0; 16];
    rows.copy_from_slice(identity.as_slice());
    // Reading in column order transposes the row-wise matrix.
    let matrix = Matrix4::from_column_slice(&fields.get("matrix", rows)?);
    let is_affine = matrix.row(3) == identity.row(3);
    if is_affine { Ok(matrix) } else { Err("matrix") }
}

/// A rotation by an angle (radians) about an axis; the identity if the axis is zero.
fn rotation([x, y, z, angle]: [f64; 4]) -> Matrix4<f64> {
    match Unit::try_new(Vector3::new(x, y, z), 0.0) {
        Some(axis) => Rotation3::from_axis_angle(&axis, angle).to_homogeneous(),
        None => Matrix4::identity(),
    }
}
