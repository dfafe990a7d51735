"""Girths of both legs from one body scan with trimesh, as one writes it in ten minutes.

    python3 benches/peer/crude_slices.py SCAN.obj

Loads an OBJ with y up, in mm, parts the legs at the middle between them, slices each every 5 mm and takes
the perimeter of each slice's convex hull. No unit, no facing, no axis, no smoothing, no levels. Prints the
seconds that loading and slicing take, without those for starting Python and importing, as JSON.
"""

import json
import sys
import time

import numpy as np
import trimesh
from scipy.spatial import ConvexHull
from trimesh.intersections import mesh_multiplane

SPACING_MM = 5.0
CROTCH_SHARE = 0.47


def girths(mesh, side, top):
    """The tape girth every 5 mm of the leg on one side (±1) of the middle, below `top`."""
    middles = mesh.triangles_center
    mine = (np.sign(middles[:, 0] - mesh.vertices[:, 0].mean()) == side) & (middles[:, 1] < top)
    leg = mesh.submesh([mine], append=True)
    heights = np.arange(leg.bounds[0][1] + 60.0, top - 20.0, SPACING_MM)
    cuts, _, _ = mesh_multiplane(leg, [0, 0, 0], [0, 1, 0], heights)
    return [ConvexHull(cut.reshape(-1, 2)).area for cut in cuts if len(cut) > 8]


def main(path):
    began = time.perf_counter()
    mesh = trimesh.load_mesh(path, process=False, skip_materials=True)
    loaded = time.perf_counter()
    top = mesh.bounds[0][1] + CROTCH_SHARE * (mesh.bounds[1][1] - mesh.bounds[0][1])
    legs = [girths(mesh, side, top) for side in (-1, 1)]
    done = time.perf_counter()
    figures = {"load_s": loaded - began, "extract_s": done - loaded, "sections": [len(leg) for leg in legs]}
    json.dump(figures, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1])
