"""results/STEPS.md of a record of ./bench data steps --corpus."""

from itertools import groupby

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.tables.numbers import significant, written

from .step_corpus_states import HALVES

SOLVER = "line_search"
OWN = "blend"  # the rule that a run has by itself
EXACT = ", exact friction"  # beside a rule: without the secant of friction
WORK = ("linear_solves", "factorizations", "linear_iterations")
PAGE = ROOT / "configs" / "steps" / "page.md"  # template of results/STEPS.md


def taken_states(record: dict) -> list[dict]:
    """Those that line_search can take. Errors: UserError for none."""
    if not (out := [state for state in record["states"] if "refused" not in state]):
        raise UserError(f"steps.json: none of {len(record['states'])} states has trials; one is needed")
    return out


def rule_of(trial: dict) -> str:
    """Its Hessian in words."""
    return trial["hessian"] + (EXACT if trial["friction_hessian"] == "exact" else "")


def trial_of(state: dict, rule: str) -> dict:
    """The trial of line_search with that Hessian."""
    return next(t for t in state["trials"] if t["step_solver"] == SOLVER and rule_of(t) == rule)


def hessians(record: dict) -> list[str]:
    first = record["states"][0]["trials"]
    return [rule_of(t) for t in first if t["step_solver"] == SOLVER]


def others(record: dict) -> list[str]:
    """Step solvers beside line_search."""
    first = record["states"][0]["trials"]
    return [t["step_solver"] for t in first if t["step_solver"] != SOLVER]


def _cell(state: dict, trial: dict) -> str:
    """Iterations, those to the tolerance, and where it ended unless that is A."""
    if "refused" in trial:
        return "-"
    if trial["status"] != "converged":
        return f"{trial['iterations']}, {trial['status'].replace('_', ' ')}"
    counts = f"{trial['iterations']} ({written(trial['iterations_to_tolerance'])})"
    if trial["minimum"] == "A" or trial["error_m"] is None:
        return counts
    far = f"{trial['error_m'] / state['tolerance_m']:.2g} tolerances from A"
    return f"{counts} {trial['minimum'] or far}"


def _states(record: dict) -> list[str]:
    head = ["state", "hard for", "half", "step", "vertices", "contacts", "linear solver", "reference"]
    rows = []
    for s in record["states"]:
        status = "" if s["reference_status"] == "converged" else f", {s['reference_status']}"
        about = [
            str(s[key]) for key in ("hard_for", "split", "step", "vertices", "contacts", "linear_solver")
        ]
        rows.append([f"`{s['name']}`", *about, f"{s['reference_iterations']}{status}"])
    return markdown(head, rows)


def _rules(record: dict) -> list[str]:
    rules = hessians(record)
    rows = [[f"`{s['name']}`", *(_cell(s, trial_of(s, rule)) for rule in rules)] for s in record["states"]]
    return markdown(["state", *rules], rows)


def _causes(record: dict) -> list[str]:
    names = list(trial_of(record["states"][0], OWN)["causes"])
    rows, total = [], dict.fromkeys([*names, "all", "regularised"], 0)
    for state in record["states"]:
        trial = trial_of(state, OWN)
        counts = {**trial["causes"], "all": trial["iterations"], "regularised": trial["regularised"]}
        rows.append([f"`{state['name']}`", *(str(counts[name]) for name in total)])
        total = {name: total[name] + counts[name] for name in total}
    rows.append(["**all states**", *(str(count) for count in total.values())])
    return markdown(["state", *("Armijo" if name == "armijo" else name for name in total)], rows)


def _sums(name: str, trials: list[dict]) -> list[str]:
    """A row of totals over states."""
    taken = [t for t in trials if "refused" not in t]
    done = [t for t in taken if t["status"] == "converged"]
    reached = [t["iterations_to_tolerance"] for t in taken if t["iterations_to_tolerance"] is not None]
    other = sum(t["minimum"] not in (None, "A") for t in done)
    work = [str(sum(t[key] for t in taken)) for key in ("iterations", *WORK)]
    seconds = f"{sum(t['seconds'] for t in taken):.1f}"
    counts = [f"{len(done)} of {len(trials)}", f"{len(reached)}, {sum(reached)}", str(other)]
    return [name, *counts, *work, seconds]


def _totals(record: dict, half: str) -> list[str]:
    head = ["trial", "converged", "to tol: states, iterations", "other minima", "iterations", "solves"]
    head += ["factors", "products", "seconds"]
    states = [s for s in record["states"] if s["split"] == half]
    rows = [_sums(f"{SOLVER} {rule}", [trial_of(s, rule) for s in states]) for rule in hessians(record)]
    for solver in others(record):
        trials = [t for s in states for t in s["trials"] if t["step_solver"] == solver]
        if any("refused" not in t for t in trials):
            rows.append(_sums(solver, trials))
    return markdown(head, rows)


def _solvers(record: dict) -> list[str]:
    head = ["state", "step solver", "iterations", "to tol", "solves", "factors", "products", "seconds"]
    head += ["error, tolerances", "minimum", "status"]
    rows = []
    for state in record["states"]:
        for t in (t for t in state["trials"] if t["step_solver"] != SOLVER and "refused" not in t):
            far = None if t["error_m"] is None else t["error_m"] / state["tolerance_m"]
            work = [
                str(t["iterations"]),
                written(t["iterations_to_tolerance"]),
                *(str(t[key]) for key in WORK),
            ]
            end = [significant(far, 2), t["minimum"] or "-", t["status"].replace("_", " ")]
            rows.append([f"`{state['name']}`", t["step_solver"], *work, f"{t['seconds']:.2f}", *end])
    return markdown(head, rows)


def _refusals(record: dict) -> list[str]:
    """Each reason once, with the states that it holds for."""
    found = sorted(
        (t["step_solver"], t["refused"], s["name"])
        for s in record["states"]
        for t in s["trials"]
        if "refused" in t
    )
    count = len(record["states"])
    rows = []
    for (solver, why), group in groupby(found, key=lambda one: one[:2]):
        names = [name for _, _, name in group]
        rows.append([solver, why, "all" if len(names) == count else ", ".join(f"`{n}`" for n in names)])
    return markdown(["step solver", "why it is refused", "states"], rows)


def _refused_states(states: list[dict]) -> list[str]:
    rows = [[f"`{s['name']}`", s["hard_for"], s["split"], s["refused"]] for s in states]
    return markdown(["state", "hard for", "half", f"why {SOLVER} cannot take it"], rows) if rows else []


def page(record: dict) -> str:
    """results/STEPS.md. Errors: UserError where no state has trials."""
    states, refused = taken_states(record), [s for s in record["states"] if "refused" in s]
    taken = {**record, "states": states}
    tables = {
        "table": _states(taken),
        "rules": _rules(taken),
        "causes": _causes(taken),
        "solvers": _solvers(taken),
        "refusals": _refusals(taken),
        "without": _refused_states(refused),
    }
    numbers = {
        "states": len(states),
        "trials": sum("refused" not in t for s in states for t in s["trials"]),
        "minutes": sum(s["seconds"] for s in states) / 60,
        "cpu": record["cpu"],
        "own": OWN,
        "halves": {half: "\n".join(_totals(taken, half)) for half in HALVES},
    }
    return filled(PAGE, {**numbers, **{name: "\n".join(lines) for name, lines in tables.items()}})
