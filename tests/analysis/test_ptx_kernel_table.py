"""The table of kernels: numbers read from machine code, what the check refuses."""

from __future__ import annotations

import copy
import struct
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "ptx"))
import kernel_table as table  # noqa: E402
import machine_code  # noqa: E402

STORE_LOCAL, LOAD_LOCAL, LOAD_GLOBAL = 0x7387, 0x7983, 0x7981


def cubin(opcodes: list[int], attributes: dict[int, int], target: int = 90, abi: int = 8) -> bytes:
    """A cubin of one kernel `k`."""
    strings = b"\0k\0"
    symbols = bytes(24) + struct.pack("<IBBHQQ", 1, 2, 0, 4, 0, 0)
    info = b"".join(struct.pack("<BBHII", 4, number, 8, 1, n) for number, n in attributes.items())
    code = b"".join(struct.pack("<HHIQ", op, 0, 0, 0) for op in opcodes)
    parts = [("", 0, b"", 0), (".strtab", 3, strings, 0), (".symtab", 2, symbols, 1), (".nv.info", 0x70000000, info, 2), (".text.k", 1, code, 2)]
    names = b"".join(name.encode() + b"\0" for name, *_ in parts) + b".shstrtab\0"
    parts.append((".shstrtab", 3, names, 0))
    heads, body = b"", b""
    for name, kind, data, link in parts:
        heads += struct.pack("<IIQQQQIIQQ", names.index(name.encode() + b"\0"), kind, 0, 0, 64 + len(body), len(data), link, 0, 1, 0)
        body += data
    flags = target << 8 if abi >= 8 else target
    head = b"\x7fELF\x02\x01\x01\x41" + bytes([abi]) + bytes(7) + struct.pack("<HHIQQQIHHHHHH", 2, 190, 1, 0, 0, 64 + len(body), flags, 64, 0, 0, 64, len(parts), len(parts) - 1)
    return head + body + heads


def object_with(*cubins: bytes) -> bytes:
    return b"\x7fELF\x02\x01" + bytes(58) + b"".join(cubins) + b"\0Cuda compilation tools, release 13.0, V13.0.88\0"


ATTRIBUTES = {machine_code.REGISTER_COUNT: 42, machine_code.FRAME_SIZE: 112}


@pytest.mark.parametrize("abi", [7, 8])
def test_registers_frame_and_local_accesses_are_read(abi):
    code = cubin([STORE_LOCAL, LOAD_GLOBAL, LOAD_LOCAL, LOAD_LOCAL], ATTRIBUTES, abi=abi)
    assert machine_code.machine_code(object_with(cubin([], ATTRIBUTES, 80), code)) == ({"k": {"registers": 42, "stack": 112, "local": 3}}, "13.0.88")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (object_with(), "0 cubins of sm_90"),
        (object_with(cubin([], ATTRIBUTES, 80)), "0 cubins of sm_90"),
        (object_with(cubin([], ATTRIBUTES), cubin([], ATTRIBUTES)), "2 cubins of sm_90"),
        (object_with(cubin([], {machine_code.FRAME_SIZE: 0})), "k: the cubin does not tell its registers"),
    ],
)
def test_anything_else_is_refused(data, words):
    with pytest.raises(machine_code.MachineCodeError, match=words):
        machine_code.machine_code(data)


def test_names_and_logs_are_read():
    log = """ptxas info    : Compiling entry function 'k' for 'sm_90'
ptxas info    : Function properties for k
    112 bytes stack frame, 8 bytes spill stores, 4 bytes spill loads
"""
    assert table.ptxas_spills(log) == {"k": 12}
    assert table.fp64_counts(".entry k(\n.param .u64 a\n)\n{\nadd.rn.f64 %fd1, %fd2, %fd3;\nmov.f64 %fd2, %fd1;\nsetp.lt.f64 %p1, %fd1, %fd2;\n}\n") == {"k": 2}
    assert table.kernel_name("void bb::exec::run_each<bb::exec::A<3> >(long, x)") == "bb::exec::A<3>"


def one(**numbers) -> dict:
    row = {"room": "linear", "registers": 40, "stack": 0, "local": 0, "fp64": 7, **numbers}
    return {"nvcc": "13.0.88", "kernels": {"a": {key: n for key, n in row.items() if n is not None}}}


def test_the_check_names_kernel_and_number():
    before = one(spills=0, lines=2.0)
    assert table.differences(before, one(lines=2.0)) == []
    assert table.differences(before, one(registers=39)) == []
    assert table.differences(before, one(registers=41)) == ["a: registers 40 -> 41"]
    assert table.differences(before, one(fp64=8)) == ["a: fp64 7 -> 8"]
    assert table.differences(one(local=2), one(local=2)) == ["a: 2 accesses to local memory; a kernel of linear has none"]
    assert table.differences(one(room="contact", local=2), one(room="contact", local=2)) == []


def test_kernels_without_numbers_are_refused():
    assert table.differences(one(), one(registers=None)) == ["a: the build has no registers"]
    assert table.differences(one(registers=None), one()) == ["a: the table has no registers"]
    other = copy.deepcopy(one())
    other["kernels"]["b"] = other["kernels"].pop("a")
    assert table.differences(one(), other) == ["b: not in KERNELS.json", "a: in KERNELS.json, but not built"]


def test_another_nvcc_is_compared_by_names_only(capsys):
    now = {**one(registers=200), "nvcc": "12.4.1"}
    now["kernels"]["b"] = one()["kernels"]["a"]
    before = one(over_least=1.0, buffers={})
    assert table.check(before, now, []) == ["b: not in KERNELS.json"]
    assert "nvcc 12.4.1" in capsys.readouterr().out


def test_a_buffer_out_of_order_needs_a_reason():
    def rows(over_least: float) -> dict:
        return one(buffers={"p": {"requests": 1, "lines": 2.0, "sectors": 8.0, "over_least": over_least}})

    assert table.unexplained(rows(1.2), []) == []
    (text,) = table.unexplained(rows(1.3), [])
    assert text.startswith("a: 'p' in 1.3 times the least sectors")
    assert table.unexplained(rows(1.3), [{"kernel": "a", "buffers": ["p"], "reason": "gathered"}]) == []
    assert table.unexplained(one(), []) == ["a: the table has no lines and sectors"]
