"""Records against the schemas: what the C++ tests wrote, and what the program answers."""

import json
import subprocess
from pathlib import Path

import jsonschema
import pytest

SCHEMAS = Path(__file__).resolve().parents[2] / "configs" / "schema"


def validator(name: str) -> jsonschema.Draft202012Validator:
    schema = json.loads((SCHEMAS / f"{name}.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.fixture
def sample(build_folder) -> Path:
    """Written by the C++ test Writer.SampleForTheSchemaTest, which runs before."""
    folder = build_folder / "sample_record"
    if not folder.exists():
        pytest.skip(f"{folder} is not there: run the C++ tests of record first")
    return folder


def test_run_record_is_valid(sample):
    validator("run").validate(json.loads((sample / "run.json").read_text()))


def test_trace_lines_are_valid(sample):
    lines = (sample / "trace.jsonl").read_text().splitlines()
    assert len(lines) == 2
    for line in lines:
        validator("trace").validate(json.loads(line))


@pytest.mark.parametrize("pointer", ["summary/newton_iterations", "status/outcome", "ids/config_id", "audit/crossings", "audit/judged", "comparability/verdict",
                                     "summary/gap_min_iterates_rel"])
def test_a_record_that_lost_a_field_is_invalid(sample, pointer):
    record = json.loads((sample / "run.json").read_text())
    section, field = pointer.split("/")
    del record[section][field]
    assert not validator("run").is_valid(record)


def test_what_earlier_versions_lack_is_optional(sample):
    record = json.loads((sample / "run.json").read_text())
    major, minor, _ = map(int, record["schema"]["version"].split("."))
    assert (major, minor) >= (2, 0)
    for field in ("d_hat_m", "limit_scale", "limit_load_source"):
        del record["matching"][field]
    record["schema"]["version"] = "2.9.0"
    validator("run").validate(record)
    record["schema"]["version"] = "1.1.0"
    assert not validator("run").is_valid(record)
    line = json.loads((sample / "trace.jsonl").read_text().splitlines()[0])
    del line["kappa_change_rel"]
    validator("trace").validate(line)


def test_a_null_without_its_kind_of_field_is_invalid(sample):
    record = json.loads((sample / "run.json").read_text())
    record["steps"][0]["newton_iterations"] = None
    assert not validator("run").is_valid(record)
    record["steps"][0]["newton_iterations"] = 1
    record["steps"][0]["gap_mni_m"] = 1.0
    assert not validator("run").is_valid(record)


def test_eval_schema_is_the_one_in_the_tree(program):
    printed = subprocess.run([program, "eval", "--schema"], capture_output=True, text=True, check=True).stdout
    assert json.loads(printed) == json.loads((SCHEMAS / "eval.schema.json").read_text())
