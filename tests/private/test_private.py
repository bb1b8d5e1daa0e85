"""Tests that look beyond their own folders, planted here, are red; so is what they leave."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import pytest

from barrierbench_analysis.front.private import left_over, variables
from tests import browser

ROOT = Path(__file__).resolve().parents[2]
CONFTEST = f"""import sys
sys.path.insert(0, {str(ROOT)!r})
from tests.private import own_folders
from tests.private.own_folders import own_folders_only
own_folders.begin()
"""
PLANTED = {
    "asks": "Path('{there}').exists()",
    "asks_in_a_process": "subprocess.run([sys.executable, '-c', 'import os; os.path.isfile(\"{there}\")'], check=True)",
    "reads": "Path('{there}').read_text()",
    "lists": "os.listdir('{folder}')",
    "writes": "Path('{folder}/written').write_text('x')",
    "removes": "os.remove('{gone}')",
    "writes_into_the_clone": f"open('{ROOT}/planted.txt', 'a').close(); os.remove('{ROOT}/planted.txt')",
    "leaves_in_the_home": "Path.home().joinpath('.planted').write_text('x')",
    "leaves_a_temporary_folder": "tempfile.mkdtemp()",
    "leaves_by_another_program": "subprocess.run(['sh', '-c', 'mktemp'], check=True)",
}
GOOD = ("from pathlib import Path\nimport json, os, subprocess, sys, tempfile\nROOT = Path({root!r})\n"
        "def test_good(tmp_path):\n"
        "    (tmp_path / 'a').write_text((ROOT / 'README.md').read_text())\n"
        "    os.rename(tmp_path / 'a', tmp_path / 'b'); os.listdir(ROOT / 'docs'); assert not Path('/nowhere/x').exists()\n"
        "    with tempfile.TemporaryDirectory() as folder: Path(folder, 'x').touch()\n"
        "    subprocess.run([sys.executable, '-c', 'import json, pathlib; pathlib.Path(\"c\").touch()'], cwd=tmp_path, check=True)\n"
        "    assert os.listdir(Path.home()) == [] and 'SECRET_OF_THIS_MACHINE' not in os.environ\n")


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory) -> dict:
    """Name of a planted test -> what is reported of it; one run of pytest in a folder of its own, as on a machine where much lies about."""
    there = tmp_path_factory.mktemp("machine")
    (ROOT / "build").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="planted-") as place:
        return planted(there, Path(place))


def planted(there: Path, place: Path) -> dict:
    for name in ("file", "gone"):
        (there / name).write_text("of somebody")
    (place / "conftest.py").write_text(CONFTEST)
    lines = [GOOD.format(root=str(ROOT))]
    for name, line in PLANTED.items():
        line = line.replace("{there}", str(there / "file")).replace("{gone}", str(there / "gone")).replace("{folder}", str(there))
        lines.append(f"def test_{name}():\n    {line}\n")
    (place / "test_planted.py").write_text("\n".join(lines))
    environment = {name: value for name, value in os.environ.items() if not name.startswith("BARRIERBENCH_TESTS_")}
    words = [sys.executable, "-m", "pytest", "-q", "-rA", "-c", os.devnull, "--rootdir", place, "--confcutdir", place, "-p", "no:cacheprovider", "test_planted.py"]
    # the folders of this test are no longer allowed there, nor is its home the one there
    done = subprocess.run(words, cwd=place, env=environment | {"SECRET_OF_THIS_MACHINE": "1", "TMPDIR": "/tmp"}, capture_output=True, text=True, check=False)
    assert "11 passed" in done.stdout, done.stdout + done.stderr  # their bodies are well; what is red comes after
    return {"": done.stdout} | {name: done.stdout.partition(f"ERROR at teardown of test_{name} _")[2].partition("\n____")[0] for name in (*PLANTED, "good")}


@pytest.mark.parametrize("name", PLANTED)
def test_a_test_that_looks_elsewhere_is_red(verdicts, name):
    word = name.partition("_")[0]
    assert "outside the clone" in verdicts[name] and f"\n{'reads' if word in ('asks', 'lists') else 'writes' if word == 'removes' else word} /" in verdicts[name].replace("E   ", "").replace("  ", ""), verdicts[name]


def test_a_test_in_its_own_folders_is_not(verdicts):
    assert verdicts["good"] == "" and f"{len(PLANTED)} errors" in verdicts[""]


def test_few_variables_are_those_of_the_machine(tmp_path):
    of_machine = {"PATH": "/bin", "HOME": "/home/of/nobody", "XDG_CACHE_HOME": "/none", "SECRET": "1", "BARRIERBENCH_CACHE": "/none", "BARRIERBENCH_PROGRAM": "/bin/true", "LC_ALL": "de_DE", "PYTHONPATH": "/none"}
    made = variables(tmp_path, of_machine)
    assert {name for name in made if of_machine.get(name) == made[name]} == {"PATH", "BARRIERBENCH_PROGRAM"}
    assert made["CCACHE_DIR"] == "/none/ccache" and all(Path(made[name]).is_relative_to(tmp_path) for name in ("HOME", "TMPDIR", "XDG_CACHE_HOME"))


def test_what_is_left_is_named_and_taken_away(tmp_path):
    variables(tmp_path, {"HOME": str(tmp_path)})
    (tmp_path / "home/.x").mkdir()
    (tmp_path / "home/.x/y").touch()
    (tmp_path / "temporary/pytest-of-a").mkdir()
    assert left_over(tmp_path, "pytest-of-*") == [tmp_path / "home/.x"] and left_over(tmp_path) == [tmp_path / "temporary/pytest-of-a"] and left_over(tmp_path) == []


def test_a_browser_of_tests_has_a_home_of_its_own(tmp_path):
    """Chromium keeps certificates in ~/.pki, whatever its profile. No other test starts it otherwise."""
    requested = {}
    play = SimpleNamespace(chromium=SimpleNamespace(launch=lambda **words: requested.update(words) or "started"))
    assert browser.launched(play, tmp_path, 7) == "started" and requested["timeout"] == 7
    folders = {name: Path(requested["env"][name]) for name in ("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME")}
    assert folders["HOME"] == tmp_path and all(folder.is_relative_to(tmp_path) for folder in folders.values()) and requested["env"]["PATH"] == os.environ["PATH"]
    starts = [path.name for path in (ROOT / "tests").rglob("*.py") if ".launch(" in path.read_text() and path != Path(__file__)]
    assert starts == ["browser.py"]
