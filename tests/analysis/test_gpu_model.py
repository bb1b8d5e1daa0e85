"""The byte model of a card: its numbers by hand, and the page that shows them."""

from pathlib import Path

import pytest

from barrierbench_analysis.studies.device import gpu_model

ROOT = Path(__file__).resolve().parents[2]


MEASURED = gpu_model.Measured("by hand", 3, 6, 2, 4, {"block_jacobi": 50})
DENSE = gpu_model.SIZES[-1]


def test_bytes_by_hand():
    blocks = 13 * 8.2e6 + 2 * 2 * 3 * 8.2e6
    assert gpu_model.blocks(DENSE, MEASURED) == pytest.approx(blocks)
    assert gpu_model.solver_bytes(DENSE, MEASURED) == pytest.approx(76 * blocks + 336 * 8.2e6)
    solve, rest = gpu_model.newton_seconds(DENSE, MEASURED, 3.0e12, "block_jacobi")
    assert solve == pytest.approx(50 * gpu_model.solver_bytes(DENSE, MEASURED) / 2.4e12)
    assert 0 < rest < solve


def test_twice_the_rate_takes_half_the_time():
    slow = sum(gpu_model.newton_seconds(DENSE, MEASURED, 1e12, "block_jacobi"))
    assert sum(gpu_model.newton_seconds(DENSE, MEASURED, 2e12, "block_jacobi")) == pytest.approx(slow / 2)


@pytest.mark.parametrize("name", ["multilevel_schwarz", "schwarz"])  # now, and in records before 3.9.0
def test_inputs_are_those_of_the_record(name):
    record = {
        "config": {"linear_solver": {"resident_preconditioner": name}},
        "summary": {"contacts": {"n": 2, "sum": 60}, "newton_iterations": 8, "steps": 2, "linear_per_solve": {"n": 4, "sum": 100}},
        "scene": {"vertices": 10},
    }
    costs = '{"rows": 20, "candidates": 90}\n 2 160  bb::exec::GatherStreamed\n{"rows": 40, "candidates": 120}\n   2 480  bb::exec::GatherStreamed\n'
    got = gpu_model.Measured(**gpu_model.measure("a run", [record], costs))
    assert got == gpu_model.Measured("a run", 3, 3, 3, 4, {"multilevel_schwarz": 25})


def test_what_has_no_record_is_not_predicted():
    for size in gpu_model.SIZES:
        known = {size.measured: MEASURED}
        assert gpu_model.NO_RECORD in gpu_model.rows_of(size, {})[0]
        assert "no record" in gpu_model.inputs_text(size, {})
        rows = gpu_model.rows_of(size, known)
        assert len(rows) == len(gpu_model.COPY_RATES)
        assert all(row[-1] == gpu_model.NO_RECORD != row[-2] for row in rows)  # Schwarz was not run
        assert "by hand" in gpu_model.inputs_text(size, known)


def test_the_page_has_the_table():
    table = gpu_model.table()
    assert all(gpu_model.inputs_text(size, gpu_model.read_inputs()) in table for size in gpu_model.SIZES)
    assert table in (ROOT / "docs" / "device.md").read_text()
