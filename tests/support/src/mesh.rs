//! Meshes for bad exports: the fixtures' bodies, plain solids, a body made of tubes, and ways to
//! spoil them. Coordinates are those of an export with y up: +x the patient's left, +z the toes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs::File;
use std::io::Read;

use gaiter_scan::Scan;
use nalgebra::Vector3;

/// The text of a scan in `fixtures/scans`.
pub fn fixture(name: &str) -> Vec<u8> {
    let file = crate::root().join(format!("fixtures/scans/{name}.obj.gz"));
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(File::open(file).unwrap()).read_to_end(&mut bytes).unwrap();
    bytes
}

/// Points and triangles, as an OBJ file holds them.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
}

/// One ring of a tube: its height, its middle and its half widths along x and z.
#[derive(Debug, Clone, Copy)]
pub struct Ring {
    pub y: f64,
    pub middle: [f64; 2],
    pub half: [f64; 2],
}

impl Mesh {
    /// The mesh of plain OBJ text: `v x y z` and `f a b c` lines.
    pub fn of_obj(bytes: &[u8]) -> Mesh {
        let mut mesh = Mesh::default();
        for line in std::str::from_utf8(bytes).unwrap().lines() {
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                ["v", x, y, z] => mesh.points.push([x, y, z].map(|word| word.parse().unwrap())),
                ["f", a, b, c] => {
                    let corner = |word: &str| word.parse::<usize>().unwrap() - 1;
                    mesh.triangles.push([a, b, c].map(corner));
                }
                _ => {}
            }
        }
        mesh
    }

    /// The body of a fixture, in the fixture's own unit.
    pub fn body(name: &str) -> Mesh {
        Mesh::of_obj(&fixture(name))
    }

    /// As the scan that is read in its file.
    pub fn scan(&self) -> Scan {
        let corners = |triangle: &[usize; 3]| triangle.map(|corner| corner as u32);
        Scan {
            points: self.points.iter().map(|point| (*point).into()).collect(),
            triangles: self.triangles.iter().map(corners).collect(),
        }
    }

    /// OBJ text.
    pub fn obj(&self) -> Vec<u8> {
        let mut text = String::new();
        for [x, y, z] in &self.points {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        text.into_bytes()
    }

    /// Every point moved.
    pub fn moved(mut self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
        self.points.iter_mut().for_each(|point| *point = map(*point));
        self
    }

    /// The mirror image, wound outwards again.
    pub fn mirrored(self) -> Mesh {
        let mut mesh = self.moved(|[x, y, z]| [-x, y, z]);
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh
    }

    /// Every point multiplied.
    pub fn scaled(self, factor: f64) -> Mesh {
        self.moved(|point| point.map(|value| value * factor))
    }

    /// Turned about the up axis, counter-clockwise from above.
    pub fn turned(self, degrees: f64) -> Mesh {
        let (sin, cos) = degrees.to_radians().sin_cos();
        self.moved(|[x, y, z]| [x * cos + z * sin, y, z * cos - x * sin])
    }

    /// The unit normals of the points, outwards.
    pub fn normals(&self) -> Vec<Vector3<f64>> {
        let at = |point: usize| Vector3::from(self.points[point]);
        let mut normals = vec![Vector3::zeros(); self.points.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(at);
            let normal = (b - a).cross(&(c - a));
            triangle.iter().for_each(|corner| normals[*corner] += normal);
        }
        normals.into_iter().map(|normal| normal.try_normalize(1e-12).unwrap_or_default()).collect()
    }

    /// With what faces a camera moved towards it. The camera stands at an angle from the toes' direction, to the
    /// patient's left, and sees what faces it within an angle to each side, radians.
    pub fn with_camera_off(mut self, at: f64, within: f64, by_mm: f64) -> Mesh {
        let to = [at.sin(), 0.0, at.cos()];
        let normals = self.normals();
        for (point, normal) in self.points.iter_mut().zip(&normals) {
            let off = (normal.x.atan2(normal.z) - at + 3.0 * PI).rem_euclid(TAU) - PI;
            if off.abs() < within {
                (0..3).for_each(|axis| point[axis] += by_mm * to[axis]);
            }
        }
        self
    }

    /// The triangles whose middle is chosen, and the points they use.
    pub fn kept(self, keeps: impl Fn([f64; 3]) -> bool) -> Mesh {
        let middle = |triangle: &&[usize; 3]| {
            let corners = triangle.map(|corner| self.points[corner]);
            keeps(std::array::from_fn(|i| {
                corners.iter().map(|corner| corner[i]).sum::<f64>() / 3.0
            }))
        };
        let triangles: Vec<_> = self.triangles.iter().filter(middle).copied().collect();
        let mut numbers = vec![usize::MAX; self.points.len()];
        let mut points = Vec::new();
        let mut renumbered = |corner: usize| {
            if numbers[corner] == usize::MAX {
                numbers[corner] = points.len();
                points.push(self.points[corner]);
            }
            numbers[corner]
        };
        let triangles = triangles.into_iter().map(|t| t.map(&mut renumbered)).collect();
        Mesh { points, triangles }
    }

    /// Both meshes.
    pub fn and(mut self, other: Mesh) -> Mesh {
        let first = self.points.len();
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|corner| corner + first)));
        self
    }

    /// A tube through rings, open at both ends.
    pub fn tube(rings: &[Ring], sides: usize) -> Mesh {
        let mut mesh = Mesh::default();
        for Ring { y, middle: [x, z], half: [a, b] } in rings {
            mesh.points.extend((0..sides).map(|side| {
                let (sin, cos) = (TAU * side as f64 / sides as f64).sin_cos();
                [x + a * cos, *y, z + b * sin]
            }));
        }
        for ring in 1..rings.len() {
            let [low, high] = [(ring - 1) * sides, ring * sides];
            for side in 0..sides {
                let next = (side + 1) % sides;
                mesh.triangles.push([low + side, high + side, high + next]);
                mesh.triangles.push([low + side, high + next, low + next]);
            }
        }
        mesh
    }

    /// A straight tube standing at `[x, z]`.
    pub fn column([x, z]: [f64; 2], radius: f64, from: f64, to: f64) -> Mesh {
        let count = ((to - from) / 8.0).ceil().max(1.0);
        let ring = |i: usize| Ring {
            y: from + (to - from) * i as f64 / count,
            middle: [x, z],
            half: [radius; 2],
        };
        Mesh::tube(&(0..=count as usize).map(ring).collect::<Vec<_>>(), 40)
    }

    /// A sphere on the floor.
    pub fn sphere(diameter: f64) -> Mesh {
        let radius = diameter / 2.0;
        let ring = |i: i32| {
            let latitude = PI * f64::from(i) / 100.0;
            Ring {
                y: radius - radius * latitude.cos(),
                middle: [0.0; 2],
                half: [radius * latitude.sin(); 2],
            }
        };
        Mesh::tube(&(0..=100).map(ring).collect::<Vec<_>>(), 160)
    }

    /// A box on the floor with these half widths, walls only.
    pub fn cuboid(half: [f64; 2], from: f64, to: f64) -> Mesh {
        Mesh::column([0.0; 2], 1.0, from, to).moved(|[x, y, z]| {
            let reach = x.abs().max(z.abs());
            [half[0] * x / reach, y, half[1] * z / reach]
        })
    }

    /// A body of four tubes, 1700 mm tall: legs with feet, ankles and calves, a trunk, a head.
    /// Measured without a finding, and small enough for thousands of runs.
    pub fn mannequin() -> Mesh {
        // Height, middle's z, half widths along x and z, of the left leg.
        const LEG: [[f64; 4]; 14] = [
            [0.0, 70.0, 40.0, 122.0],
            [14.0, 67.0, 48.0, 128.0],
            [25.0, 65.0, 46.0, 122.0],
            [50.0, 40.0, 40.0, 95.0],
            [75.0, 8.0, 36.0, 56.0],
            [100.0, 0.0, 32.0, 40.0],
            [130.0, 0.0, 31.0, 33.0],
            [200.0, -4.0, 40.0, 42.0],
            [280.0, -8.0, 54.0, 56.0],
            [340.0, -8.0, 58.0, 60.0],
            [400.0, -4.0, 54.0, 55.0],
            [450.0, 0.0, 50.0, 52.0],
            [600.0, 0.0, 66.0, 72.0],
            [840.0, 0.0, 84.0, 92.0],
        ];
        let leg = |side: f64| {
            let ring = |i: u32| {
                let y = f64::from(i) * 7.0;
                let above = LEG.iter().position(|row| row[0] > y).unwrap_or(LEG.len() - 1);
                let (low, high) = (LEG[above - 1], LEG[above]);
                // A cosine between the rows, so that every row is a turning point or a step.
                let share = (1.0 - (PI * (y - low[0]) / (high[0] - low[0])).cos()) / 2.0;
                let [_, z, a, b]: [f64; 4] =
                    std::array::from_fn(|k| low[k] + share * (high[k] - low[k]));
                Ring { y, middle: [side * (100.0 - 0.01 * y), z], half: [a, b] }
            };
            Mesh::tube(&(0..=119).map(ring).collect::<Vec<_>>(), 40)
        };
        let trunk = |i: u32| Ring {
            y: 815.0 + f64::from(i) * 15.0,
            middle: [0.0; 2],
            half: [180.0 - f64::from(i), 115.0],
        };
        let head =
            |i: u32| Ring { y: 1400.0 + f64::from(i) * 15.0, middle: [0.0; 2], half: [75.0, 95.0] };
        leg(1.0)
            .and(leg(-1.0))
            .and(Mesh::tube(&(0..=39).map(trunk).collect::<Vec<_>>(), 80))
            .and(Mesh::tube(&(0..=20).map(head).collect::<Vec<_>>(), 40))
    }
}
