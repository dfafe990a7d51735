//! Holes that the scanner's software closed. Where no camera saw the skin, some exporters put a membrane: a
//! fan of triangles, long triangles from border to border, a net of the usual spacing stretched over the hole,
//! or a patch of a smooth surface. It lies inside the true skin by up to a centimetre and more, looks like
//! skin, and makes girths too small.
//!
//! Three things show it: triangles far longer than those around; no noise amid noise; and no mean curvature,
//! with a crease all around. A membrane over a hole is bent nowhere on average, since it is stretched, so what
//! the skin would turn over the hole, it must turn at the border. Where skin is flat by nature, as on the front
//! of the shin, it turns less all around, too.
//!
//! Skin is uneven if the normals at the ends of an edge do not lean apart by the same angle: half the sum of the
//! two normals along the edge is zero on every plane, sphere and cylinder, whatever the edge's direction and
//! length, and on skin with noise it varies by 1.2 times that.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

mod curvature;

use curvature::{by_usual, mean_curvature, median, sides};

use crate::frame::union_find::DisjointSets;
use crate::sections::slice::Mesh;
use crate::statistics::range;

/// An edge is long from this many median edges on: on no mesh of good scans is one, also not if it was
/// decimated to a fifth of its facets.
const LONG_EDGES: f64 = 3.0;

/// The edges within a group of long triangles are longer than those of its outline by this factor: the border of
/// a hole is as fine as the skin around. Measured: 2 to 5; skin that was stretched in a deformed mesh has 1.8 at
/// most, and small groups.
const INNER_TO_OUTLINE: f64 = 1.6;

/// Across edges of this many median edges, a group of long triangles continues into smaller ones.
const WIDE_EDGES: f64 = 2.0;

/// An edge is quiet if it is less uneven than this share of the leg's noise. By chance one edge in five is. The second
/// share is for what a camera saw that has less noise than the others.
const QUIET_SHARES: [f64; 2] = [0.25, 0.1];

/// This many quiet triangles side by side are no chance: on 170 legs there were groups of up to 11, on a mesh
/// without noise, which consists of larger facets, of 17.
const QUIET_MIN: usize = 18;

/// This many are enough if they are larger than the leg's triangles by this factor (median): a coarse fill.
const COARSE_MIN: usize = 8;
const COARSE_AREAS: f64 = 2.5;

/// Less uneven than skin around by this factor. Cameras differ in noise by three at most; fills by 8 to 50.
const CONTRAST: f64 = 0.2;

/// … which has as much noise at least, mm: skin without noise differs from place to place by what its facets do.
const NOISE_MIN_MM: f64 = 0.05;

/// A triangle's mean curvature is small below this share of what is usual at its height. A stretched net of
/// triangles of all shapes has up to 0.5.
const FLAT_SHARE: f64 = 0.4;

/// This many flat triangles side by side.
const FLAT_MIN: usize = 12;

/// Flat parts count if they are as smooth as this, mm: on noisy skin, flat parts come by chance.
const SMOOTH_MM: f64 = 0.1;

/// Skin beside a membrane is more curved than what is usual at its height by this factor. Measured: beside flat
/// parts of skin up to 1.04, of skin with smoothed noise or veins up to 1.31; beside membranes from 1.10, four of
/// five above 1.4, up to 3: those below are narrow beside the leg's radius and do little harm.
const CREASE: f64 = 1.4;

/// Sectors around a flat part in which its border is looked at: half of them must show it, so a crest of the
/// shin on one side does not count.
const SECTORS: usize = 8;
const SECTORS_MIN: usize = 5;

/// Smaller parts are left: a hole of 25 × 30 mm changes a girth by less than 1 mm, mm².
const AREA_MIN_MM2: f64 = 600.0;

/// From what is certain, a part continues over triangles that are less uneven than this share of the skin around,
/// or flatter than this share of what is usual, for this many triangles.
const LOOSE_QUIET_SHARE: f64 = 0.35;
const LOOSE_FLAT_SHARE: f64 = 0.6;
const LOOSE_ROUNDS: usize = 3;

/// Patches whose middle is looked for reach so far beyond, with the skin around them, mm.
const AROUND_MM: f64 = 130.0;

