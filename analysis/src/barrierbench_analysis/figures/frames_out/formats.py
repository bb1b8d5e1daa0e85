"""The formats of `bench data frames`: each writes a sequence into a folder.

Frames are numbered from 0, one after the other, in the order of times.csv.
"""

import io
import struct
from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import quoteattr

import meshio
import numpy as np

from barrierbench_analysis.figures.surfaces.sequence import Mesh, Sequence, State
from barrierbench_analysis.io.frames import with_vectors
from barrierbench_analysis.io.whole_file import whole, write_whole, write_whole_bytes

from .alembic import write_alembic
from .usd import write_usd


def _name(sequence: Sequence, number: int, suffix: str) -> str:
    """Of a frame; without a number for what does not move."""
    return f"{sequence.stem}_{number:06}.{suffix}" if sequence.moves else f"{sequence.stem}.{suffix}"


def _each(sequence: Sequence, folder: Path, suffix: str, content: Callable[[Mesh, State], bytes]) -> None:
    for number, state in enumerate(sequence.states()):
        write_whole_bytes(folder / _name(sequence, number, suffix), content(sequence.mesh, state))


# --- OBJ


def obj_bytes(mesh: Mesh, state: State) -> bytes:
    """Wavefront OBJ: all vertices (m, 17 digits: every bit), then an object a body with its faces and the
    segments of its rods; vertices are counted from 1.
    """
    lines = ["v %.17g %.17g %.17g" % tuple(p) for p in state.points.tolist()]
    of_edges = mesh.of_points[mesh.edges[:, 0]]
    for body, name in enumerate(mesh.names):
        lines.append(f"o {'_'.join(name.split())}")
        lines += ["f %d %d %d" % tuple(t) for t in (mesh.triangles[mesh.of_triangles == body] + 1).tolist()]
        lines += ["l %d %d" % tuple(e) for e in (mesh.edges[of_edges == body] + 1).tolist()]
    return ("\n".join(lines) + "\n").encode()


def write_obj(sequence: Sequence, folder: Path) -> None:
    _each(sequence, folder, "obj", obj_bytes)


# --- PLY


def _table(columns: list[tuple[str, str, np.ndarray]]) -> tuple[str, bytes]:
    """Header lines and rows of an element; a column of several numbers a row is a list."""
    count = len(columns[0][2])
    fields, header = [], ""
    for name, kind, values in columns:
        word = {"<f8": "double", "<i4": "int"}[kind]
        if values.ndim == 2:
            fields += [(f"{name} of", "u1"), (name, kind, values.shape[1])]
            header += f"property list uchar {word} {name}\n"
        else:
            fields.append((name, kind))
            header += f"property {word} {name}\n"
    rows = np.zeros(count, np.dtype(fields))
    for name, _, values in columns:
        rows[name] = values
        if values.ndim == 2:
            rows[f"{name} of"] = values.shape[1]
    return header, rows.tobytes()


def ply_bytes(mesh: Mesh, state: State) -> bytes:
    """Binary PLY in double precision with the fields of the frame, as the program writes them. Rods are an
    element `edge`, which is not there without any: some readers know none.
    """
    vertex = [(axis, "<f8", state.points[:, k]) for k, axis in enumerate("xyz")]
    vertex += [("body", "<i4", mesh.of_points), *((n, "<f8", v) for n, v in state.of_points.items())]
    face = [("vertex_indices", "<i4", mesh.triangles), ("body", "<i4", mesh.of_triangles)]
    face += [(n, "<f8", v) for n, v in state.of_triangles.items()]
    edge = [(f"vertex{k + 1}", "<i4", mesh.edges[:, k]) for k in (0, 1)]
    header, body = "ply\nformat binary_little_endian 1.0\n", b""
    elements = [("vertex", vertex), ("face", face), *([("edge", edge)] if len(mesh.edges) else [])]
    for name, columns in elements:
        properties, rows = _table(columns)
        header += f"element {name} {len(columns[0][2])}\n{properties}"
        body += rows
    return f"{header}end_header\n".encode() + body


def write_ply(sequence: Sequence, folder: Path) -> None:
    _each(sequence, folder, "ply", ply_bytes)


# --- PC2


def pc2_header(n_points: int, n_samples: int) -> bytes:
    """32 bytes, little-endian: "POINTCACHE2" and a 0; int32 version 1; int32 points of a sample; float32
    frame of the first sample, 0; float32 frames from one sample to the next, 1; int32 samples. Then, sample
    by sample, x y z of every point as float32 (m). The layout that Blender's modifier "Mesh Cache" reads.
    """
    return struct.pack("<12siiffi", b"POINTCACHE2\0", 1, n_points, 0.0, 1.0, n_samples)


