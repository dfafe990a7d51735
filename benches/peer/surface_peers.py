"""Surfaces through the closed-form test leg by SciPy and geomdl, on the grid of crates/spline/benches/surface.rs.

    pip install numpy scipy geomdl && python3 benches/peer/surface_peers.py

Prints one line per method: control points along x around; mean relative error in percent and largest
error in mm by the metric of tests/support/src/metric.rs; tangent kink across the seam in
degrees; best time of some runs. The clamped peers get three more columns around, as a periodic surface
has after export. The leg is that of tests/support/src/test_leg.rs.
"""

import math
import time

import numpy as np
from scipy.interpolate import BSpline, make_lsq_spline

HEIGHT_MM, ROWS, COLUMNS = 800.0, 80, 72

BUMPS = [  # height, direction, narrowness, centre, width
    (9.0, 235, 3.5, 290, 55), (6.0, 305, 4.5, 318, 48), (3.0, 100, 14, 230, 95),
    (-2.5, 140, 7, 240, 90), (5.0, 270, 16, 70, 55), (-3.0, 235, 12, 75, 45),
    (-3.0, 305, 12, 75, 45), (7.0, 185, 14, 62, 13), (7.5, 352, 16, 52, 13),
    (3.5, 92, 14, 405, 13), (6.0, 90, 5, 462, 24), (-5.5, 270, 8, 445, 30),
    (3.5, 238, 9, 470, 45), (3.5, 302, 9, 470, 45), (5.0, 150, 6, 520, 38),
    (5.0, 75, 3, 660, 90),
]


def g(z, c, s):
    return np.exp(-(((z - c) / s) ** 2) / 2)


def sg(z, c, s):
    return (1 + np.tanh((z - c) / s)) / 2


def centre(z):
    x = 6 * np.sin(np.pi * z / 800) + 4 * g(z, 300, 80)
    y = -10 * g(z, 300, 90) + 8 * g(z, 470, 70) + 0.012 * (z - 400)
    return x, y


def radius(theta, z):
    def w(degrees, k):
        return np.exp(k * (np.cos(theta - np.radians(degrees)) - 1))

    r = (34 + 8 * g(z, 0, 45) + 22 * sg(z, 215, 55) + 9 * g(z, 305, 60) - 5 * g(z, 395, 30)
         + 3 * g(z, 450, 35) + 26 * sg(z, 590, 95))
    r = r * (1 + 0.05 * np.cos(2 * (theta - np.radians(80))) * sg(z, 120, 50)
             - 0.04 * np.cos(2 * theta) * g(z, 60, 60))
    for height, degrees, k, c, s in BUMPS:
        r = r + height * w(degrees, k) * g(z, c, s)
    return r + 6 * w(200, 3) * sg(z, 700, 60)


def grid():
    z = np.linspace(0, HEIGHT_MM, ROWS)[:, None]
    theta = np.radians(200 + 5 * np.arange(COLUMNS))[None, :]
    (cx, cy), r = centre(z), radius(theta, z)
    return np.stack([cx + r * np.cos(theta), cy + r * np.sin(theta), z + 0 * theta], axis=-1)


def outside(p):
    cx, cy = centre(p[..., 2])
    x, y = p[..., 0] - cx, p[..., 1] - cy
    return np.hypot(x, y) - radius(np.arctan2(y, x), p[..., 2])


def error(points):
    """Mean relative error in percent and the largest in mm of 251 x 200 points of a surface."""
    foot = points.copy()
    for _ in range(2):
        h = 1e-4
        slope = np.stack([(outside(foot + h * e) - outside(foot - h * e)) / (2 * h)
                          for e in np.eye(3)], axis=-1)
        size = (slope**2).sum(-1)
        far = (outside(foot) + ((points - foot) * slope).sum(-1)) / size
        foot = points - far[..., None] * slope
    distance = np.linalg.norm(points - foot, axis=-1)
    area = np.linalg.norm(np.cross(np.roll(points, -1, axis=1) - points,
                                   np.gradient(points, axis=0)), axis=-1)
    cx, cy = centre(points[..., 2])
    local = np.hypot(points[..., 0] - cx, points[..., 1] - cy)
    return 100 * (area * distance / local).sum() / area.sum(), distance.max()


def kink(at):
    """Largest angle in degrees between the tangents on either side of the seam."""
    worst = 0.0
    for u in np.linspace(0.02, 0.98, 25):
        row = at(np.array([u]), np.array([0, 1e-5, 1 - 1e-5, 1]))[0]
        a, b = row[1] - row[0], row[3] - row[2]
        cosine = a @ b / np.linalg.norm(a) / np.linalg.norm(b)
        worst = max(worst, math.degrees(math.acos(min(1.0, cosine))))
    return worst


def closed(points):
    return np.concatenate([points, points[:, :1]], axis=1)


def chords(points):
    steps = np.linalg.norm(np.diff(points, axis=1), axis=-1)
    return np.concatenate([[0], np.cumsum(steps / steps.sum(1, keepdims=True), axis=1).mean(0)])


def uniform(count):
    return np.concatenate([[0] * 3, np.linspace(0, 1, count - 2), [1] * 3])


def scipy_fit(points, along, around):
    closed_points = closed(points)
    u, v = np.linspace(0, 1, ROWS), chords(closed_points)
    tu, tv = uniform(along), uniform(around)
    rows = make_lsq_spline(u, closed_points, tu, k=3).c
    control = make_lsq_spline(v, rows.transpose(1, 0, 2), tv, k=3).c.transpose(1, 0, 2)

    def at(u, v):
        first = BSpline(tu, control, 3)(u)
        return BSpline(tv, first.transpose(1, 0, 2), 3)(v).transpose(1, 0, 2)

    return at


def geomdl_fit(points, along, around):
    from geomdl import fitting

    flat = closed(points).reshape(-1, 3).tolist()
    surface = fitting.approximate_surface(
        flat, ROWS, COLUMNS + 1, 3, 3, ctrlpts_size_u=along, ctrlpts_size_v=around)
    control = np.array(surface.ctrlpts).reshape(along, around, 3)
    tu, tv = np.array(surface.knotvector_u), np.array(surface.knotvector_v)

    def at(u, v):
        first = BSpline(tu, control, 3)(u)
        return BSpline(tv, first.transpose(1, 0, 2), 3)(v).transpose(1, 0, 2)

    return at


def main():
    points = grid()
    print("| method | control points | mean relative % | largest mm | kink ° | time ms |")
    print("|---|---|---|---|---|---|")
    for name, fit, runs in [("SciPy make_lsq_spline twice", scipy_fit, 200),
                            ("geomdl approximate_surface", geomdl_fit, 1)]:
        for along, around in [(20, 19), (30, 27), (40, 35)]:
            best = math.inf
            for _ in range(runs):
                start = time.perf_counter()
                at = fit(points, along, around)
                best = min(best, time.perf_counter() - start)
            relative, largest = error(at(np.linspace(0, 1, 251), np.arange(200) / 200))
            print(f"| {name} | {along} x {around} | {relative:.4f} | {largest:.3f} "
                  f"| {kink(at):.2f} | {1000 * best:.2f} |", flush=True)


if __name__ == "__main__":
    main()
