"""Main effects and interactions of the factors, with the scenes as samples (docs/results/method/ablation.md).

In a scene, numbers are fitted by least squares with one column a level that is not the first of its factor;
an interaction adds the products of the columns of two factors. What the runs of a scene cannot distinguish
has no value there: its column is no combination of rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.estimate import sign_test
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import holm, mean_over

from .bound import Contexts, Part, compared, contexts, direct, is_bound, left_out
from .factors import Combination, Factorial
from .flips import sign_flip

LEAST_SCENES = 10  # with fewer no effect out of 19 can be decided: 19 * 2^(1 - 9) = 0.074
LEAST_FREEDOM = 10  # of the residual of a scene: with few its value hangs on one or two runs
LEVEL = 0.05
METRICS = ("newton", "bj_p95", "pcg", "gap")  # of runs that ended ok and valid
SHARES = {"ok": lambda row: row.outcome == OK, "common": lambda row: not row.values["failed"]}
TESTED = 1e-8  # of a column: how much of it the rows may leave undetermined
NOTHING = 1e-9  # an effect below is the rounding of a fit, and no sign of anything
Samples = dict[str, tuple[list[Combination], list[float]]]  # scene -> levels and value of its runs


@dataclass(frozen=True)
class Term:
    """One column: (factor, level), or two of them for an interaction."""

    parts: tuple[tuple[int, int], ...]

    def column(self, levels: np.ndarray) -> np.ndarray:
        """levels: [runs, factors]; 1 where a run has the levels of the term, else 0."""
        return np.logical_and.reduce([levels[:, f] == level for f, level in self.parts]).astype(float)


@dataclass(frozen=True)
class Effect:
    """scenes: name -> logarithm of a ratio, or difference of shares. p: of the sign-flip test of their mean.
    holm: p times Holm's factor among the effects of its number; None below LEAST_SCENES scenes. direct: of
    the runs without the levels `without`, the first that does not agree; None where all agree (bound.py).
    """

    metric: str
    term: Term
    scenes: dict[str, float]
    mean: float | None = None
    low: float | None = None
    high: float | None = None
    p: float | None = None
    holm: float | None = None
    direct: Effect | None = None
    without: tuple[Part, ...] = ()

    @property
    def passes(self) -> bool:
        """The test, whatever the direct effect says."""
        return self.holm is not None and self.holm < LEVEL

    def same(self, one: Effect) -> bool:
        """Whether another has its sign, and p < LEVEL by itself."""
        return one.p is not None and one.p < LEVEL and one.mean * self.mean > 0

    @property
    def decided(self) -> bool:
        return self.passes and self.direct is None

    @property
    def signs(self) -> tuple[int, int]:
        """Scenes in which it is above and below nothing."""
        values = self.scenes.values()
        return sum(v > 0 for v in values), sum(v < 0 for v in values)

    @property
    def sign_p(self) -> float:
        return sign_test(*self.signs)


def main_terms(factorial: Factorial) -> list[Term]:
    return [Term(((f, level),)) for f, n in enumerate(factorial.sizes) for level in range(1, n)]


def pair_terms(factorial: Factorial, a: int, b: int) -> list[Term]:
    sizes = factorial.sizes
    return [Term(((a, i), (b, j))) for i in range(1, sizes[a]) for j in range(1, sizes[b])]


def samples(factorial: Factorial, rows: list[Row], metric: str) -> Samples:
    """Of the runs that have the number: its logarithm; of a share 0 or 1, of every run."""
    found: Samples = {scene: ([], []) for scene in factorial.scenes.labels}
    for row in rows:
        levels, values = found[row.place["scene"]]
        if metric in SHARES:
            values.append(float(SHARES[metric](row)))
        elif row.outcome == OK and row.values[metric]:
            values.append(float(np.log(row.values[metric])))
        if len(values) > len(levels):
            levels.append(factorial.levels_of(row))
    return found


def fitted(
    levels: list[Combination],
    y: list[float],
    terms: list[Term],
    wanted: list[Term],
    freedom: int = LEAST_FREEDOM,
) -> dict[Term, float]:
    """Coefficients of `wanted` that the rows determine, with a constant. Empty where fewer than `freedom`
    degrees are left for the residual.
    """
    if not y:
        return {}
    array = np.asarray(levels)
    x = np.column_stack([np.ones(len(y)), *(term.column(array) for term in terms)])
    inverse = np.linalg.pinv(x, rcond=1e-10)
    resolution = inverse @ x  # of columns: the identity where all are determined
    if len(y) - round(float(np.trace(resolution))) < freedom:
        return {}
    solution = inverse @ np.asarray(y)
    off = np.abs(resolution - np.eye(x.shape[1])).max(axis=1)
    return {
        term: float(solution[k + 1]) for k, term in enumerate(terms) if term in wanted and off[k + 1] < TESTED
    }


def over_scenes(metric: str, term: Term, scenes: dict[str, float]) -> Effect:
    """Mean, Student's interval and p of the scene values, where rounding is taken for nothing."""
    scenes = {scene: value if abs(value) > NOTHING else 0.0 for scene, value in scenes.items()}
    if not scenes:
        return Effect(metric, term, scenes, None)
    values = np.array(list(scenes.values()))
    mean = mean_over(values)
    p = sign_flip(values) if len(values) >= LEAST_SCENES else None
    return Effect(metric, term, scenes, mean.value, mean.lower, mean.upper, p)


