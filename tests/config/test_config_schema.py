"""The JSON Schemas of configs and sweeps, which the program makes from its lists, against the files of the tree."""

import json
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = [*(("config", path) for folder in ("configs/scenes", "examples/scenes") for path in sorted((ROOT / folder).glob("*.json"))),
         *(("sweep", path) for path in sorted((ROOT / "configs/sweeps").glob("*.json")))]


def validator(name: str) -> jsonschema.Draft7Validator:
    schema = json.loads((ROOT / f"configs/schema/{name}.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def test_there_are_files():
    assert {name for name, _ in FILES} == {"config", "sweep"} and len(FILES) > 8


@pytest.mark.parametrize("name, path", FILES, ids=lambda value: getattr(value, "stem", value))
def test_files_of_the_tree_fit(name, path):
    validator(name).validate(json.loads(path.read_text()))


@pytest.mark.parametrize("change", [{"tim": {}}, {"time": {"dt_s": 0}}, {"time": {"steps": 1.5}}, {"threads": 4097}, {"formulation": 3},
                                    {"diagnose": {"scalings": ["none", "none"]}}, {"contact": {"mollifier": "ipcc"}}, {"scene": None},
                                    {"scene": {"bodies": [{"name": "a"}]}},
                                    {"scene": {"bodies": [], "obstacles": [{"name": "a", "kind": "cube"}]}}])
def test_wrong_configs_do_not_fit(change):
    config = {"schema": "barrierbench.config/1", "scene": {"name": "hang"}}
    validator("config").validate(config)
    validator("config").validate({**config, "scene": {"bodies": [{"name": "a", "mesh": {"generator": "grid"}}]}})
    assert not validator("config").is_valid({**config, **change})


def numbers(schema, place=""):
    """Every rule of a number with a unit, and its place."""
    if isinstance(schema, dict):
        if "unit" in schema and ("number" in (schema.get("type"), schema.get("items", {}).get("type"))):
            yield place, schema if schema["type"] == "number" else schema["items"]
        for key, value in schema.items():
            yield from numbers(value, f"{place}/{key}")


def test_every_number_has_a_largest_size():
    """Squares and products of what a config holds stay within double (core/base/parameters/units.cpp)."""
    found = dict(numbers(json.loads((ROOT / "configs/schema/config.schema.json").read_text())))
    assert len(found) > 100
    for place, rule in found.items():
        assert max(abs(rule.get(key, 1e300)) for key in ("maximum", "exclusiveMaximum") if key in rule or key == "maximum" and "exclusiveMaximum" not in rule) <= 1e18, place
        low = rule.get("minimum", rule.get("exclusiveMinimum"))
        assert low is not None and low >= -1e18, place


@pytest.mark.parametrize("axis", [{}, {"pointer": "/a"}, {"pointer": "/a", "values": [1], "cases": [{"label": "a", "set": {}}]}])
def test_an_axis_of_no_form_does_not_fit(axis):
    assert not validator("sweep").is_valid({"schema": "barrierbench.sweep/1", "name": "a", "base": "b", "axes": [axis]})
