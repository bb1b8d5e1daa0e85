"""The record of a small run against the schemas, field by field: what is missing, of another type, or unknown is invalid."""

import json
import subprocess
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).resolve().parents[2]
SCHEMAS = ROOT / "configs" / "schema"
CONFIG = {"schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 4, "layers": 2}, "formulation": "cubic",
          "time": {"steps": 3}, "passes": {"time": True, "audit": True}, "output": {"frames_every": 1}}


def schema(name: str) -> dict:
    document = json.loads((SCHEMAS / f"{name}.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(document)
    return document


@pytest.fixture(scope="module")
def run(program, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("record")
    (folder / "config.json").write_text(json.dumps(CONFIG))
    done = subprocess.run([program, "run", str(folder / "config.json"), "--out", str(folder / "out")], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "out"


@pytest.fixture(scope="module")
def record(run) -> dict:
    return json.loads((run / "run.json").read_text())


@pytest.fixture(scope="module")
def lines(run) -> list[dict]:
    return [json.loads(line) for line in (run / "trace.jsonl").read_text().splitlines()]


def objects(value, document: dict, node: dict):
    """Every object of a record with the $def that it is an instance of."""
    node = document["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node
    if isinstance(value, dict) and "properties" in node:
        yield value, node
        for name, child in value.items():
            yield from objects(child, document, node["properties"][name])
    elif isinstance(value, list) and value:
        yield from objects(value[0], document, node["items"])  # entries are alike
    elif isinstance(value, dict) and "additionalProperties" in node:
        for child in list(value.values())[:1]:
            yield from objects(child, document, node["additionalProperties"])


def test_a_run_is_valid_and_says_why_a_number_is_absent(record, lines):
    for value, document in [(record, schema("run")), *((line, schema("trace")) for line in lines)]:
        jsonschema.Draft202012Validator(document).validate(value)
        for found, _ in objects(value, document, document):
            for name, number in found.items():
                assert (number is None) == (f"{name}_status" in found), name
    assert len(lines) > 3 and record["summary"]["steps"] == 3


@pytest.mark.parametrize("name", ["run", "trace"])
def test_every_field_is_required_of_one_type_and_known(record, lines, name):
    document = schema(name)
    whole = record if name == "run" else lines[-1]
    judged = 0
    for found, node in list(objects(whole, document, document)):
        valid = jsonschema.Draft202012Validator(node | {"$defs": document["$defs"]}).is_valid
        assert valid(found) and not valid(found | {"no_field": 1})
        for field in [f for f in found if not f.endswith("_status") or f == "linear_status"]:
            rest = {name: value for name, value in found.items() if name != field}
            assert field not in node.get("required", []) or not valid(rest), field
            wrong = ["no value"] if isinstance(found[field], dict) else {"no": "value"}
            assert not valid(rest | {field: wrong}), field
            judged += 1
    assert judged > (200 if name == "run" else 60), judged


def test_the_dictionary_of_the_program_names_every_field(program):
    def printed(*arguments: str) -> str:
        return subprocess.run([program, "help", *arguments], capture_output=True, text=True, check=True).stdout

    for format, name in (("record", "run"), ("trace", "trace")):
        assert printed(format, "--schema") == (SCHEMAS / f"{name}.schema.json").read_text()
        places = {line.split()[0] for line in printed(format).splitlines()}
        assert set(schema(name)["required"]) <= places and len(places) > 60


def test_eval_schema_is_the_one_in_the_tree(program):
    printed = subprocess.run([program, "eval", "--schema"], capture_output=True, text=True, check=True).stdout
    assert json.loads(printed) == json.loads((SCHEMAS / "eval.schema.json").read_text())
