"""CITATION.cff is a file of the Citation File Format 1.2.0, and has a place for the DOI of an archive."""

import re

import jsonschema
import pytest
import yaml

from barrierbench_analysis.front.version import version
from barrierbench_analysis.io.places import ROOT

FILE = ROOT / "CITATION.cff"
# What version 1.2.0 of the format requires of the keys that are used here; any other key is a mistake.
ENTITY = {"type": "object", "properties": {"name": {"type": "string"}}, "required": ["name"], "additionalProperties": False}
DOI = {"type": "object", "additionalProperties": False, "required": ["type", "value"],
       "properties": {"type": {"const": "doi"}, "value": {"type": "string", "pattern": r"^10\.\d{4,9}(\.\d+)?/[A-Za-z0-9:/_;\-\.\(\)\[\]\\\\]+$"},
                      "description": {"type": "string", "minLength": 1}}}
FORMAT = {"type": "object", "additionalProperties": False, "required": ["authors", "cff-version", "message", "title"],
          "properties": {"cff-version": {"const": "1.2.0"}, "title": {"type": "string"}, "message": {"type": "string"}, "type": {"enum": ["dataset", "software"]},
                         "authors": {"type": "array", "minItems": 1, "items": ENTITY}, "license": {"const": "Apache-2.0"}, "version": {"type": "string"},
                         "date-released": {"type": "string", "format": "date"}, "identifiers": {"type": "array", "minItems": 1, "items": DOI}}}


def checked(text: str) -> dict:
    data = yaml.safe_load(text)
    jsonschema.validate(data, FORMAT)
    return data


def with_doi(text: str) -> str:
    """As the comment says: without the two characters in front of the lines from `identifiers` on."""
    before, line, after = text.partition("# identifiers:\n")
    assert line, "no place for a DOI"
    return before + re.sub("(?m)^# ", "", line + after)


def test_the_file_is_valid_and_of_this_version():
    data = checked(FILE.read_text())
    assert version().startswith(f"barrierbench {data['version']}")
    assert "identifiers" not in data  # no archive has a DOI yet: none is named


def test_the_place_for_a_doi_makes_a_valid_file():
    (identifier,) = checked(with_doi(FILE.read_text()))["identifiers"]
    assert set(identifier["value"].partition("/")[0]) <= set("10.") and "0000000" in identifier["value"]  # of nobody


@pytest.mark.parametrize("change", [("cff-version: 1.2.0", "cff-version: 1.1.0"), ("title:", "titel:"), ("authors:\n  - name", "authors:\n  - nom")])
def test_a_file_that_is_not_valid_is_told(change):
    text = FILE.read_text()
    assert change[0] in text
    with pytest.raises(jsonschema.ValidationError):
        checked(text.replace(*change))


def test_a_number_that_is_no_doi_is_told():
    with pytest.raises(jsonschema.ValidationError):
        checked(with_doi(FILE.read_text()).replace("10.0000/", "doi:10.0000/"))
