"""What a run is compared with: a closed form, or runs with a much smaller d_hat and tolerance from two
formulations.

A reference says its name, positions at the times of a run, and its own uncertainty: 0 for a closed form, the
distance of the two runs for a refined one.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from . import errors
from .catenary import chain_nodes
from .shapes import gap_of_load
from .state import Motion


class NoReference(ValueError):
    """A scene without that reference, or a reference that is none."""


@dataclass
class Reference:
    name: str
    positions: Callable[
        [Motion], np.ndarray
    ]  # of a run -> [frames, vertices, 3] m at its times, NaN where it says nothing
    band: dict[str, float] = field(default_factory=dict)  # error -> its own uncertainty
    rest_gaps: Callable[[Motion], tuple[np.ndarray, np.ndarray]] | None = (
        None  # of a run at rest -> measured and exact gaps, m
    )
    momentum: Callable[[Motion], np.ndarray] | None = None  # of the start, kg m/s
    energy_J: Callable[[Motion], float] | None = None  # of the start


def measure(motion: Motion, reference: Reference) -> tuple[dict[str, float], dict[str, str]]:
    """Error -> value, and error -> why it does not apply. Errors: NotFinite."""
    found, skipped = {}, {}
    if motion.times[-1] != motion.record["steps"][-1]["t_s"]:
        raise NoReference(
            f"the last frame is of {motion.times[-1]:g} s and the run ends at"
            f" {motion.record['steps'][-1]['t_s']:g} s; /output/frames_every has to divide /time/steps - 1"
        )
    x = reference.positions(motion)
    known = np.isfinite(x).all(axis=(1, 2))
    if not known.any():
        raise NoReference(f"{reference.name} says nothing about the times of the run")
    com, com_ref = motion.com[known], motion.com_of(x[known])
    found["e_traj"] = errors.e_traj(motion.x[known], x[known], motion.size)
    found["e_com"] = errors.e_com(com, com_ref, motion.size)
    if motion.up is None:
        skipped["e_offset"] = "no gravity, so nothing has a height"
    elif not known[-1]:
        skipped["e_offset"] = "the reference says nothing about the end"
    else:
        found["e_offset"] = errors.e_offset(com[-1], com_ref[-1], motion.up)
    if reference.rest_gaps is None:
        skipped["e_gap"] = "no gap is known in closed form"
    elif motion.record["labels"]["stiffness_policy"] != "fixed":
        skipped["e_gap"] = "kappa depends on the gap: no closed form"
    else:
        found["e_gap"] = errors.e_gap(*reference.rest_gaps(motion), motion.record["labels"]["d_hat_m"])
    if reference.momentum is None:
        skipped["e_momentum"] = "something outside acts on the bodies"
    else:
        found["e_momentum"] = errors.e_momentum(motion.momentum(-2, -1), reference.momentum(motion))
    if reference.energy_J is None:
        skipped["e_energy"] = "the energy of the start has no zero that the reference names"
    else:
        found["e_energy"] = errors.e_energy(motion.energy(-1), reference.energy_J(motion))
    return found, skipped


def refined(first: Motion, second: Motion, name: str) -> Reference:
    """The middle of two runs; their distance is its band. Errors: NoReference for runs of unlike frames."""
    if first.x.shape != second.x.shape or not np.allclose(first.times, second.times, rtol=1e-9, atol=0):
        raise NoReference(f"{name}: the two runs have other frames: {first.x.shape} and {second.x.shape}")

    def positions(motion: Motion) -> np.ndarray:
        if motion.x.shape != first.x.shape or not np.allclose(
            motion.times, first.times, rtol=1e-9, atol=1e-12
        ):
            raise NoReference(f"{name}: frames at other times than those of the run")
        return 0.5 * (first.x + second.x)

    band = {
        "e_traj": errors.e_traj(first.x, second.x, first.size),
        "e_com": errors.e_com(first.com, second.com, first.size),
    }
    if first.up is not None:
        band["e_offset"] = errors.e_offset(first.com[-1], second.com[-1], first.up)
    return Reference(name, positions, band)


def _gravity(motion: Motion) -> float:
    return float(np.linalg.norm(motion.record["config"]["scene"]["gravity_m_per_s2"]))


def rigid_gap(start: float, v0: float, acceleration: float, t: float) -> float:
    """The limit d_hat -> 0: an elastic bounce at the gap 0. m at the time t (s)."""
    if acceleration == 0:
        return abs(start - v0 * t)
    speed = float(np.sqrt(v0**2 + 2 * acceleration * start))
    since = t - (speed - v0) / acceleration
    if since < 0:
        return start - v0 * t - 0.5 * acceleration * t * t
    since %= 2 * speed / acceleration
    return speed * since - 0.5 * acceleration * since * since


def rigid_bounce() -> Reference:
    """One flat body over the plane z = 0, dropped: in the limit d_hat -> 0 an elastic bounce."""

    def positions(motion: Motion) -> np.ndarray:
        start = motion.x[0]
        height, speed = start[:, 2].min(), -_velocities(motion)[0, 2]
        x = np.repeat(start[None], len(motion.times), axis=0)
        x[:, :, 2] = [[rigid_gap(height, speed, _gravity(motion), t)] for t in motion.times]
        return x

    def energy(motion: Motion) -> float:
        return float(
            sum(
                motion.masses
                * (0.5 * (_velocities(motion) ** 2).sum(axis=1) + _gravity(motion) * motion.x[0, :, 2])
            )
        )

    return Reference(
        "closed form: elastic bounce on a plane, the limit d_hat -> 0", positions, energy_J=energy
    )


def _velocities(motion: Motion) -> np.ndarray:
    """[vertices, 3] m/s at the start."""
    bodies = motion.record["config"]["scene"]["bodies"]
    return np.array([bodies[b]["velocity_m_per_s"] for b in motion.body_of], float)


def _offsets(motion: Motion) -> np.ndarray:
    return np.array([body["offset_m"] for body in motion.record["config"]["scene"]["bodies"]])


def rigid_stack() -> Reference:
    """Flat bodies on each other over the plane z = 0 at rest: heights without any gap; gaps that carry the
    weight above.
    """

    def positions(motion: Motion) -> np.ndarray:
        offsets = _offsets(motion)
        height = offsets[0] + np.concatenate([[0.0], np.cumsum(offsets[:-1] + offsets[1:])])
        x = np.full(motion.x.shape, np.nan)
        x[-1] = motion.x[0]
        x[-1, :, 2] = height[motion.body_of]
        return x

    def gaps(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
        offsets, heights = _offsets(motion), motion.com[-1, :, 2]
        measured = np.diff(heights, prepend=0.0) - (offsets + np.concatenate([[0.0], offsets[:-1]]))
        weight = np.array(
            [motion.masses[motion.body_of == b].sum() for b in range(len(motion.bodies))]
        ) * _gravity(motion)
        above = np.cumsum(weight[::-1])[::-1]
        labels, kappa = motion.record["labels"], motion.record["steps"][-1]["kappa_max_N_per_m"]
        return measured, np.array(
            [
                gap_of_load(labels["shape"], labels["argument"], kappa, labels["d_hat_m"], load / 3)
                for load in above
            ]
        )

    return Reference(
        "closed form: layers at rest, the limit d_hat -> 0; gaps from kappa |b'(d)| = weight above/3",
        positions,
        rest_gaps=gaps,
    )


def free_impact() -> Reference:
    """Two flat bodies of equal mass without gravity, the second one moving at the first: in the limit d_hat
    -> 0 they exchange their velocities.
    """

    def positions(motion: Motion) -> np.ndarray:
        v = _velocities(motion)
        first, second = motion.com[0]
        gap = (second - first)[2] - _offsets(motion).sum()
        speeds = [v[motion.body_of == b][0] for b in (0, 1)]
        when = gap / (speeds[0] - speeds[1])[2]
        x = np.repeat(motion.x[0][None], len(motion.times), axis=0)
        for frame, t in enumerate(motion.times):
            for b in (0, 1):
                x[frame, motion.body_of == b] += min(t, when) * speeds[b] + max(t - when, 0.0) * speeds[1 - b]
        return x

    return Reference(
        "closed form: elastic impact of equal masses, the limit d_hat -> 0",
        positions,
        momentum=lambda motion: motion.masses @ _velocities(motion),
        energy_J=lambda motion: float(0.5 * motion.masses @ (_velocities(motion) ** 2).sum(axis=1)),
    )


def catenary() -> Reference:
    """A chain of springs at rest between its two ends, as they stand at the end of the run."""

    def positions(motion: Motion) -> np.ndarray:
        body = motion.record["config"]["scene"]["bodies"][0]["material"]
        start, end = motion.x[0], motion.x[-1]
        length = np.linalg.norm(start[1] - start[0])
        nodes = chain_nodes(
            len(start) - 1,
            length,
            body["springs_N_per_m"],
            motion.masses[1] * _gravity(motion),
            (end[-1] - end[0])[[0, 2]],
        )
        x = np.full(motion.x.shape, np.nan)
        x[-1] = end[0]
        x[-1][:, [0, 2]] += nodes
        return x

    return Reference("closed form: discrete elastic catenary at rest", positions)


CLOSED_FORMS: dict[str, Callable[[], Reference]] = {
    "rigid_bounce": rigid_bounce,
    "rigid_stack": rigid_stack,
    "free_impact": free_impact,
    "catenary": catenary,
}
