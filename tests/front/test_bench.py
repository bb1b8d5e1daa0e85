"""The script ./bench: short, works without HOME and PATH, makes the environment once, and hands on what the front door answers."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BENCH = ROOT / "bench"


@pytest.fixture(autouse=True)
def _environment():
    if not (ROOT / ".venv/.recipe").exists():
        pytest.skip("no .venv: ./bench setup")


def bench(*words: str, **more) -> subprocess.CompletedProcess:
    return subprocess.run([str(BENCH), *words], capture_output=True, text=True, check=False, timeout=120, **more)


def test_it_has_at_most_120_lines_and_sources_nothing():
    lines = BENCH.read_text().splitlines()
    assert len(lines) <= 120
    assert not [line for line in lines if line.lstrip().startswith(("source ", ". "))]


def test_help_works_without_home_and_path(tmp_path):
    done = bench("help", env={}, cwd=tmp_path)
    assert done.returncode == 0 and done.stderr == "" and "usage: ./bench VERB" in done.stdout
    assert done.stdout == bench(env={"PATH": "/nowhere:" + os.environ["PATH"]}).stdout


def test_a_folder_with_modules_of_its_own_does_not_matter(tmp_path):
    (tmp_path / "argparse.py").write_text("raise SystemExit(9)\n")
    assert bench("gate", "compare", "--help", cwd=tmp_path).returncode == 0


def test_exit_codes_are_those_of_the_verb(tmp_path):
    missing = bench("gate", "compare", str(tmp_path / "a"), str(tmp_path / "b"))
    assert missing.returncode == 2 and "Traceback" not in missing.stderr and str(tmp_path / "a") in missing.stderr
    wrong = bench("figuers")
    assert wrong.returncode == 2 and wrong.stdout == "" and "did you mean draw figures?" in wrong.stderr


def copied(folder: Path) -> Path:
    """The script and the front door alone, with an environment of which nothing is true but the recipe."""
    for path in [BENCH, *(ROOT / "analysis").glob("requirements*.txt"), ROOT / "analysis/pyproject.toml"]:
        to = folder / path.relative_to(ROOT)
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_bytes(path.read_bytes())
    (folder / "bench").chmod(0o755)
    python = folder / ".venv/bin/python"
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "$@" >>"$(dirname "$0")/../calls"\n')
    python.chmod(0o755)
    return folder


def test_the_environment_is_made_once_and_again_when_its_recipe_changes(tmp_path):
    root = copied(tmp_path)

    def calls() -> list[str]:
        (root / ".venv/calls").write_text("")
        done = subprocess.run([str(root / "bench"), "eval", "-"], capture_output=True, text=True, check=True)
        assert done.stdout == ""
        return (root / ".venv/calls").read_text().splitlines()

    first = calls()
    assert any("requirements.txt" in call for call in first) and first[-1] == f"{root}/analysis eval -"
    assert calls() == [f"{root}/analysis eval -"]
    (root / "analysis/requirements-test.txt").write_text("another==1\n")
    assert any("requirements-test.txt" in call for call in calls())


@pytest.mark.parametrize("free_kB, said", [(65535, "1"), (65536, "unset"), ("-", "unset")])
def test_no_module_is_compiled_to_a_file_where_the_disk_is_nearly_full(tmp_path, free_kB, said):
    """From the first start of Python on, which makes the environment. df says - of a file system that has no size."""
    root = copied(tmp_path)
    (root / ".venv/bin/python").write_text('#!/bin/sh\necho "${PYTHONDONTWRITEBYTECODE-unset}"\n')
    (root / "df").write_text(f"#!/bin/sh\necho Avail\necho {free_kB}\n")
    (root / "df").chmod(0o755)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    done = subprocess.run([str(root / "bench"), "eval", "-"], capture_output=True, text=True, check=True, env={**environment, "PATH": f"{root}:{environment['PATH']}"})
    starts = [line for line in (done.stdout + done.stderr).splitlines() if not line.startswith("bench: ")]
    assert len(starts) > 3 and set(starts) == {said}
