"""The records of a sweep as one table, and the words for its columns."""

import csv
import json

import pandas as pd
import pytest
from sweep_files import SHAPES, STEPS, bench, records, refused, verb, write_sweep

from barrierbench_analysis.tables.sweeps.collect import as_frame, write
from barrierbench_analysis.tables.sweeps.dictionary import unit_of


@pytest.fixture(scope="module")
def out(program, tmp_path_factory):
    """Five runs that end well and one that ends as it should not."""
    folder = tmp_path_factory.mktemp("collect")
    file = write_sweep(folder, STEPS, SHAPES, exclude=[{"where": {"/time/steps": 2}, "labels": ["formulation=cubic"]}], repeat=1)
    assert bench(program, "sweep", file, "--out", folder / "out").returncode == 0
    failing = write_sweep(folder, {"pointer": "/step_solver/max_iterations", "values": [1]}, settings={"/time/steps": 9}, name="fails")
    assert bench(program, "sweep", failing, "--out", folder / "fails").returncode == 0
    return folder / "out"


def read(path) -> list[dict]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_every_run_is_a_row_and_every_swept_pointer_a_column(out, tmp_path):
    done = verb("data", "collect", out, tmp_path / "t.csv")
    assert done.returncode == 0, done.stderr
    rows, known = read(tmp_path / "t.csv"), records(out)
    assert len(rows) == len(known) == 5
    assert list(rows[0])[:5] == ["run", "outcome", "valid", "/formulation", "/time/steps"]
    for row in rows:
        record = known[f"steps={row['/time/steps']} formulation={row['/formulation']}"]
        assert row["run_id"] == record["ids"]["run_id"] and row["outcome"] == record["status"]["outcome"]
        assert float(row["wall_s"]) == record["summary"]["wall_s"]
        assert float(row["gap_min_m"]) == record["summary"]["gap_min_m"] if isinstance(record["summary"]["gap_min_m"], float) else True
    again = tmp_path / "again.csv"
    assert verb("data", "collect", out, again).returncode == 0 and again.read_bytes() == (tmp_path / "t.csv").read_bytes()


def test_a_run_that_failed_is_a_row_with_its_outcome(out, tmp_path):
    assert verb("data", "collect", out.parent / "fails", tmp_path / "t.csv").returncode == 0
    (row,) = read(tmp_path / "t.csv")
    assert row["outcome"] not in ("ok", "") and row["valid"] == "False" and row["/step_solver/max_iterations"] == "1"


def test_the_dictionary_has_every_column_with_unit_and_meaning(out, tmp_path):
    assert verb("data", "collect", out, tmp_path / "t.csv").returncode == 0
    words = read(tmp_path / "t.columns.csv")
    assert [word["column"] for word in words] == list(read(tmp_path / "t.csv")[0])
    of = {word["column"]: word for word in words}
    assert (of["wall_s"]["unit"], of["wall_s"]["type"], of["wall_s"]["place"]) == ("s", "number", "summary/wall_s")
    assert of["/time/steps"]["type"] == "integer" and "Number of time steps" in of["/time/steps"]["meaning"]
    assert [word["column"] for word in words if not word["meaning"]] == []
    assert all(word["unit"] for word in words if word["type"] in ("number", "integer"))


@pytest.mark.parametrize("name, unit", [("gap_min_m", "m"), ("gap_min_m_median", "m"), ("newton_per_step_n", "1"), ("wall_s", "s"),
                                        ("contact_load_max_N", "N"), ("limit_load_max_N_per_m", "N/m"), ("gap_min_rel_min", "1"),
                                        ("peak_rss_bytes", "byte"), ("steps", "1"), ("/time/dt_s", "s"), ("/scene/n", "1"), ("m", "m")])
def test_the_end_of_a_name_is_its_unit(name, unit):
    assert unit_of(name) == unit


def test_what_cannot_be_read_is_named_and_left_out(out, tmp_path):
    copy = tmp_path / "copy"
    for path in out.glob("*/run.json"):
        (copy / path.parent.name).mkdir(parents=True)
        (copy / path.parent.name / "run.json").write_text(path.read_text())
    torn, other, *_ = sorted(copy.glob("*/run.json"))
    torn.write_text(torn.read_text()[:1000])
    other.write_text(json.dumps({**json.loads(other.read_text()), "schema": {"name": "barrierbench.run", "version": "9.0.0"}}))
    done = verb("data", "collect", copy, tmp_path / "t.csv")
    assert done.returncode == 0 and len(read(tmp_path / "t.csv")) == 3
    assert str(torn) in done.stderr and str(other) in done.stderr and "9.0.0" in done.stderr
    empty = tmp_path / "empty"
    empty.mkdir()
    refused(verb("data", "collect", empty, tmp_path / "none.csv"), "no record that can be read")
    refused(verb("data", "collect", tmp_path / "nowhere", tmp_path / "none.csv"), "no such folder")
    refused(verb("data", "collect", out, tmp_path / "none.xlsx"), ".csv or .parquet")
    assert not (tmp_path / "none.csv").exists()


def test_parquet_beside_the_csv_holds_the_same_rows(out, tmp_path):
    done = verb("data", "collect", out, tmp_path / "t.csv")
    assert done.returncode == 0 and f"{tmp_path / 't.csv'}, {tmp_path / 't.parquet'}: 5 runs" in done.stdout
    text, typed = pd.read_csv(tmp_path / "t.csv", float_precision="round_trip"), pd.read_parquet(tmp_path / "t.parquet")
    assert list(text.columns) == list(typed.columns) and len(text) == len(typed) == 5
    numbers = [name for name in typed if pd.api.types.is_numeric_dtype(typed[name]) and not pd.api.types.is_bool_dtype(typed[name])]
    assert len(numbers) > 50 and len(typed.columns) - len(numbers) > 10
    for name in typed:
        if name in numbers:
            assert (typed[name].astype(float).dropna() == text[name].astype(float).dropna()).all() and (typed[name].isna() == text[name].isna()).all(), name
        else:
            assert ["" if pd.isna(value) else str(value) for value in typed[name]] == [row[name] for row in read(tmp_path / "t.csv")], name


def test_parquet_alone_where_it_is_named(out, tmp_path):
    assert verb("data", "collect", out, tmp_path / "t.parquet").returncode == 0
    assert len(pd.read_parquet(tmp_path / "t.parquet")) == 5 and {path.name for path in tmp_path.iterdir()} == {"t.parquet", "t.columns.csv"}


def test_a_column_of_words_and_numbers_is_text_in_both(tmp_path):
    """As a sweep over /linear_solver/tolerance makes it, of which some values are words."""
    frame = as_frame({"mixed": [0.1, "auto", None, True], "whole": [1, None, 3, 2**53 + 1]})
    assert write(frame, tmp_path / "t.csv") == [tmp_path / "t.csv", tmp_path / "t.parquet"]
    typed = pd.read_parquet(tmp_path / "t.parquet")
    assert list(typed["mixed"].dropna()) == ["0.1", "auto", "True"] and typed["mixed"].isna().tolist() == [False, False, True, False]
    assert typed["whole"].dropna().tolist() == [1, 3, 2**53 + 1]
    assert (tmp_path / "t.csv").read_text() == "mixed,whole\n0.1,1\nauto,\n,3\nTrue,9007199254740993\n"
