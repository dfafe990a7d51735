"""Reads CAD files and meshes with OpenCASCADE and trimesh and compares them with their figures.

    pip install cadquery-ocp trimesh numpy
    cargo run --release --example cad_files -- fixtures/scans/f_average_clean.obj.gz FOLDER
    python3 tests/cad_read_back.py FOLDER

FOLDER holds the files and `figures.json` beside them. What must hold:

    STEP, IGES    the knots and control points of our surface, as they were written
    STEP, tube    one B-spline face, valid, of our area; its normals outward: with lids on its ends
                  it encloses our volume, counted positive; nothing in the file is unresolved
    STEP, solid   one solid of three faces, valid, of our volume, counted positive
    IGES, tube    one B-spline face, valid, of our area (it has no outside)
    IGES, solid   one solid of three faces, valid, of our volume, counted positive
    STL, OBJ, GLB the area, less what chords cut off; outward; closed where it is a solid, with two
                  rims where it is a tube; GLB in metres with y up

Exit code 1 if one of them does not hold; a line for each file.
"""

import json
import math
import sys
from pathlib import Path

import numpy
import trimesh
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_BSplineSurface, GeomAbs_Plane
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_SOLID, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

# The default accuracy of the integrals is off by 2e-5.
EPS = 1e-9

# How far an exact file's knots and control points may lie from ours, mm: the last digit of a leg's
# coordinates as a 64-bit number, after the reader's own arithmetic.
SAME = 1e-9

# How far an exact file's area and volume may lie from ours, as a share.
EXACT = 1e-6

# How far a mesh's may. Chords of an arc of radius r cut off tolerance / r; legs are 25 mm and more.
MESH = 4e-3


def parts(shape, kind):
    """The parts of a kind, those that several others share once."""
    explorer, seen = TopExp_Explorer(shape, kind), []
    while explorer.More():
        part = explorer.Current()
        if not any(part.IsSame(other) for other in seen):
            seen.append(part)
        explorer.Next()
    return seen


def area(shape):
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, EPS)
    return found.Mass()


def volume(shape):
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, EPS)
    return found.Mass()


def lidded_volume(shape, face):
    """Signed volume that the face of a shape encloses with plane lids."""
    bounds = ShapeAnalysis_FreeBounds(shape, 1e-3, False, False).GetClosedWires()
    sewing = BRepBuilderAPI_Sewing(1e-3)
    sewing.Add(face)
    for wire in parts(bounds, TopAbs_WIRE):
        lid = BRepBuilderAPI_MakeFace(TopoDS.Wire(wire), True)
        if not lid.IsDone():
            return math.nan
        sewing.Add(lid.Face())
    sewing.Perform()
    if sewing.NbFreeEdges() > 0:
        return math.nan
    shell = sewing.SewedShape()
    # Sewing may turn the shell to agree with a lid: the face's own sense decides.
    tube = max((TopoDS.Face(f) for f in parts(shell, TopAbs_FACE)), key=area)
    turned = (tube.Orientation() == TopAbs_REVERSED) != (face.Orientation() == TopAbs_REVERSED)
    return -volume(shell) if turned else volume(shell)


def is_ours(face, figures):
    """Whether a face has the knots and control points of our surface. A file may swap u and v, so that
    the normal points outwards."""
    spline = BRepAdaptor_Surface(face).BSpline().Copy()
    # The reader makes a closed tube periodic.
    spline.SetUNotPeriodic()
    spline.SetVNotPeriodic()
    rows, columns = range(1, spline.NbUPoles() + 1), range(1, spline.NbVPoles() + 1)
    net = numpy.array([[spline.Pole(i, j).Coord() for j in columns] for i in rows])
    sequences = spline.UKnotSequence(), spline.VKnotSequence()
    u, v = (numpy.array([k.Value(i) for i in range(k.Lower(), k.Upper() + 1)]) for k in sequences)
    along, around = (numpy.array(knots) for knots in figures["knots"])
    ours = numpy.array(figures["net_mm"])

    def same(found, expected):
        return found.shape == expected.shape and abs(found - expected).max() <= SAME

    def same_knots(found, expected):
        # The first and the last knot have no influence, and after being periodic they are others.
        return same(found[1:-1], expected[1:-1])

    for u, v, net in ((u, v, net), (v, u, net.swapaxes(0, 1))):
        if same_knots(u, along) and same_knots(v, around) and same(net.reshape(-1, 3), ours):
            return True
    return False


def kind(face):
    return BRepAdaptor_Surface(face).GetType()


