"""Statements and made rows of the adversary, by the study at size before it has a row."""

from contextlib import contextmanager

import pytest

from barrierbench_analysis.studies.kit.study import store
from barrierbench_analysis.studies.kit.study.collect import sources_of
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.adversary import compared, draws, of_size
from barrierbench_analysis.studies.rules.adversary.gathered import _gathered, gathered

FILE = read_study("adversary").file


@contextmanager
def without_rows_of_the_study_at_size():
    """Statements as they are before the study at size has a row, so that no test depends on what its rows say."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(of_size, "rows_of", lambda study: [])
        _gathered.cache_clear()
        yield
    _gathered.cache_clear()


with without_rows_of_the_study_at_size():
    LABELS = [one.label for one in gathered(read_study("adversary")).statements]


def named(label):
    return gathered(read_study("adversary")).named(label)


def row(of, case, outcome="ok", seconds=1.0, **values):
    cell, sources = of.cell(case), sources_of(of)
    origin = {"date": "2026-01-01", "machine": "m", "commit": "c", "build": "b", "version": "1", "threads": 1}
    empty = dict.fromkeys(sources) | {"failed_audit": 0.0, "gap_min": 0.5}
    return store.Row(cell.key, cell.place, outcome, empty | values, sources, 12, seconds, "r", origin)


def keep(of, label, made, seconds=1.0):
    """Keeps rows of the next round of a statement. made: number of a draw and arm -> outcome and values."""
    file, statement = store.file_of(of), named(label)
    kept = store.read_rows(file)
    new = draws.next_draws(of, statement, draws.kept_draws(of, statement, kept))
    for draw in new:
        for case in draws.cases_of(of, draw):
            more = made(draw.number, case.place["arm"])
            outcome = more.pop("outcome", "ok")
            kept |= {(one := row(of, case, outcome, seconds, **more)).key: one}
    store.write_rows(file, kept)
    return new


def there(of, label):
    return draws.kept_draws(of, named(label), draws.rows_of_today(of))


def said(label, outcomes=("ok", "ok", "ok", "ok"), **columns):
    """The contrast of one draw whose runs have these numbers, column -> a number for each arm."""
    statement = named(label)
    rows = {}
    for k, arm in enumerate(statement.arms):
        values = {name: of[k] for name, of in columns.items()}
        place = {"statement": label, "draw": "0", "scene": "s", "arm": arm}
        empty = dict.fromkeys(sources_of(read_study("adversary"))) | {"gap_min": 0.5}
        rows[arm] = store.Row(arm, place, outcomes[k], empty | values, {}, 12, 1.0, "r", {"machine": "m", "build": "b"})
    return compared.contrast(statement, rows)
