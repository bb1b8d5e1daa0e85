"""The interval over scenes covers what it says; the bootstrap that was used before, which lives here alone, did not."""

import numpy as np
import pytest

from barrierbench_analysis.studies.claims import coverage
from barrierbench_analysis.studies.claims.coverage import SCENES, by_scene, floor, share_covered, simulations

DRAWS, OLD_RUNS = 400, 400


def old_bootstrap(drawn: np.ndarray, seed: int = 20261122) -> tuple[np.ndarray, np.ndarray]:
    """Before 2026-11-23: scenes are drawn with replacement, then their levels, then the starts of each."""
    random, found = np.random.default_rng(seed), []
    for cells in drawn:
        scenes, levels, starts = cells.shape
        s = random.integers(scenes, size=(DRAWS, scenes, 1, 1))
        lv = random.integers(levels, size=(DRAWS, scenes, levels, 1))
        k = random.integers(starts, size=(DRAWS, scenes, levels, starts))
        found.append(np.quantile(cells[s, lv, k].mean(axis=(1, 2, 3)), (0.025, 0.975)))
    return tuple(np.array(found).T)


@pytest.fixture(scope="module")
def drawn():
    return {(effects, scenes): values for effects, scenes, values in simulations()}


def test_the_interval_covers(drawn):
    found = {place: share_covered(by_scene, values) for place, values in drawn.items()}
    assert {place[0] for place in found} == {"normal", "uniform", "mildly skewed", "two clusters"} and {place[1] for place in found} == {3, 4, 6, 8, 12}
    for place, share in found.items():
        assert floor(*place) <= share <= 0.97, (place, share)
    assert all(0.93 <= found["normal", n] <= 0.97 for n in SCENES)


def test_the_floor_of_two_clusters_is_what_no_method_sees():
    assert floor("two clusters", 3) == pytest.approx(0.74) and floor("two clusters", 4) == pytest.approx(0.865)
    assert all(floor(effects, n) >= 0.92 for effects in ("normal", "uniform", "mildly skewed") for n in SCENES)


def test_the_old_bootstrap_did_not(drawn, capsys):
    shares = {n: (share_covered(old_bootstrap, drawn["normal", n][:OLD_RUNS]), share_covered(by_scene, drawn["normal", n][:OLD_RUNS])) for n in SCENES}
    with capsys.disabled():
        print("\ncoverage of normal scenes, bootstrap over scenes, levels and starts | Student's t over scenes:",
              "; ".join(f"{n}: {old:.3f} | {new:.3f}" for n, (old, new) in shares.items()))
    assert 0.70 <= shares[3][0] <= 0.82 and 0.74 <= shares[4][0] <= 0.86 and 0.80 <= shares[6][0] <= 0.91
    assert all(new - old > 0.03 for old, new in (shares[n] for n in (3, 4, 6)))


def test_levels_correlate_and_starts_are_alike(drawn):
    values = drawn["normal", 8]
    level = values.mean(axis=-1)
    assert np.corrcoef(level[..., 0].ravel(), level[..., 1].ravel())[0, 1] > 0.85
    within, total = values.var(axis=-1, ddof=1).mean(), values[..., 0].var()
    assert 1 - within / total == pytest.approx(0.99, abs=0.002)
    assert all(abs(v.mean()) < 0.02 and v[..., 0, 0].var() == pytest.approx(1.26, abs=0.1) for v in drawn.values())


def test_the_page_is_made_of_the_simulation():
    from barrierbench_analysis.studies.claims.entry import ROOT

    assert (ROOT / "results/COVERAGE.md").read_text() == coverage.markdown()
