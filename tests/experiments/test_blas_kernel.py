"""The BLAS kernel: named in every record, the same on every x86-64-v3 machine unless another is chosen."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from test_cli import BLOCK, ROOT, bench

# Contacts of a cloth: enough sums for the kernels to differ in the last bits.
DRAPE = ["configs/scenes/drape.json", "--set", "/scene/n=8", "--set", "/time/steps=2", "--set", "/passes/audit=false"]


def cpu_flags() -> set[str]:
    lines = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("flags")]
    return set(lines[0].split(":")[1].split()) if lines else set()


needs_avx2 = pytest.mark.skipif(not {"avx2", "fma"} <= cpu_flags(), reason="the fixed kernel needs AVX2 and FMA")


def run(program: str, out: Path, *arguments: str, **environment: str) -> dict:
    env = {k: v for k, v in os.environ.items() if k not in ("OPENBLAS_CORETYPE", "GLIBC_TUNABLES")} | environment
    command = [program, "--progress", "none", "run", *DRAPE, "--out", str(out), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, env=env, cwd=ROOT, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "replaced" in done.stderr or done.stderr == ""  # of another kernel, in one folder
    return json.loads((out / "run.json").read_text())


def kernel(record: dict) -> tuple[str, str]:
    blas = record["provenance"]["blas"]
    assert blas["threads"] == 1
    assert blas["config"].startswith("OpenBLAS") and "blas" in blas["library"]
    return blas["kernel"], blas["requested"]


@needs_avx2
def test_every_record_names_its_kernel_and_the_default_is_the_fixed_one(program, tmp_path):
    assert kernel(run(program, tmp_path)) == ("Haswell", "Haswell")
    record = run(program, tmp_path, OPENBLAS_CORETYPE="Prescott")
    assert kernel(record) == ("Prescott", "Prescott")  # named by the user
    assert record["provenance"]["env"]["OPENBLAS_CORETYPE"] == "Prescott"
    assert kernel(run(program, tmp_path, "--blas-kernel", "native"))[1] == "native"


@needs_avx2
def test_the_switch_gives_machines_of_other_kernels_equal_states(program, tmp_path):
    emulated = ["Prescott", "Sandybridge", "Haswell", "Zen"] + (["SkylakeX"] if "avx512f" in cpu_flags() else [])

    def hashes(*arguments: str) -> list[str]:
        records = {k: run(program, tmp_path, *arguments, OPENBLAS_CORETYPE=k) for k in emulated}
        assert all(r["status"]["outcome"] == "ok" and r["summary"]["newton_iterations"] > 0 for r in records.values())
        assert arguments or {k: kernel(r)[0] for k, r in records.items()} == {k: k for k in emulated}
        return [r["summary"]["state_hash"] for r in records.values()]

    assert len(set(hashes())) > 1
    assert len(set(hashes("--blas-kernel", "haswell"))) == 1


@needs_avx2
@pytest.mark.skipif("avx512f" not in cpu_flags(), reason="nothing to switch off")
def test_the_mathematics_library_does_not_look_at_avx512(program, tmp_path):
    without = "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD"
    with_it, less = run(program, tmp_path), run(program, tmp_path, GLIBC_TUNABLES=without)
    assert with_it["summary"]["state_hash"] == less["summary"]["state_hash"]


def test_another_word_is_refused(program):
    done = bench(program, "run", BLOCK, "--blas-kernel", "zen4")
    assert done.returncode == 2
    assert "--blas-kernel" in done.stderr and "haswell" in done.stderr and "native" in done.stderr
