"""results/STEPS.md of a record of ./bench data steps --corpus."""

from __future__ import annotations

from itertools import groupby

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.tables.numbers import significant

from .step_corpus_states import HALVES

SOLVER = "line_search"
OWN = "blend"  # the rule that a run has by itself
EXACT = ", exact friction"  # beside a rule: without the secant of friction
HEAD = """# Hard time steps

Single time steps of runs that take many iterations for different reasons, each from a state that is kept in
`results/steps`: `NAME.state` is the run in front of the step (an archive of its simulation, compressed),
`NAME.json` its config, calibration, step, scene hash and what it is hard for.

```sh
./bench data steps --corpus results/steps             # every step solver and Hessian, as tables
./bench data steps --corpus results/steps --split tune # the half that options are tuned on
./bench data steps CONFIG --at 12 --keep out/mine     # a state of your own: two files
./bench study step-corpus                              # states, record, page and figure anew
./bench study step-corpus --make                       # the states alone
./bench study step-corpus --table                      # page and figure, from results/steps.json
```

Halves: in alphabetical order every other state belongs to the half `tune`, beginning with the first, and
the others to `report`.

Every trial begins in one state and is judged by one reference: `line_search` with the Hessian `blend` at a
thousandth of the run's tolerance, whose end is the minimum A. A trial that converges farther than ten
tolerances from all known minima is continued to a thousandth of the tolerance, and its end is the next
letter. Where that does not confirm its end, its distance from A is stated instead. *To tol* counts
iterations until the true error, the largest coordinate of x - x_min, was first below the tolerance; `-`: it
never was. Step solvers other than `line_search` have their own Hessian and settings; multipliers begin at
0, `xpbd` and `projection` sweep and have no iterations, and solvers with multipliers minimise another
function, so that few of them end near a letter. `accumulated_toi` may end its step earlier in time than
asked, which counts as an error here.

Why an iteration was short or many (one cause each, so that they add up): *full*: the whole direction of the
first matrix that the Hessian rule made; *indefinite*: the whole direction of a regularised matrix, since
the first one was not positive definite, or a move along negative curvature; *contact* and *limit*: the
smaller bound, of ACCD or of the strain limit, held it; *Armijo*: less was taken than the bound allows;
*noise*: the change of E was below rounding; *failed*: no usable direction. *Regularised* counts all
iterations with a regularised matrix, whatever held them then.

*Exact friction*: without the secant that friction's matrix has after a shortened step (`/friction/hessian`);
`-`: the state has no friction.

![iterations by cause, and by Hessian rule](../docs/steps.png)
"""


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


def _count(value: int | None) -> str:
    return "-" if value is None else str(value)


def _cell(state: dict, trial: dict) -> str:
    """Iterations, those to the tolerance, and where it ended unless that is A."""
    if "refused" in trial:
        return "-"
    if trial["status"] != "converged":
        return f"{trial['iterations']}, {trial['status'].replace('_', ' ')}"
    counts = f"{trial['iterations']} ({_count(trial['iterations_to_tolerance'])})"
    if trial["minimum"] == "A" or trial["error_m"] is None:
        return counts
    far = f"{trial['error_m'] / state['tolerance_m']:.2g} tolerances from A"
    return f"{counts} {trial['minimum'] or far}"


def _states(record: dict) -> list[str]:
    head = ["state", "hard for", "half", "step", "vertices", "contacts", "linear solver", "reference"]
    rows = [
        [
            f"`{s['name']}`",
            s["hard_for"],
            s["split"],
            str(s["step"]),
            str(s["vertices"]),
            str(s["contacts"]),
            s["linear_solver"],
            f"{s['reference_iterations']}"
            + ("" if s["reference_status"] == "converged" else f", {s['reference_status']}"),
        ]
        for s in record["states"]
    ]
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
    work = (
        sum(t[key] for t in taken)
        for key in ("iterations", "linear_solves", "factorizations", "linear_iterations")
    )
    return [
        name,
        f"{len(done)} of {len(trials)}",
        f"{len(reached)}, {sum(reached)}",
        str(other),
        *(str(n) for n in work),
        f"{sum(t['seconds'] for t in taken):.1f}",
    ]


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
        for t in state["trials"]:
            if t["step_solver"] == SOLVER or "refused" in t:
                continue
            far = None if t["error_m"] is None else t["error_m"] / state["tolerance_m"]
            work = (t["linear_solves"], t["factorizations"], t["linear_iterations"])
            rows.append(
                [
                    f"`{state['name']}`",
                    t["step_solver"],
                    str(t["iterations"]),
                    _count(t["iterations_to_tolerance"]),
                    *(str(n) for n in work),
                    f"{t['seconds']:.2f}",
                    significant(far, 2),
                    t["minimum"] or "-",
                    t["status"].replace("_", " "),
                ]
            )
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
    if not states:
        return []
    rows = [[f"`{s['name']}`", s["hard_for"], s["split"], s["refused"]] for s in states]
    head = ["state", "hard for", "half", f"why {SOLVER} cannot take it"]
    return ["\n## States without trials\n", *markdown(head, rows)]


def page(record: dict) -> str:
    refused = [s for s in record["states"] if "refused" in s]
    record = {**record, "states": taken_states(record)}
    states = record["states"]
    taken = [t for s in states for t in s["trials"] if "refused" not in t]
    minutes = sum(s["seconds"] for s in states) / 60
    parts = [
        HEAD,
        f"{len(states)} states, {len(taken)} trials, {minutes:.1f} minutes of one processor with the"
        f" references ({record['cpu']}).",
        "\n## States\n",
        *_states(record),
        "\n## Hessian rules of line_search\n",
        "Iterations (to tol), and the minimum where it is not A.\n",
        *_rules(record),
        f"\n## Why: line_search, {OWN}\n",
        *_causes(record),
    ]
    for half in HALVES:
        parts += [f"\n## Totals of the half {half}\n", *_totals(record, half)]
    parts += ["\n## Other step solvers\n", *_solvers(record), "\n## Refused\n", *_refusals(record)]
    parts += _refused_states(refused)
    return "\n".join(parts) + "\n"
