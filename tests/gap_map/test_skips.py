"""Cells that a run decides: which follow from which run, and what the page says of them."""

import pytest

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules.gap_map import decided, skips
from barrierbench_analysis.studies.rules.gap_map.spec import Run
from barrierbench_analysis.studies.rules.gap_map.table import CANNOT, NOT_RUN, kept_map, row_of

ENDS = (("cubic", "on", 0.5, "ok"), ("cubic", "on", 0.1, skips.OVERLOAD), ("cubic", "on", 0.05, NOT_RUN), ("cubic", "on", 0.01, "newton_stall"),
        ("cubic", "on", 0.001, NOT_RUN), ("cubic", "off", 0.001, NOT_RUN), ("log", "on", 0.001, NOT_RUN), ("log", "on", 0.01, "newton_stall"),
        ("quadratic", "on", 0.01, skips.OVERLOAD), ("quadratic", "on", 0.003, CANNOT), ("quadratic", "on", 0.001, skips.OVERLOAD))  # fmt: skip
ROWS = [row_of(Run("s", "8", *place), end, gap=0.1) for *place, end in ENDS]


def test_only_an_overload_decides_and_only_smaller_thetas_of_its_series():
    assert skips.table(ROWS)[2:] == [
        "| s | 8 | `cubic` | limit on | 0.05 | 0.1 | left out |",
        "| s | 8 | `cubic` | limit on | 0.001 | 0.1 | left out |",
        "| s | 8 | `cubic` | limit on | 0.01 | 0.1 | **newton_stall** |",
    ]
    assert skips.table([row for row in ROWS if row["outcome"] != skips.OVERLOAD]) == []


@pytest.fixture(scope="module")
def shipped():
    return read_study("gap_map")


def test_the_rule_decides_by_the_largest_theta_that_ended_in_an_overload(shipped):
    series = {"scene": "pile", "resolution": "18", "shape": "cubic", "limit": "off"}
    mine = {float(cell.place["theta"]): cell for cell in shipped.cells if series.items() <= cell.place.items()}
    assert len(mine) == 8

    def rows(**ends):
        return {(cell := mine[float(theta)]).key: Row(cell.key, cell.place, end, {}, {}, 9, 1.0, "r", {}) for theta, end in ends.items()}

    by = decided(shipped, rows(**{"0.1": skips.OVERLOAD, "0.01": skips.OVERLOAD, "0.5": "ok", "0.003": "newton_stall"}))
    assert by == {mine[theta].key: skips.OVERLOAD for theta in (0.05, 0.02, 0.01, 0.003, 0.001)}
    assert decided(shipped, rows(**{"0.1": "newton_stall", "0.5": "ok"})) == {}


def test_the_kept_map_holds_the_rule_and_its_page_says_so(shipped):
    checks = page.checks_of(shipped, page.rows_of(shipped))
    assert checks["run"] == checks["held"] == 36 and checks["left_out"] == 4
    text = (ROOT / "results/GAP_MAP.md").read_text()
    assert "\n".join(skips.table(kept_map().rows)) in text and "4 cells are left out, and count as not run. 36 such cells were run all the same, of which 36 ended" in text
