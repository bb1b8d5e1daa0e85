"""The columns of the tables are the fields of the record, by their own names."""

import pytest

from barrierbench_analysis.io import fields


@pytest.mark.parametrize(("table", "column", "place"), [
    ("runs", "scene", ("labels", "scene")),
    ("runs", "newton_iterations", ("summary", "newton_iterations")),
    ("runs", "gap_min_rel_median", ("summary", "gap_min_rel", "median")),
    ("runs", "scene_free_dofs", ("scene", "free_dofs")),
    ("runs", "provenance_blas_kernel", ("provenance", "blas", "kernel")),
    ("steps", "contacts_total", ("contacts", "total")),
    ("trace", "alpha_strain", ("alpha_strain",)),
    ("cond", "cond", ("cond",)),
])
def test_a_column_is_named_after_its_field(table, column, place):
    where, meaning = fields.columns(table)[column]
    assert where == place and meaning


@pytest.mark.parametrize("table", ["runs", "steps", "trace", "cond"])
def test_a_value_comes_from_its_place_and_a_missing_one_is_none(table):
    columns = fields.columns(table)
    assert len(columns) > 10 and {name for name in columns if name.endswith("_status")} <= {"linear_status"}
    for column, (place, _) in columns.items():
        record = 1.5
        for name in reversed(place):
            record = {name: record}
        found = fields.row(table, record)
        assert list(found) == list(columns)
        assert {name for name, value in found.items() if value is not None} == {column}
