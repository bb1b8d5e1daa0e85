"""Records that must not be read: an empty folder, another schema, a file that is not JSON."""

import json

import pytest

from analysis.load import RecordError, load


def test_an_empty_folder_is_named(tmp_path):
    with pytest.raises(RecordError, match="no run.json"):
        load(tmp_path)


def test_another_major_version_is_refused(tmp_path):
    record = {"schema": {"name": "barrierbench.run", "version": "9.0.0"}}
    (tmp_path / "run.json").write_text(json.dumps(record))
    with pytest.raises(RecordError, match="9.0.0"):
        load(tmp_path)


def test_a_file_that_is_not_json_is_named(tmp_path):
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(RecordError, match="not JSON"):
        load(tmp_path)
