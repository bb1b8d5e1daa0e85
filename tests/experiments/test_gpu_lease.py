"""A lease of a card, run to its end on the host executor: its stages, what fails in one of them, its archives, the bundle that carries it."""

import json
import os
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

from barrierbench_analysis.studies.device import gpu_evidence

ROOT = Path(__file__).resolve().parents[2]
STAGES = ["tests", "dense_500k", "contact_82k", "dense_1m", "kernels", "counters", "growth", "sanitizer"]
MOST_BYTES, MOST_FILES = 16 * 2**20, 8
# The program; with SPOIL a scene that fails, one that neither ends nor hears SIGTERM, and one that leaves more than an archive may have.
BENCH = """#!/bin/bash
case "$SPOIL $*" in
  "yes run"*/dense_500k.json*/dense_500k.timed*) echo "a kernel failed" >&2; exit 70 ;;
  "yes run"*/dense_1m.json*) trap '' TERM; while :; do read -t 1 <> <(:); done ;;
  "yes run"*/packed_8m.json*) while [ "$1" != --out ]; do shift; done; mkdir -p "$2"; head -c 20000000 /dev/urandom >"$2/large"; echo kept >"$2/small" ;;
  "bare run"*) echo "a kernel failed" >&2; exit 70 ;;
  "none device"*) echo "there is no card" >&2; exit 5 ;;
  *" build "*) ;;
  *" run"*/dense_500k*) echo "${BARRIERBENCH_SYNCHRONIZE_PHASES:-0} $*" >>"$PROGRAM_CALLS"; exec "$PROGRAM" "$@" ;;
  *" scenes "*) touch "$4" ;;  # a verb that is no verb of the program
  *) exec "$PROGRAM" "$@" ;;
esac
"""
# Nsight Compute and compute-sanitizer leave their own words out and run the command.
NCU = '#!/bin/bash\nwhile [ "${1##*/}" != bench ]; do shift; done\necho \'"ID","Kernel Name","Metric Name","Metric Unit","Metric Value"\'\n"$@" >/dev/null\n' \
    "echo '\"0\",\"void bb::exec::run_each<bb::exec::RankRows>(long, T1)\",\"gpu__time_duration.sum\",\"ns\",\"5,000\"'\n"
SANITIZER = '#!/bin/bash\necho "$GTEST_SHARD_INDEX of $GTEST_TOTAL_SHARDS: $*" >&2\n"${@: -1}"\n'
TEST = '#!/bin/bash\necho "X100: 3 kernels in 9 launches, 9 compared with the host, 0 kernels differ"\n'


def executable(path: Path, text: str) -> None:
    path.write_text(text)
    path.chmod(0o755)


@pytest.fixture
def around(tmp_path, program):
    """The environment of a lease: programs that stand for what only a machine with a card has."""
    for folder in ("tests", "tools"):
        (tmp_path / folder).mkdir()
    executable(tmp_path / "bench", BENCH)
    for name in ("test_device", "test_card_contact", "test_card_linear"):
        executable(tmp_path / "tests" / name, TEST)
    executable(tmp_path / "tools/ncu", NCU), executable(tmp_path / "tools/compute-sanitizer", SANITIZER)
    return {**os.environ, "BARRIERBENCH_BENCH": str(tmp_path / "bench"), "BARRIERBENCH_DEVICE_TESTS": str(tmp_path / "tests"), "PROGRAM": program, "PROGRAM_CALLS": str(tmp_path / "calls"),
            "BARRIERBENCH_CONFIGS": str(ROOT / "configs"), "PATH": f"{tmp_path / 'tools'}:{os.environ['PATH']}"}


def lease(around, tmp_path, *words, script=ROOT / "experiments/gpu_evidence.sh", **more):
    """Takes as long as its work does, some seconds, since no limit is reached."""
    return subprocess.run([script, "--lease", "--dry", "--out", tmp_path / "raw", *words], env={**around, **more}, capture_output=True, text=True, check=False)


