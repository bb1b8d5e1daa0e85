""".ci/run: tests there do not see this machine's home and temporary folder, and a file that they leave is a failure."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MAY_MOUNT = os.geteuid() == 0 and subprocess.run(["unshare", "--mount", "true"], capture_output=True, check=False).returncode == 0


def run(tmp_path: Path, bench: str, **more) -> subprocess.CompletedProcess:
    """The script in a tree in the home of a machine where much lies about, with these lines as ./bench."""
    home = tmp_path / "machine"
    tree = home / "tree"
    (tree / ".ci").mkdir(parents=True)
    shutil.copy(ROOT / ".ci/run", tree / ".ci/run")
    (tree / "bench").write_text(f"#!/usr/bin/env bash\nset -eu\n{bench}\n")
    (tree / "bench").chmod(0o755)
    (home / "made_once").write_text("by somebody")
    (home / ".cache").mkdir()
    (home / ".cache/kept").touch()
    environment = {"PATH": os.environ["PATH"], "HOME": str(home), "TMPDIR": str(tmp_path), **more}
    return subprocess.run([tree / ".ci/run", "-L", "contact"], env=environment, capture_output=True, text=True, check=False)


def test_the_home_and_the_temporary_folder_are_empty_ones(tmp_path):
    done = run(tmp_path, 'echo "$*"; ls -A "$HOME" "$TMPDIR"; mkdir "$TMPDIR/a"; test ! -e "$HOME/made_once"; touch "$(dirname "$0")/made_in_the_tree"')
    assert done.returncode == 0 and done.stdout.startswith("test -L contact\n") and "made_once" not in done.stdout, done.stderr
    assert (tmp_path / "machine/tree/made_in_the_tree").exists() and not list(tmp_path.glob("barrierbench-ci*"))


@pytest.mark.skipif(not MAY_MOUNT, reason="only root may mount")
def test_what_this_machine_has_cannot_be_read_by_its_name(tmp_path):
    done = run(tmp_path, f'test ! -e "{tmp_path}/machine/made_once"; test -e "{tmp_path}/machine/.cache/kept"; ls "{tmp_path}/machine/tree"')
    assert done.returncode == 0 and "bench" in done.stdout, done.stderr
    assert run(tmp_path / "again", f'cat "{tmp_path}/again/machine/made_once"').returncode == 1


@pytest.mark.parametrize("place", ["$HOME/.left", "$TMPDIR/left/in"])
def test_a_file_that_is_left_is_a_failure(tmp_path, place):
    done = run(tmp_path, f'mkdir -p "$(dirname "{place}")"; touch "{place}"')
    assert done.returncode == 1 and "files were left outside the tree:\n/" in done.stderr and Path(place).name in done.stderr


def test_what_fails_stays_a_failure(tmp_path):
    assert run(tmp_path, "exit 3").returncode == 3
