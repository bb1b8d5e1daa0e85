"""The PTX translator: what it refuses, names and lines in its messages, what it writes; the tables beside it."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "ptx"


def module(name: str):
    spec = importlib.util.spec_from_file_location(f"ptx_{name}", FOLDER / f"{name}.py")
    loaded = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = loaded
    spec.loader.exec_module(loaded)
    return loaded


sys.path.insert(0, str(FOLDER))
import translator  # noqa: E402

faults, assigned = module("inject_faults"), module("assigned")


def kernel(body: str) -> str:
    return f""".version 9.0
.target sm_90
.address_size 64
.visible .entry k(
  .param .u64 k_param_0,
  .param .align 8 .b8 k_param_1[20]
)
.maxntid 256, 1, 1
{{
  .reg .pred %p<2>;
  .reg .b32 %r<5>;
  .reg .f64 %fd<5>;
  .reg .b64 %rd<4>;
  .shared .align 8 .b8 a[16];
  .shared .align 8 .b8 b[24];
{body}
  ret;
}}
"""


def test_parameters_and_shared_memory_are_laid_out():
    text = translator.translate(kernel("ld.param.u32 %r1, [k_param_1+16];\nmov.u32 %r2, b;\nst.shared.u32 [%r2+4], %r1;"), "m")
    assert "get<uint32_t>(t.params + 24)" in text
    assert "16u" in text  # b lies behind a
    assert '{"k", entry_1, 28, 40, false, params_1' in text


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("vote.sync.any.pred %p1, %p1, -1;", "instruction"),
        ("atom.global.add.f64 %fd1, [%rd1], %fd2;", "depend on the order"),
        ("add.sat.s32 %r1, %r2, %r3;", ".sat"),
        ("add.ftz.f64 %fd1, %fd2, %fd3;", ".ftz"),
        ("mov.u32 %r1, %clock;", "operand %clock"),
        ("ld.param.u32 %r1, [k_param_1+20];", "outside"),
        ("mov.b32 %r9, 1;", "register %r9"),
        ("bar.sync 1;", "barrier"),
        ("call.uni f, ();", "call"),
    ],
)
def test_what_is_not_known_is_refused_with_line_and_text(line, message):
    with pytest.raises(translator.Unknown) as error:
        translator.translate(kernel(f"mov.u32 %r1, 1;\n{line}"), "m")
    assert message in str(error.value) and line.rstrip(";") in str(error.value) and "line 17" in str(error.value)


def test_a_barrier_makes_the_kernel_and_its_callers_wait():
    called = kernel("{\n.param .b64 p;\nst.param.b64 [p+0], %rd1;\ncall.uni f, (p);\n}") + ".func f(.param .b64 f_0)\n{\n bar.sync 0;\n ret;\n}\n"
    assert "true, params_1" in translator.translate(called, "m")
    assert "false, params_1" in translator.translate(kernel("mov.u32 %r1, 1;"), "m")


def test_instructions_are_counted_by_straight_pieces_of_code():
    text = translator.translate(kernel("setp.eq.s32 %p1, %r1, 0;\n@%p1 bra $L1;\nmov.u32 %r1, 1;\n$L1:\nmov.u32 %r2, 1;"), "m")
    assert "blocks[] = {{16, 2}, {18, 1}, {20, 2}}" in text


def test_faults_have_switches():
    body = "bar.sync 0;\nsetp.eq.s32 %p1, %r1, 0;\n@%p1 bra $L1;\nst.global.u32 [%rd1], %r1;\n$L1:\nbar.sync 0;"
    text = translator.translate(kernel(body), "m", with_faults=True)
    for kind in ("barrier", "guard", "store", "last barrier"):
        assert f'"{kind}", ' in text
    assert "fault" not in translator.translate(kernel(body), "m")


def test_the_list_of_faults_is_read():
    listed = faults.parse_list("x\nfault m 3 1 40 last barrier; void k(int, int)\nfault m 4 0 41 store; k\n", "t")
    assert [(f.module, f.number, f.line, f.kind, f.kernel) for f in listed] == [("m", 3, 40, "last barrier", "void k(int, int)")]
    assert faults.reason(listed[0], [{"kind": "last barrier", "kernel": "*", "reason": "end"}]) == "end"
    assert faults.reason(listed[0], [{"kind": "last barrier", "kernel": "*", "line": 9, "reason": "end"}]) == ""


def test_a_register_that_some_path_does_not_set_is_named():
    def read_unset(body: str) -> list[tuple[int, str]]:
        (function,) = translator.Module(kernel(body), "m").functions.values()
        return [(line, name) for line, name in assigned.unassigned(function) if not name.startswith("%p")]

    assert read_unset("mov.u32 %r1, 1;\nadd.u32 %r2, %r1, %r1;") == []
    ((_, name),) = read_unset("setp.eq.s32 %p1, 0, 0;\n@%p1 bra $L1;\nmov.u32 %r1, 1;\n$L1:\nadd.u32 %r2, %r1, 1;")
    assert name == "%r1"
    ((_, name),) = read_unset("mov.u32 %r2, %r1;\nadd.u32 %r3, %r2, 1;")  # a copy of nothing
    assert name == "%r2"
    assert read_unset("@%p1 mov.u32 %r1, 1;\nadd.u32 %r2, %r1, 1;") != []
