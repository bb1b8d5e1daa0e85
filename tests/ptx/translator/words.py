"""Words of PTX: types, special registers, comparisons, and what they are in C++."""

from __future__ import annotations

import re

REGISTER_TYPES = {
    "pred": "bool",
    "b8": "uint8_t",
    "u8": "uint8_t",
    "s8": "uint8_t",
    "b16": "uint16_t",
    "u16": "uint16_t",
    "s16": "uint16_t",
    "b32": "uint32_t",
    "u32": "uint32_t",
    "s32": "uint32_t",
    "b64": "uint64_t",
    "u64": "uint64_t",
    "s64": "uint64_t",
    "f32": "float",
    "f64": "double",
}
SPECIAL = {
    "%tid.x": "t.tid",
    "%ctaid.x": "t.ctaid",
    "%ntid.x": "t.ntid",
    "%nctaid.x": "t.nctaid",
    "%laneid": "(t.tid % 32u)",
    "%tid.y": "0u",
    "%tid.z": "0u",
    "%ctaid.y": "0u",
    "%ctaid.z": "0u",
    "%ntid.y": "1u",
    "%ntid.z": "1u",
}
COMPARE = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">=", "lo": "<", "ls": "<=", "hi": ">", "hs": ">="}
OPPOSITE = {"equ": "!=", "neu": "==", "ltu": ">=", "leu": ">", "gtu": "<=", "geu": "<"}  # not (a OP b), true with NaN
ROUNDING = {"rz": "FE_TOWARDZERO", "rm": "FE_DOWNWARD", "rp": "FE_UPWARD"}
MEMORY_WORDS = {"volatile", "relaxed", "acquire", "release", "weak", "nc", "gpu", "cta", "sys", "ca", "cg", "cs", "lu", "cv", "wb", "wt"}
SPACES = {"global", "shared", "local", "param", "const"}


class Unknown(Exception):
    """An instruction, operand or directive that is not known."""


def c_type(suffix: str) -> str:
    """f64 -> double, s32 -> int32_t, b32 and u32 -> uint32_t."""
    if suffix in ("f32", "f64", "pred"):
        return REGISTER_TYPES[suffix]
    if not re.fullmatch(r"[sub](8|16|32|64)", suffix):
        raise Unknown(f"type .{suffix}")
    return ("int" if suffix[0] == "s" else "uint") + suffix[1:] + "_t"


def size_of(suffix: str) -> int:
    return 1 if suffix == "pred" else int(suffix[1:]) // 8


def is_float(type_name: str) -> bool:
    return type_name in ("float", "double")


def convert(text: str, source: str, target: str) -> str:
    """The same bits as another type; integers are cut or filled with zeros (of signed: with the sign)."""
    if source == target:
        return text
    if is_float(source) and is_float(target):
        raise Unknown(f"a {source} as a {target}")
    if is_float(source):
        if target not in ("uint64_t", "int64_t") and source == "double" or target not in ("uint32_t", "int32_t") and source == "float":
            raise Unknown(f"a {source} as a {target}")
        return f"({target})bits({text})"
    if is_float(target):
        return f"{'f64' if target == 'double' else 'f32'}({text})"
    return f"({target})({text})"


def symbol(name: str) -> str:
    return "v_" + name.replace("$", "_S_").replace("%", "_P_")
