"""Trajectories of one file for all frames and no cells: PC2 of Blender, MDD of LightWave."""

import struct
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import TRAJECTORY, opened
from barrierbench_analysis.program.film_files.film import ROUNDED

from .trajectory import Topology, Trajectory, increasing, no_cells

PC2_HEADER = struct.Struct("<12siiffi")
MDD_HEADER = struct.Struct(">ii")


def _bytes(path: Path) -> bytes:
    with opened(path, TRAJECTORY) as file:
        return file.read()


def _bare(n: int) -> Topology:
    return Topology(n, no_cells(3), no_cells(2), no_cells(4))


def _frame_numbers(path: Path, start: float, rate: float, samples: int) -> list[float]:
    """Of the samples, in frames of the scene. Errors: UserError for numbers that are none."""
    if not np.isfinite(start):
        raise UserError(f"{path}: the first sample is at frame {start}; a finite number is needed")
    if not (np.isfinite(rate) and rate > 0) and samples > 1:
        raise UserError(
            f"{path}: found {rate} frames from sample to sample; a finite number above 0 is needed"
        )
    return [start + k * rate for k in range(samples)]


def of_pc2(path: Path) -> Trajectory:
    """Float32 positions, as Blender's cache has them, without cells."""
    data = _bytes(path)
    if len(data) < PC2_HEADER.size or not data.startswith(b"POINTCACHE2\0"):
        raise UserError(f"{path}: not a PC2 file (POINTCACHE2)")
    _, version, points, start, rate, samples = PC2_HEADER.unpack_from(data)
    wanted = PC2_HEADER.size + 12 * points * samples
    if version != 1 or points < 1 or samples < 1 or len(data) != wanted:
        raise UserError(
            f"{path}: version {version}, {samples} samples of {points} points, {len(data)} bytes; "
            f"version 1 and {wanted} bytes are needed"
        )
    numbers = _frame_numbers(path, start, rate, samples)
    states = np.frombuffer(data, "<f4", offset=PC2_HEADER.size).reshape(samples, points, 3)
    labels = [f"sample {k} (frame {number:g})" for k, number in enumerate(numbers)]
    notes = (
        ROUNDED,
        f"the file counts frames, from {numbers[0]:g} to {numbers[-1]:g}, and no seconds: dt_s of --about",
    )
    return Trajectory(
        _bare(points), lambda: map(np.float64, states), labels, str(path), "pc2", notes=notes,
        frame_numbers=numbers,
    )  # fmt: skip


def of_mdd(path: Path) -> Trajectory:
    """Big-endian: int32 frames, int32 points, a float32 time (s) a frame, float32 positions."""
    data = _bytes(path)
    if len(data) < MDD_HEADER.size:
        raise UserError(f"{path}: {len(data)} bytes; not an MDD file")
    frames, points = MDD_HEADER.unpack_from(data)
    wanted = MDD_HEADER.size + 4 * frames + 12 * points * frames
    if frames < 1 or points < 1 or len(data) != wanted:
        raise UserError(
            f"{path}: {frames} frames of {points} points, {len(data)} bytes; {wanted} bytes are needed"
        )
    times = np.frombuffer(data, ">f4", frames, MDD_HEADER.size).astype(float)
    states = np.frombuffer(data, ">f4", offset=MDD_HEADER.size + 4 * frames).reshape(frames, points, 3)
    labels, times_s = [f"frame {k}" for k in range(frames)], increasing(times, lambda k: f"{path}: time {k}")
    read = (_bare(points), lambda: map(np.float64, states))
    return Trajectory(*read, labels, str(path), "mdd", times_s, notes=(ROUNDED,))
