"""The Python of analysis/: formatted and without faults by ruff, no function longer than a screen, one package."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ANALYSIS = ROOT / "analysis"
PACKAGE = ANALYSIS / "src/barrierbench_analysis"
LONGEST = 60


def ruff(*words: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, "-m", "ruff", *words, "--no-cache", str(ANALYSIS)], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("words", [("format", "--check"), ("check",)])
def test_ruff_finds_nothing(words):
    done = ruff(*words)
    assert done.returncode == 0, done.stdout + done.stderr + "\n./bench dev format writes the form"


def test_tests_and_examples_have_no_faults_either():
    """Names that do not exist, imports that nothing uses: also in a test that is skipped here."""
    done = subprocess.run([sys.executable, "-m", "ruff", "check", "--isolated", "--no-cache", "--select", "F,E9", "tests", "examples"],
                          cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_test_waits_for_a_state_and_not_for_a_time():
    """On a busy machine no time is long enough: tests/processes.py waits. The others sleep because time is their subject."""
    waits = re.compile(r"sleep\(|\.wait\([\d.]|select\.select\(|TimeoutExpired")
    sleepers = {str(path.relative_to(ROOT / "tests")) for path in (ROOT / "tests").rglob("*.py") if waits.search(path.read_text())}
    assert sleepers == {"processes.py", "front/test_form.py",
                        "forked.py", "front/test_forked.py",  # a verb that hangs
                        "experiments/test_resume.py", "sweeps/test_random_kills.py",  # kills at random moments
                        "engines/test_engines_of_others.py",  # an engine that hangs
                        "mutation/tree.py", "ptx/inject_faults.py"}  # code that is broken on purpose and may hang


def test_no_function_is_longer_than_a_screen():
    long = []
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno + 1 > LONGEST:
                long.append(f"{path.relative_to(ROOT)}: {node.name}")
    assert not long


def test_users_see_one_kind_of_error():
    """Other exceptions are a mistake of this code, or are caught where something is decided by them."""
    classes = {}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef) and any(isinstance(base, ast.Name) and base.id.endswith(("Error", "Exception")) for base in node.bases):
                classes[node.name] = [base.id for base in node.bases]
    assert classes == {"UserError": ["ValueError"], "RecordError": ["UserError"], "FormulaError": ["UserError"], "NoReference": ["ValueError"], "NotFinite": ["ValueError"], "NoHistory": ["Exception"], "RepeatedKey": ["ValueError"], "NoExpression": ["ValueError"], "NotAtRest": ["ValueError"]}


def test_one_place_starts_the_program():
    """Other files start git, compilers and their like, Python, or targets of their own."""
    others = {"figures/pictures/animation.py", "io/git.py", "studies/toolkit/compare_toolkit.py", "studies/engines/environment.py", "studies/engines/launch.py",
              "program/formula/cache.py", "program/building.py", "pages/readme/snippets.py",
              *(f"front/{name}.py" for name in ("fuzz", "python_module", "site", "test", "tools"))}
    starters, program = set(), re.compile(r"built_program\(|ensure_program\(|RELEASE|BARRIERBENCH_PROGRAM")
    for path in PACKAGE.rglob("*.py"):
        name = path.relative_to(PACKAGE).as_posix()
        if re.search(r"subprocess\.(run|Popen|call|check_\w+)\(|os\.(exec|spawn|system|popen)", text := path.read_text()):
            starters.add(name)
            assert name in ("program/start.py", "program/building.py", "front/test.py") or not program.search(text), name
    assert starters == {"program/start.py", *others}
