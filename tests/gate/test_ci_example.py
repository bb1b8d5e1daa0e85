"""examples/ci: the commands of its README make the baselines, those of the workflow judge, and a defect of the solver turns them red."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples" / "ci"


def commands_of_the_workflow() -> list[str]:
    """What stands in the `run: |` blocks, block by block."""
    lines, blocks = (FOLDER / "conditioning.yml").read_text().splitlines(), []
    for number, line in enumerate(lines):
        if line.strip() == "run: |":
            indent = len(line) - len(line.lstrip())
            block = []
            for below in lines[number + 1 :]:
                if below.strip() and len(below) - len(below.lstrip()) <= indent:
                    break
                block.append(below.strip())
            blocks.append("\n".join(block).strip())
    return blocks


@pytest.fixture(scope="module")
def repository(tmp_path_factory) -> Path:
    """A stranger's repository after both checkouts, with its baselines made as the README says."""
    if not (ROOT / ".venv").exists():
        pytest.skip("no .venv: ./bench setup")
    folder = tmp_path_factory.mktemp("solver")
    shutil.copy(FOLDER / "toy_solver.py", folder)
    (folder / "barrierbench").symlink_to(ROOT)
    first = re.search(r"```sh\n(.*?)```", (FOLDER / "README.md").read_text(), re.DOTALL).group(1)
    done = shell(folder, first)
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in (folder / "ci").iterdir()) == ["matrices.json", "record.json"]
    return folder


def shell(folder: Path, text: str) -> subprocess.CompletedProcess:
    """As the runner does it: bash -e, with a python3 that has numpy. The program is not there, and is not needed."""
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}", "BARRIERBENCH_PROGRAM": "/nonexistent"}
    return subprocess.run(["bash", "-e", "-o", "pipefail", "-c", text], cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_the_commands_run_and_are_green(repository):
    blocks = commands_of_the_workflow()
    assert len(blocks) == 3 and "toy_solver.py" in blocks[0] and "--matrix" in blocks[1] and "--record" in blocks[2]
    for block in blocks:
        done = shell(repository, block)
        assert done.returncode == 0, done.stderr + done.stdout
    assert "green" in done.stdout and (repository / "gate/matrices/gate.json").is_file() and (repository / "gate/record/gate.json").is_file()


def test_a_defect_of_the_solver_turns_both_red(repository):
    solver, matrices, record = commands_of_the_workflow()
    assert shell(repository, solver + " --defect 4").returncode == 0
    for block, metric in ((matrices, "log10_cond raw max"), (record, "gap_min")):
        done = shell(repository, block)
        assert done.returncode == 1 and "RED" in done.stdout
        assert any(metric in line and "FAIL" in line for line in done.stdout.splitlines())


def test_another_config_of_the_solver_has_another_baseline(repository):
    solver, _, record = commands_of_the_workflow()
    assert shell(repository, solver + " --kappa 400").returncode == 0
    done = shell(repository, record)
    assert done.returncode == 2 and "/kappa_N_per_m: 100.0 and 400.0" in done.stderr
