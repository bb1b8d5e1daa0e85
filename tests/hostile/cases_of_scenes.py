"""Meshes, and scenes that config and files show to be wrong."""

from tests.hostile.case import DONE, check, mesh, refused_run
from tests.hostile.files import (
    FACES, POINTS, SQUARE, TRIANGLE_BYTES, VERTICES, binary_ply, binary_points, binary_stl, bodies, body, config, grid, one_mesh,
    ply)

# --- meshes

FAR = "v 0 0 0\nv %s 0 0\nv 0 1 0\nf 1 2 3\n"
MSH = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 0 1 2 %s\n$EndElements\n"
VTU = (
    '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1"><Points><DataArray type="Float64" '
    'NumberOfComponents="3">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells><DataArray type="Int64" Name="connectivity">0 1 2</DataArray>'
    '<DataArray type="Int64" Name="offsets">3</DataArray><DataArray type="UInt8" Name="types">5</DataArray></Cells></Piece>'
    "</UnstructuredGrid></VTKFile>"
)
MESHES = [
    mesh("ply-10-18-without-properties", "m.ply", ply([VERTICES, ("mystery", 10**18, [])], POINTS), "10"),
    mesh("ply-10-18-binary-without-properties", "m.ply", binary_ply([VERTICES, FACES, ("mystery", 10**18, [])], TRIANGLE_BYTES),
         "without a property"),
    mesh("ply-10-18-empty-lists", "m.ply", binary_ply([VERTICES, ("mystery", 10**18, ["list uchar int x"])], TRIANGLE_BYTES),
         "1000000000000000000 mystery"),
    mesh("ply-10-18-vertices", "m.ply", ply([("vertex", 10**18, VERTICES[2])], POINTS), "1000000000000000000 vertex"),
    mesh("ply-10-18-faces", "m.ply", binary_ply([VERTICES, ("face", 10**18, FACES[2])], TRIANGLE_BYTES), "1000000000000000000 face"),
    mesh("ply-count-10-19", "m.ply", ply([("vertex", 10**19, VERTICES[2])], POINTS), "m.ply:3"),
    mesh("ply-count-negative", "m.ply", ply([("vertex", -1, VERTICES[2])], POINTS), "m.ply:3"),
    mesh("ply-one-vertex-more", "m.ply", binary_ply([("vertex", 4, VERTICES[2])], TRIANGLE_BYTES[:72]), "4 vertex"),
    mesh("ply-list-of-4-billion", "m.ply", binary_ply([VERTICES, ("face", 1, ["list uint int vertex_indices"])],
                                                      TRIANGLE_BYTES[:72] + b"\xff\xff\xff\xff"), "face 0"),
    mesh("ply-list-negative", "m.ply", binary_ply([VERTICES, ("face", 1, ["list char int vertex_indices"])], TRIANGLE_BYTES[:72] + b"\xff"),
         "a list of -1"),
    mesh("ply-data-behind", "m.ply", ply([VERTICES, FACES], POINTS + "3 0 1 2\n0 0 9\n"), "behind the last element"),
    mesh("ply-data-behind-binary", "m.ply", binary_ply([VERTICES, FACES], TRIANGLE_BYTES + b"\0"), "1 bytes behind"),
    mesh("ply-property-twice", "m.ply", ply([("vertex", 3, ["double x", "double y", "double z", "double x"]), FACES], POINTS), "x twice"),
    mesh("ply-corners-twice", "m.ply", ply([VERTICES, ("face", 1, [*FACES[2], "list uchar int vertex_index"])], POINTS), "twice"),
    mesh("ply-element-twice", "m.ply", ply([VERTICES, VERTICES], POINTS * 2), "vertex twice"),
    mesh("ply-format-twice", "m.ply", b"ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n", "m.ply:3"),
    mesh("ply-version", "m.ply", ply([VERTICES, FACES], POINTS, version="9.9"), "m.ply:2"),
    mesh("ply-property-list-of-floats", "m.ply", ply([VERTICES, ("face", 1, ["list float int vertex_indices"])], POINTS), "m.ply:"),
    mesh("ply-a-million-properties", "m.ply", ply([("vertex", 1, [f"char p{i}" for i in range(300_000)])]), "at most 1000"),
    mesh("ply-no-end-of-header", "m.ply", b"ply\nformat ascii 1.0\n" + b"comment x\n" * 100_000, "end_header"),
    mesh("ply-empty", "m.ply", b"", "m.ply"),
    mesh("ply-zero-bytes", "m.ply", bytes(100_000), "m.ply:1"),
    mesh("ply-x-is-a-list", "m.ply", ply([("vertex", 1, ["list uchar double x", "double y", "double z"])], "1 0 0 0\n"), "property x"),
    mesh("ply-index-negative", "m.ply", binary_ply([VERTICES, FACES], TRIANGLE_BYTES[:-4] + b"\xff\xff\xff\xff"), "vertex -1"),
    mesh("ply-infinite", "m.ply", binary_ply([VERTICES, FACES], binary_points(0, 0, float("inf")) + TRIANGLE_BYTES[24:]), "vertex 0"),
    mesh("stl-4-billion-triangles", "m.stl", binary_stl(0xFFFFFFFF, 50), "m.stl"),
    mesh("stl-cut", "m.stl", binary_stl(2, 99), "m.stl"),
    mesh("stl-behind-endsolid", "m.stl", "solid a\nendsolid a\nfacet normal 0 0 1\n", "behind endsolid"),
    mesh("stl-four-numbers", "m.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0 0\n", "m.stl:4"),
    mesh("stl-large", "m.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e200 0 0\nvertex 0 1e200 0\nendloop\nendfacet\n"
         "endsolid a\n", "1e+15"),
    mesh("obj-zero-bytes", "m.obj", bytes(100_000), "m.obj"),
    mesh("obj-index-2-63", "m.obj", SQUARE + f"f 1 2 {2**63}\n", "m.obj:7"),
    mesh("obj-index-minus-2-63", "m.obj", SQUARE + f"f 1 2 {-2**63}\n", "m.obj:7"),
    mesh("obj-one-long-line", "m.obj", "v" + " 1" * 1_000_000, "without mass"),
    mesh("obj-a-face-of-a-million", "m.obj", SQUARE + "f" + " 1" * 1_000_000, "m.obj:7"),
    mesh("obj-coordinate-1e154", "m.obj", FAR % "1e154", "m.obj:2", "1e+15"),
    mesh("obj-coordinate-1e78", "m.obj", FAR % "-1e78", "m.obj:2", "1e+15"),
    mesh("obj-coordinate-1e308", "m.obj", FAR % "1e308", "m.obj:2"),
    mesh("obj-coordinate-1e309", "m.obj", FAR % "1e309", "m.obj:2"),
    mesh("obj-coordinate-denormal", "m.obj", "v 0 0 0\nv 1e-310 0 0\nv 0 1e-310 0\nf 1 2 3\n", "m.obj:4"),
    mesh("extension", "m.xyz", SQUARE, "m.xyz"),
    mesh("msh-number-2e9-without-node", "m.msh", MSH % "2000000000", "m.msh: element 1", "node 2000000000"),
    mesh("msh-10-12-nodes", "m.msh", (MSH % 3).replace("$Nodes\n3", "$Nodes\n1000000000000"), "1000000000000 things"),
    mesh("vtu-10-12-points", "m.vtu", VTU.replace('Points="3"', 'Points="1000000000000"'), "9 numbers"),
    mesh("vtu-10-12-cells", "m.vtu", VTU.replace('Cells="1"', 'Cells="1000000000000"'), "1 numbers"),
    mesh("vtu-type-200", "m.vtu", VTU.replace("5</DataArray>", "200</DataArray>"), "cell 0", "type 200"),
    mesh("vtu-entities", "m.vtu", '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><VTKFile>&x;</VTKFile>', "m.vtu"),
    mesh("vtk-10-9-corners", "m.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOLYGONS 1 1000000000\n", "1000000000 things"),
    mesh("obj-word", "m.obj", SQUARE + "q 1 2 3\n", "m.obj:7", '"q"'),
    mesh("ply-empty-lines", "m.ply", ply([VERTICES, FACES], "\n" * 1_000_000), "m.ply"),
]

