"""What every adapter shares: the scene file, the settings of the card, and the files that a run leaves. Runs
in the environment of an engine, so it imports numpy and nothing of this project.

An adapter reads a scene (configs/schema/engine_scene.schema.json), steps it and hands every state to
`Frames`. It ends with exit code 0, or with REFUSED where the scene holds something that the engine has no
words for.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10, whose pip brings the same reader
    from pip._vendor import tomli as tomllib

REFUSED = 3  # exit code: the scene cannot be mapped; the reason is the last line of stderr
RUN = "barrierbench.engine_run/1"


class Refused(Exception):
    """What the engine cannot be told."""


@dataclass(frozen=True)
class Scene:
    """SI units; n vertices, m triangles, p given vertices."""

    name: str
    dt_s: float  # of a frame; an engine may take smaller steps
    steps: int  # frames after the start
    gravity: np.ndarray  # [3] m/s^2
    x: np.ndarray  # [n, 3] m, start
    rest: np.ndarray  # [n, 3] m
    v: np.ndarray  # [n, 3] m/s
    mass: np.ndarray  # [n] kg, 0 of given vertices
    triangles: np.ndarray  # [m, 3]
    segments: np.ndarray  # [s, 2] of rods
    bodies: list[dict]
    obstacles: list[dict]
    given: np.ndarray  # [p] vertices
    given_x: np.ndarray  # [frames or 1, p, 3] m
    friction: float  # Coulomb's coefficient of all surfaces

    def given_at(self, frame: float) -> np.ndarray:
        """[p, 3] m, at a time in frames; on a straight line between two frames."""
        return _between(self.given_x, frame)

    def point_of(self, obstacle: dict, frame: float) -> np.ndarray:
        """[3] m, of an obstacle that may move, at a time in frames."""
        return _between(np.array(obstacle.get("points_m") or [obstacle["point_m"]], float), frame)

    def body_of(self) -> np.ndarray:
        """[n] number of the body of each vertex."""
        first = [body["first_vertex"] for body in self.bodies]
        return np.searchsorted(first, np.arange(len(self.x)), side="right") - 1

    def triangles_of(self, body: dict) -> np.ndarray:
        """[k, 3], in the numbers of the body."""
        return _own(self.triangles, body)

    def segments_of(self, body: dict) -> np.ndarray:
        """[k, 2], in the numbers of the body."""
        return _own(self.segments, body)


def _own(cells: np.ndarray, body: dict) -> np.ndarray:
    first, n = body["first_vertex"], body["vertices"]
    inside = (cells[:, 0] >= first) & (cells[:, 0] < first + n)
    return cells[inside] - first


def _between(states: np.ndarray, frame: float) -> np.ndarray:
    """On a straight line between two states; the last one stays."""
    last = len(states) - 1
    k = min(int(frame), last)
    return states[last] if k == last else states[k] + (frame - k) * (states[k + 1] - states[k])


def require(scene: Scene, *, friction: bool = False, motion: bool = False, rods: bool = False) -> None:
    """What an engine has words for. Errors: Refused with the first that it has none for."""
    if scene.friction > 0 and not friction:
        raise Refused("friction is not mapped; surfaces without friction are")
    for o in scene.obstacles:
        if "points_m" in o and not motion:
            raise Refused(f"obstacle {o['name']}: moves; obstacles that rest are mapped")
    for body in scene.bodies:
        if "rod" in body and not rods:
            raise Refused(f"body {body['name']}: is a rod; sheets are mapped")


def corners_of(segments: np.ndarray) -> np.ndarray:
    """[c, 3] end, vertex, other end of every vertex between two segments."""
    ends: dict[int, list[int]] = {}
    for a, b in segments.tolist():
        ends.setdefault(a, []).append(b)
        ends.setdefault(b, []).append(a)
    return np.array([[e[0], v, e[1]] for v, e in ends.items() if len(e) == 2], int).reshape(-1, 3)


def read_scene(path: Path) -> Scene:
    data = json.loads(path.read_text())
    table = lambda key, width: np.array(data[key], float).reshape(-1, width)  # noqa: E731
    given = np.array(data["given"]["vertices"], int)
    return Scene(
        data["name"],
        data["dt_s"],
        data["steps"],
        np.array(data["gravity_m_s2"], float),
        table("positions_m", 3),
        table("rest_m", 3),
        table("velocities_m_s", 3),
        np.array(data["mass_kg"], float),
        np.array(data["triangles"], int).reshape(-1, 3),
        np.array(data.get("segments", []), int).reshape(-1, 2),
        data["bodies"],
        data["obstacles"],
        given,
        np.array(data["given"]["positions_m"], float).reshape(
            len(data["given"]["positions_m"]), len(given), 3
        ),
        data.get("friction", 0.0),
    )


def edges_of(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """[e, 2] edges, and [h, 4] e0 e1 v0 v1 of those that two triangles share."""
    opposite: dict[tuple[int, int], list[int]] = {}
    for a, b, c in triangles.tolist():
        for i, j, k in ((a, b, c), (b, c, a), (c, a, b)):
            opposite.setdefault((min(i, j), max(i, j)), []).append(k)
    edges = np.array(list(opposite), int).reshape(-1, 2)
    hinges = [[*edge, *others] for edge, others in opposite.items() if len(others) == 2]
    return edges, np.array(hinges, int).reshape(-1, 4)


def plane_stress(membrane: dict) -> tuple[float, float]:
    """Young's modulus times thickness (N/m) and Poisson's ratio of the Lame parameters of a sheet."""
    mu, lam = membrane["lame_mu_N_per_m"], membrane["lame_lambda_N_per_m"]
    return 4 * mu * (lam + mu) / (lam + 2 * mu), lam / (lam + 2 * mu)


def reach(body: dict, asked: float = 0.0) -> float:
    """How far from its middle surface a body is met, m: what is asked for, else half of its thickness and
    half of the distance at which our barrier begins.
    """
    return asked or body["half_thickness_m"] + body["d_hat_m"] / 2


class Frames:
    """The states of a run, and where the time went: `with frames.stepping():` around what is the engine's."""

    def __init__(self, scene: Scene, dt_s: float):
        self.scene = scene
        self.substeps = max(1, round(scene.dt_s / dt_s))  # of a frame
        self.dt_s = scene.dt_s / self.substeps
        self.states: list[np.ndarray] = []
        self.iterations: list[float] = []
        self.seconds = 0.0
        self.begun = time.perf_counter()
        self._since: float | None = None

    def __enter__(self) -> None:
        self._since = time.perf_counter()

    def __exit__(self, *_) -> None:
        self.seconds += time.perf_counter() - self._since

    def stepping(self) -> Frames:
        return self

    def add(self, x: np.ndarray) -> bool:
        """Whether to go on: not after a state that is not finite, which is kept."""
        self.states.append(np.array(x, float))
        return bool(np.isfinite(x).all())