def read(raw: Path):
    """(stages, parts) of raw files: name -> exit code, name -> status."""
    return {stage["name"]: stage for stage in gpu_evidence.stages_of(raw)}, {name: part["status"] for name, part in gpu_evidence.parts_of(raw).items()}


def test_a_lease_runs_all_of_its_stages(around, tmp_path):
    done = lease(around, tmp_path, "--archives", tmp_path / "archives")
    assert done.returncode == 0 and done.stdout.strip() == str(tmp_path / "archives"), done.stderr
    stages, parts = read(tmp_path / "raw")
    assert list(stages) == STAGES
    assert sum(stage["limit_s"] for stage in stages.values()) <= 540
    no_card = {"device", "device_again"}  # this machine may have none
    assert {name for name, status in parts.items() if status != "passed"} - no_card == {"dense_500k.before"}
    assert {"card_contact", "card_linear", "dense_500k", "dense_500k.timed", "counters", "dense_1m", *(f"packed_8m.{layers}" for layers in (8, 16, 32)),
            *(f"drape_82k.{variant}" for variant in ("line_search.escape", "line_search.ignore", "accumulated_toi.report", "accumulated_toi.ignore"))} <= set(parts)
    files = sorted((tmp_path / "archives").iterdir())
    assert [file.name for file in files] == [f"{number}-{name}.tar.gz" for number, name in enumerate(STAGES, 1)] and len(files) <= MOST_FILES
    assert all(0 < file.stat().st_size <= MOST_BYTES for file in files)


def test_the_archives_of_a_lease_make_the_record(around, tmp_path):
    assert lease(around, tmp_path).returncode == 0
    raw = gpu_evidence.unpacked(tmp_path / "raw/archives", tmp_path / "unpacked")
    assert raw == tmp_path / "unpacked"
    (raw / "device.json").write_text(json.dumps({"usable": True, "card": "X100", "copy": {"on_the_card_Bps": 3e12}}))
    with pytest.raises(gpu_evidence.UserError, match="of a lease without a card"):
        gpu_evidence.collect(raw, "", 0)
    record = gpu_evidence.collect(raw, "", 0, dry=True)
    assert record["synchronized"] == ["dense_500k.phases"]
    calls = [line.split() for line in (tmp_path / "calls").read_text().splitlines()]
    runs = {words[words.index("--out") + 1].rsplit("/", 1)[1]: words[0] for words in calls}
    assert runs == {"dense_500k": "0", "dense_500k.phases": "1", "dense_500k.timed": "0", "dense_500k.counted": "0"}
    assert [stage["name"] for stage in record["stages"]] == STAGES and 0 <= record["seconds"] <= 540  # whole seconds: a dry lease may take none
    ran = {name for name, scene in record["scenes"].items() if scene is not None}
    assert ran == {"dense_500k", "dense_500k.phases", "dense_500k.timed", "dense_500k.counted", "dense_1m", "packed_8m.8", "packed_8m.16", "packed_8m.32",
                   *(f"drape_82k.{variant}" for variant in ("line_search.escape", "line_search.ignore", "accumulated_toi.report", "accumulated_toi.ignore"))}
    for name in ran:
        phases = record["scenes"][name]["phases_ms"]
        assert len(phases) == 17 and sum(phases.values()) > 0, name
    assert record["scenes"]["dense_500k"]["first_step_s"] > 0
    assert record["counters"] == [{"name": "bb::exec::RankRows", "gpu__time_duration.sum": 5000.0}]


def test_an_archive_of_another_kind_is_named(tmp_path):
    (tmp_path / "1-tests.tar.gz").write_text("no archive")
    with pytest.raises(gpu_evidence.UserError, match="1-tests.tar.gz: not an archive of a lease"):
        gpu_evidence.unpacked(tmp_path, tmp_path / "unpacked")
    with tarfile.open(tmp_path / "1-tests.tar.gz", "w:gz") as archive:
        archive.add(__file__, "../elsewhere")
    with pytest.raises(gpu_evidence.UserError, match="'../elsewhere'; allowed: files below"):
        gpu_evidence.unpacked(tmp_path, tmp_path / "unpacked")


