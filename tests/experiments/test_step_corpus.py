"""States of steps: ./bench data steps --keep and --corpus, what they refuse, and the committed corpus of ./bench study step-corpus."""

import hashlib
import json
import re
import shutil
import subprocess
import zlib
from pathlib import Path

import pytest
from processes import started, wait_until

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.steps import step_corpus
from barrierbench_analysis.studies.steps import step_corpus_figure as figure
from barrierbench_analysis.studies.steps import step_corpus_page as page
from barrierbench_analysis.studies.steps import step_corpus_states as make

ROOT = Path(__file__).resolve().parents[2]
CONFIG = [str(ROOT / "configs/scenes/drape.json"), "--set", "/scene/layers=2", "--set", "/scene/n=6", "--set", "/threads=1",
          "--set", "/matching/load_N=1", "--set", "/matching/limit_load_N_per_m=10"]
STEP = 9
LITERAL = ["/scene/variant=pinned", "/scene/protocol=article_literal", "/scene/pairs=vertex_vertex", "/time/steps=4", "/threads=1",
           "/formulation/stiffness_policy/kappa_N_per_m=1", "/strain_limit/shape=log"]


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
    done = bench(program, "list", "step_solvers")
    listed = set(re.findall(r"^  ([a-z_]+) ", done.stdout, re.MULTILINE))
    assert done.returncode == 0 and {"line_search", "xpbd", "pncg"} < listed
    assert {trial["step_solver"] for trial in state["trials"]} == listed
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
    rules = [rule for rule in page.hessians(taken[1]) if "refused" not in page.trial_of(state, rule)]
    assert judged == len(rules) == 5
    assert "without friction" in page.trial_of(state, page.OWN + page.EXACT)["refused"]
    assert "refused: /formulation/shape" in taken[0] and "small, step 9" in taken[0]


def test_a_state_that_line_search_cannot_have_is_a_row_and_the_others_are_taken(program, kept, tmp_path):
    literal = [ROOT / "configs/scenes/drape2d.json", *(word for value in LITERAL for word in ("--set", value))]
    folder = shutil.copytree(kept, tmp_path / "states")
    done = bench(program, "steps", *literal, "--at", "1", "--keep", folder / "literal")
    assert done.returncode == 0, done.stderr
    done = bench(program, "steps", "--corpus", folder, "--out", tmp_path / "steps.json")
    assert done.returncode == 0 and "literal, step 1: refused: /step_solver/name" in done.stdout, done.stderr
    record = json.loads((tmp_path / "steps.json").read_text())
    literal, small = record["states"]
    assert literal["refused"].startswith('/step_solver/name: found "line_search"') and "trials" not in literal
    assert len(small["trials"]) > 10
    written = page.page(record)
    assert "1 states, " in written and "States without trials" in written and literal["refused"] in written
    figure.paint(record, tmp_path / "steps.png")
    with pytest.raises(UserError, match="none of 1 states has trials"):
        page.page({**record, "states": [literal]})


def test_a_record_has_every_state_that_was_taken_before_the_program_was_killed(program, kept, tmp_path):
    folder = shutil.copytree(kept, tmp_path / "states")
    for ending in (".json", ".state"):  # seconds of work
        shutil.copy(ROOT / f"results/steps/large_five_twist{ending}", folder / f"twist{ending}")
    out = tmp_path / "steps.json"
    with started(program, "steps", "--corpus", folder, "--out", out, "--progress", "none") as process:
        wait_until(out.exists, process)
    assert [state["name"] for state in json.loads(out.read_text())["states"]] == ["small"]


def test_a_place_that_cannot_be_written_is_refused_and_neither_file_is_left(program, tmp_path):
    for taken in ("json", "state"):
        (tmp_path / taken / f"x.{taken}").mkdir(parents=True)
        done = bench(program, "steps", *CONFIG, "--at", STEP, "--keep", tmp_path / taken / "x")
        assert done.returncode != 0 and f"x.{taken}: cannot be written" in done.stderr, done.stderr
        assert [file.name for file in (tmp_path / taken).iterdir()] == [f"x.{taken}"]


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


