"""Hostile files, each made by a few lines: configs, sweeps, meshes, and what is no file at all."""

import json
import os
import socket
import struct
from pathlib import Path
from typing import Callable, Union

Content = Union[str, bytes, dict, list, Callable[[Path], None]]
SCENES = Path(__file__).resolve().parents[2] / "configs/scenes"
BLOCK = str(SCENES / "resting_block_1d.json")
SQUARE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n"


def make(path: Path, content: Content) -> None:
    """Writes text, bytes or JSON, or lets a function make what `path` stands for."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if callable(content):
        content(path)
    elif isinstance(content, bytes):
        path.write_bytes(content)
    elif isinstance(content, str):
        path.write_text(content)
    else:
        path.write_text(json.dumps(content))


def fifo(path: Path) -> None:
    os.mkfifo(path)


def folder(path: Path) -> None:
    path.mkdir()


def unix_socket(path: Path) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # the address of a socket holds 108 bytes only
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(path.name)
    os.chdir(here)


def link_to(target: str) -> Callable[[Path], None]:
    return lambda path: path.symlink_to(target)


def sparse(n_bytes: int) -> Callable[[Path], None]:
    """A file of zeros that takes no space on the disk."""
    def create(path: Path) -> None:
        with path.open("wb") as file:
            file.truncate(n_bytes)
    return create


def nested(n: int, opening: str = "[", closing: str = "]") -> str:
    return opening * n + closing * n


def config(scene: dict, **more) -> dict:
    return {"schema": "barrierbench.config/1", "scene": scene, "formulation": {"name": "log", "d_hat_m": 0.01},
            "time": {"dt_s": 0.01, "steps": 1}, **more}


def body(mesh: dict, **more) -> dict:
    return {"name": "cloth", "mesh": mesh, **more}


def bodies(*all_bodies: dict, **more) -> dict:
    return config({"bodies": list(all_bodies), **more})


def grid(**more) -> dict:
    return {"generator": "grid", "n_x": 3, "n_y": 3, **more}


def one_mesh(name: str, **more) -> dict:
    """A config of one falling body whose mesh is a file."""
    return bodies(body({"file": name}, **more))


def sweep(axes: list, **more) -> dict:
    return {"schema": "barrierbench.sweep/1", "name": "hostile", "base": BLOCK, "axes": axes, **more}


def case(label: str, **more) -> dict:
    return {"label": label, "set": {"/time/steps": 1}, **more}


VERTICES = ("vertex", 3, ["double x", "double y", "double z"])
FACES = ("face", 1, ["list uchar int vertex_indices"])
POINTS = "0 0 0\n1 0 0\n0 1 0\n"


def ply(elements: list, body_text: Union[str, bytes] = "", form: str = "ascii", version: str = "1.0") -> bytes:
    """A PLY file from (name, count, properties) and its body."""
    lines = ["ply", f"format {form} {version}"]
    for name, count, properties in elements:
        lines += [f"element {name} {count}", *(f"property {p}" for p in properties)]
    head = "\n".join([*lines, "end_header"]) + "\n"
    return head.encode() + (body_text.encode() if isinstance(body_text, str) else body_text)


def binary_ply(elements: list, body_bytes: bytes) -> bytes:
    return ply(elements, body_bytes, "binary_little_endian")


def binary_points(*xyz: float) -> bytes:
    return struct.pack(f"<{len(xyz)}d", *xyz)


TRIANGLE_BYTES = binary_points(0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<B3i", 3, 0, 1, 2)


def binary_stl(n_announced: int, n_bytes: int) -> bytes:
    return bytes(80) + struct.pack("<I", n_announced) + bytes(n_bytes)


PLUGIN_SOURCE = Path(__file__).with_name("plugin_cases.c")