def test_a_stage_that_fails_or_is_cut_does_not_stop_the_others(around, tmp_path):
    assert lease(around, tmp_path, "--seconds", "120", SPOIL="yes").returncode == 0
    stages, parts = read(tmp_path / "raw")
    assert list(stages) == STAGES
    assert parts["dense_500k.timed"] == "failed" and stages["kernels"]["exit_code"] == 70
    assert parts["dense_1m"] == "timed_out" and stages["dense_1m"]["exit_code"] in (124, 137)
    assert parts["counters"] == "passed" and parts["memcheck_contact.3"] == "passed"
    archives = tmp_path / "raw/archives"
    assert len(list(archives.iterdir())) == len(STAGES) and all(file.stat().st_size <= MOST_BYTES for file in archives.iterdir())
    with tarfile.open(archives / "7-growth.tar.gz") as archive:
        names = archive.getnames()
    assert "./left_out.txt" in names and "./packed_8m.8/small" in names
    left_out = (tmp_path / "raw/left_out.txt").read_text().split()
    assert left_out and all(name.endswith("/large") and name not in names for name in left_out)


def test_the_module_on_which_memcheck_ended_least_is_next(around, tmp_path):
    bundle = tmp_path / "bundle"
    for folder in ("bin", "results/gpu"):
        (bundle / folder).mkdir(parents=True)
    shutil.copy(ROOT / "experiments/gpu_evidence.sh", bundle), shutil.copytree(ROOT / "experiments/card", bundle / "card"), shutil.copytree(ROOT / "configs", bundle / "configs")
    executable(bundle / "bin/barrierbench", "#!/bin/sh\n")
    (bundle / "results/gpu/x100-2026-01-01.json").write_text(json.dumps({"parts": {
        "memcheck_contact.0": {"status": "passed"}, "memcheck_linear": {"status": "left_out"}, "memcheck_linear.1": {"status": "timed_out"},
        "memcheck_linear_more.0": {"status": "failed"}}}, indent=1))
    assert lease(around, tmp_path, script=bundle / "gpu_evidence.sh").returncode == 0
    assert (tmp_path / "raw/sanitized_module").read_text() == "linear\n"
    assert "0 of 4: --tool memcheck" in (tmp_path / "raw/logs/memcheck_linear.0.err").read_text()


