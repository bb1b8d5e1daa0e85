"""Surfaces in motion for the comparison with the IPC Toolkit, and the file in which contact_stages and
contact_probe read them (experiments/microbenchmarks/contact_problem.hpp)."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io import input_file


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a binary PLY with one scalar type for the coordinates."""
    with input_file.opened(path) as file:
        header: list[str] = []
        while not header or header[-1] != "end_header":
            header.append(file.readline().decode().strip())
        body = file.read()
    order = ">" if any("big_endian" in line for line in header) else "<"
    real = order + ("f8" if any("property double x" in line for line in header) else "f4")
    count = [int(line.split()[2]) for line in header if line.startswith("element")]
    n_bytes = 3 * count[0] * np.dtype(real).itemsize
    vertices = np.frombuffer(body[:n_bytes], real).reshape(-1, 3).astype(float)
    faces = np.frombuffer(body[n_bytes:], [("n", "u1"), ("v", order + "i4", 3)], count[1])
    assert (faces["n"] == 3).all()
    # Vertices of no triangle go: the toolkit would pair them with each other.
    used, corners = np.unique(faces["v"], return_inverse=True)
    return vertices[used], corners.reshape(-1, 3).astype(np.int32)


def generated_sheets(n: int, d_hat: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, end of the motion and triangles of three wavy sheets of (n + 1)^2 vertices, half of d_hat apart,
    that sink into each other by up to twice that gap."""
    rng = np.random.default_rng(1)
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)))
    corner = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)[:-1, :-1].ravel()
    cells = np.stack([corner, corner + 1, corner + n + 2, corner, corner + n + 2, corner + n + 1], 1)
    starts, ends, faces = [], [], []
    for layer in range(3):
        height = 0.1 * np.sin(7 * u) * np.cos(5 * v) + 0.5 * d_hat * layer
        start = np.stack([u + 0.3 * layer / n, v + 0.2 * layer / n, height], 1)
        start += 0.05 * d_hat * rng.uniform(-1, 1, start.shape)
        sink = -0.5 * d_hat * layer * (1 + np.sin(9 * u) * np.sin(8 * v))
        ends.append(start + np.stack([0.02 * np.cos(3 * v), 0.01 * u, sink], 1))
        starts.append(start)
        faces.append(cells.reshape(-1, 3) + layer * len(u))
    return np.concatenate(starts), np.concatenate(ends), np.concatenate(faces).astype(np.int32)


def write_problem(path: Path, rest, x0, x1, faces, d_hat: float, mollify: bool = True) -> None:
    with open(path, "wb") as file:
        np.array([len(rest), len(faces), mollify], "<i4").tofile(file)
        np.array([d_hat], "<f8").tofile(file)
        for x in (rest, x0, x1):
            np.ascontiguousarray(x, "<f8").tofile(file)
        np.ascontiguousarray(faces, "<i4").tofile(file)
