"""Specs are held against their schemas by one reader: file, place, what was found, what is allowed."""

import json
from pathlib import Path

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.gate import cases
from barrierbench_analysis.studies.matrices.matrix_corpus import read_corpus
from barrierbench_analysis.io.spec_file import read_spec

ROOT = Path(__file__).resolve().parents[2]
COMMITTED = {"gates": "configs/gates/*.json",
             "study": "configs/studies/*.json", "matrix_corpus": "configs/matrices/*.json", "stress": "configs/stress/[SM][0-9][0-9].json", "claim": "claims/*.json", "catalogue": "configs/catalogue/*.json", "figure": "configs/figures/*.json", "step_corpus": "configs/steps/corpus.json", "expected_ends": "configs/report/expected.json"}


@pytest.mark.parametrize("kind", COMMITTED)
def test_every_committed_spec_is_read_as_it_is(kind):
    files = sorted(ROOT.glob(COMMITTED[kind]))
    assert files
    for file in files:
        assert read_spec(file, kind) == json.loads(file.read_text())


def edited(tmp_path: Path, source: str, edit) -> Path:
    data = json.loads((ROOT / source).read_text())
    edit(data)
    file = tmp_path / "small.json"
    file.write_text(json.dumps(data))
    return file


@pytest.mark.parametrize(("edit", "said"), [
    (lambda d: d.update(schema="x"), "#/schema: found 'x'; 'barrierbench.gates/1' is needed"),
    (lambda d: d.update(speed=1), "#/speed: unknown; allowed: schema, doc, set, formulations, scenes"),
    (lambda d: d["scenes"][1].pop("config"), "#/scenes/1/config: is missing"),
    (lambda d: d["scenes"][0].update(resumed="no"), "#/scenes/0/resumed: found 'no'; true or false is needed"),
    (lambda d: d["formulations"][0].update(set=[]), "#/formulations/0/set: found []; overrides")])
def test_a_bad_set_of_gates(tmp_path, monkeypatch, edit, said):
    file = edited(tmp_path, "configs/gates/small.json", edit)
    monkeypatch.setattr(cases, "FOLDER", tmp_path)
    with pytest.raises(UserError) as told:
        cases.read_set("small")
    assert f"{file}{said}" in str(told.value)


@pytest.mark.parametrize(("edit", "said"), [
    (lambda d: d["systems"][2].pop("why"), "#/systems/2/why: is missing"),
    (lambda d: d["systems"][0].update(pick="best"), "#/systems/0/pick: found 'best'; one of largest_cond, first, with_exact is needed"),
    (lambda d: d["systems"].append(d["systems"][0]), "#/systems: found [")])
def test_a_bad_corpus(tmp_path, edit, said):
    file = edited(tmp_path, "configs/matrices/corpus.json", edit)
    with pytest.raises(UserError) as told:
        read_corpus(file)
    assert f"{file}{said}" in str(told.value)


def test_an_integer_is_written_as_one(tmp_path):
    file = edited(tmp_path, "configs/studies/pareto.json", lambda d: d.update(seeds=[2.0]))
    with pytest.raises(UserError, match="#/seeds/0: found 2.0; a whole number from 0 is needed"):
        read_spec(file, "study")