def test_a_bundle_is_one_archive_that_can_be_carried(around, tmp_path, program):
    if Path(program) != (ROOT / "build/release/experiments/barrierbench").resolve():
        pytest.skip(f"a bundle is made of build/release, and this program is {program}")
    done = subprocess.run([ROOT / "experiments/gpu_evidence.sh", "--bundle", tmp_path / "card", "--before", "none"], env=around, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    packed = tmp_path / "card.tar.xz"
    assert 0 < packed.stat().st_size <= 64 * 2**20
    shutil.rmtree(tmp_path / "card")
    (tmp_path / "there").mkdir()
    subprocess.run(["tar", "--extract", "--file", packed, "--directory", tmp_path / "there"], check=True)
    there = tmp_path / "there/card"
    shutil.copytree(there, there / "before", ignore=shutil.ignore_patterns("lib", "minis"))  # stands for the program of the commit before
    bare = {name: value for name, value in around.items() if not name.startswith("BARRIERBENCH_")}
    assert lease(bare, tmp_path, script=there / "gpu_evidence.sh").returncode == 0
    stages, parts = read(tmp_path / "raw")
    assert list(stages) == STAGES and parts["dense_500k"] == parts["dense_500k.before"] == "passed"


def test_a_lease_without_a_card_ends_at_once(around, tmp_path):
    done = subprocess.run([ROOT / "experiments/gpu_evidence.sh", "--lease", "--out", tmp_path / "raw"], env={**around, "SPOIL": "none"}, capture_output=True, text=True, check=False)
    assert done.returncode == 5 and "there is no card" in done.stderr and not (tmp_path / "raw").exists()


def test_a_lease_of_which_no_stage_passed_says_so(around, tmp_path):
    shutil.rmtree(tmp_path / "tests")
    executable(tmp_path / "tools/ncu", "#!/bin/sh\nexit 9\n")
    done = lease(around, tmp_path, "--seconds", "0090", SPOIL="bare")
    assert done.returncode == 1 and "no stage passed" in done.stderr and len(list((tmp_path / "raw/archives").iterdir())) == len(STAGES)
    assert read(tmp_path / "raw")[0]["dense_500k"]["limit_s"] == 50 * 90 // 540


@pytest.fixture
def checkout(tmp_path):
    """A clone with one commit of history, of the scripts alone."""
    origin = tmp_path / "origin"
    shutil.copytree(ROOT / "experiments/card", origin / "experiments/card"), shutil.copy(ROOT / "experiments/gpu_evidence.sh", origin / "experiments")
    git = ["git", "-C", origin, "-c", "user.name=a", "-c", "user.email=a@b.c"]
    subprocess.run(["git", "init", "-q", origin], check=True), subprocess.run([*git, "add", "."], check=True)
    for message in ("first", "second"):
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", message], check=True)
    subprocess.run(["git", "clone", "-q", "--depth", "1", f"file://{origin}", tmp_path / "clone"], check=True)
    return tmp_path


@pytest.mark.parametrize(("where", "words", "lacks", "reported"), [
    ("clone", (), "", "--before HEAD~1: this clone is shallow and does not have that commit; allowed: a commit that it has, or --before none"),
    ("origin", ("--before", "elsewhere"), "", "--before elsewhere: this is no commit of the checkout"),
    ("clone", ("--before", "none"), "xz", "the program xz was not found"),
    ("clone", ("--before", "none"), "strip", "the program strip was not found"),
    ("clone", ("--bundle", "full/"), "", "full: it is there and is not an empty folder; allowed: a new folder or an empty one")])
def test_a_bundle_that_cannot_be_made_is_refused_before_anything_is_built(checkout, where, words, lacks, reported):
    (checkout / "full").mkdir(), (checkout / "full/kept").write_text("kept"), (checkout / "few").mkdir()
    for tool in {"bash", "dirname", "readlink", "date", "git", "realpath", "find", "xz", "strip"} - {lacks}:
        (checkout / "few" / tool).symlink_to(shutil.which(tool))
    executable(checkout / "bench", f'#!/bin/bash\n: >"{checkout}/built"\nexit 70\n')
    done = subprocess.run([checkout / where / "experiments/gpu_evidence.sh", "--bundle", "new/", *words], cwd=checkout, capture_output=True, text=True, check=False,
                          env={"PATH": str(checkout / "few"), "BARRIERBENCH_BENCH": str(checkout / "bench")})
    assert done.returncode == 2 and reported in done.stderr, done.stderr
    assert not (checkout / "built").exists() and not (checkout / "new").exists() and (checkout / "full/kept").exists()


@pytest.mark.parametrize(("words", "reported"), [
    (("--before", "none"), "--before means nothing without --bundle"), (("--seconds", "90"), "--seconds means nothing without --lease"),
    (("--lease", "--only", "tests"), "--only means nothing with --lease"), (("--lease", "--records", "kept"), "--records means nothing with --lease"),
    (("--lease", "--bundle", "card"), "--bundle means nothing with --lease"), (("--bundle", ""), '--bundle "": the value is empty')])
def test_options_that_mean_nothing_together_are_refused(tmp_path, words, reported):
    done = subprocess.run([ROOT / "experiments/gpu_evidence.sh", *words], cwd=tmp_path, env={**os.environ, "BARRIERBENCH_BENCH": "/bin/false"}, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and f"gpu_evidence: {reported}" in done.stderr and not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [("--lease", "--seconds", "59"), ("--lease", "--seconds", "0059"), ("--lease", "--seconds", "ten"), ("--dry",), ("--archives", "somewhere")])
def test_words_that_no_lease_has_are_refused(tmp_path, words):
    done = subprocess.run([ROOT / "experiments/gpu_evidence.sh", "--out", tmp_path / "raw", *words], env={**os.environ, "BARRIERBENCH_BENCH": "/bin/false"}, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "gpu_evidence: --" in done.stderr and not (tmp_path / "raw").exists()
