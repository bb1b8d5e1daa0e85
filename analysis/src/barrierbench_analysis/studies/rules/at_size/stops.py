"""The work that three stop rules ask for, read from one run that goes on to a tolerance a hundred times as
tight: so that all of them are of the same steps.
"""

LOOSE = 1e-4  # of d_hat/h: the speed at which the program ends a step by default
RESIDUAL = 1e-2  # of the force that moves the mean vertex by d_hat in a step
GAP = 0.1  # of the gap at the end of the step
RULES = {
    "velocity": f"the direction moves no vertex by more than {LOOSE:g} d_hat",
    "residual": f"no entry of the gradient is above {RESIDUAL:g} of the inertia of a vertex times d_hat",
    "gap": f"the smallest gap is, and stays, within {GAP:.0%} of its value at the end of the step",
}
WORK = {
    "newton": "linear systems",
    "products": "matrix products of conjugate gradients",
    "flop": "operations of the Cholesky factorisations",
    "seconds": "seconds of the iterations",
}
FREE = 1.0  # gap in d_hat of a state without contact


def _gap(line: dict) -> float:
    found = line["gap_min_iterates_rel"]
    return FREE if found is None else found


def solved(of_step: list[dict], rule: str, limits: dict[str, float], end_gap: float) -> int | None:
    """How many systems of a step are solved when a rule holds; None where it never does. limits: velocity (m)
    and residual (N). The gradient and the gap of an iterate are known before its system is solved.
    """
    if rule == "velocity":
        at = (k + 1 for k, line in enumerate(of_step) if line["dx_inf_m"] <= limits["velocity"])
    elif rule == "residual":
        at = (k for k, line in enumerate(of_step) if line["grad_inf_N"] <= limits["residual"])
    else:
        far = [k for k, line in enumerate(of_step) if abs(_gap(line) - end_gap) > GAP * end_gap]
        return far[-1] + 1 if far else 0
    return next(at, None)


def until_slow(steps: dict[int, list[dict]], most_m: float) -> dict[int, list[dict]]:
    """The iterations of each step until its direction is as short as the program asks for by default."""
    limits = {"velocity": most_m}
    return {number: of[: solved(of, "velocity", limits, FREE)] for number, of in steps.items()}


def _work(lines: list[dict]) -> dict[str, float]:
    return {
        "newton": len(lines),
        "products": sum(line["linear_iterations"] for line in lines),
        "flop": sum(line["factor_flop"] for line in lines),
        "seconds": sum(sum(v for v in (line["time"] or {}).values() if v) for line in lines),
    }


def work(steps: dict[int, list[dict]], record: dict, limits: dict[str, float]) -> dict[str, float]:
    """RULE_WORK -> what a run takes to that rule in all of its steps, and RULE_missed -> steps in which the
    rule never holds, which count with all of their iterations. steps: lines of the trace by step.
    """
    ends = {step["step"]: step["gap_min_rel"] for step in record["steps"]}
    found: dict[str, float] = {}
    for rule in RULES:
        total, missed = dict.fromkeys(WORK, 0.0), 0
        for number, of in steps.items():
            end = FREE if ends.get(number) is None else ends[number]
            taken = solved(of, rule, limits, end)
            missed += taken is None
            for name, value in _work(of if taken is None else of[:taken]).items():
                total[name] += value
        found |= {f"{rule}_{name}": value for name, value in total.items()} | {f"{rule}_missed": missed}
    return found
