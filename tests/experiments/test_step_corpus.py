"""States of steps: ./bench steps --keep and --corpus, what they refuse, and the committed corpus of ./bench step-corpus."""

import hashlib
import json
import re
import shutil
import subprocess
import zlib
from pathlib import Path

import pytest

from analysis.errors import UserError
from analysis import step_corpus_figure as figure
from analysis import step_corpus_page as page
from analysis import step_corpus_states as make

ROOT = Path(__file__).resolve().parents[2]
CONFIG = [str(ROOT / "configs/scenes/drape.json"), "--set", "/scene/layers=2", "--set", "/scene/n=6", "--set", "/threads=1",
          "--set", "/matching/load_N=1", "--set", "/matching/limit_load_N_per_m=10"]
STEP = 9


def bench(program: str, *words) -> subprocess.CompletedProcess:
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False, timeout=240)


@pytest.fixture(scope="module")
def kept(program, tmp_path_factory) -> Path:
    """A folder with one state of a small drape."""
    folder = tmp_path_factory.mktemp("steps")
    done = bench(program, "steps", *CONFIG, "--set", "/time/steps=12", "--at", STEP, "--keep", folder / "small")
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [f"{folder}/small.json", f"{folder}/small.state"]
    return folder


@pytest.fixture(scope="module")
def taken(program, kept, tmp_path_factory) -> tuple[str, dict]:
    """What was printed of its trials, and the record."""
    out = tmp_path_factory.mktemp("taken") / "steps.json"
    done = bench(program, "steps", "--corpus", kept, "--only", "small", "--out", out)
    assert done.returncode == 0, done.stderr
    return done.stdout, json.loads(out.read_text())


def test_the_runs_own_choice_gives_the_step_of_the_run(program, taken, tmp_path):
    done = bench(program, "run", *CONFIG, "--set", f"/time/steps={STEP + 1}", "--out", tmp_path / "run")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "run/run.json").read_text())
    own = page.trial_of(taken[1]["states"][0], "blend")
    assert own["state_hash"] == record["summary"]["state_hash"]
    assert own["iterations"] == record["steps"][STEP]["newton_iterations"] > 2


def test_every_solver_of_the_registry_is_taken_or_refused_by_name_and_causes_add_up(program, taken):
    [state] = taken[1]["states"]
    listed = {line.split()[0] for line in bench(program, "list", "step-solvers").stdout.splitlines() if re.match(r"[a-z]", line)}
    assert {trial["step_solver"] for trial in state["trials"]} >= {"line_search", "xpbd", "pncg"} and (not listed or {t["step_solver"] for t in state["trials"]} <= listed)
    assert state["contacts"] > 0 and state["reference_status"] == "converged"
    judged = 0
    for trial in state["trials"]:
        if "refused" in trial:
            assert trial["refused"].startswith("/") and "allowed: " in trial["refused"]
            continue
        assert sum(trial["causes"].values()) == trial["iterations"] > 0
        if trial["iterations_to_tolerance"] is not None:
            assert trial["iterations_to_tolerance"] <= trial["iterations"]
        judged += trial["step_solver"] == "line_search" and trial["minimum"] == "A" and trial["error_m"] < 10 * state["tolerance_m"]
    assert judged == len(page.hessians(taken[1])) >= 5
    assert "refused: /formulation/shape" in taken[0] and "small, step 9" in taken[0]


def damaged(kept: Path, folder: Path, edit) -> Path:
    """A copy of the folder whose side-car and archive went through `edit(document, archive)`."""
    shutil.copytree(kept, folder)
    document = json.loads((folder / "small.json").read_text())
    packed = (folder / "small.state").read_bytes()
    packed = edit(document, packed) or packed
    (folder / "small.json").write_text(json.dumps(document))
    (folder / "small.state").write_bytes(packed)
    return folder


