"""Small scenes of our own in the forms of PolyFEM, libuipc and the ppf contact solver."""

import json

import numpy as np

CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
TETRAHEDRA = np.array([[0, 4, 6, 7], [0, 6, 2, 7], [0, 2, 3, 7], [0, 3, 1, 7], [0, 1, 5, 7], [0, 5, 4, 7]])
SQUARE = np.array([[-0.5, 0, -0.5], [0.5, 0, -0.5], [0.5, 0, 0.5], [-0.5, 0, 0.5]])
TRIANGLES = np.array([[0, 2, 1], [0, 3, 2]])


def sheet(n=5):
    """A square grid of n by n points in the x-z plane, with its triangles."""
    line = np.linspace(-0.5, 0.5, n)
    points = np.array([[x, 0.0, z] for x in line for z in line])
    corners = [(i * n + j, i * n + j + 1, (i + 1) * n + j + 1, (i + 1) * n + j) for i in range(n - 1) for j in range(n - 1)]
    return points, np.array([t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))])


# --- PolyFEM


def msh(path, points, cells):
    """MSH 2.2 of tetrahedra."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(points))]
    lines += [f"{k + 1} {p[0]!r} {p[1]!r} {p[2]!r}" for k, p in enumerate(np.asarray(points, float).tolist())]
    lines += ["$EndNodes", "$Elements", str(len(cells))]
    lines += [f"{k + 1} 4 2 0 0 {' '.join(str(c + 1) for c in row)}" for k, row in enumerate(cells)]
    path.write_text("\n".join([*lines, "$EndElements", ""]))
    return path


def obj(path, points, triangles):
    lines = ["v %r %r %r" % tuple(p) for p in np.asarray(points, float).tolist()]
    path.write_text("\n".join([*lines, *("f %d %d %d" % tuple(t + 1) for t in triangles), ""]))
    return path


def polyfem_data():
    """A cube of 0.2 m that falls 5 mm onto a floor."""
    return {
        "geometry": [
            {"mesh": "cube.msh", "transformation": {"translation": [0, 0.105, 0], "scale": 0.2}, "volume_selection": 1},
            {"mesh": "floor.obj", "is_obstacle": True, "surface_selection": 9, "transformation": {"dimensions": [2, 0, 2]}},
        ],
        "contact": {"enabled": True, "dhat": 1e-3, "friction_coefficient": 0.3, "epsv": 2e-3},
        "time": {"dt": 0.01, "tend": 0.2},
        "boundary_conditions": {"rhs": [0, 9.81, 0]},
        "materials": [{"type": "NeoHookean", "id": 1, "E": 1e6, "nu": 0.4, "rho": 1000}],
    }


def polyfem(folder, data=None, name="scene.json"):
    """The scene with its meshes; its path."""
    msh(folder / "cube.msh", CUBE, TETRAHEDRA)
    obj(folder / "floor.obj", SQUARE, TRIANGLES)
    path = folder / name
    path.write_text(json.dumps(data if data is not None else polyfem_data()))
    return path


# --- libuipc


class Saved:
    """A saved scene in the making: attributes are numbered in one list."""

    def __init__(self):
        self.attributes, self.geometries, self.objects = [], [], []

    def collection(self, size=1, **values):
        held = {}
        for name, rows in values.items():
            kind = "string" if isinstance(rows[0], str) else "F64"
            self.attributes.append({"__data__": {"default_value": rows[0], "values": rows}, "__meta__": {"base": "IAttribute", "type": kind}})
            key = name.replace("__", "/")
            held[key] = {"allow_destroy": True, "index": len(self.attributes) - 1, "is_evolving": False, "name": key}
        return {"__data__": held or None, "__meta__": {"size": size, "type": "AttributeCollection"}}

    def add(self, name, kind, **parts):
        """A geometry under an object of this name; parts: collection -> its attributes."""
        data = {part: self.collection(**values) for part, values in parts.items()}
        self.geometries.append({"__data__": data, "__meta__": {"base": "Geometry", "type": kind}})
        number = len(self.geometries) - 1
        self.objects.append({"geometries": [number], "id": number, "name": name})

    def body(self, name, points, uid, *, meta=None, instances=None, vertices=None, **cells):
        points = np.asarray(points, float)
        self.add(
            name,
            "SimplicialComplex",
            meta={"constitution_uid": [uid], "mass_density": [1000.0], "contact_element_id": [0], "self_collision": [1], **(meta or {})},
            instances={"transform": [np.eye(4).tolist()], **(instances or {})},
            vertices={
                "position": columns(points),
                "thickness": [0.0] * len(points),
                "is_fixed": [0] * len(points),
                "velocity": columns(0 * points),
                **(vertices or {}),
            },
            **cells,
        )

    def ground(self, height, element=0):
        self.add("ground", "ImplicitGeometry", meta={"implicit_geometry_uid": [1], "contact_element_id": [element]}, instances={"N": [[[0.0], [1.0], [0.0]]], "P": [[[0.0], [height], [0.0]]], "is_fixed": [1]})

    def write(self, path, friction=((0, 0, 0.2, 1),), **config):
        settings = {"dt": [0.01], "gravity": [[[0.0], [-9.8], [0.0]]], "contact__d_hat": [0.01], "contact__enable": [1], "contact__constitution": ["ipc"], "contact__eps_velocity": [0.01], "contact__friction__enable": [1], "integrator__type": ["bdf1"], "newton__max_iter": [1024]}
        collections = {
            "config": self.collection(**(settings | config)),
            "contact_models": self.collection(
                len(friction),
                topo=[[[a], [b]] for a, b, _, _ in friction],
                friction_rate=[rate for _, _, rate, _ in friction],
                is_enabled=[on for _, _, _, on in friction],
                resistance=[1e9] * len(friction),
            ),
            "subscene_models": self.collection(topo=[[[0], [0]]], is_enabled=[1]),
        }
        slots = [{"id": k, "index": k} for k in range(len(self.geometries))]
        atlas = {"attribute_collections": collections, "attributes": self.attributes, "geometries": self.geometries}
        data = {
            "contact_tabular": {"contact_elements": [{"id": 0, "name": "default"}]},
            "geometry_atlas": {"__data__": atlas, "__meta__": {"type": "GeometryAtlas"}},
            "geometry_slots": slots,
            "object_collection": {"next_id": len(slots), "objects": self.objects},
            "subscene_tabular": {"subscene_elements": [{"id": 0, "name": "default"}]},
        }
        path.write_text(json.dumps({"__meta__": {"type": "SceneSnapshot"}, "__data__": data}))
        return path


def columns(rows):
    """Vectors as libuipc writes them."""
    return np.asarray(rows)[..., None].tolist()


def libuipc(folder, **config):
    """A cube of 0.2 m that falls onto the ground."""
    saved = Saved()
    saved.body("cube", 0.2 * CUBE + [0, 0.12, 0], 10, tetrahedra={"topo": columns(TETRAHEDRA), "mu": [4e5] * 6, "lambda": [1.4e6] * 6})
    saved.ground(0.0)
    return saved.write(folder / "saved.json", **config)


# --- ppf


PARAM = """[param]
dt = 0.01
frames = 12
fps = 60.0
barrier = "cubic"
friction_mode = "max"
gravity = [0.0, -9.8, 0.0]
disable_contact = false
world_scaling = 1.0
cg_tol = 0.001
"""


def ppf(folder, more_info="", more_param="", pins=(), wall=True, **parameters):
    """A sheet that falls onto a wall. pins: (vertices, text of the operations, rows of each)."""
    points, triangles = sheet()
    (folder / "bin/param").mkdir(parents=True)
    n, m = len(points), len(triangles)

    def array(name, rows, kind):
        np.asarray(rows, kind).tofile(folder / "bin" / f"{name}.bin")

    array("displacement", [[0, 0.02, 0]], "<f8")
    array("vert_dmap", [0] * n, "<u4")
    array("vert", points, "<f8")
    array("vel", 0 * points, "<f4")
    array("tri", triangles, "<u8")
    usual = {"model": 2, "young-mod": 1000.0, "density": 0.5, "poiss-rat": 0.3, "bend": 1.0, "contact-gap": 2e-3, "contact-offset": 0.0, "friction": 0.4, "strain-limit": 0.0}
    for name, value in (usual | {key.replace("_", "-"): value for key, value in parameters.items()}).items():
        array(f"param/tri-{name}", [value] * m if np.isscalar(value) else value, "u1" if name == "model" else "<f4")
    counts = {"vert": n, "rod": 0, "tri": m, "tet": 0, "static_vert": 0, "static_tri": 0, "pin_block": len(pins), "wall": int(wall), "sphere": 0, "stitch": 0, "shell_count": m}
    info = "[count]\n" + "".join(f"{key} = {value}\n" for key, value in counts.items())
    for k, (vertices, text, rows) in enumerate(pins):
        array(f"pin-ind-{k}", vertices, "<u8")
        info += f"[pin-{k}]\noperation_count = {len(rows)}\npin = {len(vertices)}\npull = 0.0\n" + text
        for j, row in enumerate(rows):
            if row is not None:
                array(f"pin-{k}-op-{j}", row, "<f8")
    if wall:
        info += '[wall-0]\nkeyframe = 1\nnx = 0.0\nny = 1.0\nnz = 0.0\ntransition = "linear"\nfriction = 0.1\ncontact-gap = 0.001\n'
        array("wall-pos-0", [[0, 0, 0]], "<f8")
        array("wall-timing-0", [0], "<f8")
    (folder / "info.toml").write_text(info + more_info)
    (folder / "param.toml").write_text(PARAM + more_param)
    return folder
