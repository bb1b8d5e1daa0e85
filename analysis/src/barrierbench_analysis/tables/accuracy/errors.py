"""The errors of a run against a reference, as plain functions of arrays. Every one says its unit; none hides
a value that is not finite.

Positions are [times, vertices, 3] in m. Sources: Ando and others judge contact by gap and offset,
work-precision studies by trajectory.
"""

import numpy as np

MEANING = {
    "e_traj": (
        "largest distance of a vertex from the reference over the sampled times, over the size of the scene"
    ),
    "e_com": "the same of the centres of mass of the bodies",
    "e_gap": (
        "largest |d - d*| over the layers at rest, in units of d_hat; d* carries the load above it in closed"
        " form"
    ),
    "e_offset": (
        "largest height of a body's centre of mass above the reference at the end, in m: the thickness of the"
        " barrier"
    ),
    "e_momentum": "|p_end - p_0| / |p_0| of all bodies together, with nothing outside that acts on them",
    "e_energy": "|E_end - E_0| / E_0; nothing in the program dissipates but its time integrator",
}
NAMES = tuple(MEANING)


class NotFinite(ValueError):
    """An error that is not a number."""


def _checked(value: float, name: str) -> float:
    if not np.isfinite(value):
        raise NotFinite(f"{name} is {value}")
    return float(value)


def e_traj(x: np.ndarray, reference: np.ndarray, size: float) -> float:
    """1. max over t and i of |x_i - x_ref,i| / size (m). Errors: ValueError for unlike shapes, NotFinite."""
    if x.shape != reference.shape or x.size == 0:
        raise ValueError(f"positions {x.shape} and reference {reference.shape}")
    return _checked(np.linalg.norm(x - reference, axis=-1).max() / size, "e_traj")


def e_com(com: np.ndarray, reference: np.ndarray, size: float) -> float:
    """1. As e_traj, of centres of mass [times, bodies, 3]."""
    if com.shape != reference.shape or com.size == 0:
        raise ValueError(f"centres of mass {com.shape} and reference {reference.shape}")
    return _checked(np.linalg.norm(com - reference, axis=-1).max() / size, "e_com")


def e_gap(gaps: np.ndarray, reference: np.ndarray, d_hat: float) -> float:
    """In units of d_hat. gaps, reference: [layers] m at rest."""
    return _checked(np.abs(np.asarray(gaps) - np.asarray(reference)).max() / d_hat, "e_gap")


def e_offset(com: np.ndarray, reference: np.ndarray, up: np.ndarray) -> float:
    """m. com, reference: [bodies, 3] at the end; up: unit vector against gravity. Absolute: below the
    reference is an error too.
    """
    return _checked(np.abs((com - reference) @ up).max(), "e_offset")


def e_momentum(end: np.ndarray, start: np.ndarray) -> float:
    """1. Momenta [3] kg m/s. Errors: ValueError without momentum at the start."""
    if not np.linalg.norm(start) > 0:
        raise ValueError("no momentum at the start")
    return _checked(np.linalg.norm(end - start) / np.linalg.norm(start), "e_momentum")


def e_energy(end: float, start: float) -> float:
    """1. Energies in J, start > 0: its zero belongs to the reference."""
    if not start > 0:
        raise ValueError(f"energy at the start {start} J; a positive one is needed")
    return _checked(abs(end - start) / start, "e_energy")
