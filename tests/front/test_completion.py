"""The script of ./bench completion in the shells themselves: what they offer for a beginning of a word."""

import shutil
import subprocess

import pytest

from barrierbench_analysis.front.completion import script
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.verb_table import HEADINGS
from tests.bench_call import bench


def offered(*words: str, cwd=ROOT) -> list[str]:
    """By bash, for the last of `./bench WORDS`."""
    code = script("bash") + f"COMP_WORDS=({' '.join(map(repr, ['./bench', *words]))})\nCOMP_CWORD={len(words)}\n_bench\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
    done = subprocess.run(["bash", "-c", code], cwd=cwd, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


def test_bash_offers_the_verbs_on_top_and_those_that_begin_so():
    names = sorted(row.name for row in verbs.top())
    assert 20 < len(names) <= 32 and offered("") == names
    assert offered("gat") == ["gate"] and set(offered("de")) == {"demo", "dev", "device"}
    assert offered("nothing") == offered("gap") == offered("neutr") == []


def test_bash_offers_sub_commands_behind_their_heading(tmp_path):
    """And no files, which stand behind a sub-command alone."""
    (tmp_path / "still.json").touch()
    for heading in HEADINGS:
        names = [verb.name.split()[1] for verb in verbs.below(heading)]
        assert len(names) >= 5 and offered(heading.name, "", cwd=tmp_path) == names
    assert offered("draw", "st", cwd=tmp_path) == ["still"] and offered("study", "ga", cwd=tmp_path) == ["gap-map"]
    assert offered("draw", "still", "st", cwd=tmp_path) == ["still.json"]


def test_bash_offers_the_modes_of_a_study_and_files(tmp_path):
    (tmp_path / "plan.json").touch()
    assert offered("study", "gap-map", "", cwd=tmp_path) == ["run", "plan", "page", "plan.json"]
    assert offered("study", "gap-map", "pl", cwd=tmp_path) == ["plan", "plan.json"]
    assert offered("study", "score", "pl", cwd=tmp_path) == offered("study", "gap-map", "page", "pl", cwd=tmp_path) == ["plan.json"]


def test_bash_offers_the_options_that_the_help_of_a_verb_names(tmp_path):
    helped = tmp_path / "bench"
    helped.write_text("#!/bin/sh\nprintf 'usage: bench %s [-h] [--bicubic COLUMNS ROWS]\\n  --body NAME  a body--or none\\n' \"$*\"\necho $* >>asked\n")
    helped.chmod(0o755)
    for words, asked in ((("run",), "run"), (("data", "frames"), "data frames"), (("data", "frames", "a", "b"), "data frames"), (("gate",), "gate run"), (("gate", "trend"), "gate trend")):
        assert offered(*words, "--", cwd=tmp_path) == ["--bicubic", "--body", "--help"]
        assert offered(*words, "--bi", cwd=tmp_path) == ["--bicubic"]
        assert (tmp_path / "asked").read_text().splitlines()[-1] == f"{asked} --help"


def test_bash_offers_files_behind_a_verb(tmp_path):
    (tmp_path / "drape.json").touch()
    assert offered("run", "dr", cwd=tmp_path) == ["drape.json"]


def test_zsh_reads_the_script(tmp_path):
    if not shutil.which("zsh"):
        pytest.skip("zsh is not installed (apt-get install zsh)")
    subprocess.run(["zsh", "-n", "-c", script("zsh")], check=True, cwd=tmp_path)


def test_zsh_has_a_row_for_every_verb_and_sub_command_with_quotes_that_match():
    rows = [line for line in script("zsh").splitlines() if line.startswith("      '")]
    assert len(rows) == len(verbs.every()) + len(HEADINGS) > 70
    assert all(row.count("'") == 2 and row.endswith("'") for row in rows)


def test_another_shell_is_refused(tmp_path):
    done = bench("completion", "fish", cwd=tmp_path)
    assert done.returncode == 2 and "bash" in done.stderr and "zsh" in done.stderr
    assert bench("completion", "bash", cwd=tmp_path).stdout == script("bash")
