"""The methods text of a report: sentences for a paper, made of what the records say of themselves."""

import re
import shlex
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.tables.words import counted, listed

from .gather import Entry, Folder
from .tables import shown_path

ESTIMATORS = ("ritz", "inverse_power", "spectra", "dense", "lanczos")  # by the number in records
OWN_FRICTION = re.compile(r"/scene/(bodies|obstacles)/\d+/friction")


def _text(value) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _values(values: list) -> str:
    """Each value; where there are several, in how many runs."""
    known = Counter(_text(value) for value in values if value not in (None, ""))
    if len(known) == 1 and sum(known.values()) == len(values):
        return next(iter(known))
    words = [f"{value} ({counted(n, 'run')})" for value, n in known.most_common()]
    return listed(words) or "not recorded"


class Said:
    """Values of the runs, by column of their rows or by pointer of their settings."""

    def __init__(self, entries: list[Entry]):
        self.entries = entries

    def of(self, name: str) -> str:
        source = [entry.settings if name.startswith("/") else entry.row for entry in self.entries]
        return _values([values.get(name) for values in source])

    def of_each(self, value: Callable[[Entry], object]) -> str:
        return _values([value(entry) for entry in self.entries])


def _scenes(entries: list[Entry]) -> str:
    scenes: dict[str, list[Entry]] = {}
    for entry in entries:
        scenes.setdefault(entry.row["scene"], []).append(entry)
    parts = []
    for name, runs in scenes.items():
        sizes = sorted(
            {run.row["scene_free_dofs"] for run in runs if run.row.get("scene_free_dofs") is not None}
        )
        span = f"{sizes[0]} to {sizes[-1]}" if len(sizes) > 1 else _text(sizes[0]) if sizes else "unknown"
        parts.append(f"{name} ({counted(len(runs), 'run')}, {span} unknowns)")
    return listed(parts, 12)


def _formulations(entries: list[Entry]) -> str:
    of: dict[str, set] = {}
    for entry in entries:
        of.setdefault(entry.row["formulation"], set()).add(str(entry.row.get("stiffness_policy") or "?"))
    return listed([f"{name} (stiffness policy {listed(sorted(rules))})" for name, rules in of.items()], 20)


def _method(said: Said) -> list[str]:
    published = [entry for entry in said.entries if entry.row.get("method")]
    text = [
        f"Formulations: {_formulations(said.entries)}. The width of the barrier d_hat is"
        f" {said.of('d_hat_m')} m."
    ]
    if published:
        words = _values([entry.row["method"] for entry in published])
        text.append(f"Published methods in one piece: {words}, in {counted(len(published), 'run')}.")
    text.append(
        f"Stiffness by the matching rule {said.of('matching_rule')}, theta {said.of('matching_theta')}, with"
        f" loads from: {said.of('matching_load_source')}. Strain limit: {said.of('/strain_limit/enabled')}."
    )
    return text


def _estimator(entry: Entry) -> str | None:
    """Of condition numbers: records have its number."""
    number = entry.settings.get("/diagnose/tier")
    return None if number is None else ESTIMATORS[int(number)]


def _duration_s(entry: Entry) -> float | None:
    """Simulated time that was asked for, in whichever form."""
    given = entry.settings.get("/time/duration_s")
    steps, dt = entry.settings.get("/time/steps"), entry.row.get("dt_s") or entry.settings.get("/time/dt_s")
    return given if given is not None or not (steps and dt) else steps * dt


def _friction(entry: Entry) -> str:
    """Law and coefficients of the contacts of a run: of bodies and obstacles, and of the rest."""
    settings = entry.settings
    own = [
        value for pointer, value in settings.items() if OWN_FRICTION.fullmatch(pointer) and value is not None
    ]
    rest = settings.get("/friction/mu") or 0.0
    if not rest and not any(own):
        return "none"
    words = f"coefficient {rest:g}"
    if (most := settings.get("/friction/mu_static")) is not None:
        words += f" ({most:g} while it sticks)"
    if own:
        words += (
            f", {listed([f'{value:g}' for value in sorted(set(own))])} of bodies or obstacles with their own"
        )
    slide = settings.get("/friction/eps_m")
    threshold = (
        f"a sliding speed of {_text(settings.get('/friction/eps_v_m_per_s'))} m/s"
        if slide is None
        else f"a slide of {_text(slide)} m in a step"
    )
    if settings.get("/friction/refresh") == "per_iteration":
        loads = "with the loads of every iterate"
    else:
        loads = (
            f"solved {counted(settings.get('/friction/lag_iterations') or 1, 'time')} a step for its loads"
        )
    return (
        f"law {settings.get('/friction/law', 'not recorded')}, {words}, of two sides by the rule"
        f" {settings.get('/friction/combine', 'not recorded')}, full above {threshold}, {loads}"
    )


