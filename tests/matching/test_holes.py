"""A run that failed in the middle of a sweep over stiffness, with whatever gap and cost it had reached: paths have a hole there, in the
fronts, on their page and figure, in claims at equal gap and in the gap map. All numbers have a closed form.
"""

import pytest
from made_runs import METRICS, page_of, row, runs_of

from barrierbench_analysis.studies.rules.gap_map import compare as gap_map
from barrierbench_analysis.studies.rules.pareto.figure import _means, failure_sentence
from barrierbench_analysis.studies.rules.pareto.fronts import Runs, at_gap, failures, over_shared, range_of, unreached

SCALES = (0.01, 0.1, 1.0, 10.0, 100.0)
HOLES = SCALES[1:-1]


def gap_of(scale: float) -> float:
    return 0.1 * scale**0.3


def runs(failed: float, outcome: str = "newton_stall", seeds=(1, 2), gap: bool = True) -> Runs:
    """newton = 2/gap of the log, 6/gap of the cubic, whose run at the scale `failed` ended otherwise with numbers that mean nothing."""
    rows = []
    for name, factor in (("log", 2.0), ("cubic", 6.0)):
        for scale in SCALES:
            for seed in seeds:
                values = {"gap": gap_of(scale), **dict.fromkeys(METRICS, factor / gap_of(scale))}
                if name == "cubic" and scale == failed:
                    values = {"outcome": outcome, "gap": 0.9 * gap_of(scale) if gap else None, **dict.fromkeys(METRICS, 1e-3)}
                rows.append(row("a", name, scale, seed, **values))
    return runs_of(rows)


@pytest.mark.parametrize("hole", HOLES)
@pytest.mark.parametrize("outcome", ["newton_stall", "stall_overload", "not_valid"])
@pytest.mark.parametrize("with_gap", [True, False])
def test_no_number_is_of_a_failed_run_or_across_it(hole, outcome, with_gap):
    made = runs(hole, outcome, gap=with_gap)
    k = SCALES.index(hole)
    low, high = gap_of(SCALES[k - 1]), gap_of(SCALES[k + 1])
    asked = 0
    for scale in (0.011, 0.05, 0.09, 0.12, 0.5, 0.95, 1.05, 3.0, 9.0, 11.0, 50.0, 99.0):
        gap = gap_of(scale)
        value, ratio = at_gap(made, "a", "cubic", "newton", gap)
        if low < gap < high:
            assert value is None and ratio is None, scale
        elif value is not None:
            assert value.value == pytest.approx(6 / gap) and ratio.value == pytest.approx(3)
            asked += 1
        assert at_gap(made, "a", "log", "newton", gap)[0].value == pytest.approx(2 / gap)
    assert asked >= (6 if k == 2 else 2)
    (found,) = [failures(made, "a", "cubic")]
    assert found == {hole: {outcome: 2}}


@pytest.mark.parametrize("hole", HOLES)
def test_what_both_reach_has_the_ratio_of_the_rest(hole):
    ratio = over_shared(runs(hole), "a", "cubic", "newton")
    assert ratio.value == pytest.approx(3) and (ratio.n, ratio.of) == (2, 2)


def test_ranges_end_at_the_hole():
    beside = runs(0.1)  # its neighbour 0.01 has no other one: it is no part of a path
    assert range_of(beside, "a", "cubic") == (pytest.approx(gap_of(1.0)), pytest.approx(gap_of(100.0)))
    assert range_of(beside, "a", "log") == (pytest.approx(gap_of(0.01)), pytest.approx(gap_of(100.0)))
    alone = runs_of([row for row in runs(1.0).rows if row.place["formulation"] == "cubic"])
    free = unreached(alone, "a")
    assert [(pytest.approx(a), pytest.approx(b)) for a, b in free] == [
        (0, gap_of(0.01)), (gap_of(0.1), gap_of(10.0)), (gap_of(100.0), 1.0)]  # fmt: skip


def test_one_start_that_failed_leaves_the_others():
    values = {"gap": gap_of(1.0), **dict.fromkeys(METRICS, 6 / gap_of(1.0))}
    made = runs_of([row("a", "cubic", 1.0, 2, **values) if r.place["seed"] == "2" and r.outcome != "ok" else r for r in runs(1.0).rows])
    value, ratio = at_gap(made, "a", "cubic", "newton", gap_of(2.0))
    assert value.value == pytest.approx(6 / gap_of(2.0)) and ratio.value == pytest.approx(3) and (value.n, value.of) == (1, 2)


@pytest.mark.parametrize("hole", HOLES)
def test_the_figure_and_the_page_show_the_hole(hole):
    made = runs(hole)
    found = _means(made, made.of("a", "cubic"), "newton")
    assert [scale for scale, point in found.items() if point is None] == [hole]
    for scale, point in found.items():
        assert point is None or point == (pytest.approx(gap_of(scale)), pytest.approx(6 / gap_of(scale)))
    assert f"cubic at x{hole:g}" in failure_sentence(made, "a", ("log", "cubic"))
    assert f"x{hole:g}: 2 newton_stall" in page_of(made, (0.1, 0.2))


def test_the_gap_map_has_it_too():
    thetas = (0.5, 0.25, 0.1, 0.05, 0.01)

    def row(shape, theta, **edit):
        place = {"scene": "a", "resolution": "n=8", "shape": shape, "limit": "off", "theta": theta, "outcome": "ok", "gap": theta}
        return place | dict.fromkeys(gap_map.METRICS, (6 if shape == "cubic" else 2) / theta) | edit

    for hole in thetas[1:-1]:
        rows = [row("log", theta) for theta in thetas]
        rows += [row("cubic", theta, **({"outcome": "newton_stall", "cond_p95": 1e-3} if theta == hole else {})) for theta in thetas]
        k = thetas.index(hole)
        for gap in (0.4, 0.26, 0.2, 0.11, 0.07, 0.03, 0.012):
            found = gap_map.at_gap(rows, "off", gap, ["cubic"]).ratios
            if thetas[k + 1] < gap < thetas[k - 1]:
                assert not found, (hole, gap)
            else:
                assert [found["cubic"][metric].value for metric in gap_map.METRICS] == pytest.approx([3] * 4), (hole, gap)