# --- scenes that config and files show to be wrong: `run` and `check` alike

RIGID_FAR = body(grid(), name="plate", kind="rigid", transform={"translate_m": [0, 0, -1]})


def with_obstacle(kind: str, **more) -> dict:
    """A cloth at z = 0 and one obstacle."""
    return config({"bodies": [body(grid())], "obstacles": [{"name": "thing", "kind": kind, "point_m": [0, 0, -1], **more}]})


def moved(**motion) -> dict:
    """A cloth above a driven plate."""
    return bodies(body(grid()), {**RIGID_FAR, "motion": motion})


HUGE_OR_TINY = {  # what the scene holds, and the place of the number
    "translate": (bodies(body(grid(), transform={"translate_m": [0, 0, 1e16]})), "transform/translate_m/2: found 1e+16; allowed: a number >= -1e+15 and <= 1e+15 (m)"),
    "scale": (bodies(body(grid(), transform={"scale": 5e-324})), "transform/scale: found 5e-324; allowed: a number >= 1e-36 and <= 1e+18"),
    "velocity": (bodies(body(grid(), velocity_m_per_s=[0, -1e308, 0])), "velocity_m_per_s/1: found -1e+308"),
    "density": (bodies(body(grid(), material={"density_kg_per_m2": 1e308})), "density_kg_per_m2: found 1e+308"),
    "density-denormal": (bodies(body(grid(), material={"density_kg_per_m2": 1e-310})), "density_kg_per_m2: found 1e-310; allowed: 0, or a number >= 1e-36 and <= 1e+18 (kg/m^2)"),
    "youngs": (bodies(body(grid(), material={"youngs_N_per_m": 1e308})), "youngs_N_per_m: found 1e+308"),
    "bending": (bodies(body(grid(), material={"bending_J": 1e300})), "bending_J: found 1e+300"),
    "offset": (bodies(body(grid(), offset_m=1e308)), "offset_m: found 1e+308"),
    "d-hat-of-a-body": (bodies(body(grid(), d_hat_m=1e-300)), "d_hat_m: found 1e-300"),
    "gravity": (config({"bodies": [body(grid())], "gravity_m_per_s2": [0, 0, -1e308]}), "gravity_m_per_s2/2: found -1e+308"),
    "radius": (with_obstacle("sphere", radius_m=1e200), "radius_m: found 1e+200"),
    "pull": (bodies(body(grid(), pins=[{"indices": [0], "pull_N_per_m": 1e308}])), "pull_N_per_m: found 1e+308"),
    "hold": (bodies(body(grid(), pins=[{"indices": [0], "hold_s": 1e308}])), "hold_s: found 1e+308"),
    "turning": (moved(angular_velocity_rad_per_s=1e300), "angular_velocity_rad_per_s: found 1e+300"),
    "wind": (config({"bodies": [body(grid())], "air": {"normal_N_s_per_m3": 1, "wind_m_per_s": [1e300, 0, 0]}}), "wind_m_per_s/0: found 1e+300"),
    "grid": (bodies(body(grid(size_x_m=1e308))), "size_x_m: found 1e+308"),
}
EMPTY_LISTS = {
    "keyframes": (moved(keyframes=[]), "motion/keyframes: found []; allowed: an array of at least 1 and at most 10000 elements"),
    "then": (moved(velocity_m_per_s=[0, 0, 1], then=[]), "motion/then: found []"),
    "keyframes-of-a-pin": (bodies(body(grid(), pins=[{"indices": [0], "motion": {"keyframes": []}}])), "pins/0/motion/keyframes: found []"),
    "keyframes-in-then": (moved(velocity_m_per_s=[0, 0, 1], then=[{"keyframes": []}]), "motion/then/0/keyframes: found []; allowed: an array of at least 1 and at most 10000 elements"),
    "wind-schedule": (config({"bodies": [body(grid())], "air": {"normal_N_s_per_m3": 1, "wind_schedule": []}}), "/scene/air/wind_schedule: found []; allowed: an array of at least 1 and at most 10000 elements"),
    "pressure-schedule": (bodies(body(grid(), pressure_schedule=[])), "pressure_schedule: found []"),
    "gravity-schedule": (config({"bodies": [body(grid())], "gravity_schedule": []}), "gravity_schedule: found []"),
    "pull-factors": (bodies(body(grid(), pins=[{"indices": [0], "pull_N_per_m": 1, "pull_factors": []}])), "pull_factors: found []"),
    "shrink-schedule": (bodies(body(grid(), material={"shrink_schedule": []})), "shrink_schedule: found []"),
}
CONTROL = "a\x1b[31m"
CONTROL_CHARACTERS = {
    "body": (bodies(body(grid(), name=CONTROL)), "/scene/bodies/0/name: found \"a\\u001b[31m\"; allowed: a string that is not empty, without control characters"),
    "body-nul": (bodies(body(grid(), name="a\0b")), "/scene/bodies/0/name: found \"a\\u0000b\""),
    "body-c1": (bodies(body(grid(), name="a\u009bb")), "/scene/bodies/0/name"),
    "obstacle": (config({"bodies": [body(grid())], "obstacles": [{"name": CONTROL, "kind": "plane"}]}), "/scene/obstacles/0/name"),
    "group": (bodies(body(grid(), collision_group=CONTROL)), "/scene/bodies/0/collision_group"),
    "file": (one_mesh(CONTROL + ".ply"), "/scene/bodies/0/mesh/file"),
    "config": ({**bodies(body(grid())), "name": CONTROL}, "#/name"),
    "doc": ({**bodies(body(grid())), "doc": CONTROL}, "#/doc"),
    "key": ({**bodies(body(grid())), CONTROL: 1}, "a\\x1b[31m"),
}

