"""The byte model of a card: its numbers by hand, and the page that shows them."""

from pathlib import Path

import pytest

from barrierbench_analysis import gpu_model

ROOT = Path(__file__).resolve().parents[2]


def test_bytes_by_hand():
    dense = gpu_model.SIZES[-1]
    blocks = 13 * 8.2e6 + 2 * 0.49 * 184.1e6
    assert dense.blocks == pytest.approx(blocks)
    assert gpu_model.solver_bytes(dense) == pytest.approx(76 * blocks + 336 * 8.2e6)
    assert 24e9 < gpu_model.solver_bytes(dense) < 25e9
    solve, rest = gpu_model.newton_seconds(dense, 3.0e12, "block Jacobi")
    assert solve == pytest.approx(1100 * gpu_model.solver_bytes(dense) / 2.4e12)
    assert 0 < rest < solve


def test_twice_the_rate_takes_half_the_time():
    for size in gpu_model.SIZES:
        slow = sum(gpu_model.newton_seconds(size, 1e12, "Schwarz"))
        assert sum(gpu_model.newton_seconds(size, 2e12, "Schwarz")) == pytest.approx(slow / 2)


def test_the_page_has_the_table():
    table = gpu_model.table()
    assert table.count("\n") == 2 + len(gpu_model.SIZES) * len(gpu_model.COPY_RATES)
    assert table in (ROOT / "docs" / "device.md").read_text()