def other_archive(document: dict, packed: bytes) -> bytes:
    """The same bytes but for the last eight, which a program of another build does not write."""
    rows = zlib.decompress(packed)
    n = len(rows) // 8
    archive = bytes(rows[n * (i % 8) + i // 8] for i in range(8 * n)) + rows[8 * n :]
    archive += bytes(8)
    document["archive"].update(bytes=len(archive), sha256=hashlib.sha256(archive).hexdigest())
    m = len(archive) // 8
    return zlib.compress(bytes(archive[8 * i + k] for k in range(8) for i in range(m)) + archive[8 * m :])


@pytest.mark.parametrize("edit, said", [
    (lambda document, packed: packed[:-20], "cut off or damaged"),
    (lambda document, packed: bytes(reversed(packed)), "cut off or damaged"),
    (lambda document, _: document["config"]["scene"].update(n=7), "of another scene or mesh"),
    (lambda document, _: document["config"]["scene"].update(width_m=1.1), "of another scene or mesh"),
    (lambda document, _: document.update(schema="barrierbench.step_state/0"), 'schema "barrierbench.step_state/0"'),
    (lambda document, _: document.__delitem__("calibration"), "a key that is missing or of another type"),
    (lambda document, _: document.update(velocity_hash="0"), "an archive of another build"),
    (other_archive, "an archive of another build (archive: more than this program keeps)"),
])
def test_a_state_that_this_program_cannot_take_is_refused_with_the_command_that_remakes_it(program, kept, tmp_path, edit, said):
    folder = damaged(kept, tmp_path / "states", edit)
    done = bench(program, "steps", "--corpus", folder, "--out", tmp_path / "out.json")
    assert done.returncode == 2 and done.stdout == "" and not (tmp_path / "out.json").exists()
    assert said in done.stderr and f"{folder}/small" in done.stderr and "./bench step-corpus --make --only small" in done.stderr


def test_what_is_not_there_is_refused_by_name(program, kept, tmp_path):
    for words, said in [
        (["--corpus", tmp_path], f"{tmp_path}: found no state"),
        (["--corpus", tmp_path / "none"], "none: found no folder"),
        (["--corpus", kept, "--only", "smal"], '--only: found "smal"; allowed: states of'),
        (["--corpus", kept, "--split", "tune"], '--split: found "tune"'),
        (["--corpus", kept, *CONFIG], "--corpus: found a config"),
        ([*CONFIG, "--at", "1", "--only", "small"], "--only: found no --corpus"),
        ([*CONFIG, "--at", "1,2", "--keep", tmp_path / "x"], "--keep: found --at with 2 steps"),
        ([*CONFIG, "--at", "5000", "--keep", tmp_path / "x"], "--at: found 5000"),
        ([*CONFIG], "--at: found nothing"),
        ([], "config: found nothing"),
    ]:
        done = bench(program, "steps", *words)
        assert done.returncode == 2 and said in done.stderr and done.stdout == "", (words, done.stderr)
    assert list(tmp_path.iterdir()) == []


def test_without_a_folder_the_corpus_is_results_steps(program, tmp_path):
    done = subprocess.run([program, "steps", "--corpus", "--only", "x"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 2 and "results/steps: found no folder" in done.stderr


def test_the_halves_alternate_in_alphabetical_order():
    assert make.halves(["c", "a", "b"]) == {"a": "tune", "b": "report", "c": "tune"}


@pytest.mark.parametrize("edit, said", [
    (lambda spec: spec["states"][0].update(base="x.json", catalogue="twist"), "either base (a config) or catalogue"),
    (lambda spec: spec["states"].append(spec["states"][0]), "a name twice"),
    (lambda spec: spec["states"][0].pop("hard_for"), "states/0/hard_for: is missing"),
])
def test_a_bad_list_is_refused(tmp_path, edit, said):
    spec = json.loads((ROOT / "configs/steps/corpus.json").read_text())
    edit(spec)
    file = tmp_path / "corpus.json"
    file.write_text(json.dumps(spec))
    with pytest.raises(UserError, match=re.escape(said)):
        make.read_corpus(file)


def test_the_committed_record_and_page_are_of_the_committed_states():
    record = json.loads((ROOT / "results/steps.json").read_text())
    names = sorted(path.stem for path in (ROOT / "results/steps").glob("*.state"))
    assert [state["name"] for state in record["states"]] == names and len(names) > 15
    assert page.page(record) == (ROOT / "results/STEPS.md").read_text()
    for state in record["states"]:
        document = json.loads((ROOT / f"results/steps/{state['name']}.json").read_text())
        assert (state["step"], state["hard_for"], state["split"]) == (document["step"], document["hard_for"], document["split"])


def test_the_figure_draws_every_state(taken, tmp_path):
    figure.paint(taken[1], tmp_path / "steps.png")
    assert (tmp_path / "steps.png").stat().st_size > 10_000
