// Records with legs of known geometry, for the tests of the 3D view.
//
// A leg is an upright tube of elliptic sections in the body frame (mm, +Z up, −Y where the toes
// point, +X the patient's left) with a toe-ward bulge for a foot, so that front and back differ.

/** Distance of each leg's axis from the body's middle plane, mm. */
export const AXIS_X_MM = 95;

/** Height of the upper end of the measured skin, mm. */
export const TOP_MM = 700;

/** Heights of the levels, mm. */
export const LEVELS_MM = { B: 120, B1: 195, C: 330, D: 405 };

/** Ends of the surface, mm. */
const SURFACE_MM = [100, 440];

/** Mean radius over the height: knots of a polygon, mm. */
const RADII_MM = [[0, 45], [60, 45], [120, 34], [330, 58], [440, 50], [520, 58], [700, 82]];

/** Where each section has its peaks and valleys: label, kind, angle from the front, degrees. */
const FEATURES = [["P1", "peak", 0], ["P2", "valley", 50], ["P3", "peak", 100], ["P4", "valley", 180], ["P5", "peak", -90]];

/** Radius of the tube at a height and an angle from the front, mm. */
export function radiusMm(height, angleDeg) {
  const after = Math.max(1, RADII_MM.findIndex(([knot]) => knot >= height));
  const [[z0, r0], [z1, r1]] = [RADII_MM[after - 1], RADII_MM[after]];
  const mean = r0 + ((height - z0) / (z1 - z0)) * (r1 - r0);
  const forward = Math.cos((angleDeg * Math.PI) / 180);
  const toes = Math.max(0, 1 - height / 80) * 130 * Math.max(0, forward) ** 6;
  return mean * (1 + 0.08 * forward * forward) + toes;
}

/** A point on the tube. */
export function pointMm(side, height, angleDeg) {
  const angle = (angleDeg * Math.PI) / 180;
  const [sign, radius] = [side === "left" ? 1 : -1, radiusMm(height, angleDeg)];
  return [sign * (AXIS_X_MM + radius * Math.sin(angle)), -radius * Math.cos(angle), height];
}

/** Standard base64 of little-endian 16-bit integers. */
export function base64(values) {
  const bytes = Buffer.alloc(values.length * 2);
  values.forEach((value, index) => bytes.writeInt16LE(Math.round(value), index * 2));
  return bytes.toString("base64");
}

function grid(side, [low, high], rows, columns, widerMm = 0) {
  const points = [];
  for (let row = 0; row < rows; row += 1) {
    const height = low + ((high - low) * row) / (rows - 1);
    for (let column = 0; column < columns; column += 1) {
      const [x, y, z] = pointMm(side, height, -180 + (360 * column) / columns);
      const out = [x - (side === "left" ? 1 : -1) * AXIS_X_MM, y];
      const share = widerMm / Math.hypot(...out);
      points.push(x + share * out[0], y + share * out[1], z);
    }
  }
  return { rows, columns, points: base64(points.map((mm) => mm * 10)) };
}

/** Errors of a surface from a function of row and column, mm; null is not seen. */
export function errors(rows, columns, errorMm) {
  const cells = Array.from({ length: rows * columns }, (_, at) =>
    errorMm(Math.floor(at / columns), at % columns));
  return base64(cells.map((mm) => (mm === null ? -32768 : mm * 100)));
}

function section(side, level) {
  const [height_mm, sign] = [LEVELS_MM[level], side === "left" ? 1 : -1];
  const angles = Array.from({ length: 120 }, (_, at) => -180 + 3 * at);
  return {
    level,
    height_mm,
    outline: {
      centre_mm: [sign * AXIS_X_MM, 0, height_mm],
      front: [0, -1, 0],
      lateral: [sign, 0, 0],
      radius_mm: angles.map((angle) => radiusMm(height_mm, angle)),
      curvature_per_mm: angles.map(() => 1 / radiusMm(height_mm, 0)),
      scan_angle_deg: angles,
      scan_radius_mm: angles.map((angle) => radiusMm(height_mm, angle)),
    },
  };
}

/** The tape girth at a height: told apart on the two legs, mm. */
export function girthAtMm(side, height) {
  return 2 * Math.PI * radiusMm(height, 90) + (side === "left" ? 3 : 0);
}

/** The tape girth the record gives a level, mm. */
export const girthMm = (side, level) => girthAtMm(side, LEVELS_MM[level]);

/** The girth curve: a row every 5 mm, none measured between two heights. */
function girthCurve(side, [from, to] = [800, 800]) {
  const height_mm = Array.from({ length: 119 }, (_, at) => 100 + 5 * at);
  return { height_mm, tape_mm: height_mm.map((height) => (height > from && height < to ? null : girthAtMm(side, height))) };
}

/** One leg of a record; `errorMm(row, column)` gives the surface's error, `widerMm` is how much the skin stands
 *  out, and between the heights `openMm` no girth was measured. */
export function leg(side, errorMm = () => 0, { rows = 60, columns = 72, widerMm = 0, openMm = undefined } = {}) {
  const [levels, sign] = [Object.keys(LEVELS_MM), side === "left" ? 1 : -1];
  const scan = [];
  for (let at = 0; at < 3000; at += 1) scan.push(...pointMm(side, (TOP_MM * at) / 3000, (at * 137.508) % 360));
  return {
    side,
    axis: { foot_mm: [sign * AXIS_X_MM, 0, 0], direction: [0, 0, 1], front: [0, -1, 0], lateral: [sign, 0, 0] },
    landmarks: Object.fromEntries(levels.map((level) => [level, {
      height_mm: LEVELS_MM[level], along_axis_mm: LEVELS_MM[level], girth_tape_mm: girthMm(side, level), doubts: [],
    }])),
    sections: levels.map((level) => section(side, level)),
    features: levels.flatMap((level) => FEATURES.map(([label, kind, angle_deg]) => ({
      level, label, kind, angle_deg, position_mm: pointMm(side, LEVELS_MM[level], angle_deg), curvature_per_mm: 0.02,
    }))),
    girth_curve: girthCurve(side, openMm),
    profile: [{ height_mm: 160, girth_tape_mm: girthAtMm(side, 160), doubts: [] }],
    shape: {
      skin: grid(side, [0, TOP_MM], 2 * rows, columns, widerMm),
      surface: { ...grid(side, SURFACE_MM, rows, columns), error: errors(rows, columns, errorMm) },
      scan: { points: base64(scan.map((mm) => mm * 10)) },
    },
  };
}

/** A record of both legs, or of the legs given. */
export function record(legs = [leg("left"), leg("right")]) {
  return { schema: "gaiter.leg-record/1", legs, findings: [] };
}
