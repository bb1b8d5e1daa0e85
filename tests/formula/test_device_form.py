"""The kernel of a formula: what is generated, what nvcc makes of it, and when it is made again. That its numbers are those of the shape
is tests/standin/test_formula_kernel.cpp, on the sample whose text is compared here."""

import json
from pathlib import Path

import pytest

from analysis.formula import checks, device, source, symbolic
from analysis.formula.grammar import FormulaError, read

ROOT = Path(__file__).resolve().parents[2]
LOG = "-(d - d_hat)^2*log(d/d_hat)"
SAMPLE = ROOT / "tests/standin/formula_sample.cu"
FUNCTIONS = ("(d_hat - d)^2*exp(d_hat/d - 1)*cosh(1 - d/d_hat)", "(d_hat - d)^2*(atan(1 - d/d_hat) + sqrt(d_hat/d) + tanh(d/d_hat))",
             "(d_hat - d)^(5/2)/d^(1/2)", "(d_hat - d)^2/sin(pi*d/(2*d_hat))")
needs_nvcc = pytest.mark.skipif(device.find_nvcc() is None, reason="no nvcc")


@pytest.fixture()
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("BARRIERBENCH_CACHE", str(tmp_path))
    return tmp_path / "formulas"


def test_the_sample_of_the_cpp_test_is_what_is_generated():
    terms = symbolic.terms_of(read(LOG))
    assert SAMPLE.read_text() == source.cu(read(LOG).text, terms, checks.check(terms, None)), f"write it again: source.cu of {LOG}"


@needs_nvcc
def test_the_kernel_is_kept_until_what_it_was_made_from_changes(empty_cache):
    first = device.device_code(LOG)
    ptx = Path(first["ptx"])
    text = ptx.read_text()
    assert first["entry"] == "barrierbench_shape" and f".entry {first['entry']}(" in text and f"{first['entry']}_param_1[" in text
    assert ".target sm_80" in text and "fma.rn.f64" in text  # of the library's log; of the formula's own there is none
    made = ptx.stat().st_mtime_ns
    assert device.device_code(" - (d-d_hat)**2 * ln(d/d_hat)") == first and ptx.stat().st_mtime_ns == made
    about = ptx.with_suffix(".ptx.json")
    known = json.loads(about.read_text())
    assert {"core/resident/contact/given_shape.hpp", "core/resident/contact/resident_rows.hpp"} <= set(known["headers"])
    about.write_text(json.dumps(known | {"headers": known["headers"] | {"core/resident/contact/given_shape.hpp": "0"}}))
    device.device_code(LOG)
    assert ptx.stat().st_mtime_ns > made
    made = ptx.stat().st_mtime_ns
    ptx.write_text(text + "\n")
    device.device_code(LOG)
    assert ptx.read_text() == text
    assert not list(empty_cache.glob("making-*"))


@needs_nvcc
@pytest.mark.parametrize("formula", FUNCTIONS)
def test_functions_of_the_library_are_in_the_kernel(empty_cache, formula):
    text = Path(device.device_code(formula)["ptx"]).read_text()
    assert ".entry barrierbench_shape(" in text and ".extern" not in text


@needs_nvcc
def test_a_sum_of_products_is_not_fused(empty_cache):
    text = Path(device.device_code("(d_hat - d)^3/d + (d_hat - d)^2")["ptx"]).read_text()
    body = text[text.index(".entry"):]
    assert body.count("mul.rn.f64") + body.count("mul.f64") > 5 and "fma" not in body


def test_without_nvcc_it_says_what_is_needed(monkeypatch):
    monkeypatch.setattr(device, "USUAL", ())
    for name in ("CUDACXX", "CUDA_HOME", "CUDA_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(FormulaError) as refused:
        device.device_code(LOG)
    assert "no nvcc" in refused.value.found and "12.8" in refused.value.allowed and "cpu or host" in refused.value.allowed


@needs_nvcc
def test_what_nvcc_refuses_is_said_and_nothing_is_left(monkeypatch, empty_cache):
    monkeypatch.setattr(source, "DEVICE", source.DEVICE.replace("EvaluateShape", "EvaluateNothing"))
    with pytest.raises(FormulaError) as refused:
        device.device_code(LOG)
    assert "EvaluateNothing" in refused.value.found and "nvcc" in refused.value.allowed
    assert list(empty_cache.iterdir()) == []
