"""How often the 95% interval over scenes has the true mean in it: a seeded simulation, printed by `./bench
study claims --coverage`.
"""

from collections.abc import Callable, Iterator

import numpy as np

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.tables.estimate import student

SEED, RUNS = 20261123, 20000
SCENES = (3, 4, 6, 8, 12)
LEVELS, STARTS, INTRACLASS = 3, 5, 0.99
LEVEL_SD, LEVEL_CORRELATION = (
    0.5,
    0.5,
)  # beside scenes of standard deviation 1; of neighbouring levels of a scene
CLUSTER_SD = 0.3

# Effects of scenes, mean 0 and variance 1.
EFFECTS: dict[str, Callable] = {
    "normal": lambda random, size: random.standard_normal(size),
    "uniform": lambda random, size: random.uniform(-(3**0.5), 3**0.5, size),
    "mildly skewed": lambda random, size: (random.gamma(8, size=size) - 8) / 8**0.5,
    "two clusters": lambda random, size: random.choice([-1.0, 1.0], size) * (1 - CLUSTER_SD**2) ** 0.5
    + CLUSTER_SD * random.standard_normal(size),
}


def floor(effects: str, scenes: int) -> float:
    """What coverage may not fall below. Two clusters: with probability 2^(1-n) all n scenes are of one
    cluster and nothing in the data tells of the other, so that share is lost to every method; a percent more
    where few values make a lattice. Uniform and skewed: three scenes show neither tail nor edge.
    """
    if effects == "normal":
        return 0.93
    return min(0.92, 1 - 2.0 ** (1 - scenes) - 0.01) if effects == "two clusters" else 0.92


def draw(effects: str, scenes: int, runs: int, random: np.random.Generator) -> np.ndarray:
    """runs x scenes x levels x starts, of true mean 0: effect of a scene, levels correlated within it, starts
    with an intraclass correlation of 0.99.
    """
    made = np.broadcast_to(EFFECTS[effects](random, (runs, scenes))[..., None], (runs, scenes, LEVELS)).copy()
    level = random.standard_normal((runs, scenes))
    for k in range(LEVELS):
        if k:
            level = LEVEL_CORRELATION * level + (1 - LEVEL_CORRELATION**2) ** 0.5 * random.standard_normal(
                (runs, scenes)
            )
        made[..., k] += LEVEL_SD * level
    start_sd = ((1 + LEVEL_SD**2) * (1 - INTRACLASS) / INTRACLASS) ** 0.5
    return made[..., None] + start_sd * random.standard_normal((runs, scenes, LEVELS, STARTS))


def by_scene(drawn: np.ndarray) -> tuple:
    """The interval that verdicts use: of the mean over levels of the mean over starts."""
    return student(drawn.mean(axis=-1).mean(axis=-1))


def share_covered(interval: Callable, drawn: np.ndarray) -> float:
    lower, upper = interval(drawn)
    return float(np.mean((lower <= 0) & (upper >= 0)))


def simulations(runs: int = RUNS) -> Iterator[tuple[str, int, np.ndarray]]:
    """Every kind of effects and number of scenes, each with a seed of its own."""
    for k, effects in enumerate(EFFECTS):
        for scenes in SCENES:
            yield effects, scenes, draw(effects, scenes, runs, np.random.default_rng((SEED, k, scenes)))


TEMPLATE = ROOT / "configs" / "studies" / "claims_coverage.md"


def markdown() -> str:
    found = {(effects, scenes): share_covered(by_scene, drawn) for effects, scenes, drawn in simulations()}
    rows = [
        [effects, *(f"{found[effects, n]:.3f} (floor {floor(effects, n):.3f})" for n in SCENES)]
        for effects in EFFECTS
    ]
    table = table_lines(["effects of scenes", *(f"{n} scenes" for n in SCENES)], rows)
    numbers = {
        "runs": RUNS,
        "levels": LEVELS,
        "starts": STARTS,
        "intraclass": INTRACLASS,
        "level_sd": LEVEL_SD,
    }
    return filled(TEMPLATE, numbers | {"level_correlation": LEVEL_CORRELATION, "table": "\n".join(table)})
