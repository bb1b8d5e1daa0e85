"""Every check holds where its subject is there, is red where it is not, and is red without a subject."""

import copy

import pytest

from barrierbench_analysis.studies.catalogue.checks import CHECKS, judge

STEP = {"t_s": 0.5, "contact_J": 0.1, "limit_J": 0.2, "kinetic_J": 2.0, "gravity_J": 5.0, "friction_sticking": 3, "friction_sliding": 0, "friction_dissipation_J": 0.01, "contact_load_sum_N": 4.2}
RECORD = {
    "status": {"outcome": "ok", "detail": ""},
    "summary": {"contacts": {"max": 7}, "gap_min_rel": {"min": 0.4}, "contact_gaps": {"a|b": {"load_N": 3.0}}, "max_stretch": 0.04},
    "audit": {"enabled": True, "judged": 9, "motions": 4, "crossings": 0, "violations": 0, "unproven": 0},
    "steps": [STEP, {**STEP, "t_s": 1.0, "kinetic_J": 0.01, "gravity_J": 3.0}],
    "config": {"scene": {"bodies": [{"name": "a", "pins": [{"motion": {"angular_velocity_rad_per_s": 6.3, "end_s": 0.9}}]}]}},
}
EMPTY = {**RECORD, "steps": [], "status": {"outcome": "initial_intersection", "detail": "a meets b"}}
BOUNCE = {**RECORD, "steps": [{**STEP, "kinetic_J": value} for value in (2.0, 0.4, 1.97)]}
ASKED = {
    "contacts_active": {"between": "a|*"},
    "turned": {"body": "a", "turns": 0.9},
    "came_to_rest": {"share": 0.01},
    "fell": {"share": 0.5},
    "carries": {"load_N": 4.0, "within": 0.1},
    "bounced": {"share": 0.05},
    "rejected": {"outcome": "initial_intersection", "says": "b"},
}


def found(name, record, **more):
    ((told, finding),) = judge(record, [{"check": name, "because": "b", **ASKED.get(name, {}), **more}])
    assert told == name and finding.saw
    return finding


def changed(place, value):
    record = copy.deepcopy(RECORD)
    *way, last = place
    at = record
    for key in way:
        at = at[key]
    at[last] = value
    return record


@pytest.mark.parametrize("name", [check.__name__ for check in CHECKS])
def test_it_holds_of_its_subject(name):
    assert found(name, {"rejected": EMPTY, "bounced": BOUNCE}.get(name, RECORD)).holds is True


def each(name, value):
    return {**RECORD, "steps": [{**step, name: value} for step in RECORD["steps"]]}


@pytest.mark.parametrize("name, record", [
    ("no_crossing", changed(("audit", "enabled"), False)),
    ("no_crossing", changed(("audit", "motions"), 0)),
    ("contacts_active", changed(("summary", "contact_gaps"), {"c|d": {"load_N": 3.0}})),
    ("contacts_active", changed(("summary", "gap_min_rel"), {"min": None})),
    ("contact_work", {**RECORD, "steps": []}),
    ("friction_engaged", each("friction_dissipation_J", None)),
    ("sticks", each("friction_dissipation_J", None)),
    ("limit_engaged", changed(("summary", "max_stretch"), None)),
    ("turned", changed(("config", "scene", "bodies"), [{"name": "a"}])),
    ("turned", {**RECORD, "steps": []}),
    ("came_to_rest", each("kinetic_J", 0.0)),
    ("fell", {**RECORD, "steps": []}),
    ("carries", {**RECORD, "steps": []}),
    ("carries", {**RECORD, "steps": [{**STEP, "contact_load_sum_N": None}]}),
    ("bounced", {**RECORD, "steps": []}),
    ("bounced", each("kinetic_J", 0.0)),
    ("rejected", RECORD),
])
def test_it_is_red_without_a_subject(name, record):
    finding = found(name, record)
    assert finding.holds is None and finding.red


@pytest.mark.parametrize("name, record", [
    ("no_crossing", changed(("audit", "crossings"), 1)),
    ("no_crossing", changed(("audit", "unproven"), 1)),
    ("contacts_active", changed(("summary", "contact_gaps", "a|b", "load_N"), 0.0)),
    ("contact_work", each("contact_J", 0.0)),
    ("friction_engaged", each("friction_sticking", 0)),
    ("sticks", each("friction_sliding", 1)),
    ("limit_engaged", each("limit_J", 0.0)),
    ("turned", changed(("config", "scene", "bodies", 0, "pins", 0, "motion", "end_s"), 0.5)),
    ("came_to_rest", each("kinetic_J", 1.0)),
    ("fell", each("gravity_J", 1.0)),
    ("carries", each("contact_load_sum_N", 4.5)),
    ("bounced", each("kinetic_J", 2.0)),  # nothing was given up at the turn
    ("bounced", {**BOUNCE, "steps": BOUNCE["steps"][:2]}),  # and nothing has come back yet
    ("rejected", {**EMPTY, "status": {"outcome": "invalid_scene", "detail": "b"}}),
    ("rejected", {**EMPTY, "status": {"outcome": "initial_intersection", "detail": "other words"}}),
])
def test_it_is_red_where_its_subject_fails(name, record):
    assert found(name, record).holds is False
