"""The machine code in an object file of nvcc: registers, stack frame and accesses to local memory of each kernel, read
from the ELF file of the device (cubin) that lies in it uncompressed (-Xfatbin=-compress=false). No tool of CUDA is needed."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

ELF, EM_CUDA = b"\x7fELF\x02\x01", 190  # 64 bits, little end first
SYMBOLS = 2  # sh_type
REGISTER_COUNT, FRAME_SIZE = 0x2F, 0x11  # attributes of .nv.info
LOCAL_ACCESS = {0x983, 0x387}  # LDL and STL: the lowest 12 bits of an instruction of 16 bytes (sm_70 and later)
RELEASE = re.compile(rb"Cuda compilation tools, release [\d.]+, V([\d.]+)")


class MachineCodeError(Exception):
    """No machine code, or not of the form that is known."""


@dataclass
class Section:
    name: str
    type: int
    data: bytes
    link: int


def sections_of(elf: bytes) -> list[Section]:
    (offset,) = struct.unpack_from("<Q", elf, 40)
    size, count, names_at = struct.unpack_from("<HHH", elf, 58)
    heads = [struct.unpack_from("<IIQQQQII", elf, offset + i * size) for i in range(count)]

    def data(head: tuple) -> bytes:
        return b"" if head[1] == 8 else elf[head[4] : head[4] + head[5]]  # 8: takes no space in the file

    names = data(heads[names_at])
    return [Section(names[h[0] : names.index(b"\0", h[0])].decode(), h[1], data(h), h[6]) for h in heads]


def cubins(data: bytes) -> Iterator[bytes]:
    """ELF files of a device within an object file."""
    at = data.find(ELF, 1)
    while at >= 0:
        if struct.unpack_from("<H", data, at + 18)[0] == EM_CUDA:
            yield data[at:]
        at = data.find(ELF, at + 1)


def architecture(elf: bytes) -> int:
    """90 of sm_90: a byte of the flags, which moved with version 8 of the ABI (CUDA 13)."""
    (flags,) = struct.unpack_from("<I", elf, 48)
    return flags >> (8 if elf[8] >= 8 else 0) & 0xFF


def symbol_names(sections: list[Section]) -> list[str]:
    table = next((s for s in sections if s.type == SYMBOLS), None)
    if table is None:
        raise MachineCodeError("a cubin has no symbols")
    text = sections[table.link].data
    starts = [struct.unpack_from("<I", table.data, i)[0] for i in range(0, len(table.data), 24)]
    return [text[s : text.index(b"\0", s)].decode() for s in starts]


def attributes(info: bytes) -> Iterator[tuple[int, bytes]]:
    """Number and value of each attribute: a form, a number, and two bytes of value or the length of the value."""
    at = 0
    while at + 4 <= len(info):
        form, number, length = struct.unpack_from("<BBH", info, at)
        at += 4
        if form == 4:
            yield number, info[at : at + length]
            at += length


def local_accesses(code: bytes) -> int:
    return sum((struct.unpack_from("<H", code, at)[0] & 0xFFF) in LOCAL_ACCESS for at in range(0, len(code), 16))


def kernels_of(elf: bytes) -> dict[str, dict[str, int]]:
    """Mangled name -> registers, stack (bytes), local (instructions, those of functions that it calls included)."""
    sections = sections_of(elf)
    names = symbol_names(sections)
    numbers: dict[int, dict[str, int]] = {REGISTER_COUNT: {}, FRAME_SIZE: {}}
    for section in sections:
        if section.name.startswith(".nv.info"):
            for number, value in attributes(section.data):
                if number in numbers:
                    symbol, n = struct.unpack("<II", value)
                    numbers[number][names[symbol]] = n
    out = {}
    for section in sections:
        if section.name.startswith(".text."):
            kernel = section.name.removeprefix(".text.")
            if kernel not in numbers[REGISTER_COUNT] or kernel not in numbers[FRAME_SIZE]:
                raise MachineCodeError(f"{kernel}: the cubin does not tell its registers or its stack frame")
            out[kernel] = {"registers": numbers[REGISTER_COUNT][kernel], "stack": numbers[FRAME_SIZE][kernel], "local": local_accesses(section.data)}
    return out


def machine_code(data: bytes, target: int = 90) -> tuple[dict[str, dict[str, int]], str]:
    """Kernels of the machine code for sm_TARGET in an object file, and the version of the tools that made it.
    Errors: MachineCodeError where there is none, or several."""
    found = [elf for elf in cubins(data) if architecture(elf) == target]
    if len(found) != 1:
        raise MachineCodeError(f"{len(found)} cubins of sm_{target} in plain text, wanted 1")
    rows = kernels_of(found[0])
    if not rows:
        raise MachineCodeError(f"the cubin of sm_{target} has no kernel")
    version = RELEASE.search(found[0])
    return rows, version[1].decode() if version else ""