@pytest.mark.parametrize("edit, message", [
    (lambda document, packed: packed[:-20], "cut off or damaged"),
    (lambda document, packed: bytes(reversed(packed)), "cut off or damaged"),
    (lambda document, _: document["config"]["scene"].update(n=7), "of another scene or mesh"),
    (lambda document, _: document["config"]["scene"].update(width_m=1.1), "of another scene or mesh"),
    (lambda document, _: document.update(schema="barrierbench.step_state/0"), 'schema "barrierbench.step_state/0"'),
    (lambda document, _: document.__delitem__("calibration"), "a key that is missing or of another type"),
    (lambda document, _: document.update(velocity_hash="0"), "an archive of another build"),
    (other_archive, "an archive of another build (archive: more than this program keeps)"),
])
def test_a_state_that_this_program_cannot_take_is_refused_with_the_command_that_remakes_it(program, kept, tmp_path, edit, message):
    folder = damaged(kept, tmp_path / "states", edit)
    done = bench(program, "steps", "--corpus", folder, "--out", tmp_path / "out.json")
    assert done.returncode == 2 and done.stdout == "" and not (tmp_path / "out.json").exists()
    assert message in done.stderr and f"{folder}/small" in done.stderr and "./bench study step-corpus --make --only small" in done.stderr


def test_what_is_not_there_is_refused_by_name(program, kept, tmp_path):
    for words, message in [
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
        assert done.returncode == 2 and message in done.stderr and done.stdout == "", (words, done.stderr)
    assert list(tmp_path.iterdir()) == []


def test_without_a_folder_the_corpus_is_results_steps(program, tmp_path):
    done = subprocess.run([program, "steps", "--corpus", "--only", "x"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 2 and "results/steps: found no folder" in done.stderr


def test_the_halves_alternate_in_alphabetical_order():
    assert make.halves(["c", "a", "b"]) == {"a": "tune", "b": "report", "c": "tune"}


@pytest.mark.parametrize("edit, message", [
    (lambda spec: spec["states"][0].update(base="x.json", catalogue="twist"), "either base (a config) or catalogue"),
    (lambda spec: spec["states"].append(spec["states"][0]), "; every name once is needed"),
    (lambda spec: spec["states"][0].pop("hard_for"), "states/0/hard_for: is missing"),
])
def test_a_bad_list_is_refused(tmp_path, edit, message):
    spec = json.loads((ROOT / "configs/steps/corpus.json").read_text())
    edit(spec)
    file = tmp_path / "corpus.json"
    file.write_text(json.dumps(spec))
    with pytest.raises(UserError, match=re.escape(message)):
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


@pytest.mark.parametrize("words", [("--make", "--take"), ("--make", "--table"), ("--take", "--table")])
def test_two_parts_of_the_work_at_once_are_refused(words, capsys):
    assert step_corpus.main(list(words)) == 2
    assert "not allowed with" in capsys.readouterr().err


def test_the_figure_of_the_results_goes_to_docs_however_the_folder_is_written(monkeypatch, tmp_path):
    (tmp_path / "results").mkdir()
    painted = []
    monkeypatch.setattr(step_corpus, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(step_corpus, "ROOT", tmp_path)
    monkeypatch.setattr(step_corpus, "read_of_schema", lambda *_: {})
    monkeypatch.setattr(step_corpus, "page", lambda _: "")
    monkeypatch.setattr(step_corpus, "paint", lambda _, path: painted.append(path))
    monkeypatch.chdir(tmp_path)
    step_corpus.write_page(Path("results"))
    step_corpus.write_page(Path("results/../results"))
    assert painted == [tmp_path / "docs/steps.png"] * 2


def test_what_an_earlier_list_had_goes_by_name_and_own_files_stay(tmp_path, capsys):
    kept = {"schema": "barrierbench.step_state/1"}
    for name, document in [("listed", {**kept, "split": "tune"}), ("earlier", {**kept, "split": "report"}), ("mine", kept), ("other", {"split": "tune"})]:
        (tmp_path / f"{name}.json").write_text(json.dumps(document))
        (tmp_path / f"{name}.state").write_bytes(b"x")
    (tmp_path / "lone.state").write_bytes(b"x")
    make.drop_unlisted(tmp_path, ["listed"])
    assert {file.stem for file in tmp_path.iterdir()} == {"listed", "mine", "other", "lone"}
    message = capsys.readouterr().err
    assert message.count("removed") == 2 and f"{tmp_path}/earlier.json" in message and f"{tmp_path}/earlier.state" in message


def test_a_take_that_is_cut_off_leaves_the_earlier_record(monkeypatch, tmp_path):
    record = tmp_path / "steps.json"
    record.write_text("earlier")

    def cut_off(*words):
        Path(words[words.index("--out") + 1]).write_text("a part")
        return subprocess.CompletedProcess(words, 130, "", "interrupted")

    monkeypatch.setattr(step_corpus, "started", cut_off)
    with pytest.raises(UserError, match=re.escape(f"{tmp_path}/steps.part.json has the states that were taken")):
        step_corpus.take(tmp_path, record)
    assert record.read_text() == "earlier"
