"""The linear solver cudss where something of it is missing: the message, exit code 2, nothing written."""

import json
import os
from pathlib import Path

import pytest
from test_cli import bench, refused, write

BLOCK = {"schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 5}, "formulation": "log", "time": {"steps": 1},
         "matching": {"rule": "equal_force"}, "linear_solver": {"name": "cudss"}, "threads": 1}


def run(program: str, tmp_path: Path, library: str):
    config = write(tmp_path / "a.json", json.dumps(BLOCK))
    return bench(program, "run", config, "--out", tmp_path / "out", env={**os.environ, "BARRIERBENCH_CUDSS": library})


def built_with_header(program: str, tmp_path: Path) -> bool:
    return "BARRIERBENCH_CUDSS" in run(program, tmp_path, "/nowhere/libcudss.so").stderr


def test_what_is_missing_is_named_before_anything_is_written(program, tmp_path):
    done = run(program, tmp_path, "/nowhere/libcudss.so")
    refused(done, "/linear_solver/name", '"cudss"', "another solver: ")
    reasons = ["built without CUDA", "-DBB_CUDSS_ROOT=FOLDER", "/nowhere/libcudss.so"]
    assert sum(reason in done.stderr for reason in reasons) == 1, done.stderr
    if not json.loads(bench(program, "device", "--json").stdout)["built"]:
        assert reasons[0] in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_library_without_its_functions_is_refused(program, tmp_path):
    if not built_with_header(program, tmp_path):
        pytest.skip("this program was built without cudss.h")
    refused(run(program, tmp_path, "libm.so.6"), "/linear_solver/name", "libm.so.6", "it has no function cudssGetProperty")
    assert not (tmp_path / "out").exists()


def test_the_steps_of_a_config_are_refused_too(program, tmp_path):
    config = write(tmp_path / "a.json", json.dumps(BLOCK))
    refused(bench(program, "steps", config, "--at", "0", "--out", tmp_path / "steps.json",
                  env={**os.environ, "BARRIERBENCH_CUDSS": "/nowhere/libcudss.so"}), "/linear_solver/name")
    assert not (tmp_path / "steps.json").exists()


def test_the_resident_pipeline_takes_no_other_solver(program, tmp_path):
    config = write(tmp_path / "a.json", json.dumps(BLOCK))
    refused(bench(program, "check", config, "--set", '/device="host"'), "/linear_solver/name", '"cudss"', "pcg_resident")


def test_other_verbs_do_without_it(program):
    listed = bench(program, "list", "linear_solvers")
    assert listed.returncode == 0 and "cudss" in listed.stdout
    corpus = Path(__file__).resolve().parents[2] / "results/matrices"
    matrix = min(corpus.glob("*.mtx"), key=lambda file: file.stat().st_size)
    done = bench(program, "matrix", matrix, env={**os.environ, "BARRIERBENCH_CUDSS": "/nowhere/libcudss.so"})
    assert done.returncode == 0 and "cholmod" in done.stdout and "cudss" not in done.stdout