WRONG_SCENES = {
    "model": (bodies(body(grid(), material={"model": "corotationl"})), "corotationl"),
    "mesh": ({**one_mesh("m.obj")}, "m.obj:4"),
    "pin": (bodies(body(grid(), pins=[{"indices": [9]}])), "vertex 9"),
    "empty-pin": (bodies(body(grid(), pins=[{"box_m": [[5, 5, 5], [6, 6, 6]]}])), "no vertex selected"),
    "pin-box-inverted": (bodies(body(grid(), pins=[{"box_m": [[-5, 5, -5], [5, -5, 5]]}])), "/scene/bodies/0/pins/0/box_m: found an inverted box: along y its min 5 is above its max -5"),
    "sphere-of-radius-0": (with_obstacle("sphere", radius_m=0), "/scene/obstacles/0/radius_m: found 0"),
    "sphere-of-radius-minus-1": (with_obstacle("sphere", radius_m=-1), "/scene/obstacles/0/radius_m: found -1"),
    "cylinder-without-radius": (with_obstacle("cylinder", axis=[0, 0, 1]), "/scene/obstacles/0/radius_m"),
    "density": (bodies(body(grid(), material={"density_kg_per_m2": 0})), "without mass"),
    "all-pinned": (bodies(body(grid(), pins=[{"all": True}])), "no free vertex"),
    "no-body": (bodies(), "at least one body"),
    "name-twice": (bodies(body(grid()), body(grid())), "cloth"),
    "grid-20000": (bodies(body(grid(n_x=20000, n_y=20000))), "GiB"),
    "cylinder-20000": (bodies(body({"generator": "cylinder", "n_around": 20000, "n_along": 20000})), "GiB"),
    "drape-of-100-layers": (config({"name": "drape", "n": 1000, "layers": 100}), "GiB"),
    "scaled-far": (bodies(body(grid(), transform={"scale": 1e17})), "1e+15"),
    "moved-far": (bodies(body(grid(), transform={"translate_m": [1e155, 0, 0]})), "1e+15"),
    "plate-driven-far": (bodies(body(grid()), {**RIGID_FAR, "motion": {"velocity_m_per_s": [1e12, 0, 0]}}) | {"time": {"dt_s": 1e6, "steps": 1}}, "driven too far"),
    "plate-vanishes": (bodies(body(grid()), {**RIGID_FAR, "transform": {"scale": 1e17, "translate_m": [0, 0, -1]}}), "1e+15"),
    "obstacle-far": (config({"bodies": [body(grid())], "obstacles": [{"name": "o", "kind": "plane", "point_m": [0, 0, -1e155]}]}), "1e+15"),
    "jitter-far": ({**bodies(body(grid())), "seeds": {"jitter_m": 1e200}}, "1e+15"),
    "zero-size": (bodies(body(grid(size_x_m=0))), "size_x_m"),
    "planar-bending": (bodies(body(grid(), material={"bending_J": 1}), planar=True), "planar"),
}
SCENE_CASES = [
    make(name, content, says, files={"m.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"} if name == "mesh" else {})
    for name, (content, says) in WRONG_SCENES.items() for make in (check, refused_run)
]
SCENE_CASES += [check(f"{kind}-{name}", content, says) for kind, table in (("size", HUGE_OR_TINY), ("empty", EMPTY_LISTS), ("control", CONTROL_CHARACTERS))
                for name, (content, says) in table.items()]
