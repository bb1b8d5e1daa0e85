"""The numbers of a figure as a table of pgfplots: a row a line, columns apart by blanks."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def _word(value) -> str:
    """nan where there is none; a text with blanks, or an empty one, in braces, which keep it one cell."""
    if value is None or (isinstance(value, float) and value != value):
        return "nan"
    text = str(value)
    return text if text and not set(text) & set(" \t\n{}") else "{" + text.replace("\n", " ") + "}"


def text(numbers: pd.DataFrame) -> str:
    """With a first line of column names, in which `_` stands for every character that TeX would trip over."""
    names = ["".join(c if c.isalnum() else "_" for c in str(column)) for column in numbers.columns]
    rows = [" ".join(map(_word, row)) for row in numbers.astype(object).itertuples(index=False, name=None)]
    return "\n".join([" ".join(names), *rows]) + "\n"