def write_pc2(sequence: Sequence, folder: Path) -> None:
    """STEM.pc2, and STEM.obj: the mesh at the first sample, whose vertices are the points in their order.
    What does not move has the OBJ alone.
    """
    if not sequence.moves:
        return write_obj(sequence, folder)
    path = folder / f"{sequence.stem}.pc2"
    with whole(path) as part, part.open("wb") as out:
        out.write(pc2_header(len(sequence.mesh.of_points), len(sequence.steps)))
        for number, state in enumerate(sequence.states()):
            out.write(state.points.astype("<f4").tobytes())
            if number == 0:
                write_whole_bytes(folder / f"{sequence.stem}.obj", obj_bytes(sequence.mesh, state))


# --- VTU, PVD


def _vtu(mesh: Mesh, state: State) -> meshio.Mesh:
    """Triangles and, of rods, lines; point data: body, gap_rel, load_N, and forces as vectors contact_N and
    friction_N; cell data: body, stretch (nan of lines).
    """
    cells = [("triangle", mesh.triangles), ("line", mesh.edges)]
    of_cells = {"body": [mesh.of_triangles, mesh.of_points[mesh.edges[:, 0]]]}
    of_cells |= {name: [v, np.full(len(mesh.edges), np.nan)] for name, v in state.of_triangles.items()}
    there = [k for k, (_, corners) in enumerate(cells) if len(corners)]
    return meshio.Mesh(
        state.points,
        [cells[k] for k in there],
        point_data={"body": mesh.of_points, **with_vectors(state.of_points)},
        cell_data={name: [values[k] for k in there] for name, values in of_cells.items()},
    )


def write_vtu(sequence: Sequence, folder: Path) -> None:
    for number, state in enumerate(sequence.states()):
        path = folder / _name(sequence, number, "vtu")
        with whole(path) as part:
            meshio.vtu.write(str(part), _vtu(sequence.mesh, state))


def pvd_text(sequences: list[Sequence]) -> str:
    """A collection for ParaView: every file with its time in s; a sequence is a part, and what does not move
    is there at every time.
    """
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">']
    lines.append("  <Collection>")
    for number, time in enumerate(sequences[0].times_s):
        for part, sequence in enumerate(sequences):
            name = quoteattr(_name(sequence, number, "vtu"))
            lines.append(f'    <DataSet timestep="{time!r}" group="" part="{part}" file={name}/>')
    return "\n".join([*lines, "  </Collection>", "</VTKFile>", ""])


# --- NPZ


def write_npz(sequence: Sequence, folder: Path) -> None:
    """STEM.npz of NumPy, under the names that `data film` and `judge` read: positions [frames, n, 3] m,
    triangles, segments (rods), times_s; beside them body [n], names of the bodies, and every field of
    vertices [frames, n], forces [frames, n, 3] N. nan: at the start, where nothing is solved.
    """
    states = list(sequence.states())
    fields = [with_vectors(state.of_points) for state in states]
    arrays = {
        "positions": np.stack([state.points for state in states]),
        "times_s": np.array(sequence.times_s),
    }
    arrays |= {"triangles": sequence.mesh.triangles, "body": sequence.mesh.of_points}
    arrays |= {"names": np.array(sequence.mesh.names)}
    if len(sequence.mesh.edges):
        arrays["segments"] = sequence.mesh.edges
    arrays |= {name: np.stack([field[name] for field in fields]) for name in fields[0]}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    write_whole_bytes(folder / f"{sequence.stem}.npz", buffer.getvalue())


WRITERS = {
    "obj": write_obj,
    "ply": write_ply,
    "pc2": write_pc2,
    "vtu": write_vtu,
    "npz": write_npz,
    "usd": write_usd,
    "abc": write_alembic,
}


def write(sequences: list[Sequence], kind: str, folder: Path) -> None:
    """All files of a format, and times.csv."""
    for sequence in sequences:
        WRITERS[kind](sequence, folder)
    if kind == "vtu":
        write_whole(folder / "frames.pvd", pvd_text(sequences))
    rows = enumerate(zip(sequences[0].steps, sequences[0].times_s))
    table = "".join(f"{number},{step},{time!r}\n" for number, (step, time) in rows)
    write_whole(folder / "times.csv", f"frame,step,time_s\n{table}")
