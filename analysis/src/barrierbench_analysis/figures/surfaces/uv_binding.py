"""A mesh bound by its texture coordinates: each vertex is where the surface of a body has the same ones."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.mesh_arrays import MeshArrays, read_frame_file

from .binding import Binding, Fit
from .obstacle_rays import triangle_distances
from .sequence import Run

ROOM = 1e-9  # of a weight: how far beside a triangle a coordinate still is on it


def uv_of_vertices(cells: MeshArrays, file: Path) -> np.ndarray:
    """[n, 2]: of every vertex the coordinates that its first corner has. Errors: UserError for a vertex
    without.
    """
    has = cells.corner_uvs >= 0
    of, first = np.unique(cells.corners[has], return_index=True)
    none = np.setdiff1d(np.arange(len(cells.points)), of)
    if len(none):
        raise UserError(
            f"{file}: vertex {none[0]} has no texture coordinates; allowed: an OBJ file whose faces give"
            " every vertex some (f v/vt)"
        )
    return cells.uvs[cells.corner_uvs[has][first]]


def uv_of_triangles(cells: MeshArrays, triangles: np.ndarray) -> np.ndarray:
    """[m, 3, 2] of triangles [m, 3] that the faces of the file are cut into; nan where a face has none."""
    starts = np.concatenate([[0], np.cumsum(cells.sizes)])
    of_face = np.repeat(np.arange(len(cells.sizes)), cells.sizes)
    faces: dict[int, set[int]] = {}
    for vertex, face in zip(cells.corners.tolist(), of_face.tolist()):
        faces.setdefault(vertex, set()).add(face)
    out = np.full((len(triangles), 3, 2), np.nan)
    for t, corners in enumerate(triangles.tolist()):
        whole = set.intersection(*(faces.get(v, set()) for v in corners))
        if not whole:
            continue
        face = min(whole)
        own = cells.corners[starts[face] : starts[face + 1]].tolist()
        uvs = cells.corner_uvs[starts[face] : starts[face + 1]]
        for k, vertex in enumerate(corners):
            number = uvs[own.index(vertex)]
            if number >= 0:
                out[t, k] = cells.uvs[number]
    return out


def _weights(uv: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """[k, 3] of points [k, 2] in triangles [k, 3, 2]; nan in those without area."""
    a, b, c = corners.transpose(1, 0, 2)

    def area(p, q, r):
        return (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])

    with np.errstate(invalid="ignore", divide="ignore"):
        return np.stack([area(uv, b, c), area(a, uv, c), area(a, b, uv)], axis=1) / area(a, b, c)[:, None]


def located(
    uv: np.ndarray, uv_triangles: np.ndarray, points: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Of coordinates [n, 2] the triangle [n] that covers them, -1 where none does, and their weights in it
    [n, 3]. Of several it is the one that is closest in space, at corners [m, 3, 3], to points [n, 3].
    """
    from scipy.spatial import cKDTree

    usable = np.flatnonzero(np.isfinite(uv_triangles).all(axis=(1, 2)))
    owner, weights = np.full(len(uv), -1), np.zeros((len(uv), 3))
    if not len(usable):
        return owner, weights
    middles = uv_triangles[usable].mean(axis=1)
    reach = np.linalg.norm(uv_triangles[usable] - middles[:, None], axis=2).max()
    tree, finite = cKDTree(middles), np.flatnonzero(np.isfinite(uv).all(axis=1))
    for k, near in zip(finite, tree.query_ball_point(uv[finite], reach * (1 + 1e-6), return_sorted=True)):
        which = usable[np.asarray(near, int)]
        found = _weights(np.repeat(uv[k][None], len(which), axis=0), uv_triangles[which])
        inside = (found >= -ROOM).all(axis=1)
        if not inside.any():
            continue
        which, found = which[inside], found[inside]
        best = 0
        if len(which) > 1:
            best = int(np.argmin(triangle_distances(*(corners[which] - points[k]).transpose(1, 0, 2))))
        held = np.clip(found[best], 0, None)
        owner[k], weights[k] = which[best], held / held.sum()
    return owner, weights


def body_file(run: Run, name: str) -> Path:
    """The mesh file of a body, as the record has it. Errors: UserError where it has none with coordinates."""
    bodies = run.record["config"].get("scene", {}).get("bodies", [])
    mesh = next((body["mesh"] for body in bodies if body.get("name") == name), {})
    file = mesh.get("file", "")
    if not file.lower().endswith(".obj") or mesh.get("objects"):
        found = f"{file}{', some of its objects' if mesh.get('objects') else ''}" if file else "a generator"
        raise UserError(
            f"--bind uv: the mesh of {name} is {found}; allowed: the whole of an OBJ file with texture"
            " coordinates"
        )
    return run.folder / file


def bound_by_uv(
    cells: MeshArrays, file: Path, run: Run, name: str, chosen: np.ndarray
) -> tuple[Binding, Fit]:
    """Binds the vertices of a file to the triangles `chosen` of the frame of the start, those of a body. They
    lie on the surface, wherever the file has them. Errors: UserError that names the vertex whose coordinates
    nothing covers.
    """
    source = body_file(run, name)
    own = read_frame_file(source, uvs=True)
    if not len(own.uvs):
        raise UserError(f"{source}: no texture coordinates; allowed: a file with lines vt and faces f v/vt")
    of_body = np.flatnonzero(np.asarray(run.start.of_vertices["body"]) == run.body(name))
    if len(own.points) != len(of_body):
        raise UserError(f"{source}: {len(own.points)} vertices; allowed: {len(of_body)}, as {name} has")
    first = int(of_body[0])
    x, triangles = run.start.vertices, run.start.triangles[chosen]
    uv, corners = uv_of_vertices(cells, file), x[triangles]
    index, weights = located(uv, uv_of_triangles(own, triangles - first), cells.points, corners)
    beside = np.flatnonzero(index < 0)
    if len(beside):
        u, v = uv[beside[0]]
        raise UserError(
            f"{file}: vertex {beside[0]} has the texture coordinates ({u:.6g}, {v:.6g}), which no triangle of"
            f" {name} covers; allowed: coordinates within those of {source}"
        )
    owner, none = chosen[index], np.zeros(len(uv))
    made = Binding(cells.triangles, owner[cells.triangles[:, 0]], triangles[index], weights, owner, none)
    back = np.linalg.norm(made.points(x, run.start.triangles) - cells.points, axis=1)
    return made, Fit(back, float(back.max(initial=0)))
