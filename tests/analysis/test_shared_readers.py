"""Readers and writers that many verbs share: JSON of a schema, digests, where numbers come from, figures beside a page."""

import hashlib

import pytest

from barrierbench_analysis.io.digests import BLOCK, of_file, of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.json_file import is_number, number_at, read_of_schema
from barrierbench_analysis.io.origin import origin, seconds_of_run, stamp

REMEDY = "; ./bench made makes it"


def test_digests_are_those_of_the_bytes(tmp_path):
    content = bytes(range(256)) * (BLOCK // 128) + b"end"  # more than two blocks
    (tmp_path / "file").write_bytes(content)
    assert of_file(tmp_path / "file") == hashlib.sha256(content).hexdigest()
    assert of_text("kappa \u00e9") == hashlib.sha256("kappa \u00e9".encode()).hexdigest()
    with pytest.raises(UserError, match="none: No such file or directory"):
        of_file(tmp_path / "none")


@pytest.mark.parametrize("text, said", [(None, ": No such file or directory; a file that can be read is needed; ./bench made"), ("{", ": not JSON: "), (b"\xff", ": not JSON: "), ("[" * 100000, ": not JSON: "),
                                        ("[]", ": not a JSON object; ./bench made"), ("{}", "#/schema: found None; 'made/1' is needed; ./bench made"),
                                        ('{"schema": "other"}', "#/schema: found 'other'; 'made/1' is needed; ./bench made")])
def test_what_is_no_file_of_the_schema_is_told_with_what_makes_one(tmp_path, text, said):
    file = tmp_path / "made.json"
    if text is not None:
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(UserError) as told:
        read_of_schema(file, "made/1", REMEDY)
    assert str(told.value).startswith(f"{file}{said}") and str(told.value).endswith(REMEDY)


def test_the_origin_of_numbers_names_every_day_machine_and_program_once():
    def record(day: str, build: str) -> dict:
        return {"status": {"started_utc": f"{day}T23:59:59Z", "ended_utc": "2024-01-03T00:00:01.5Z"}, "machine": {"cpu_model": "a cpu", "cores": 2},
                "provenance": {"git_commit": "0123456789abcdef"}, "ids": {"build_id": build * 32}}

    records = [record("2024-01-02", "f"), record("2024-01-01", "e"), record("2024-01-02", "f")]
    assert origin(records) == {"date": "2024-01-01, 2024-01-02", "machine": "a cpu, 2 cores, 1 thread a run", "commit": "0123456789", "build": f"{'e' * 16}, {'f' * 16}"}
    assert stamp(records[0], "commit", "machine") == {"commit": "0123456789", "machine": "a cpu, 2 cores"}
    assert seconds_of_run(records[0]) == 2.5


def test_a_page_gets_picture_and_caption_alone(tmp_path):
    paths = [tmp_path / f"figure{suffix}" for suffix in (".png", ".pdf", ".csv", ".txt")]
    for path in paths:
        path.write_text(path.suffix)
    copy_to_page(paths, tmp_path / "new" / "docs")
    assert {path.name: path.read_text() for path in (tmp_path / "new/docs").iterdir()} == {"figure.png": ".png", "figure.txt": ".txt"}


@pytest.mark.parametrize("value, number", [(0, True), (1.5, True), (10**400, True), (True, False), (float("nan"), False), (float("inf"), False), ("1", False), (None, False)])
def test_what_is_a_number(value, number):
    assert is_number(value) is number and number_at({"a": {"b": value}}, ("a", "b")) == (value if number else None) and number_at({"a": 3}, ("a", "b")) is None