SCENE_CASES += [  # a direction may have any size
    check(f"axis-{size}", config({"bodies": [body(grid(), transform={"axis": [0, 0, size], "angle_deg": 30, "translate_m": [0, 0, 1]})],
                                  "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, size]}]}), code=DONE) for size in (1e-200, 5e-324, 1e200, 1e308)
]
SCENE_CASES += [
    check("bowl-smaller-than-what-is-in-it", with_obstacle("sphere", radius_m=0.2, inside=True), 'body "cloth" inside obstacle "thing"', "found 1.41421 m across", "less than 0.4 m"),
    check("obstacle-that-touches-at-the-start", with_obstacle("sphere", radius_m=1.0), "obstacle_triangle: thing, cloth[0]", "gap 0 m"),
    check("plane-that-touches-at-the-start", config({"bodies": [body(grid())], "obstacles": [{"name": "floor", "kind": "plane", "point_m": [0, 0, 0]}]}),
          "obstacle: floor", "gap 0 m"),
    check("rod-that-branches", one_mesh("m.obj", material={"line_density_kg_per_m": 0.1, "rod_bending_N_m2": 1}), 'body "cloth"/material/rod_bending_N_m2',
          "vertex 1 in 3 lone edges", "at most 2", files={"m.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1 1 0\nl 1 2 3\nl 2 4\n"}),
    check("rod-that-folds-back", one_mesh("m.obj", material={"line_density_kg_per_m": 0.1, "rod_bending_N_m2": 1}), "folds back at vertex 1",
          files={"m.obj": "v 0 0 0\nv 1 0 0\nv 0.5 0 0\nl 1 2 3\n"}),
    check("ten-thousand-and-one-bodies", bodies(*[body(grid(), name=f"b{i}") for i in range(10_001)]), "at most 10000"),
    check("formulation-upwards", {**bodies(body(grid())), "formulation": {
        "name": "../../up", "shape": "log", "argument": "gap", "stiffness_policy": {"name": "fixed"}, "d_hat_m": 0.01}}, "/formulation/name"),
    check("formulation-a-name-alone", {**bodies(body(grid())), "formulation": {"name": "mine", "shape": "log", "d_hat_m": 0.01}}, "/formulation/name: found \"mine\"", "one of ",
          "or any name beside shape, argument and stiffness_policy (missing: argument, stiffness_policy)"),
    check("formulation-a-path", {**bodies(body(grid())), "formulation": {"name": "a/b", "d_hat_m": 0.01}}, "/formulation/name"),
    check("formulation-of-300", {**bodies(body(grid())), "formulation": {
        "name": "n" * 300, "shape": "log", "argument": "gap", "stiffness_policy": {"name": "fixed"}, "d_hat_m": 0.01}}, "150 bytes"),
    check("mesh-and-hash", one_mesh("m.obj"), "sha256", files={"a.json": bodies(body({"file": "m.obj", "sha256": "0" * 64})), "m.obj": SQUARE}),
]
