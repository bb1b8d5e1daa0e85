"""The balance of energies over the frames: what appears in it comes from nowhere.

At the middle of an interval between two frames the balance is T = K + (G + G')/2 + (E + E')/2 - W with the
kinetic energy K of the mean velocities of the interval, the energies of gravity G, G' and of elasticity E, E'
of its two frames, all of vertices that move freely, and the work W that prescribed vertices have done against
elastic forces by then. Where nothing adds energy T is never above its first value: contact may store some of
it and give it back, and friction, drag and the damping of an integrator only take from it. What T has above
its first value appears from nowhere; after a loss more may have appeared than that. Frames that are too far
apart for the motion make gains of their own, since K of a mean velocity is too small while something swings;
so the same is computed of every second frame, and a gain that changes much with it says nothing.
"""

import numpy as np

from barrierbench_analysis.program.trajectories.trajectory import Topology

from .about import About

MOVES = 1e-12  # m, of prescribed vertices: less is rounding


class Motion:
    """Kinetic energy and that of gravity of free vertices, of frames in order."""

    def __init__(self, mass: np.ndarray | None, about: About, times_s: np.ndarray | None):
        self.free = None if mass is None else np.where(np.isin(np.arange(len(mass)), about.given), 0.0, mass)
        self.about, self.times_s = about, times_s
        self.last: list[np.ndarray] = []  # the last two frames
        self.gravity, self.kinetic, self.kinetic_of_two = [], [], []
        self.given_move = False

    def _kinetic(self, x: np.ndarray, number: int, back: int) -> float:
        v = (x - self.last[-back]) / (self.times_s[number] - self.times_s[number - back])
        return 0.5 * float(self.free @ (v * v).sum(axis=1))

    @np.errstate(all="ignore")
    def add(self, number: int, x: np.ndarray) -> None:
        if self.free is None or self.times_s is None:
            return
        self.gravity.append(-float(self.free @ (x @ np.array(self.about.gravity_m_s2))))
        for back, series in ((1, self.kinetic), (2, self.kinetic_of_two)):
            series.append(self._kinetic(x, number, back) if len(self.last) >= back else 0.0)
        given = self.about.given
        if self.last and len(given):
            self.given_move |= bool(np.abs(x[given] - self.last[-1][given]).max() > MOVES)
        self.last = [*self.last[-1:], np.array(x)]


def balance(kinetic: np.ndarray, potential: np.ndarray, work: np.ndarray) -> np.ndarray:
    """[n - 1] J at the middles of intervals, of frames [n]: kinetic[0] is not read, work is done by then."""
    return kinetic[1:] + (potential[1:] + potential[:-1]) / 2 - (work[1:] + work[:-1]) / 2


def gain(values: np.ndarray) -> float:
    """The most that a series is above its first value, at least 0."""
    return float((values - values[0]).max(initial=0.0))


def _missing(topology: Topology, about: About, motion: Motion, frames: list[dict]) -> str | None:
    """Why there is no balance, or None."""
    if motion.free is None:
        return "no density is given"
    if motion.times_s is None:
        return "the frames have no times"
    body = topology.body_of_vertices()
    moving = {topology.names[k] for k in np.unique(np.delete(body, about.given))}
    if bare := sorted(moving - set(about.materials)):
        return f"no material is given of {', '.join(bare)}"
    if light := sorted(moving - set(about.density)):
        return f"no density is given of {', '.join(light)}"
    if about.paths_m:
        return "an obstacle moves, whose work through contact is not known"
    if len(frames) < 2 or not all(frame["finite"] for frame in frames):
        return "two frames or more, all finite, are needed"
    return None


def _conditions(motion: Motion) -> list[str]:
    out = ["elastic energies are those of this program's models, with the materials of --about"]
    if motion.given_move:
        out.append(
            "prescribed vertices move: their work against elastic forces is taken off, that through contact"
            " is not"
        )
    return out


def energy_of(topology: Topology, about: About, motion: Motion, frames: list[dict]) -> dict | None:
    """`energy` of the record, None without density and material; splits `elastic_J` of frames."""
    for frame in frames:
        if "elastic_J" in frame:  # the program answers by kind of element
            parts = frame["elastic_parts_J"] = frame["elastic_J"]
            frame["elastic_J"] = None if None in parts.values() else float(sum(parts.values()))
    if not about.density and not about.materials:
        return None
    why = _missing(topology, about, motion, frames)
    elastic = [frame.get("elastic_J") for frame in frames]
    if why is None and None in elastic:
        why = "an elastic energy is not finite"
    if why is not None:
        return {"gained_J": None, "why_not": why}
    kinetic, two, gravity = (np.array(s) for s in (motion.kinetic, motion.kinetic_of_two, motion.gravity))
    potential = np.array(elastic) + gravity
    work = np.cumsum([frame["work_of_given_J"] for frame in frames])
    values = balance(kinetic, potential, work)
    coarse = balance(two[::2], potential[::2], work[::2])
    if not np.isfinite(values).all():
        return {"gained_J": None, "why_not": "an energy is beyond the range of numbers"}
    exchanged = max(float(np.ptp(series)) for series in (kinetic[1:], gravity, np.array(elastic)))
    return {
        "gained_J": gain(values),
        "gained_of_every_second_frame_J": gain(coarse) if len(coarse) > 1 else None,
        "lost_J": float(values[0] - values[-1]),
        "exchanged_J": exchanged,
        "work_of_given_J": float(work[-1]),
        "balance_J": values.tolist(),
        "conditions": _conditions(motion),
    }


def words(energy: dict | None) -> list[str]:
    """Lines of the summary."""
    if energy is None:
        return []
    if energy["gained_J"] is None:
        return [f"energy: no balance: {energy['why_not']}"]
    coarse = energy["gained_of_every_second_frame_J"]
    second = "" if coarse is None else f" ({coarse:.3g} J by every second frame)"
    gained, lost, exchanged = (energy[key] for key in ("gained_J", "lost_J", "exchanged_J"))
    return [
        f"energy: at least {gained:.3g} J appear from nowhere{second}, {lost:.3g} J are lost; up to"
        f" {exchanged:.3g} J change their kind",
        *(f"  {condition}" for condition in energy["conditions"]),
    ]
