"""claims/ as committed, the kept numbers, and what is reported when something is missing."""

import csv
import json

import pytest
from made import record

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.claims import verb
from barrierbench_analysis.studies.claims import fresh
from barrierbench_analysis.pages.claims import parts_file, report
from barrierbench_analysis.studies.claims.entry import FOLDER, ROOT, ids, read_claim, read_sweep
from barrierbench_analysis.studies.claims.judge import RULES, judge, missing
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.claims.plan import plan
from barrierbench_analysis.studies.claims.parts import KEYS, THRESHOLDS, check
from barrierbench_analysis.studies.claims.proofs import PROOFS, Eval
from barrierbench_analysis.studies.claims.registry import confirmable, confirmed_parts
from barrierbench_analysis.studies.claims.sizes import of_sweeps
from barrierbench_analysis.studies.claims.slices import slice_of
from barrierbench_analysis.studies.kit.success import read_for
from barrierbench_analysis.studies.claims.table import FILE, Table, collect, read, used_metrics, write

HEAD = '{"schema": "barrierbench.claims/2"}\n'
WANTED = {*(f"K{k}" for k in range(1, 19)), *(f"H{k}" for k in range(1, 10)), "N1", "N2"}


def test_every_claim_is_there_and_refers_to_what_exists():
    assert set(ids()) == WANTED
    judged = 0
    for claim in map(read_claim, ids()):
        for part in claim.parts:
            assert set(part) <= set(KEYS) and ("proof" in part) != ("rule" in part), (claim.id, part)
            judged += 1
            if "proof" in part:
                assert part["proof"] in PROOFS
                continue
            sweep = read_sweep(part["sweep"])
            places = sweep.cases.values()
            paths = part["rule"] == "at_equal_gap"  # its cases are NAME xSCALE
            assert part["rule"] in RULES and {part[k] for k in ("case", "over") if k in part} <= {p[2].rpartition(" x")[0] if paths else p[2] for p in places}, (claim.id, part)
            assert set(part.get("scenes", [])) <= {p[0] for p in places}, (claim.id, part)
            assert all(len({p[1] for p in places if p[0] == s}) >= 3 for s in {p[0] for p in places})
            assert "starts" not in part or len({p[3] for p in places}) >= 5
            assert {part.get("metric", "newton"), *read_for(part.get("bad"))} <= set(METRICS)
            assert part["rule"] == "outcomes" or len(set(THRESHOLDS) & set(part)) == 1
            slice_of(part, sweep)
    assert judged > 50
    confirmations = {path.stem for path in (FOLDER / "confirmation").glob("*.json")} - {"registry"}
    assert {path.stem for path in (FOLDER / "sweeps").glob("*.json")} == {s for claim in map(read_claim, ids()) for s in claim.sweeps} - confirmations
    assert confirmations == {s for claim in map(read_claim, ids()) for s in claim.confirmation_sweeps} and len(confirmations) >= 8


def test_trivial_truths_are_named():
    kinds = {name: read_claim(name).kind for name in ids()}
    assert {name for name, kind in kinds.items() if kind == "by construction"} == {"K5", "H5"} and kinds["H6"] == "by dimension" and kinds["H8"] == "closed form"
    for claim in map(read_claim, ids()):
        proofs = [part for part in claim.deciding if "proof" in part]
        assert claim.kind not in ("closed form", "by dimension") or len(proofs) == len(claim.deciding), claim.id
        assert claim.kind != "runs" or len(proofs) < len(claim.deciding) or claim.waits_for, claim.id


def test_claims_on_shells_can_be_confirmed():
    assert {name for name in ids() if confirmable(read_claim(name))} == {
        "K1", "K2", "K3", "K4", "K7", "K8", "K9", "K10", "K12", "K13", "K14", "K15", "K16", "H1", "H2", "H3", "H4", "H5", "H7", "N1", "N2"}
    for claim in map(read_claim, ids()):
        for part in confirmed_parts(claim) if confirmable(claim) else []:
            if "sweep" in part:
                sweep = read_sweep(part["sweep"])
                fresh.check(sweep)
                check(part, sweep)
                slice_of(part, sweep)
                places = sweep.cases.values()
                assert {part[k] for k in ("case", "over") if k in part} <= {p[2].rpartition(" x")[0] if part["rule"] == "at_equal_gap" else p[2] for p in places}
                assert set(part.get("scenes", [])) <= {p[0] for p in places} and "confirm" not in part
                assert "starts" not in part or len({p[3] for p in places}) >= 5


