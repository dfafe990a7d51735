"""Reads STEP files with OpenCASCADE and prints what it finds, a line each.

    pip install "cadquery-ocp>=8"
    python3 tests/step_read_back.py FILE…

For each file: faces, edges, validity, area, the share of sampled normals that point away from the
middle of their ring (1.000: outward everywhere), and the volume of the solid that the face makes
with a lid on each end (positive: outward). Exit code 1 if a file is not one valid outward face.
"""

import sys

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from OCP.gp import gp_Pnt, gp_Vec

# The default accuracy of the area integral is off by 2e-5.
EPS = 1e-9


def parts(shape, kind):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def outward_share(face):
    """Share of 20 × 36 normals that point away from the mean of their ring of constant u."""
    surface = BRepAdaptor_Surface(face)
    u0, u1 = surface.FirstUParameter(), surface.LastUParameter()
    v0, v1 = surface.FirstVParameter(), surface.LastVParameter()
    outward = 0
    for i in range(20):
        ring = []
        for j in range(36):
            point, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()
            u, v = u0 + (u1 - u0) * i / 19, v0 + (v1 - v0) * j / 36
            surface.D1(u, v, point, du, dv)
            normal = du.Crossed(dv)
            if face.Orientation() == TopAbs_REVERSED:
                normal.Reverse()
            ring.append((gp_Vec(point.XYZ()), normal))
        middle = gp_Vec(0.0, 0.0, 0.0)
        for place, _ in ring:
            middle.Add(place.Multiplied(1 / len(ring)))
        outward += sum(normal.Dot(place.Subtracted(middle)) > 0 for place, normal in ring)
    return outward / (20 * 36)


def lidded_volume(shape, face):
    """Signed volume that the face of a shape encloses with plane lids; None if they do not fit."""
    bounds = ShapeAnalysis_FreeBounds(shape, 1e-3, False, False).GetClosedWires()
    sewing = BRepBuilderAPI_Sewing(1e-3)
    sewing.Add(face)
    for wire in parts(bounds, TopAbs_WIRE):
        lid = BRepBuilderAPI_MakeFace(TopoDS.Wire(wire), True)
        if not lid.IsDone():
            return None
        sewing.Add(lid.Face())
    sewing.Perform()
    if sewing.NbFreeEdges() > 0:
        return None
    shell = sewing.SewedShape()
    # Sewing may turn the shell to agree with a lid: the face's own sense decides.
    tube = max((TopoDS.Face(f) for f in parts(shell, TopAbs_FACE)), key=area)
    turned = (tube.Orientation() == TopAbs_REVERSED) != (face.Orientation() == TopAbs_REVERSED)
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shell, found, EPS)
    return -found.Mass() if turned else found.Mass()


def area(shape):
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, EPS)
    return found.Mass()


def report(path):
    """Prints one line; whether the file holds one valid face that points outward."""
    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone or reader.TransferRoots() == 0:
        print(f"{path}: not read")
        return False
    shape = reader.OneShape()
    faces = [TopoDS.Face(face) for face in parts(shape, TopAbs_FACE)]
    edges = list(parts(shape, TopAbs_EDGE))
    valid = BRepCheck_Analyzer(shape).IsValid()
    print(f"{path}: {len(faces)} face(s), {len(edges)} edges, {'valid' if valid else 'INVALID'}", end="")
    good = valid and len(faces) == 1
    for face in faces:
        sense = "reversed" if face.Orientation() == TopAbs_REVERSED else "forward"
        share, volume = outward_share(face), lidded_volume(shape, face)
        shown = "unknown" if volume is None else f"{volume:.3f} mm3"
        tolerance = max(BRep_Tool.Tolerance_s(TopoDS.Edge(edge)) for edge in edges)
        print(
            f", {sense}, area {area(face):.4f} mm2, outward {share:.3f}, "
            f"volume with lids {shown}, edge tolerance {tolerance:.1e} mm",
            end="",
        )
        good = good and share == 1.0 and (volume is None or volume > 0)
    print()
    return good


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    results = [report(path) for path in sys.argv[1:]]
    sys.exit(0 if all(results) else 1)
