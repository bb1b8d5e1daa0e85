"""Runs a step at a time, or whole."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .given import folder
from .python_sources import brought
from .scene import Config, Scene, _given


def _brought(given: tuple[str, str, str, list[str]]) -> list[tuple[str, str, str]]:
    config = json.loads(_core.resolved_json(*given))
    formulation = config["formulation"]
    return brought(formulation["shape"], formulation["stiffness_policy"]["name"], config["step_solver"]["name"])


class Simulation:
    """A config, advanced one time step at a time: the scene, matching, steps and record of `bench run`.

    config: a dict, JSON text or the path of a config; overrides: {"/time/steps": 5} or ["/time/steps=5"].
    out: folder of the record, its trace, frames and matrices, which `finish` puts in place; None: nothing is written. A
    record of the same config there is replaced; a record or checkpoint of another config, or a file of their names,
    only with `replace`.

    It is one pass. A config that requests times and the audit (the default does) is run by the program twice, once
    for each; here the observed pass alone is made, and the config of the record says so (/passes/time false). The
    record is then, number for number, that of `bench run --set /passes/time=false`.

    `step` either makes a step or raises, and then the run is where it was, bit for bit. A simulation belongs to one
    thread; while a step is computed other threads of Python go on.
    Errors: ConfigError with every violation, before anything is written; RecordError for a folder that is in use or
    cannot be written.

    >>> sim = Simulation({"scene": {"name": "hang"}}, {"/time/steps": 3})
    >>> while not sim.done:
    ...     report = sim.step()
    >>> sim.outcome, report["step"], round(sim.time, 9) == 3 * report["dt_s"]
    ('ok', 2, True)
    """

    def __init__(
        self,
        config: Config,
        overrides: Sequence[str] | Mapping[str, Any] = (),
        out: str | os.PathLike | None = None,
        on_iteration: Callable[[dict[str, Any]], None] | None = None,
        replace: bool = False,
    ):
        record = folder(out)
        given = _given(config, overrides, record)
        self._run = _core.Run(*given, record, sys.argv[:], _brought(given), True, replace)
        self.on_iteration = on_iteration
        """Called after every Newton iteration with the fields of a line of the trace (`./bench help trace`)."""
        self._scene: Scene | None = None

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Simulation({self.scene.name!r}): {self._run.steps()} steps, {self.outcome}"

    def step(self) -> dict[str, Any]:
        """Makes the next time step; its record, as `steps` of run.json has it (`./bench help record`).

        Errors: RuntimeError when it is done; what `on_iteration` or a shape of Python raises; KeyboardInterrupt.
        """
        return self._run.step(self.on_iteration)

    def run(self) -> Simulation:
        """Makes all steps that are left."""
        while not self.done:
            self.step()
        return self

    @property
    def done(self) -> bool:
        """Nothing is left to do: the last step is made, or one did not converge, or the scene cannot start."""
        return self._run.over()

    @property
    def outcome(self) -> str:
        """ok, or the word of what ended it; that of the audit is in the record."""
        return self._run.outcome()

    @property
    def detail(self) -> str:
        """One sentence; empty when ok."""
        return self._run.detail()

    @property
    def time(self) -> float:
        """Simulated, s."""
        return self._run.time()

    @property
    def steps(self) -> int:
        """That are over."""
        return self._run.steps()

    @property
    def positions(self) -> NDArray[np.float64]:
        """[n, 3] m, a read-only view of the state: it moves with the next step. Copy it to keep it."""
        return self._run.positions

    @property
    def velocities(self) -> NDArray[np.float64]:
        """[n, 3] m/s, a read-only view as `positions`."""
        return self._run.velocities

    @property
    def scene(self) -> Scene:
        """The scene that is run: faces, edges, masses; copies."""
        if self._scene is None:
            self._scene = Scene(**self._run.scene())
        return self._scene

    @property
    def faces(self) -> NDArray[np.int32]:
        """[t, 3] triangles of the collision surface."""
        return self.scene.faces

    @property
    def edges(self) -> NDArray[np.int32]:
        """[e, 2] edges of the collision surface, rods among them."""
        return self.scene.edges

    @property
    def state_hash(self) -> str:
        """SHA-256 of the positions: equal exactly when states are bit-identical; summary.state_hash of a record."""
        return self._run.state_hash()

    @property
    def config(self) -> dict[str, Any]:
        """Every setting of the run."""
        return json.loads(self._run.config_json())

    def record(self) -> dict[str, Any]:
        """The record so far. Of a run that is not done its outcome is timeout. With frames: after `finish` alone."""
        return json.loads(self._run.record_json())

    def finish(self) -> dict[str, Any]:
        """Ends the run where it is, writes what belongs to it to `out`, and returns its record."""
        return json.loads(self._run.finish_json())

    def close(self) -> None:
        """Frees everything; files of a run without `finish` go. Nothing but this may be called after it."""
        self._run.close()


def run(
    config: Config,
    overrides: Sequence[str] | Mapping[str, Any] = (),
    out: str | os.PathLike | None = None,
    on_step: Callable[[dict[str, Any]], None] | None = None,
    resume: bool = False,
    replace: bool = False,
) -> dict[str, Any]:
    """A whole run as `bench run` makes it, both passes and times with it; returns the record that it wrote.

    out: folder of the record (default results/runs/LABEL). on_step: called after every step with what a progress line
    shows. resume: go on from the checkpoint of this very run. replace: the record or checkpoint of another config in
    the folder, or another file of their names, goes. Ctrl-C leaves a checkpoint, as in the program.
    Errors: ConfigError; RecordError; what on_step raises, with a checkpoint left.
    """
    record = folder(out)
    given = _given(config, overrides, record)
    written = _core.run_whole(*given, record, sys.argv[:], _brought(given), on_step, resume, replace)
    return json.loads((Path(written) / "run.json").read_text())