def test_the_program_takes_every_sweep(program):
    import subprocess

    for path in sorted([*(FOLDER / "sweeps").glob("*.json"), *(FOLDER / "confirmation").glob("shells_*.json")]):
        done = subprocess.run([program, "sweep", str(path), "--dry-run"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert len(done.stdout.split("\n")) > len(read_sweep(path.stem).cases)


def test_the_page_is_made_of_the_kept_numbers():
    table = read(FILE)
    asker = Eval(None, table.answers)
    answers = [judge(read_claim(name), table, asker) for name in ids()]
    made = {"CLAIMS.md": report.markdown(answers, table), "CLAIMS.csv": parts_file.parts_text(answers, table), "CLAIMS_SWEEPS.csv": parts_file.sweeps_text(table)}
    for name, text in made.items():
        assert (ROOT / "results" / name).read_text() == text, name
    assert len(made["CLAIMS.md"]) < 40_000 and all(made["CLAIMS.md"].count(f"\n| [{name}]") == 1 for name in ids())
    assert not [line for a in answers for line in missing(a.claim, table)] and len(table.sweeps) >= 10


def test_all_verdicts_are_of_small_scenes_as_the_docs_say():
    table = read(FILE)
    sizes = of_sweeps(table.sweeps, table)
    assert sizes.small and f"(all are: {sizes.least} to {sizes.largest} unknowns)" in (ROOT / "docs/results/claims.md").read_text()
    rows = list(csv.DictReader((ROOT / "results/CLAIMS.csv").read_text().splitlines()))
    assert {row["of_small_scenes"] for row in rows if row["sweep"]} == {"yes"} and {row["unknowns_largest"] for row in rows if not row["sweep"]} == {""}
    small = [line for line in (ROOT / "results/CLAIMS.md").read_text().splitlines() if "; of small scenes (up to " in line]
    assert {line.partition("]")[0][3:] for line in small} == set(ids()) - {"H6", "H8"}  # closed forms decide these


def test_the_table_survives_writing(tmp_path):
    table = read(FILE)
    write(table, tmp_path / "claims.jsonl")
    assert (tmp_path / "claims.jsonl").read_bytes() == FILE.read_bytes()
    (tmp_path / "claims.jsonl").write_text('{"schema": "other/1"}')
    with pytest.raises(UserError, match='line 1: found .*other/1.*; allowed: {"schema": "barrierbench.claims/2"}; remove it'):
        read(tmp_path / "claims.jsonl")


def test_a_plan_counts_what_is_missing_by_the_seconds_of_its_sweep(capsys):
    """Rows of other inputs are none; the sweep of a confirmation counts where it is registered."""
    claim, table = read_claim("K12"), read(FILE)
    first, again = (len(read_sweep(name).cases) for name in ("hessian_modes", "shells_modes"))
    assert plan([claim], table, {}) == [f"claims: {first} cells, {first} with a row in claims.jsonl, 0 to run"]
    table.sweeps["hessian_modes"].about |= {"seconds": 2.0 * first, "inputs_sha256": "0"}
    del table.sweeps["shells_modes"]
    assert plan([claim], table, {"K12": {}}) == [
        f"claims: {first + again} cells, 0 with a row in claims.jsonl, {first + again} to run", f"about {2 * first} s of one core for {first} runs of these",
        f"{again} runs without a kept row whose labels are alike: not estimated"]
    assert verb.main(["K12", "--plan"]) == 0 and f"{first + again} with a row in claims.jsonl, 0 to run" in capsys.readouterr().out


def test_missing_records_name_their_command(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(verb, "FILE", tmp_path / "none.json")
    assert verb.main(["K3", "--no-run", "--runs", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    count = len(read_sweep("contact_shapes").cases)
    assert f"K3: {count} of {count} records of contact_shapes are missing: ./bench sweep claims/sweeps/contact_shapes.json --out results/runs/claims/contact_shapes" in said
    assert not (tmp_path / "none.json").exists()


def test_runs_that_leave_no_record_name_the_command(monkeypatch, tmp_path, capsys):
    """A program that ends well and writes nothing, and one that fails."""
    monkeypatch.setattr(verb, "FILE", tmp_path / "none.json")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", "/bin/true")
    assert verb.main(["K3", "--runs", str(tmp_path)]) == 2 and "records of contact_shapes are missing: ./bench sweep" in capsys.readouterr().err
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", "/bin/false")
    assert verb.main(["K3", "--runs", str(tmp_path)]) == 2 and "claims/sweeps/contact_shapes.json: the program ended with 1" in capsys.readouterr().err
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(tmp_path / "none"))
    assert verb.main(["K3", "--runs", str(tmp_path)]) == 2 and "is not built: ./bench build" in capsys.readouterr().err


def test_numbers_of_another_sweep_file_are_missing():
    table = read(FILE)
    table.sweeps["contact_shapes"].about["sha256"] = "0"
    assert "are of another claims/sweeps/contact_shapes.json" in missing(read_claim("K3"), table)[0]


@pytest.mark.parametrize("edit, said", [
    ({"id": "K2"}, "/id: found 'K2'"), ({"sentence": 1}, "/sentence: found 1; a string is needed"), ({"parts": [], "waits_for": ""}, "neither parts"),
    ({"schema": "x"}, "'barrierbench.claim/1' is needed"), ({"verdict": "holds"}, "/verdict: unknown"),
    ({"kind": "obvious"}, "/kind: found 'obvious'; one of runs, closed form"), ({"kind": None}, "/kind: found None; one of runs, closed form")])
def test_a_bad_claim(tmp_path, edit, said):
    (tmp_path / "K1.json").write_text(json.dumps({**json.loads((FOLDER / "K1.json").read_text()), **edit}))
    with pytest.raises(UserError, match=said):
        read_claim("K1", tmp_path)


def test_confirmation_sweeps_have_the_metrics_of_their_parts():
    used = used_metrics([read_claim("K12"), read_claim("H7")])
    assert used["shells_modes"] == ["newton"] and used["shells_float"] == ["stopped"] and {"newton", "seconds"} <= set(used["hessian_modes"])


def test_unknown_names(capsys):
    assert verb.main(["K99", "--no-run"]) == 2 and "one of K1, K2" in capsys.readouterr().err
    claim = read_claim("K3")
    claim.parts[0]["metric"] = "speed"
    with pytest.raises(UserError, match="'speed': one of cond_max"):
        used_metrics([claim])


def test_records_become_rows(tmp_path):
    sweep = read_sweep("tight_limits")
    record(tmp_path, sweep, "tight_limits: strip 1% log main=3", "one")
    record(tmp_path, sweep, "tight_limits: ball 2% cubic main=1", "two", valid=False)
    record(tmp_path, sweep, "tight_limits: a case of an older file", "three")
    (tmp_path / "torn").mkdir()
    (tmp_path / "torn" / "run.json").write_text('{"schema"')
    runs = collect(sweep, tmp_path, ["stretch_of_limit", "cond_max", "newton"])
    assert len(runs.rows) == 2 and runs.about["seconds"] == 4.0 and runs.about["machine"].startswith("a cpu")
    ball, strip = runs.rows
    assert (strip["scene"], strip["level"], strip["case"], strip["seed"], strip["outcome"]) == ("strip", "1%", "log", 3, "ok")
    assert runs.about["sha256"] == ""  # nothing says which sweep file made them
    (tmp_path / "sweep.json").write_bytes((FOLDER / "sweeps" / "tight_limits.json").read_bytes())
    assert collect(sweep, tmp_path, ["newton"]).about["sha256"] == sweep.sha256
    assert (strip["stretch_of_limit"], strip["cond_max"], strip["newton"]) == (pytest.approx(0.75), 1000.0, 6)
    assert ball["outcome"] == "not_valid"
    record(tmp_path, sweep, "tight_limits: strip 1% log main=3", "again")
    with pytest.raises(UserError, match="two records of one case"):
        collect(sweep, tmp_path, ["newton"])


def test_a_claim_without_records_is_not_decided():
    answer = judge(read_claim("K3"), Table(), Eval(None))
    assert answer.verdict.verdict == "not decided" and "./bench sweep claims/sweeps/contact_shapes.json" in answer.verdict.missing


@pytest.mark.parametrize("kept", ['{"schema": "barrierbench.cl', "[]", HEAD + "[1]", HEAD + '{"sweep": "x", "columns": ["a"]}\n', HEAD + '{"sweep": "x", "about": {}, "columns": ["a"]}\n[1, 2]', HEAD + '{"columns": [', HEAD + "3"])
def test_a_torn_table_is_refused(tmp_path, monkeypatch, capsys, kept):
    file = tmp_path / "claims.jsonl"
    file.write_text(kept)
    with pytest.raises(UserError, match="claims.jsonl: line .*remove it, then ./bench study claims"):
        read(file)
    monkeypatch.setattr(verb, "FILE", file)
    assert verb.main(["--no-run"]) == 2 and "claims.jsonl" in capsys.readouterr().err
