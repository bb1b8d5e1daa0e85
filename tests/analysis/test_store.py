"""io/store.py: rows are laid out one a line, and rows that are added change no other row."""

import copy
import json

import pytest

from barrierbench_analysis.io import store
from barrierbench_analysis.io.errors import UserError

KEPT = [{"scene": "a", "case": "log", "cond": 1.5}, {"scene": "a", "case": "cubic", "cond": 2.5}, {"scene": "b", "case": "log", "cond": 3.5}]
KEY = ("scene", "case")


def test_a_new_row_stands_behind_the_kept_ones_and_changes_none_of_them():
    before, new = copy.deepcopy(KEPT), {"scene": "b", "case": "cubic", "cond": 4.5}
    for replace in (False, True):
        assert store.merged(KEPT, [new], KEY, replace) == [*before, new] and KEPT == before


def test_an_equal_row_is_added_once():
    assert store.merged(KEPT, copy.deepcopy(KEPT[::-1]), KEY) == KEPT


def test_a_row_with_other_numbers_is_refused_by_name_and_replaced_where_that_is_asked_for():
    new = {"scene": "a", "case": "cubic", "cond": 9.0}
    with pytest.raises(UserError, match="^a, cubic: found a row with another cond than the kept one; allowed: "):
        store.merged(KEPT, [new], KEY)
    assert store.merged(KEPT, [new], KEY, replace=True) == [KEPT[0], new, KEPT[2]]
    with pytest.raises(UserError, match="another newton"):
        store.merged(KEPT, [KEPT[0] | {"newton": 3}], KEY)


def test_two_new_rows_of_one_key_contradict_each_other():
    with pytest.raises(UserError, match="^c, log: "):
        store.merged(KEPT, [{"scene": "c", "case": "log", "cond": x} for x in (1, 2)], KEY)


def test_rows_are_laid_out_a_line_each_and_read_back():
    text = store.a_line_each([json.dumps([row["case"], row["cond"]]) for row in KEPT], 2)
    assert text == '[\n  ["log", 1.5],\n  ["cubic", 2.5],\n  ["log", 3.5]]' and json.loads(text)[1] == ["cubic", 2.5]
    assert json.loads(store.a_line_each(['"a": 1', '"b": 2'], 1, "{}")) == {"a": 1, "b": 2} and store.a_line_each([], 1) == "[\n ]"
