"""The script of ./bench completion in the shells themselves: what they offer for a beginning of a word."""

import shutil
import subprocess

import pytest

from barrierbench_analysis.front.completion import script
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program import verbs
from tests.bench_call import bench


def offered(*words: str, cwd=ROOT) -> list[str]:
    """By bash, for the last of `./bench WORDS`."""
    code = script("bash") + f"COMP_WORDS=({' '.join(map(repr, ['./bench', *words]))})\nCOMP_CWORD={len(words)}\n_bench\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
    done = subprocess.run(["bash", "-c", code], cwd=cwd, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


def test_bash_offers_every_verb_and_those_that_begin_so():
    names = sorted(verb.name for verb in verbs.every())
    assert len(names) > 40 and offered("") == names
    assert offered("gat") == ["gate"] and set(offered("ca")) == {name for name in names if name.startswith("ca")} != set()
    assert offered("nothing") == []


def test_bash_offers_the_options_that_the_help_of_a_verb_names(tmp_path):
    helped = tmp_path / "bench"
    helped.write_text("#!/bin/sh\nprintf 'usage: bench %s [-h] [--bicubic COLUMNS ROWS]\\n  --body NAME  a body--or none\\n' \"$1\"\n")
    helped.chmod(0o755)
    assert offered("frames", "--", cwd=tmp_path) == ["--bicubic", "--body"]
    assert offered("frames", "--bi", cwd=tmp_path) == ["--bicubic"]


def test_bash_offers_files_behind_a_verb(tmp_path):
    (tmp_path / "drape.json").touch()
    assert offered("run", "dr", cwd=tmp_path) == ["drape.json"]


def test_zsh_reads_the_script(tmp_path):
    if not shutil.which("zsh"):
        pytest.skip("zsh is not installed (apt-get install zsh)")
    subprocess.run(["zsh", "-n", "-c", script("zsh")], check=True, cwd=tmp_path)


def test_zsh_has_a_row_for_every_verb_with_quotes_that_match():
    rows = [line for line in script("zsh").splitlines() if line.startswith("      '")]
    assert len(rows) == len(verbs.every()) > 40
    assert all(row.count("'") == 2 and row.endswith("'") for row in rows)


def test_another_shell_is_refused(tmp_path):
    done = bench("completion", "fish", cwd=tmp_path)
    assert done.returncode == 2 and "bash" in done.stderr and "zsh" in done.stderr
    assert bench("completion", "bash", cwd=tmp_path).stdout == script("bash")