def parse(argv: list[str], card: dict) -> tuple[argparse.Namespace, dict]:
    """The arguments, and the settings: those of the card, then of its variant, then of --set."""
    parser = argparse.ArgumentParser(description=f"{card['title']}: one scene")
    more = "; may be repeated, with an --out each"
    parser.add_argument(
        "--scene", type=Path, action="append", required=True, help=f"barrierbench.engine_scene/1{more}"
    )
    parser.add_argument(
        "--out", type=Path, action="append", required=True, help="folder of frames.npz and engine.json"
    )
    parser.add_argument("--variant", choices=list(card["variants"]), default=next(iter(card["variants"])))
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="given")
    options = parser.parse_args(argv)
    if len(options.scene) != len(options.out):
        parser.error(f"found {len(options.out)} --out; allowed: one for each of {len(options.scene)} --scene")
    settings = {name: one["default"] for name, one in card["settings"].items()}
    settings |= card["variants"][options.variant].get("settings", {})
    for word in options.given:
        name, _, text = word.partition("=")
        if name not in settings:
            parser.error(f"--set {word}: found {name!r}; allowed: {', '.join(settings)}")
        settings[name] = _value(text, card["settings"][name], parser)
    return options, settings


def _value(text: str, setting: dict, parser: argparse.ArgumentParser):
    """A value of the type of the default, within what is allowed."""
    kind = type(setting["default"])
    try:
        value = {"true": True, "false": False}[text] if kind is bool else kind(text)
    except (KeyError, ValueError):
        parser.error(f"found {text!r}; allowed: a {kind.__name__}")
    if "allowed" in setting and value not in setting["allowed"]:
        parser.error(f"found {text!r}; allowed: {', '.join(setting['allowed'])}")
    if "above" in setting and not value > setting["above"]:
        parser.error(f"found {text!r}; allowed: above {setting['above']}")
    if "least" in setting and not value >= setting["least"]:
        parser.error(f"found {text!r}; allowed: from {setting['least']}")
    return value


def run(adapter: Path, simulate: Callable[[Scene, dict, Frames, dict], None]) -> None:
    """The whole of an adapter: `simulate(scene, settings, frames, notes)` steps; `notes` are kept."""
    card = tomllib.loads((adapter.parent / "card.toml").read_text())
    options, settings = parse(sys.argv[1:], card)
    for path, out in zip(options.scene, options.out):
        scene = read_scene(path)
        frames, notes = Frames(scene, settings["dt_s"]), {}
        try:
            simulate(scene, settings, frames, notes)
        except Refused as why:
            print(why, file=sys.stderr)
            sys.exit(REFUSED)
        leave(out, frames, {"engine": card["name"], "variant": options.variant, "settings": settings}, notes)


def leave(out: Path, frames: Frames, who: dict, notes: dict) -> None:
    """Writes frames.npz and engine.json."""
    out.mkdir(parents=True, exist_ok=True)
    scene = frames.scene
    np.savez_compressed(
        out / "frames.npz",
        positions=np.array(frames.states),
        triangles=scene.triangles,
        times_s=scene.dt_s * np.arange(len(frames.states)),
        **({"segments": scene.segments} if len(scene.segments) else {}),
    )
    record = {
        "schema": RUN,
        **who,
        "version": notes.pop("version", ""),
        "dt_s": frames.dt_s,
        "frames": len(frames.states),
        "stepping_s": frames.seconds,
        "other_s": time.perf_counter() - frames.begun - frames.seconds,
        "iterations_a_step": float(np.mean(frames.iterations)) if frames.iterations else None,
        "notes": notes,
    }
    (out / "engine.json").write_text(json.dumps(record, indent=1) + "\n")
