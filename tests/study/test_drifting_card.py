"""The study of the drifting card: what is measured along the table and not normal to it, how stiffnesses are
matched, and what the page makes of rows."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from barrierbench_analysis.studies.kit.alone import REFUSED
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules.drifting_card import arms, matched, measured, report
from barrierbench_analysis.studies.rules.drifting_card.arms import ALL_PAIRS, Arm

STUDY = read_study("drifting_card")
LOG = Arm("log", ALL_PAIRS, "25mm")
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def moved(velocities, dt=0.1):
    """The square at the ends of steps with these velocities, m/s."""
    places = np.cumsum(np.array([np.zeros(3), *velocities]) * dt, axis=0)
    return SQUARE + places[:, None]


def of(velocities):
    mass = measured.masses(SQUARE, TRIANGLES, 6.0)
    assert mass == pytest.approx([2, 1, 2, 1])
    return measured.of_motion(SQUARE, moved(velocities), mass, 0.1)


def test_a_card_that_moves_along_the_normal_has_no_drift_and_no_tangential_force():
    found = of([[0, 0, -0.3], [0, 0, -0.1], [0, 0, 0]])
    assert found == pytest.approx({"drift_m": 0, "tangential_J": 0, "pull": 0}, abs=1e-15)


def test_drift_energy_and_force_are_those_along_the_table():
    found = of([[0, 0, 0], [0.03, 0.04, 0], [0.06, 0.08, 0]])
    assert found["drift_m"] == pytest.approx(0.1 * (0.05 + 0.1))
    assert found["tangential_J"] == pytest.approx(0.5 * 6 * 0.1**2)
    assert found["pull"] == pytest.approx(0.05 / 0.1 / 9.81)  # the normal force is the weight


def test_a_turn_about_the_normal_is_energy_without_drift():
    mass = np.ones(4)
    ends = []
    for angle in (0.0, 0.01, 0.02):
        c, s = math.cos(angle), math.sin(angle)
        ends.append((SQUARE - [0.5, 0.5, 0]) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
    found = measured.of_motion(ends[0], np.array(ends), mass, 0.1)
    assert found["drift_m"] == pytest.approx(0, abs=1e-12)
    assert found["tangential_J"] == pytest.approx(0.5 * 4 * 0.5 * 0.1**2, rel=1e-3)  # m r^2 omega^2/2


def test_the_share_of_rows_at_borders_is_over_all_steps():
    kinds = {"point_point": 1, "point_edge": 2, "point_triangle": 5, "edge_edge": 1, "mollified": 1, "total": 10}
    rest = dict.fromkeys(kinds, 0) | {"point_triangle": 10, "total": 10}
    assert measured.border_share({"steps": [{"contacts": kinds}, {"contacts": rest}]}) == pytest.approx(0.2)
    assert measured.border_share({"steps": []}) is None


def test_formulations_and_models_are_those_of_the_program():
    names, models = arms.compared(), arms.models()
    assert {"log", "cubic", "ipc2020"} <= set(names) and "article_cubic" not in names
    assert models[:3] == [ALL_PAIRS, "area", "area_corrected"] and "offset_geometric" in models
    every = list(arms.arms(STUDY))
    assert len(set(every)) == len(every) and {arm.formulation for arm in every if arm.model == "points"} == {"log"}


def row(arm, label, outcome="ok", scale=None, **values):
    """scale: of a run that matches."""
    case = arms.case(STUDY, arm, label, 0, scale) if scale else None
    key = STUDY.cell(case).key if case else f"{arm} {label}"
    place = {"formulation": arm.formulation, "model": arm.model, "level": arm.level, "placement": label}
    numbers = dict.fromkeys(measured.MEASURED) | {"detail": "", "newton": 9} | values
    return Row(key, place, outcome, numbers, {}, 12, 1.0, "r", {"build": "b", "machine": "m"})


def carried(arm, gap_of):
    """The search of an arm whose card rests at gap_of(scale); None: the run fails."""
    rows = {}
    while True:
        found = matched.search(STUDY, arm, rows)
        last = found.cases[-1]
        if STUDY.cell(last).key in rows:
            return found, [rows[STUDY.cell(case).key].values["gap"] for case in found.cases]
        scale = last.settings["/formulation/stiffness_policy/scale"]
        gap = gap_of(scale)
        made = row(arm, last.place["placement"], "ok" if gap else "newton_stall", scale, gap=gap)
        rows[made.key] = made


def test_a_search_finds_the_stiffness_that_carries_the_card_at_the_gap():
    theta, within = STUDY.about["theta"], STUDY.about["within"]
    found, gaps = carried(LOG, lambda scale: 1 - 0.1 / math.sqrt(scale))  # a cubic: its force is (1 - u)^2
    assert abs(gaps[-1] - theta) < 1e-3 and len(gaps) == 2
    assert found.scale == pytest.approx((0.1 / (1 - theta)) ** 2, rel=1e-3)
    found, gaps = carried(LOG, lambda scale: 1 - 0.1 / scale if scale > 0.2 else None)  # fails where it is soft
    assert abs(gaps[-1] - theta) <= within and None in gaps and found.scale == pytest.approx(0.1 / (1 - theta), rel=0.1)
    found, gaps = carried(LOG, lambda scale: 1 - 0.1 / scale if scale > 0.5 else None)  # none rests at the gap
    scales = [case.settings["/formulation/stiffness_policy/scale"] for case in found.cases]
    failed = [scale for scale, gap in zip(scales, gaps, strict=True) if gap is None]
    assert failed == sorted(set(failed)) and found.scale == min(set(scales) - set(failed))  # none is tried twice


def test_a_refused_run_ends_a_search_and_has_no_placements():
    first = row(LOG, "match1", REFUSED, matched.START)
    found = matched.search(STUDY, LOG, {first.key: first})
    assert found.scale is None and len(found.cases) == 1


def test_sets_of_pairs_without_weights_have_the_stiffness_of_all_pairs():
    assert matched.matched_as(Arm("log", "offset_geometric", "25mm")) == LOG
    assert matched.matched_as(Arm("log", "area", "25mm")).model == "area"


def test_the_page_has_means_with_intervals_and_outcomes_where_there_is_no_number():
    values = {"gap": 0.7, "tangential_J": 1e-9, "pull": 1e-3, "border": 0.1}
    rows = [row(LOG, str(k), drift_m=1e-3 * k, **values) for k in (1, 3)] + [row(LOG, "4", "newton_stall")]
    blocks = Arm("log", "offset_geometric", "25mm")
    drifts = {1: 1e-3, 2: 9e-3, 3: 1e-3}  # placement 2 is none of all pairs
    rows += [row(blocks, str(k), drift_m=one, **values | {"border": 0.0}) for k, one in drifts.items()]
    refused = Arm("ipc2020", "area", "25mm")
    rows.append(row(refused, "match1", REFUSED, detail="#/contact/weighting: no area"))
    found = report.rule(STUDY, rows)
    line = next(one for one in found["tables"][ALL_PAIRS]["drift_m"].splitlines() if one.startswith("| log |"))
    assert line == "| log | not run | 2 [-10.7, 14.7] (2 of 3) | not run |"
    assert "| ipc2020 | not run | refused | not run |" in found["tables"]["area"]["drift_m"]
    assert (found["runs"], found["failed"], found["refused"]) == (6, 1, ["no area"])
    # 1 and 1/3 of the drift of all pairs; Student's t of two placements
    upper = math.exp(-math.log(3) / 2 + 12.706 * math.log(3) / 2)
    assert found["beside"][0].startswith(f"`offset_geometric` drifts 0.577 [{1 / (3 * upper):.3g}, {upper:.3g}] on 25mm (2 placements)")
    assert "`all_pairs`: 10 % on 25mm" in found["borders"]
    assert found["failures"] == ["`all_pairs`: newton_stall 1, of 3"]
    assert not any(one.startswith("| cubic |") for one in found["tables"][ALL_PAIRS]["drift_m"].splitlines())
    assert "cubic" in found["lacking"][0] and found["lacking"][0].startswith("`all_pairs`: ")


def test_a_run_that_does_not_end_well_has_no_number():
    record = {"status": {"outcome": "newton_stall", "valid": True}}
    assert set(measured.measure(SimpleNamespace(), None, record).values()) == {None}
