"""The recipes of examples/cluster, with stand-ins for GNU parallel and Slurm that run their jobs here, one after the other."""

import os
import shutil
import subprocess
import sys

import pytest
from sweep_files import ROOT, SHAPES, STEPS, records, verb, write_sweep

STAND_INS = {
    "parallel": '''words=(); while [ $# -gt 0 ]; do case "$1" in --jobs|--joblog) shift 2;; --retries) exit 9;; *) words+=("$1"); shift;; esac; done
while read -r line; do "${words[@]//\\{\\}/$line}" < /dev/null || exit 1; done''',
    "srun": '[ "$1" = --ntasks=1 ] && shift; exec "$@"',
    "scontrol": 'echo "scontrol $*" >> "$CALLS"',
    "sbatch": '''echo "sbatch $*" >> "$CALLS"
last=0; wrap=""
while [ $# -gt 0 ]; do case "$1" in
  --array=1-*) last="${1#--array=1-}"; shift;; --wrap) wrap="$2"; shift 2;; --wrap=*) wrap="${1#--wrap=}"; shift;; -*) shift;; *) break;; esac; done
if [ -n "$wrap" ]; then bash -c "$wrap" > /dev/null; else
for k in $(seq "$last"); do SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=$k "$@" > /dev/null; echo "task $k $?" >> "$CALLS"; done; fi
echo 7''',
}


@pytest.fixture
def environment(program, tmp_path):
    """With the stand-ins before everything else, and ./bench without its builds."""
    tools = tmp_path / "tools"
    tools.mkdir()
    for name, text in {**STAND_INS, "bench": f'case "$1" in status|collect) exec {sys.executable} {ROOT}/analysis "$@";; *) exec {program} "$@";; esac'}.items():
        (tools / name).write_text(f"#!/usr/bin/env bash\n{text}\n")
        (tools / name).chmod(0o755)
    return {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "BENCH": str(tools / "bench"), "CALLS": str(tmp_path / "calls")}


def called(script: str, *words, environment) -> str:
    done = subprocess.run([ROOT / "examples/cluster" / script, *map(str, words)], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("script, words", [("parallel.sh", [2]), ("slurm.sh", [2])])
def test_a_recipe_makes_every_record_and_judges_them(tmp_path, environment, script, words):
    file, out = write_sweep(tmp_path, STEPS, SHAPES, settings={"/time/dt_s": 0.01}), tmp_path / "out"
    message = called(script, file, out, *words, environment=environment)
    assert "own: 6 runs (2 x 3), 0 there" in message
    assert len(records(out)) == 6 and verb("status", out).returncode == 0
    assert all(record["comparability"]["reference_run"] for record in records(out).values())
    words_of = {word for record in records(out).values() for word in record["provenance"]["argv"]}
    assert ("--index" in words_of) == (script == "parallel.sh") and {"1/2", "2/2"} & words_of == ({"1/2", "2/2"} if script == "slurm.sh" else set())
    again = called(script, file, out, *words, environment=environment)
    assert "6 there" in again


def test_a_task_whose_time_is_over_goes_back_into_the_queue(tmp_path, environment):
    stopped = tmp_path / "stopped"
    stopped.write_text("#!/usr/bin/env bash\nexit 75\n")
    stopped.chmod(0o755)
    task = [ROOT / "examples/cluster/slurm_task.sh", stopped, "s.json", "out", "4"]
    done = subprocess.run(task, env={**environment, "SLURM_ARRAY_JOB_ID": "7", "SLURM_ARRAY_TASK_ID": "3"}, check=False)
    assert done.returncode == 75 and (tmp_path / "calls").read_text() == "scontrol requeue 7_3\n"


@pytest.mark.parametrize("codes, calls, last", [([75, 75, 0], 3, 0), ([75, 75, 75, 0], 3, 75), ([75, 2], 2, 2), ([2], 1, 2), ([70], 1, 70), ([137], 1, 137), ([1, 0], 1, 1), ([0], 1, 0)])
def test_only_a_call_that_ends_with_75_is_made_again(tmp_path, codes, calls, last):
    """By again.sh, which parallel.sh and the Snakefile start; neither has retries of its own, which would be after every exit code."""
    (tmp_path / "codes").write_text("".join(f"{code}\n" for code in codes))
    command = 'echo "$1" >> calls; code="$(head -n 1 codes)"; sed -i 1d codes; exit "$code"'
    done = subprocess.run([ROOT / "examples/cluster/again.sh", "bash", "-c", command, "bash", "with a blank"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == last and (tmp_path / "calls").read_text() == "with a blank\n" * calls, done.stderr
    for name in ("parallel.sh", "Snakefile"):
        text = (ROOT / "examples/cluster" / name).read_text()
        assert "again.sh" in text and "retries" not in text.replace("again.sh does", "")


def test_gnu_parallel_gives_up_wrong_input_at_once(tmp_path, environment):
    """The sweep is refused by `plan`; a case that fails otherwise is called once."""
    file, out = write_sweep(tmp_path, STEPS, SHAPES, settings={"/time/dt_s": 0.01}), tmp_path / "out"
    bench = tmp_path / "tools/bench"
    bench.write_text(bench.read_text().replace('case "$1" in', 'case "$*" in *--index*) echo "$*" >> "$CALLS"; exit 2;; esac; case "$1" in', 1))
    done = subprocess.run([ROOT / "examples/cluster/parallel.sh", file, out, "1"], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and len((tmp_path / "calls").read_text().splitlines()) == 1, done.stderr  # the stand-in of parallel stops there


def test_a_module_has_its_own_libraries_and_presets(program, tmp_path):
    """Nodes do not see the tree that the program was built in: what only the folder of the module has is found."""
    folder = tmp_path / "module"
    done = subprocess.run([ROOT / "containers/make_module.sh", folder], env={**os.environ, "BARRIERBENCH_PROGRAM": str(program)},
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    shutil.copy(folder / "configs/formulations/cubic.json", folder / "configs/formulations/only_here.json")
    lines = [line.split(maxsplit=2) for line in (folder / "modulefiles/barrierbench/1").read_text().splitlines()[1:]]
    environment = {name: value for word, name, value in lines if word in ("setenv", "prepend-path")}
    run = subprocess.run([folder / "bin/barrierbench", "check", ROOT / "configs/scenes/hang.json", "--set", "/formulation=only_here"],
                         env={**os.environ, **environment, "PATH": f"{environment['PATH']}:{os.environ['PATH']}"}, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert len(list((folder / "lib").iterdir())) > 5
