"""Rules `proof`: a closed form, and the functions that the pipeline runs, asked by `barrierbench eval`,
against it.

Each proof says its law in the claim; the numbers here show that the program's functions obey it. They have no
interval but a range.
"""

import json
from dataclasses import dataclass, field

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import started

from .verdict import HOLDS, NOT, ONLY_IF, Judged


@dataclass
class Eval:
    """Answers of `eval`, kept under the text of their query. With fresh kept ones are asked again; without a
    program there are no others.
    """

    program: str | None
    answers: dict[str, dict] = field(default_factory=dict)
    fresh: bool = False
    asked: set[str] = field(default_factory=set)
    plugins: tuple[str, ...] = ()  # that the program loads

    def ask(self, **query) -> dict:
        text = json.dumps(query, sort_keys=True)
        if text in self.answers and (text in self.asked or not self.fresh):
            self.asked.add(text)
            return self.answers[text]
        self.asked.add(text)
        if self.program is None:
            raise UserError(f"no kept answer of eval to {text}: ./bench study claims asks it")
        done = started("eval", plugins=list(self.plugins), input=text + "\n")
        if done.returncode != 0:
            raise UserError(f"eval {text}: {done.stderr.strip() or done.stdout.strip()}")
        self.answers[text] = json.loads(done.stdout)
        return self.answers[text]


def _range(values: list[float], **more) -> dict:
    low, high = min(values), max(values)
    return {"value": low, "lower": low, "upper": high, "extremes": True, "proof": True, **more}


def rho_above(part: dict, asker: Eval) -> Judged:
    """rho(u) = d_hat b''/|b'| of `left` over that of `right` at gaps u: stiffness at equal load and gap."""

    def rho(u: float, side: str) -> float:
        return asker.ask(kind="rho", u=u, **part[side])["rho"]

    found = [(u, rho(u, "left") / rho(u, "right")) for u in part["u"]]
    above = [u for u, x in found if x > part["above"]]
    more = _range(
        [x for _, x in found],
        threshold=f"above {part['above']:g} at every gap",
        bounds=(part["above"],),
        measures="stiffness at equal load and gap, ratio",
        counted=f"{len(found)} gaps u from {min(part['u']):g} to {max(part['u']):g}",
    )
    if len(above) == len(found):
        return Judged(HOLDS, **more)
    if not above:
        return Judged(NOT, **more)
    some, every = (", ".join(f"{u:g}" for u in of) for of in (above, part["u"]))
    return Judged(ONLY_IF, condition=f"u in {some} of {every}", **more)


def light_touch(part: dict, asker: Eval) -> Judged:
    """Stiffness of a contact under a small part of the load at which shapes push alike, over that of the
    other shapes: has to grow without bound as the load falls, and to be above a number at the smallest.
    """

    def stiffness(shape: str, load: float) -> float:
        matched = {"kind": "match", "rule": "equal_force", "load": 1.0, "theta": part["theta"]}
        kappa = asker.ask(shape=shape, d_hat=0.01, **matched)["kappa"]
        return asker.ask(kind="equilibrium", shape=shape, kappa=kappa, d_hat=0.01, load=load)["K"]

    loads = sorted(part["loads"], reverse=True)
    ratios = [[stiffness(part["shape"], f) / stiffness(other, f) for f in loads] for other in part["over"]]
    more = _range(
        [row[-1] for row in ratios],
        threshold=f"above {part['above']:g}, and growing",
        bounds=(part["above"],),
        measures=(
            f"stiffness of a contact at {loads[-1]:g} of the matched load: {part['shape']} /"
            f" {', '.join(part['over'])}"
        ),
        counted=f"{len(loads)} loads from {loads[0]:g} to {loads[-1]:g}",
    )
    growing = all(a < b for row in ratios for a, b in zip(row, row[1:]))
    return Judged(HOLDS if growing and all(row[-1] > part["above"] for row in ratios) else NOT, **more)


def unit_change(part: dict, asker: Eval) -> Judged:
    """kappa (kg/s^2, no length in it) of one contact in metres over that in millimetres: 1 where it is
    invariant.
    """

    def kappa(length: float) -> float:
        contact = {"weights": [1.0], "normal": [0.0, 0.0, 1.0], "masses": [0.001]}
        contact |= {"gap": 0.004 * length, "d_hat": 0.01 * length}
        terms = {"mass_term": part["mass_term"], "elastic_term": False}
        if part["mass_term"] in ("inertia", "scaled"):
            terms |= {"dt": 0.01, "c": 1.0}
        return asker.ask(kind="stiffness", policy="elasticity_inclusive", **terms, **contact)["kappa"]

    x = kappa(1.0) / kappa(1000.0)
    changes = abs(x - 1) > 1e-9
    return Judged(
        HOLDS if changes == part["changes"] else NOT,
        measures=f"kappa in m over kappa in mm: {part['mass_term']}",
        counted="one contact",
        **_range([x], threshold="not 1" if part["changes"] else "1", bounds=(1.0,)),
    )


def force_falls(part: dict, asker: Eval) -> Judged:
    """|b'| of a shape from a peak on falls to 0 towards contact: what is pushed past the peak is crushed.
    Value: largest load over that of
    the same shape on the gap at equal kappa.
    """

    def force(u: float, argument: str) -> float:
        return abs(asker.ask(kind="shape", shape=part["shape"], argument=argument, d=u, d_hat=1.0)["db"])

    u = part["u"]
    mine, other = [force(x, part["argument"]) for x in u], [force(x, "gap") for x in u]
    peak = max(range(len(u)), key=lambda k: mine[k])
    falls = all(mine[k] < mine[k + 1] for k in range(peak)) and mine[0] < 0.1 * mine[peak]
    never = all(other[k] > other[k + 1] for k in range(len(u) - 1))
    contact = {"kind": "equilibrium", "shape": part["shape"], "kappa": 1.0, "d_hat": 1.0, "load": 0.01}
    capacity = asker.ask(argument=part["argument"], **contact)["capacity"]
    whole = asker.ask(**contact)["capacity"]
    return Judged(
        HOLDS if peak > 0 and falls and never else NOT,
        measures=(
            f"largest load of {part['shape']} on {part['argument']} over that on the gap; its force peaks at"
            f" u = {u[peak]:g} and falls to {mine[0] / mine[peak]:.2g} of that at u = {u[0]:g}"
        ),
        counted=f"{len(u)} gaps",
        **_range([capacity / whole], threshold="peak above contact, force falls below it", bounds=(1.0,)),
    )


PROOFS = {proof.__name__: proof for proof in (rho_above, light_touch, unit_change, force_falls)}
