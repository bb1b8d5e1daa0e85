"""The one printer of tables: columns, edges, empty cells, rows that do not fit."""

import pytest

from barrierbench_analysis.pages.stated.statement import cells_of
from barrierbench_analysis.io.text_table import aligned, markdown


def test_columns_are_as_wide_as_their_widest_cell_and_numbers_end_at_their_right_edge():
    assert aligned(("case", "n", "note"), [("a long one", "1", ""), ("b", "1000", "said")], {1}) == [
        "case           n  note", "a long one     1", "b           1000  said"]
    assert aligned(["alone"], []) == ["alone"]


def test_a_table_in_markdown_has_one_blank_in_an_empty_cell():
    assert markdown(["a", "b"], [["1", ""], ("", "2")]) == ["| a | b |", "|---|---|", "| 1 | |", "| | 2 |"]


def test_a_bar_in_a_cell_is_text_and_is_read_back_as_it_was():
    cells = ["a | b", "|", "end|"]
    lines = markdown(["x", "y", "z|"], [cells])
    assert lines == [r"| x | y | z\| |", "|---|---|---|", r"| a \| b | \| | end\| |"]
    assert cells_of(lines[2]) == cells and cells_of("| 1 | |") == ["1", ""]


@pytest.mark.parametrize("row", [["1"], ["1", "2", "3"]])
def test_a_row_that_does_not_fit_its_head_is_a_mistake(row):
    with pytest.raises(ValueError, match=rf"{len(row)} cells below 2 columns"):
        markdown(["a", "b"], [["1", "2"], row])
    with pytest.raises(ValueError, match=rf"{len(row)} cells below 2 columns"):
        aligned(["a", "b"], [["1", "2"], row])
