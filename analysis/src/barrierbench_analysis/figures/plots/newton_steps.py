"""Residual curves of single time steps, one line a choice of Hessian, from the file that `./bench data steps
--out` writes.
"""

import json
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import is_number, read_of_schema

SCHEMA = "barrierbench.steps/1"
# colour and dash of each choice; black is the default of line_search
LOOKS = {
    "clamped": ("#0072b2", "-"),
    "absolute": ("#56b4e9", "--"),
    "exact_or_clamped": ("#d55e00", "-."),
    "progressive": ("#009e73", "--"),
    "blend": ("#000000", "-"),
}
SHOWN = (
    "{scene}, {formulation}: largest entry of the Newton direction over the iterations of single time steps,"
    " each step from one state with every choice of Hessian for all terms; both axes logarithmic. Dashed"
    " line: the tolerance; a step ends when its estimated error, not |dx|, is below. A cross: not converged."
)
JUMP = 10.0  # times |dx| of the iteration before: a jump
JUMPS = (
    "Rings: |dx| at least {jump:g} times that of the iteration before: {list}. {switch}The file does not name"
    " the matrix of an iteration; a trace does (hessian_t)."
)
SWITCH = (
    "exact_or_clamped tries the exact matrix, and takes the clamped one for two iterations whenever that is"
    " not positive definite: where it jumps with |dx| above the tolerance, the exact matrix has become"
    " positive definite again, but barely, so that its direction is long and the line search takes a part of"
    " it. "
)
RING = "ring"  # gid
AFTER_SADDLE = ", after a direction below the tolerance: the step goes on from a saddle"


# what a figure needs of a trial: is it so, and what is allowed
TRIAL = {
    "step": (lambda value: isinstance(value, int) and value >= 0, "an integer of 0 or more"),
    "hessian": (lambda value: value in LOOKS, f"one of {', '.join(LOOKS)}"),
    "status": (lambda value: isinstance(value, str), "a word"),
    "tolerance_m": (is_number, "a finite number"),
    "dx_inf_m": (
        lambda value: isinstance(value, list) and all(is_number(dx) for dx in value),
        "a list of finite numbers",
    ),
}


def read_steps(path: Path) -> dict:
    """The file as it is. Raises UserError with place, value and what is allowed when it is none of `./bench
    data steps --out`.
    """
    data = read_of_schema(path, SCHEMA, "; ./bench data steps --out makes it")
    trials, config = data.get("trials"), data.get("config")
    if not isinstance(trials, list) or not trials:
        raise UserError(f"{path}#/trials: no trials; allowed: a list of at least one")
    if not isinstance(config, dict) or not all(
        isinstance(config.get(name), dict) for name in ("scene", "formulation")
    ):
        raise UserError(
            f"{path}#/config: found {json.dumps(config)[:60]}; allowed: the resolved config of the run"
        )
    for k, trial in enumerate(trials):
        for name, (is_right, allowed) in TRIAL.items():
            found = trial.get(name) if isinstance(trial, dict) else None
            if not is_right(found):
                raise UserError(
                    f"{path}#/trials/{k}/{name}: found {json.dumps(found)[:60]}; allowed: {allowed}"
                )
    return data


def numbers(data: dict) -> pd.DataFrame:
    """One row an iteration."""
    columns = ["step", "hessian", "iteration", "dx_inf_m", "status", "tolerance_m"]
    rows = [
        {**trial, "iteration": k, "dx_inf_m": dx}
        for trial in data["trials"]
        for k, dx in enumerate(trial["dx_inf_m"], 1)
    ]
    return pd.DataFrame(rows, columns=columns)


def jumps(table: pd.DataFrame) -> pd.DataFrame:
    """Rows of numbers() whose direction is JUMP times that of the iteration before, with `before_m`."""
    before = table.groupby(["step", "hessian"], sort=False)["dx_inf_m"].shift()
    return table.assign(before_m=before)[table["dx_inf_m"] >= JUMP * before]


def jump_sentence(found: pd.DataFrame, data: dict) -> str:
    """What a caption says of the rings; empty without one."""
    if found.empty:
        return ""
    failed = {(trial["step"], trial["hessian"]): trial.get("hessian_fallbacks") for trial in data["trials"]}
    words = []
    for row in found.itertuples():
        text = (
            f"{row.hessian}, step {row.step}, iteration {row.iteration} ({row.before_m:.1e} to"
            f" {row.dx_inf_m:.1e} m)"
        )
        if row.before_m < row.tolerance_m:
            text += AFTER_SADDLE
        elif row.hessian == "exact_or_clamped" and (attempts := failed[row.step, row.hessian]):
            text += f", failed attempts with the exact matrix in this step: {attempts}"
        words.append(text)
    switched = ((found["hessian"] == "exact_or_clamped") & (found["before_m"] >= found["tolerance_m"])).any()
    return JUMPS.format(jump=JUMP, list="; ".join(words), switch=SWITCH if switched else "")


def same_sentence(table: pd.DataFrame) -> str:
    """Which choices of a step have one line, the last one drawn over the others; empty without any."""
    words = []
    for step, of_step in table.groupby("step"):
        names: dict[tuple, list[str]] = {}
        for hessian, part in of_step.groupby("hessian", sort=False):
            names.setdefault(tuple(part["dx_inf_m"]), []).append(hessian)
        words += [f"{', '.join(same)} in step {step}" for same in names.values() if len(same) > 1]
    return f"One line: {'; '.join(words)}." if words else ""


def figure(data: dict, stem: Path) -> list[Path]:
    """One panel a step. Returns the files that were written."""
    table = numbers(data)
    found = jumps(table)
    steps = sorted(table["step"].unique())
    fig, axes = plt.subplots(
        1, len(steps), figsize=(style.WIDE_IN, 2.9), sharey=True, squeeze=False, layout="constrained"
    )
    for axis, step in zip(axes[0], steps):
        for hessian, part in table[table["step"] == step].groupby("hessian", sort=False):
            color, dash = LOOKS[hessian]
            axis.plot(part["iteration"], part["dx_inf_m"], dash, color=color, linewidth=1.1, label=hessian)
            if part["status"].iloc[0] != "converged":
                axis.plot(part["iteration"].iloc[-1:], part["dx_inf_m"].iloc[-1:], "x", color=color)
            ring = found[(found["step"] == step) & (found["hessian"] == hessian)]
            hollow = {"markersize": 7, "markerfacecolor": "none", "color": color, "gid": RING}
            axis.plot(ring["iteration"], ring["dx_inf_m"], "o", **hollow)
        axis.set(xscale="log", yscale="log", xlabel=f"Newton iteration of step {step}, counted from 1")
    for axis in axes[0]:  # the axes share y: its limits are set when all lines are there
        style.reference_line(axis, table["tolerance_m"].iloc[0], "tolerance", "--")
    axes[0, 0].set_ylabel(r"$|\Delta x|_\infty$ (m)")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0, 0])
    config = data["config"]
    formulation = config["formulation"].get("name") or config["formulation"].get("shape", "unknown")
    shown = SHOWN.format(scene=config["scene"].get("name", "bodies"), formulation=formulation)
    return style.save(
        fig,
        stem,
        table.assign(jump=table.index.isin(found.index)),
        " ".join(filter(None, [shown, same_sentence(table), jump_sentence(found, data)])),
    )


def make(file: Path, out: Path | None) -> int:
    """The figure of a file of `./bench data steps --out`; the exit code."""
    for path in figure(read_steps(file), (out or file.parent) / file.stem):
        print(path)
    return 0