/// From the median of absolute values to a standard deviation.
const MEDIAN_TO_SD: f64 = 1.0 / 0.6745;

/// A hole that was closed by software.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its lower and its upper end, mm.
    pub height_mm: [f64; 2],
    /// Its extent around the leg, mm.
    pub width_mm: f64,
    /// Its middle.
    pub middle: Point3<f64>,
    /// Its area, mm².
    pub area_mm2: f64,
}

/// The closed holes of a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// For each triangle whether it closes a hole.
    pub is_filled: Vec<bool>,
    /// The holes, lowest first.
    pub patches: Vec<Patch>,
}

/// Finds the triangles that close holes whose middle lies between two heights, mm: above the instep and below the
/// thigh, where skin is round. Triangles must be wound alike. A bare cloud has none.
pub fn filled(mesh: &Mesh, span_mm: [f64; 2]) -> Filled {
    let mut is_filled = vec![false; mesh.triangles().len()];
    let Some(skin) = Skin::from_mesh(mesh, span_mm) else {
        return Filled { is_filled, patches: Vec::new() };
    };
    let mut found = Vec::new();
    for part in skin.parts(|triangle| skin.is_long[triangle], span_mm, 1) {
        found.extend(skin.bridged(&part));
    }
    for limit_mm in QUIET_SHARES.map(|share| share * skin.noise_mm) {
        for part in skin.parts(|triangle| skin.is_quiet(triangle, limit_mm), span_mm, COARSE_MIN) {
            found.extend(skin.noiseless(&part));
        }
    }
    let is_flat = |triangle: usize| skin.bend[triangle].abs() < FLAT_SHARE;
    for part in skin.parts(is_flat, span_mm, FLAT_MIN) {
        found.extend(skin.stretched(&part));
    }
    for mask in found {
        is_filled.iter_mut().zip(mask).for_each(|(all, one)| *all |= one);
    }
    let parts = skin.parts(|triangle| is_filled[triangle], [f64::NEG_INFINITY, f64::INFINITY], 1);
    let mut patches: Vec<Patch> = parts.iter().map(|part| skin.patch(part)).collect();
    patches.sort_by(|a, b| a.height_mm[0].total_cmp(&b.height_mm[0]));
    Filled { is_filled, patches }
}

/// A leg's mesh with the figures that identify skin.
struct Skin<'a> {
    mesh: &'a Mesh,
    /// Unit normals, wound like the triangles and without the long ones; zero at points that only these use.
    normals: Vec<Vector3<f64>>,
    /// Length of each edge of the mesh, mm.
    lengths_mm: Vec<f64>,
    /// How uneven the skin is along each edge, mm; infinite for long ones.
    uneven_mm: Vec<f64>,
    /// The edges of each triangle.
    sides: Vec<[u32; 3]>,
    areas_mm2: Vec<f64>,
    is_long: Vec<bool>,
    /// Mean curvature of each triangle by what is usual at its height; infinite if unknown.
    bend: Vec<f64>,
    /// Median of the edges' lengths, mm.
    edge_mm: f64,
    /// Median of the triangles' areas, mm².
    area_mm2: f64,
    /// Standard deviation of the unevenness, mm.
    noise_mm: f64,
}