def read(path, faults):
    """The shape in a STEP or IGES file."""
    reader = STEPControl_Reader() if path.suffix == ".step" else IGESControl_Reader()
    faults.require(reader.ReadFile(str(path)) == IFSelect_RetDone, "not read")
    # Syntax, references that lead nowhere, values out of range.
    checks = reader.WS().ModelCheckList(False)
    faults.require(checks.IsEmpty(False), "the reader's own check has something to say")
    roots = reader.TransferRoots()
    faults.require(roots == 1, f"{roots} roots, not 1")
    return reader.OneShape()


class Faults(list):
    def require(self, holds, what):
        if not holds:
            self.append(what)

    def close(self, what, found, expected, share):
        error = found / expected - 1
        self.require(abs(error) <= share, f"{what} {found:.3f} where it is {expected:.3f}")
        return f"{what} {error:+.1e}"


def brep(path, figures, solid):
    faults = Faults()
    shape = read(path, faults)
    if shape is None or shape.IsNull():
        return ["nothing"], faults
    faces = [TopoDS.Face(face) for face in parts(shape, TopAbs_FACE)]
    solids = parts(shape, TopAbs_SOLID)
    edges = [TopoDS.Edge(edge) for edge in parts(shape, TopAbs_EDGE)]
    faults.require(BRepCheck_Analyzer(shape).IsValid(), "not valid")
    tubes = [face for face in faces if kind(face) == GeomAbs_BSplineSurface]
    faults.require(len(tubes) == 1, f"{len(tubes)} B-spline faces, not 1")
    planes = sum(kind(face) == GeomAbs_Plane for face in faces)
    faults.require(planes == len(faces) - 1 == (2 if solid else 0), f"{planes} planes")
    faults.require(len(solids) == int(solid), f"{len(solids)} solids")
    if len(tubes) != 1 or len(solids) != int(solid):
        return ["not what it should hold"], faults
    faults.require(is_ours(tubes[0], figures), "not our knots and control points")
    tolerance = max(BRep_Tool.Tolerance_s(edge) for edge in edges)
    faults.require(tolerance < 1e-3, f"edges lie {tolerance:.1e} mm off")
    said = [f"{len(faces)} face(s), {len(edges)} edges within {tolerance:.0e} mm"]
    said.append(faults.close("area", area(tubes[0]), figures["area_mm2"], EXACT))
    if solid:
        said.append(faults.close("volume", volume(solids[0]), figures["volume_mm3"], EXACT))
    elif path.suffix == ".step":
        enclosed = lidded_volume(shape, tubes[0])
        said.append(faults.close("volume", enclosed, figures["volume_mm3"], EXACT))
    return said, faults


def mesh(path, figures, solid):
    faults = Faults()
    mesh = trimesh.load(path, process=False)
    if isinstance(mesh, trimesh.Scene):
        (mesh,) = mesh.geometry.values()
    triangles, normals = mesh.triangles, None
    if path.suffix == ".glb":
        # Back from metres with y up.
        triangles = triangles[:, :, [0, 2, 1]] * [1000.0, -1000.0, 1000.0]
        normals = mesh.vertex_normals[mesh.faces][:, :, [0, 2, 1]] * [1.0, -1.0, 1.0]
    points, places = numpy.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    merged = trimesh.Trimesh(points, places.reshape(-1, 3), process=False)
    faults.require(merged.is_winding_consistent, "the triangles turn both ways")
    faults.require(merged.is_watertight == solid, f"watertight: {merged.is_watertight}")
    # A ball has 2, a tube 0.
    euler = merged.euler_number
    faults.require(euler == (2 if solid else 0), f"Euler's number is {euler}")
    if normals is not None:
        off = (normals * merged.face_normals[:, None]).sum(axis=2).min()
        faults.require(off > 0.99, f"a normal is turned off its triangle, cosine {off:.3f}")
    said = [f"{len(merged.faces)} triangles"]
    if solid:
        said.append(faults.close("volume", merged.volume, figures["volume_mm3"], MESH))
    else:
        said.append(faults.close("area", merged.area, figures["area_mm2"], MESH))
        # A tube encloses something only as seen from a place; from its own middle it is positive.
        centred = merged.copy()
        centred.apply_translation(-merged.triangles_center.mean(axis=0))
        faults.require(centred.volume > 0, "turned inside out")
    return said, faults


def main(folder):
    figures = json.loads((folder / "figures.json").read_text())
    bad = 0
    for leg in figures.values():
        for word, name in leg["files"].items():
            check = brep if word.startswith(("step", "iges")) else mesh
            said, faults = check(folder / name, leg, word.endswith("-solid"))
            print(f"{name}: {', '.join(said)}", *[f"  WRONG: {fault}" for fault in faults], sep="\n", flush=True)
            bad += bool(faults)
    print(f"{sum(len(leg['files']) for leg in figures.values())} files, {bad} wrong")
    return bad


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(1 if main(Path(sys.argv[1])) else 0)
