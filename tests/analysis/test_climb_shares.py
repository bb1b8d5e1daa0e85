"""The share of the strain limit in the growth of a condition number: it must not depend on which of limit and contact is added first."""

import pytest
from barrierbench_analysis.studies.kit.metrics import METRICS

climb = METRICS["climb_of_limit"][3]


def record(full, without_contact, without_both, without_limit=None):
    stages = {"full": full, "without_contact": without_contact, "without_contact_and_limit": without_both, "without_limit": without_limit}
    return {"summary": {"cond": {f"{stage}/none": {"log10_cond": {"p95": value}} for stage, value in stages.items() if value is not None}}}


def test_shapleys_share_is_the_mean_of_both_orders():
    # of four decades the limit adds 3 before contact and 1 after it
    assert climb(record(6.0, 5.0, 2.0, 5.0)) == pytest.approx((3 + 1) / 2 / 4)
    # each alone makes all of it: half each, where one order says all and the other nothing
    assert climb(record(6.0, 6.0, 2.0, 6.0)) == pytest.approx(0.5)
    # contact has the share that is left
    swapped = climb(record(6.0, 3.0, 2.0, 5.5))
    assert swapped + climb(record(6.0, 5.5, 2.0, 3.0)) == pytest.approx(1)


def test_records_of_one_order_have_no_share():
    assert climb(record(6.0, 5.0, 2.0)) is None  # that of one order would be 3/4, where the other may have 0
    assert climb(record(2.3, 2.2, 2.0, 2.1)) is None and climb(record(6.0, None, 2.0, 5.0)) is None
