"""Kept hard steps with another barrier: copies whose config names the shape, with the stiffness at which it
carries the load at theta d_hat that the barrier of the state carries there.
"""

import functools
import json
import shutil
import subprocess
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.start import started

from . import shape

STATES = ROOT / "results" / "steps"
TRIAL = "line_search/blend"
LIMIT_S = 600  # of one call of the program, on the clock


def of_half(study_states: dict[str, list[str]], half: str) -> dict[str, dict]:
    """name -> kept state. Errors: UserError for one of another half, or with more than a fixed stiffness of
    contact."""
    found = {name: read_object(STATES / f"{name}.json") for name in study_states[half]}
    for name, state in found.items():
        config = state["config"]
        policy, limit = config["formulation"]["stiffness_policy"], config["strain_limit"]["enabled"]
        if state["split"] != half or policy["name"] != "fixed" or limit:
            raise UserError(
                f"{STATES / name}.json: found half {state['split']}, stiffness {policy['name']}, strain limit"
                f" {limit}; allowed: half {half}, fixed, no strain limit"
            )
    return found


def stiffness_of(state: dict) -> float:
    """Of its run, N/m."""
    calibrated = state["calibration"]["kappa_N_per_m"]
    given = state["config"]["formulation"]["stiffness_policy"]["kappa_N_per_m"]
    return given if calibrated is None else calibrated


@functools.cache
def _force_of_run(name: str, theta: float) -> float:
    return shape.terms_of(name, [theta])["force"][0]


def with_shape(state: dict, name: str, force: float, theta: float) -> dict:
    """The state with this shape, whose force at theta d_hat is `force` for kappa d_hat = 1."""
    found = json.loads(json.dumps(state))
    of_run = _force_of_run(state["config"]["formulation"]["shape"], theta)
    found["config"]["formulation"]["shape"] = name
    found["calibration"]["kappa_N_per_m"] = stiffness_of(state) * of_run / force
    return found


def taken(states: dict[str, dict], name: str, theta: float, plugins: list[str], folder: Path) -> dict | str:
    """The record of `steps --corpus` of these states with a shape, made in `folder`; or why the program
    refused the shape, crashed or did not end."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        force = shape.terms_of(name, [theta], plugins)["force"][0]
    except UserError as error:
        return str(error)
    for state, kept in states.items():
        (folder / f"{state}.json").write_text(json.dumps(with_shape(kept, name, force, theta)))
        shutil.copyfile(STATES / f"{state}.state", folder / f"{state}.state")
    out = folder / "taken.json"
    words = ["--corpus", str(folder), "--trials", TRIAL, "--without-reference", "--out", str(out)]
    try:
        done = started("steps", *words, "--progress", "none", plugins=plugins, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return f"not over after {LIMIT_S} s"
    if done.returncode != 0:
        return f"the program ended with {done.returncode}: {done.stderr.strip()[:400]}"
    return read_object(out)