impl Skin<'_> {
    /// Of what reaches between two heights, with some skin around, mm; `None` for a cloud.
    fn from_mesh(mesh: &Mesh, [low_mm, high_mm]: [f64; 2]) -> Option<Skin<'_>> {
        let points = mesh.points();
        let edges = mesh.edges();
        let along =
            |[from, to]: [u32; 2]| points[to as usize].coords - points[from as usize].coords;
        let lengths_mm: Vec<f64> = edges.iter().map(|edge| along(*edge).norm()).collect();
        let edge_mm = median(lengths_mm.clone())?;
        let sides = sides(points.len(), edges, mesh.triangles());
        let long_mm = LONG_EDGES * edge_mm;
        let is_long: Vec<bool> = sides
            .iter()
            .map(|sides| sides.iter().any(|side| lengths_mm[*side as usize] > long_mm))
            .collect();
        let across: Vec<Vector3<f64>> =
            mesh.triangles().iter().map(|t| mesh.facet(t).across()).collect();
        let mut normals = vec![Vector3::zeros(); points.len()];
        let usual = mesh.triangles().iter().zip(&across).zip(&is_long).filter(|(_, long)| !**long);
        for ((triangle, normal), _) in usual {
            triangle.iter().for_each(|corner| normals[*corner as usize] += *normal);
        }
        for normal in &mut normals {
            *normal = normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        }
        let uneven_mm: Vec<f64> = edges
            .iter()
            .zip(&lengths_mm)
            .map(|(edge, length_mm)| {
                let ends = edge.map(|end| normals[end as usize]);
                let is_known = ends.iter().all(|normal| *normal != Vector3::zeros());
                let uneven = (ends[0] + ends[1]).dot(&along(*edge)).abs() / 2.0;
                if is_known && *length_mm <= long_mm { uneven } else { f64::INFINITY }
            })
            .collect();
        let areas_mm2: Vec<f64> = across.iter().map(|normal| normal.norm() / 2.0).collect();
        let area_mm2 = median(areas_mm2.clone())?;
        let known = uneven_mm.iter().copied().filter(|uneven_mm| uneven_mm.is_finite());
        let noise_mm = MEDIAN_TO_SD * median(known.collect())?;
        let looked_at = low_mm - AROUND_MM..high_mm + AROUND_MM;
        let curvature = mesh.triangles().iter().zip(&across).zip(&is_long).map(|((t, n), long)| {
            let is_out = *long || !looked_at.contains(&points[t[0] as usize].z);
            if is_out { f64::INFINITY } else { mean_curvature(points, &normals, t, n) }
        });
        let bend = by_usual(mesh, curvature.collect())?;
        let skin = Skin {
            mesh,
            normals,
            lengths_mm,
            uneven_mm,
            sides,
            areas_mm2,
            is_long,
            bend,
            edge_mm,
            area_mm2,
            noise_mm,
        };
        Some(skin)
    }

    fn is_quiet(&self, triangle: usize, limit_mm: f64) -> bool {
        self.sides[triangle].iter().all(|side| self.uneven_mm[*side as usize] < limit_mm)
    }

    /// The connected groups of triangles that are chosen, which have at least this many and the least area,
    /// and whose middle lies between two heights, mm.
    fn parts(
        &self,
        is_chosen: impl Fn(usize) -> bool,
        [low_mm, high_mm]: [f64; 2],
        least: usize,
    ) -> Vec<Vec<usize>> {
        let count = self.sides.len();
        let chosen: Vec<usize> = (0..count).filter(|triangle| is_chosen(*triangle)).collect();
        if chosen.len() < least {
            return Vec::new();
        }
        let mut sets = DisjointSets::new(count);
        let mut owners = vec![u32::MAX; self.lengths_mm.len()];
        for &triangle in &chosen {
            for side in self.sides[triangle] {
                let owner = &mut owners[side as usize];
                if *owner == u32::MAX {
                    *owner = triangle as u32;
                } else {
                    sets.join(*owner, triangle as u32);
                }
            }
        }
        let mut keyed: Vec<(u32, usize)> =
            chosen.into_iter().map(|triangle| (sets.root(triangle as u32), triangle)).collect();
        keyed.sort_unstable();
        let groups = keyed.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() >= least);
        let groups = groups.map(|group| group.iter().map(|(_, t)| *t).collect::<Vec<usize>>());
        groups
            .filter(|part| {
                let height_mm = part.iter().map(|t| self.middle(*t).z).sum::<f64>();
                let height_mm = height_mm / part.len() as f64;
                self.area(part) >= AREA_MIN_MM2 && (low_mm..=high_mm).contains(&height_mm)
            })
            .collect()
    }

    /// A hole bridged by long triangles, if these are such.
    fn bridged(&self, part: &[usize]) -> Option<Vec<bool>> {
        let mut uses = vec![0u8; self.lengths_mm.len()];
        for side in part.iter().flat_map(|triangle| self.sides[*triangle]) {
            uses[side as usize] = uses[side as usize].saturating_add(1);
        }
        let used = |times: u8| {
            let sides = uses.iter().zip(&self.lengths_mm).filter(|(uses, _)| **uses == times);
            median(sides.map(|(_, length_mm)| *length_mm).collect())
        };
        let (outline_mm, inner_mm) = (used(1)?, used(2)?);
        let wide_mm = WIDE_EDGES * self.edge_mm;
        (inner_mm > INNER_TO_OUTLINE * outline_mm).then(|| {
            let is_wide = |side: u32| self.lengths_mm[side as usize] > wide_mm;
            self.flooded(part, |_| true, is_wide)
        })
    }

    /// A hole filled without noise, if these triangles are such.
    fn noiseless(&self, part: &[usize]) -> Option<Vec<bool>> {
        let is_coarse = self.area(part) > COARSE_AREAS * self.area_mm2 * part.len() as f64;
        if part.len() < QUIET_MIN && !is_coarse {
            return None;
        }
        let around_mm = self.noise_around_mm(part)?;
        let is_noiseless = around_mm > NOISE_MIN_MM && self.rms_mm(part) < CONTRAST * around_mm;
        is_noiseless.then(|| {
            let limit_mm = LOOSE_QUIET_SHARE * around_mm;
            let uneven_mm = |triangle: usize| {
                self.sides[triangle].iter().map(|side| self.uneven_mm[*side as usize]).sum::<f64>()
            };
            let filled = self.flooded(part, |t| uneven_mm(t) < 3.0 * limit_mm, |_| true);
            self.grown(&filled)
        })
    }

    /// A hole with a stretched membrane, if these flat triangles are such.
    fn stretched(&self, part: &[usize]) -> Option<Vec<bool>> {
        // The crease first, because few flat parts have one.
        if self.crease(part)? <= CREASE {
            return None;
        }
        let around_mm = self.noise_around_mm(part)?;
        let is_smooth = self.rms_mm(part) < SMOOTH_MM.max(2.0 * CONTRAST * around_mm);
        is_smooth.then(|| {
            let is_flat = |triangle: usize| self.bend[triangle].abs() < LOOSE_FLAT_SHARE;
            self.grown(&self.flooded(part, is_flat, |_| true))
        })
    }

    /// Root mean square of the unevenness within, mm.
    fn rms_mm(&self, part: &[usize]) -> f64 {
        let sides = part.iter().flat_map(|triangle| self.sides[*triangle]);
        let squares = sides.map(|side| self.uneven_mm[side as usize].powi(2)).sum::<f64>();
        (squares / (3 * part.len()) as f64).sqrt()
    }

    /// Noise of the skin from two to five rings of points outside, mm.
    fn noise_around_mm(&self, part: &[usize]) -> Option<f64> {
        let near = (0..2).fold(self.mask(part), |mask, _| self.grown(&mask));
        let far = (0..3).fold(near.clone(), |mask, _| self.grown(&mask));
        let around = (0..far.len()).filter(|triangle| far[*triangle] && !near[*triangle]);
        let sides = around.flat_map(|triangle| self.sides[triangle]);
        let uneven_mm = sides.map(|side| self.uneven_mm[side as usize]);
        let middle_mm = median(uneven_mm.filter(|uneven_mm| uneven_mm.is_finite()).collect())?;
        Some(MEDIAN_TO_SD * middle_mm)
    }

    /// Median, over sectors, of the mean curvature within two rings of points outside.
    fn crease(&self, part: &[usize]) -> Option<f64> {
        let inside = self.mask(part);
        let outside = (0..2).fold(inside.clone(), |mask, _| self.grown(&mask));
        let middle = self.middle_of(part);
        let [along, aside] = self.directions(part)?;
        let places = |of: usize| self.middle(of) - middle;
        let sd = |direction: &Vector3<f64>| {
            let squares = part.iter().map(|t| places(*t).dot(direction).powi(2)).sum::<f64>();
            (squares / part.len() as f64).sqrt().max(f64::MIN_POSITIVE)
        };
        let (length, width) = (sd(&along), sd(&aside));
        let mut sectors = [(0.0, 0.0); SECTORS];
        for triangle in (0..inside.len()).filter(|t| outside[*t] && !inside[*t]) {
            if !self.bend[triangle].is_finite() {
                continue;
            }
            let place = places(triangle);
            let angle = (place.dot(&aside) / width).atan2(place.dot(&along) / length);
            let sector = ((angle + PI) / TAU * SECTORS as f64 + 0.5) as usize % SECTORS;
            let area = self.areas_mm2[triangle];
            sectors[sector].0 += area;
            sectors[sector].1 += area * self.bend[triangle];
        }
        let seen = sectors.iter().filter(|(area, _)| *area > 0.0);
        let means: Vec<f64> = seen.map(|(area, bend)| bend / area).collect();
        if means.len() < SECTORS_MIN { None } else { median(means) }
    }

    /// Directions in a part: upwards and aside. `None` if it lies level.
    fn directions(&self, part: &[usize]) -> Option<[Vector3<f64>; 2]> {
        let corners = part.iter().flat_map(|triangle| self.mesh.triangles()[*triangle]);
        let normal = corners.map(|corner| self.normals[corner as usize]).sum::<Vector3<f64>>();
        let aside = normal.cross(&Vector3::z()).try_normalize(f64::MIN_POSITIVE)?;
        Some([aside.cross(&normal).try_normalize(f64::MIN_POSITIVE)?, aside])
    }

    fn mask(&self, part: &[usize]) -> Vec<bool> {
        let mut mask = vec![false; self.sides.len()];
        part.iter().for_each(|triangle| mask[*triangle] = true);
        mask
    }

    /// All triangles that share a point with those of a mask.
    fn grown(&self, mask: &[bool]) -> Vec<bool> {
        let mut touched = vec![false; self.normals.len()];
        let triangles = self.mesh.triangles();
        for (triangle, _) in triangles.iter().zip(mask).filter(|(_, is_in)| **is_in) {
            triangle.iter().for_each(|corner| touched[*corner as usize] = true);
        }
        triangles.iter().map(|t| t.iter().any(|corner| touched[*corner as usize])).collect()
    }

    /// A part and the triangles that may join it, over sides that may be crossed, for a few rounds.
    fn flooded(
        &self,
        part: &[usize],
        may_join: impl Fn(usize) -> bool,
        may_cross: impl Fn(u32) -> bool,
    ) -> Vec<bool> {
        let mut mask = self.mask(part);
        let mut touched = vec![false; self.lengths_mm.len()];
        let mut last = part.to_vec();
        for _ in 0..LOOSE_ROUNDS {
            let sides = last.iter().flat_map(|triangle| self.sides[*triangle]);
            sides.for_each(|side| touched[side as usize] |= may_cross(side));
            let is_reached = |t: usize| self.sides[t].iter().any(|side| touched[*side as usize]);
            last =
                (0..mask.len()).filter(|t| !mask[*t] && is_reached(*t) && may_join(*t)).collect();
            last.iter().for_each(|triangle| mask[*triangle] = true);
        }
        mask
    }

    fn area(&self, part: &[usize]) -> f64 {
        part.iter().map(|triangle| self.areas_mm2[*triangle]).sum()
    }

    fn middle(&self, triangle: usize) -> Point3<f64> {
        self.mesh.facet(&self.mesh.triangles()[triangle]).middle()
    }

    /// The middle of a part, by area.
    fn middle_of(&self, part: &[usize]) -> Point3<f64> {
        let moments = part.iter().map(|t| self.middle(*t).coords * self.areas_mm2[*t]);
        (moments.sum::<Vector3<f64>>() / self.area(part)).into()
    }

    fn patch(&self, part: &[usize]) -> Patch {
        let corners = part.iter().flat_map(|triangle| self.mesh.triangles()[*triangle]);
        let points: Vec<Point3<f64>> =
            corners.map(|corner| self.mesh.points()[corner as usize]).collect();
        let along = |direction: &Vector3<f64>| {
            range(points.iter().map(|point| direction.dot(&point.coords)))
        };
        let aside = self.directions(part).map_or(Vector3::x(), |[_, aside]| aside);
        let [from_mm, to_mm] = along(&aside);
        Patch {
            height_mm: along(&Vector3::z()),
            width_mm: to_mm - from_mm,
            middle: self.middle_of(part),
            area_mm2: self.area(part),
        }
    }
}

#[cfg(test)]
mod tests;