def with_holm(effects: list[Effect]) -> list[Effect]:
    of = iter(holm([effect.p for effect in effects if effect.p is not None]))
    return [effect if effect.p is None else replace(effect, holm=next(of)) for effect in effects]


def _of(metric: str, of: Samples, mains: list[Term], wanted: list[Term]) -> list[Effect]:
    terms = list(dict.fromkeys([*mains, *wanted]))
    found: dict[Term, dict[str, float]] = {term: {} for term in wanted}
    for scene, sample in of.items():
        for term, value in fitted(*sample, terms, wanted).items():
            found[term][scene] = value
    return [over_scenes(metric, term, scenes) for term, scenes in found.items()]


def _beside(factorial: Factorial, of: Samples, allowed: Contexts, effect: Effect) -> Effect:
    """With the first direct effect that does not agree. Without some levels fewer scenes have it: fewer than
    LEAST_SCENES decide nothing, but where nothing is left out, and exclusions bind the level, they do not
    agree.
    """
    part, mains = effect.term.parts[0], main_terms(factorial)
    scenes = {}
    for scene in effect.scenes:
        others = {term.parts[0]: value for term, value in fitted(*of[scene], mains, mains).items()}
        scenes[scene] = compared(allowed, part, *of[scene], None if effect.metric in SHARES else others)
    for out in left_out(factorial, part[0], is_bound(allowed, part)):
        found = {scene: direct(part, runs, out) for scene, runs in scenes.items()}
        known = {scene: value for scene, value in found.items() if value is not None}
        one = over_scenes(effect.metric, effect.term, known)
        if not effect.same(one) and (one.p is not None or not out):
            return replace(effect, direct=one, without=out)
    return effect


def main_effects(factorial: Factorial, rows: list[Row], metric: str) -> list[Effect]:
    """In the order of the factors; of those that pass the test, what takes them back beside them."""
    of, mains, allowed = samples(factorial, rows, metric), main_terms(factorial), contexts(factorial)
    found = with_holm(_of(metric, of, mains, mains))
    return [_beside(factorial, of, allowed, effect) if effect.passes else effect for effect in found]


def pair_effects(factorial: Factorial, rows: list[Row], metric: str) -> list[Effect]:
    """Interactions, fitted for one pair of factors at a time."""
    of, mains = samples(factorial, rows, metric), main_terms(factorial)
    pairs = (pair_terms(factorial, a, b) for a, b in combinations(range(len(factorial.factors)), 2))
    return with_holm([effect for terms in pairs for effect in _of(metric, of, mains, terms)])
