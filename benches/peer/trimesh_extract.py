"""Legs measured from one body scan with trimesh, numpy and scipy: a peer of `gaiter extract`.

    python3 benches/peer/trimesh_extract.py SCAN.obj > legs.json

Written as a competent user of trimesh would write it for an OBJ with y up. README.md in this folder
says what it does and what it does not do.
"""

import json
import sys

import numpy as np
import trimesh
from scipy.interpolate import BSpline, UnivariateSpline, splev, splrep
from scipy.spatial import ConvexHull
from trimesh.intersections import mesh_multiplane

UNITS_MM = {"mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1000.0}
FRAGMENT_MAX_SHARE = 0.005
SPACING_MM = 5.0
GAP_MAX_DEG = 60.0
STANDS_OUT_MM = 1.5
HARMONICS = 12
ANGLES = np.linspace(-np.pi, np.pi, 720, endpoint=False)
UP = np.array([0.0, 0.0, 1.0])


def load(path):
    """The body: mm, z up, floor at 0, toes towards −y, middle of the shanks at x = y = 0."""
    mesh = trimesh.load_mesh(path, process=False, skip_materials=True)
    labels = trimesh.graph.connected_component_labels(mesh.edges, node_count=len(mesh.vertices))
    large = np.bincount(labels) > FRAGMENT_MAX_SHARE * len(mesh.vertices)
    mesh.update_faces(large[labels[mesh.faces[:, 0]]])
    mesh.remove_unreferenced_vertices()
    height = np.ptp(mesh.vertices[:, 1])
    unit = next((u for u, mm in UNITS_MM.items() if 1000 <= height * mm <= 2300), None)
    if unit is None:
        sys.exit(f"no unit makes {height:.4g} a stature")
    vertices = mesh.vertices[:, [0, 2, 1]] * [1, -1, 1] * UNITS_MM[unit]
    vertices[:, 2] -= vertices[:, 2].min()
    stature = vertices[:, 2].max()
    # The line through the shanks is the lateral axis; the toes say which way is the front.
    shank = vertices[np.abs(vertices[:, 2] / stature - 0.115) < 0.035, :2]
    across = np.linalg.svd(shank - shank.mean(axis=0), full_matrices=False)[2][0]
    foot = vertices[vertices[:, 2] < 0.035 * stature, :2]
    front = np.array([across[1], -across[0]])
    front *= np.sign((foot.mean(axis=0) - shank.mean(axis=0)) @ front)
    vertices[:, :2] = (vertices[:, :2] - shank.mean(axis=0)) @ np.c_[[-front[1], front[0]], -front]
    mesh.vertices = vertices
    return mesh, unit, stature


def crotch_height(mesh, stature):
    """The first height at which skin bridges the middle between the legs."""

    def bridged(lines):
        x = lines[..., 0]
        x = x[np.abs(x).max(axis=1) < 0.1 * stature]
        return ((x.min(axis=1) <= 0) & (x.max(axis=1) >= 0)).any()

    low, high = 0.38 * stature, 0.56 * stature
    for step in (10.0, 1.0):
        heights = np.arange(low, high, step)
        cuts = slices(mesh, np.zeros(3), UP, heights)
        high = next((h for h, lines in zip(heights, cuts) if bridged(lines)), high)
        low = high - step
    return high


def slices(mesh, origin, normal, heights):
    """Segments in space, (n, 2, 3) for each height along the normal."""
    lines, to_3d, _ = mesh_multiplane(mesh, origin, normal, heights)
    return [l @ m[:3, :2].T + m[:3, 3] for l, m in zip(lines, to_3d)]


def leg_mesh(mesh, sign, top):
    """The faces on one side of the middle and below a height."""
    middles = mesh.triangles_center
    return mesh.submesh([(middles[:, 0] * sign > 0) & (middles[:, 2] < top)], append=True)


def frame(foot, direction, sign):
    """Rows: front, lateral, along; coordinates count from the axis's foot."""
    front = np.array([0.0, -1.0, 0.0])
    front = trimesh.unitize(front - direction * (front @ direction))
    return np.array([front, np.cross(direction, front) * sign, direction]), foot


def in_frame(lines, rows_foot):
    return (lines - rows_foot[1]) @ rows_foot[0].T


def own(segments, centre=None):
    """The segments around a centre up to the first gap in radius: the leg without hands."""
    if centre is None:
        centre = np.median(segments.reshape(-1, segments.shape[-1]), axis=0)[:2]
    radius = np.linalg.norm(segments[:, 0, :2] - centre, axis=1)
    order = np.argsort(radius)
    gap = np.flatnonzero(np.diff(radius[order]) > 20)
    return segments[order[: gap[0] + 1]] if len(gap) else segments


def centroid(segments):
    """Centroid of the area around which the segments run, in any order and sense."""
    p, q = segments[:, 0, :2], segments[:, 1, :2]
    centre = (p + q).mean(axis=0) / 2
    p, q = p - centre, q - centre
    weight = np.abs(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    return centre + (weight[:, None] * (p + q)).sum(axis=0) / (3 * weight.sum())


def axis(mesh, sign, stature, crotch):
    """The line through section centroids, first below any hand, then up to the groin."""
    rows_foot = frame(np.zeros(3), UP, sign)
    for top in (0.32 * stature, 0.92 * crotch, 0.92 * crotch):
        heights = np.arange(0.066 * stature, top, 10.0)
        centres = []
        for along, lines in zip(heights, slices(mesh, rows_foot[1], rows_foot[0][2], heights)):
            near = (0.0, 0.0) if rows_foot[1].any() else None
            segments = own(in_frame(lines, rows_foot), near)
            centres.append(np.append(centroid(segments), along) @ rows_foot[0] + rows_foot[1])
        mean = np.mean(centres, axis=0)
        direction = np.linalg.svd(centres - mean)[2][0]
        direction *= np.sign(direction[2])
        rows_foot = frame(mean - direction * mean[2] / direction[2], direction, sign)
    return rows_foot


def section(segments):
    """The periodic smoothing curve radius(angle) of one section and its girths, or None."""
    segments = own(segments, (0.0, 0.0))
    if len(segments) < 24:
        return None
    centre = centroid(segments)
    arms = segments[..., :2].reshape(-1, 2) - centre
    angle, first = np.unique(np.arctan2(arms[:, 1], arms[:, 0]).round(6), return_index=True)
    radius = np.linalg.norm(arms[first], axis=1)
    if np.degrees(np.diff(angle, append=angle[0] + 2 * np.pi).max()) > GAP_MAX_DEG:
        return None
    # How much to smooth: neighbouring crossings share mesh points and so their noise, hence the
    # scatter about twelve harmonics and not about the neighbours.
    turns = angle[:, None] * np.arange(1, HARMONICS + 1)
    waves = np.c_[np.ones(len(angle)), np.cos(turns), np.sin(turns)]
    scatter = np.abs(radius - waves @ np.linalg.lstsq(waves, radius, rcond=1e-3)[0])
    sd = max(1.4826 * np.median(scatter), 0.02)
    good = scatter < max(5 * sd, 1.0)
    x, y = angle[good], radius[good]
    closed = np.append(x, x[0] + 2 * np.pi), np.append(y, y[0])
    curve = splrep(*closed, s=len(x) * sd**2, per=True, quiet=1)
    fitted = splev(np.mod(ANGLES - x[0], 2 * np.pi) + x[0], curve)
    outline = centre + fitted[:, None] * np.c_[np.cos(ANGLES), np.sin(ANGLES)]
    contour = np.linalg.norm(np.diff(outline, axis=0, append=outline[:1]), axis=1).sum()
    # In the plane the area of qhull is the perimeter.
    tape = ConvexHull(outline).area
    return {"outline": outline, "centre": centre, "contour": contour, "tape": tape}


def girth_curve(along, girth):
    """A quartic smoothing spline, whose slope has roots; noise judged by third differences."""
    sd = max(1.4826 * np.median(np.abs(np.diff(girth, 3))) / np.sqrt(20), 0.05)
    return UnivariateSpline(along, girth, k=4, s=len(along) * sd**2)


def landmarks(curve, stature):
    """B, C, D by extrema and B1 by slope, along the axis in mm; what is not there is absent."""
    slope, bend = curve.derivative(), curve.derivative(2)
    extrema = slope.roots()
    lows, highs = extrema[bend(extrema) > 0], extrema[bend(extrema) < 0]
    found = {}
    lows, highs = lows[lows > 0.05 * stature], highs[highs < 0.30 * stature]
    b = next((x for x in lows[lows < 0.15 * stature]), None)
    if b is None:
        return found
    found["B"] = b
    above = [x for x in highs if x > b]
    for c in above:
        following = lows[lows > c]
        if len(following) and curve(c) - curve(following[0]) > STANDS_OUT_MM:
            found["C"], d = c, following[0]
            rise = curve(np.arange(d, min(d + 60, curve.get_knots()[-1]), 5.0)).max() - curve(d)
            if rise > STANDS_OUT_MM:
                found["D"] = d
            between = np.arange(b, c, 1.0)
            found["B1"] = between[np.argmax(curve(between + 10) - curve(between - 10))]
            break
    return found


def curvature_peaks(outline):
    """Angle (degrees) and three-point curvature (1/mm) of the peaks of one section."""
    points = outline[::10]
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    a, b, c = points - before, after - points, after - before
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    lengths = np.linalg.norm([a, b, c], axis=2).prod(axis=0)
    curvature = 2 * cross / lengths
    around = np.max([np.roll(curvature, k) for k in (-3, -2, -1, 1, 2, 3)], axis=0)
    peaks = np.flatnonzero((curvature > around) & (curvature > curvature.mean()))
    degrees = np.degrees(ANGLES[10 * peaks]).round(1)
    pairs = zip(degrees, curvature[peaks].round(5))
    return [{"angle_deg": a, "curvature_per_mm": k} for a, k in pairs]


def surface(along, grid, rows=30, columns=24):
    """Least-squares bicubic tensor product, clamped along and periodic around; its rms, mm."""
    u = (along - along[0]) / (along[-1] - along[0])
    rows = min(rows, len(u))
    knots = np.r_[[0] * 3, np.linspace(0, 1, rows - 2), [1] * 3]
    along_basis = BSpline.design_matrix(u, knots, 3).toarray()
    v = np.arange(grid.shape[1]) / grid.shape[1]
    wide = BSpline.design_matrix(v, np.arange(-3, columns + 4) / columns, 3).toarray()
    around_basis = wide[:, :columns]
    around_basis[:, :3] += wide[:, columns:]
    half = np.linalg.lstsq(along_basis, grid.reshape(len(u), -1), rcond=None)[0]
    half = half.reshape(rows, len(v), 3).transpose(1, 0, 2).reshape(len(v), -1)
    control = np.linalg.lstsq(around_basis, half, rcond=None)[0]
    control = control.reshape(columns, rows, 3).transpose(1, 0, 2)
    fitted = np.einsum("ui,vj,ijk->uvk", along_basis, around_basis, control, optimize=True)
    return control, np.sqrt(((fitted - grid) ** 2).sum(axis=2).mean())


def measure(mesh, sign, stature, crotch):
    """Everything about one leg."""
    leg = leg_mesh(mesh, sign, crotch + 60)
    rows_foot = axis(leg, sign, stature, crotch)
    rows, foot = rows_foot

    def sections(along):
        cut = slices(leg, foot, rows[2], along)
        return [section(in_frame(lines, rows_foot)) if len(lines) else None for lines in cut]

    along = np.arange(40.0, crotch / rows[2, 2], SPACING_MM)
    found = [(x, s) for x, s in zip(along, sections(along)) if s is not None]
    at = np.array([x for x, _ in found])
    tape = np.array([s["tape"] for _, s in found])
    curve = girth_curve(at, tape)
    levels = landmarks(curve, stature)
    tilt = round(np.degrees(np.arccos(rows[2, 2])), 2)
    report = {"tilt_deg": tilt, "landmarks": {}, "features": {}}
    for (name, x), cut in zip(levels.items(), sections(np.array(list(levels.values())))):
        if cut is None:
            continue
        height = foot[2] + np.append(cut["centre"], x) @ rows[:, 2]
        figures = {
            "height_mm": height,
            "along_axis_mm": x,
            "girth_tape_mm": curve(x),
            "girth_contour_mm": cut["contour"],
        }
        report["landmarks"][name] = {k: round(float(value), 2) for k, value in figures.items()}
        report["features"][name] = curvature_peaks(cut["outline"])
    low, high = levels.get("B", at[0]) - 20, levels.get("D", 0.27 * stature) + 20
    kept = [(x, s["outline"][::10]) for x, s in found if low <= x <= high]
    grid = np.array([np.c_[outline, np.full(len(outline), x)] for x, outline in kept]) @ rows + foot
    control, rms = surface(np.array([x for x, _ in kept]), grid)
    report["surface"] = {"control_points": control.tolist(), "rms_mm": round(float(rms), 4)}
    report["girth_curve"] = {"along_axis_mm": at.tolist(), "tape_mm": tape.round(2).tolist()}
    return report


def main(path):
    mesh, unit, stature = load(path)
    crotch = crotch_height(mesh, stature)
    sides = {"left": 1.0, "right": -1.0}
    legs = {side: measure(mesh, sign, stature, crotch) for side, sign in sides.items()}
    body = {"unit": unit, "stature_mm": stature, "crotch_height_mm": crotch}
    json.dump({"body": body, "legs": legs}, sys.stdout, default=float)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
