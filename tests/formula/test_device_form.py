"""The kernel of a formula: what is generated, what nvcc makes of it, and when it is made again. That its numbers are those of the shape
is tests/standin/test_formula_kernel.cpp, on the samples whose text is compared here."""

import json
import re
from pathlib import Path

import pytest

from barrierbench_analysis.program.formula import checks, device, source, symbolic
from barrierbench_analysis.program.formula.grammar import FormulaError, read

ROOT = Path(__file__).resolve().parents[2]
LOG = "-(d - d_hat)^2*log(d/d_hat)"
SAMPLES = {name: ROOT / f"tests/standin/formula_{name}.cu" for name in ("log", "functions")}
LAYOUT = int(re.search(r"given_shape_layout == (0x[0-9a-f]+)", SAMPLES["log"].read_text())[1], 16)  # nvcc compiles it: it is that of the sources
FUNCTIONS = ("(d_hat - d)^2*exp(d_hat/d - 1)*cosh(1 - d/d_hat)", "(d_hat - d)^2*(atan(1 - d/d_hat) + sqrt(d_hat/d) + tanh(d/d_hat))",
             "(d_hat - d)^(5/2)/d^(1/2)", "(d_hat - d)^2/sin(pi*d/(2*d_hat))")
needs_nvcc = pytest.mark.skipif(device.find_nvcc() is None, reason="no nvcc")


@pytest.fixture()
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("BARRIERBENCH_CACHE", str(tmp_path))
    return tmp_path / "formulas"


@pytest.mark.parametrize("name", SAMPLES)
def test_the_samples_of_the_cpp_test_are_what_is_generated(name):
    given = (ROOT / f"tests/standin/formula_shapes/formula_{name}.cpp").read_text()
    text = "".join(re.findall(r'"([^"]*)"', given[given.index("sample_formula =") :].split(";")[0]))
    terms = symbolic.terms_of(read(text))
    assert SAMPLES[name].read_text() == source.cu(read(text).text, terms, checks.check(terms, None), LAYOUT), f"write it again: source.cu of {text}"


def test_the_flags_are_those_of_the_kernels_of_the_program():
    text = (ROOT / "cmake/Cuda.cmake").read_text()
    of_all = text[text.index("set(BB_DEVICE_FLAGS") :].split(")")[0]
    assert re.findall(r"-[-=\w]+fmad=false|-Xcompiler=-ffp-contract=off|--expt-relaxed-constexpr|-Werror=[\w-]+", of_all)
    assert [flag for flag in re.findall(r"-\S+", of_all) if flag.strip(">") not in device.FLAGS.split()] == ["-Xcompiler=-fPIC>"]


@needs_nvcc
def test_the_kernel_is_kept_until_what_it_was_made_from_changes(empty_cache):
    first = device.device_code(LOG, LAYOUT)
    ptx = Path(first["ptx"])
    text = ptx.read_text()
    assert first["entry"] == "barrierbench_shape" and f".entry {first['entry']}(" in text and f"{first['entry']}_param_1[" in text
    assert ".target sm_80" in text and "fma.rn.f64" not in text  # nothing is contracted, and the logarithm is that of core/math
    made = ptx.stat().st_mtime_ns
    assert device.device_code(" - (d-d_hat)**2 * ln(d/d_hat)", LAYOUT) == first and ptx.stat().st_mtime_ns == made
    about = ptx.with_suffix(".ptx.json")
    known = json.loads(about.read_text())
    assert {"core/contact/executor/given_shape.hpp", "core/contact/executor/executor_rows.hpp"} <= set(known["headers"])
    about.write_text(json.dumps(known | {"headers": known["headers"] | {"core/contact/executor/given_shape.hpp": "0"}}))
    device.device_code(LOG, LAYOUT)
    assert ptx.stat().st_mtime_ns > made
    made = ptx.stat().st_mtime_ns
    ptx.write_text(text + "\n")
    device.device_code(LOG, LAYOUT)
    assert ptx.read_text() == text
    assert not list(empty_cache.glob("making-*"))


@needs_nvcc
@pytest.mark.parametrize("formula", FUNCTIONS)
def test_functions_of_the_library_are_in_the_kernel(empty_cache, formula):
    text = Path(device.device_code(formula, LAYOUT)["ptx"]).read_text()
    assert ".entry barrierbench_shape(" in text and ".extern" not in text


@needs_nvcc
def test_a_sum_of_products_is_not_fused(empty_cache):
    text = Path(device.device_code("(d_hat - d)^3/d + (d_hat - d)^2", LAYOUT)["ptx"]).read_text()
    body = text[text.index(".entry"):]
    assert body.count("mul.rn.f64") + body.count("mul.f64") > 5 and "fma" not in body


@needs_nvcc
def test_variables_of_nvcc_pass_no_flags_on(monkeypatch, empty_cache):
    monkeypatch.setenv("NVCC_APPEND_FLAGS", "--fmad=true")
    text = Path(device.device_code("(d_hat - d)^3/d + (d_hat - d)^2", LAYOUT)["ptx"]).read_text()
    assert "mul" in text and "fma" not in text[text.index(".entry"):]


@needs_nvcc
def test_a_program_of_other_sources_is_refused(empty_cache):
    with pytest.raises(FormulaError) as refused:
        device.device_code(LOG, LAYOUT + 8)
    assert "other sources" in refused.value.found and list(empty_cache.iterdir()) == []


def test_without_nvcc_it_says_what_is_needed(monkeypatch):
    monkeypatch.setattr(device, "USUAL", ())
    for name in ("CUDACXX", "CUDA_HOME", "CUDA_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(FormulaError) as refused:
        device.device_code(LOG, LAYOUT)
    assert "log(d / d_hat)" in refused.value.found and "no nvcc" in refused.value.found and "CUDACXX" in refused.value.allowed


@needs_nvcc
def test_what_nvcc_refuses_is_said_and_nothing_is_left(monkeypatch, empty_cache):
    monkeypatch.setattr(source, "DEVICE", source.DEVICE.replace("EvaluateShape", "EvaluateNothing"))
    with pytest.raises(FormulaError) as refused:
        device.device_code(LOG, LAYOUT)
    assert "EvaluateNothing" in refused.value.found and "nvcc" in refused.value.allowed
    assert list(empty_cache.iterdir()) == []
