"""tables/statistics.py: means over scenes, geometric means and slopes, and that no module has a geometric mean of its own."""

import ast
import math
from pathlib import Path

import pytest

from barrierbench_analysis.tables import statistics

SOURCE = Path(__file__).resolve().parents[2] / "analysis" / "src" / "barrierbench_analysis"
# The module itself, and modules whose code is registered or belongs to the page of a folder of records.
OWN = {"tables/statistics.py", "studies/kit/metrics.py", "pages/stated/sources.py"}


def test_a_mean_of_two_scenes_has_the_interval_of_students_t_and_one_scene_has_none():
    two, one = statistics.mean_over([1.0, 3.0]), statistics.mean_over([1.0])
    assert two.value == 2 and two.upper - two.value == pytest.approx(12.7062047) and two.scenes == 2  # t of 1 degree of freedom times 1
    assert (one.value, one.lower, one.upper, str(one)) == (1, None, None, "1")
    with pytest.raises(ValueError, match="needs one scene"):
        statistics.mean_over([])


def test_a_ratio_is_the_mean_of_logarithms_and_turns():
    found = statistics.ratio_over([math.log(x) for x in (2, 4, 8)])
    assert found.value == pytest.approx(4) and found.lower * found.upper == pytest.approx(16)
    assert found.turned() == statistics.Ratio(1 / found.value, 1 / found.upper, 1 / found.lower, 3)
    assert statistics.ratio_over([0.0, 700.0]).upper == math.inf


def test_a_geometric_mean_and_its_scatter():
    assert statistics.geometric([1, 4, 16]) == pytest.approx(4)
    assert statistics.spread([0.0, math.log(4)]) == pytest.approx((2, 1, 4))
    with pytest.raises(ValueError):
        statistics.geometric([])
    with pytest.raises(ValueError):
        statistics.geometric([1.0, 0.0])


@pytest.mark.parametrize("points, expected", [
    ([(0, 1), (1, 3), (2, 5)], 2), ([(0, 0), (1, 1), (2, 0)], 0), ([(1, 1), (1, 2)], None), ([], None), ([(3, 7), (5, 7)], 0)])
def test_the_slope_of_a_line(points, expected):
    assert statistics.slope(points) == expected


def test_an_interval_that_is_infinite_can_be_turned():
    wide = statistics.ratio_over([0.0, 700.0])
    assert (wide.lower, wide.upper) == (0, float("inf")) and (wide.turned().lower, wide.turned().upper) == (0, float("inf"))


def means_of_logarithms(text: str) -> list[int]:
    """Lines where exp has a mean, a sum or fsum in its argument."""
    def name(call: ast.Call) -> str:
        return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")

    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    return [call.lineno for call in calls if name(call) == "exp"
            and any(isinstance(below, ast.Call) and name(below) in ("mean", "sum", "fsum", "nanmean") or isinstance(below, ast.Attribute) and below.attr == "mean"
                    for argument in call.args for below in ast.walk(argument))]


@pytest.mark.parametrize("text", ["np.exp(np.mean(np.log(x)))", "math.exp(sum(logs) / len(logs))", "np.exp(both.mean())"])
def test_a_geometric_mean_is_found(text):
    assert means_of_logarithms(text) == [1]


def test_only_one_module_has_a_geometric_mean():
    texts = {path.relative_to(SOURCE).as_posix(): path.read_text() for path in sorted(SOURCE.rglob("*.py"))}
    assert len(texts) > 300 and OWN <= set(texts)
    assert {name: lines for name, text in texts.items() if name not in OWN and (lines := means_of_logarithms(text))} == {}