def _solver(said: Said) -> list[str]:
    return [
        f"Time integrator {said.of('integrator')}, time step {said.of('dt_s')} s, duration"
        f" {said.of_each(_duration_s)} s. Friction: {said.of_each(_friction)}.",
        f"Step solver {said.of('step_solver')} with at most"
        f" {said.of('/step_solver/max_iterations')} iterations a step, to a Newton direction of"
        f" {said.of('/step_solver/tol_velocity_m_per_s')} m/s; Hessian {said.of('/contact/hessian_mode')};"
        f" precision {said.of('precision')}.",
        f"Linear solver {said.of('linear_solver')}, preconditioner {said.of('preconditioner')}.",
        f"Passes: time {said.of('passes_time')}, diagnose {said.of('passes_diagnose')}, audit"
        f" {said.of('passes_audit')}. The passes diagnose and audit share a second run, whose times are not"
        f" reported. Condition numbers of every diagnosed iteration (one in {said.of('/diagnose/every')},"
        f" estimator {said.of_each(_estimator)}).",
    ]


def _machine(said: Said) -> list[str]:
    days = sorted({str(entry.row.get("started_utc") or "")[:10] for entry in said.entries} - {""})
    day = " to ".join(dict.fromkeys((days[0], days[-1]))) if days else "an unknown day"
    commits = [str(entry.row.get("provenance_git_commit") or "")[:10] for entry in said.entries]
    dirty = sum(bool(entry.row.get("provenance_git_dirty")) for entry in said.entries)
    return [
        f"Run on {day} (UTC) on {said.of('machine_cpu_model')}, {said.of('machine_cores')} cores,"
        f" {said.of('machine_os')}, {said.of('machine_kernel')}; {said.of('provenance_threads')} threads;"
        f" BLAS"
        f" kernel {said.of('provenance_blas_kernel')}.",
        f"barrierbench {said.of('provenance_tool_version')}, commit {_values(commits)}"
        + (f" (files differed from it in {counted(dirty, 'run')})" if dirty else "")
        + f", compiled by {said.of('provenance_compiler')} with {said.of('provenance_flags')}; record schema"
        f" {said.of('schema_version')}.",
    ]


def text(folder: Folder) -> list[str]:
    """Paragraphs."""
    said, good = Said(folder.entries), sum(entry.good for entry in folder.entries)
    total = len(folder.entries)
    begin = (
        f"{counted(total, 'run').capitalize()} of"
        f" {counted(len(folder.groups), 'sweep or scene', 'sweeps or scenes')}"
        f" ({listed(list(folder.groups))}); {good} ended ok and valid, and failures are kept in every count."
        f" Scenes: {_scenes(folder.entries)}."
    )
    statistic = (
        "Condition numbers of a run are medians over its diagnosed iterations; factors are quotients over the"
        " reference that the record names, of pairs that the program calls comparable, as geometric means."
    )
    paragraphs = [begin, *_method(said), *_solver(said), statistic, *_machine(said)]
    if references := _references(folder.entries):
        paragraphs.append(references)
    return paragraphs


def _references(entries: list[Entry]) -> str:
    sources = dict.fromkeys(
        f"{entry.row['method_name']}: {entry.row['method_source']}"
        for entry in entries
        if entry.row.get("method_name") and entry.row.get("method_source")
    )
    return f"Publications of these methods: {'; '.join(sources)}." if sources else ""


def sweep_commands(folder: Folder) -> list[str]:
    """The line of each sweep whose file is in this repository as it was read; each once."""
    lines = {}
    for entry in folder.entries:
        words = entry.argv[1:]
        if len(words) < 2 or words[0] != "sweep":
            continue
        asked, kept = Path(words[1]), entry.path.parent.parent / "sweep.json"
        file = asked if asked.is_absolute() else ROOT / asked
        same = (
            file.is_file() and kept.is_file() and input_file.read_bytes(file) == input_file.read_bytes(kept)
        )
        if same and file.is_relative_to(ROOT):
            out = "" if entry.in_archive else f" --out {shlex.quote(str(shown_path(kept.parent)))}"
            lines[f"./bench sweep {file.relative_to(ROOT)}{out}"] = None
    return list(lines)
