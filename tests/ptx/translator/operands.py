"""Operands of one function: registers, numbers and names as C++ values, and places in memory."""

from __future__ import annotations

import re

from .source import Function
from .words import MEMORY_WORDS, SPACES, SPECIAL, Unknown, convert, is_float, symbol


class Operands:
    """Names that hold in one function, and what instructions of every kind require."""

    def __init__(self, module, function: Function):
        self.module, self.function = module, function
        self.scopes: list[dict[str, tuple[str, str]]] = [{}]  # register -> C++ name, type
        self.scope_ids = [0]
        self.n_scopes = 0
        self.declared: dict[str, str] = {}
        self.buffers: list[dict[str, tuple[str, int]]] = [{}]  # .param inside a call
        self.params = {p.name: p for p in function.params}
        self.returns = {p.name: p for p in function.returns}
        self.local: dict[str, tuple[int, int]] = {}
        self.local_bytes = 0
        self.shared: dict[str, int] = {}
        self.uses_carry = False
        self.line = 0
        for name, (align, size) in module.shared.items():
            if re.search(r"(?<![\w$])" + re.escape(name) + r"(?![\w$])", function.body):
                self.add_shared(name, align, size)

    # --- names
    def add_shared(self, name: str, align: int, size: int) -> None:
        at = (self.function.shared_bytes + align - 1) // align * align
        self.shared[name] = at
        self.function.shared_bytes = at + size

    def declare(self, names: list[str], type_name: str) -> None:
        suffix = "" if self.n_scopes == 0 else f"_s{self.scope_ids[-1]}" if len(self.scopes) > 1 else ""
        for name in names:
            cpp = "r" + name.replace("%", "_").replace("$", "_S_").replace(".", "_") + suffix
            self.scopes[-1][name] = (cpp, type_name)

    def register(self, name: str) -> tuple[str, str]:
        for scope in reversed(self.scopes):
            if name in scope:
                cpp, type_name = scope[name]
                self.declared[cpp] = type_name
                return cpp, type_name
        raise Unknown(f"register {name}")

    def is_register(self, name: str) -> bool:
        return any(name in scope for scope in self.scopes)

    def value(self, text: str, type_name: str) -> str:
        """An operand as a value of a C++ type."""
        text = text.strip()
        if text.startswith("!"):
            return f"!({self.value(text[1:], type_name)})"
        if self.is_register(text):
            cpp, own = self.register(text)
            return convert(cpp, own, type_name)
        if text in SPECIAL:
            return convert(SPECIAL[text], "uint32_t", type_name)
        if re.fullmatch(r"0[dD][0-9a-fA-F]{16}", text):
            return convert(f"f64(0x{text[2:]}ull)", "double", type_name)
        if re.fullmatch(r"0[fF][0-9a-fA-F]{8}", text):
            return convert(f"f32(0x{text[2:]}u)", "float", type_name)
        if re.fullmatch(r"-?\d+|-?0x[0-9a-fA-F]+", text):
            if is_float(type_name):
                raise Unknown(f"operand {text} as a {type_name}")
            number = int(text, 0)
            if number < 0:
                return f"({type_name})({number}ll)" if number > -(2**63) else f"({type_name})(-9223372036854775807ll - 1)"
            return f"({type_name}){number}ull"
        return convert(self.address_of(text), "uint64_t", type_name)

    def address_of(self, name: str) -> str:
        if name in self.shared:
            return f"(uint64_t){self.shared[name]}u"
        if name in self.local:
            return f"(local.base() + {self.local[name][0]}u)"
        if name in self.module.constants:
            return f"(uint64_t){symbol(name)}"
        if name in self.params:
            if not self.function.entry:
                raise Unknown(f"the address of parameter {name} of a device function")
            return f"(uint64_t){self.params[name].offset}u"
        raise Unknown(f"operand {name}")

    def set(self, name: str, text: str, source: str) -> str:
        if name == "_":
            return f"(void)({text});"
        cpp, own = self.register(name)
        return f"{cpp} = {convert(text, source, own)};"

    def only(self, rest: list[str], *allowed: str) -> None:
        for word in rest:
            if word not in allowed:
                raise Unknown(f".{word}")

    def place(self, text: str, space: str, use: str, n_bytes: int) -> str:
        """A C++ pointer to what [base+offset] names, for a "load", "store" or "atomic"."""
        m = re.fullmatch(r"\[\s*([^\]+]+?)\s*(?:\+\s*(-?\w+))?\s*\]", text)
        if not m:
            raise Unknown(f"address {text}")
        base, offset = m[1], int(m[2] or "0", 0)
        if space == "param":
            for scope in reversed(self.buffers):
                if base in scope:
                    cpp, size = scope[base]
                    if offset < 0 or offset + n_bytes > size:
                        raise Unknown(f"{text} is outside")
                    return f"{cpp} + {offset}"
            if base in self.returns:
                return f"ret + {self.returns[base].offset + offset}"
            if base in self.params and not self.function.entry:
                return f"args + {self.params[base].offset + offset}"
            if use != "load":
                raise Unknown(f"a store to parameter {base}")
            if base in self.params:
                if offset < 0 or offset + n_bytes > self.params[base].size:
                    raise Unknown(f"{text} is outside")
                return f"t.params + {self.params[base].offset + offset}"
        if space == "const":
            space = "global"
        address = self.value(base, "uint64_t")
        if space in ("shared", "local") and self.is_register(base) and self.register(base)[1] == "uint32_t":
            address = f"(uint64_t)(uint32_t)({self.value(base, 'uint32_t')} + {offset})"
        elif offset:
            address = f"({address} + (uint64_t)({offset}ll))"
        if base in self.module.constants and use == "load":
            return f"(const unsigned char*)({address})"
        return f"t.{use}_{space}({address}, {n_bytes}, {self.line})"

    def memory_words(self, rest: list[str]) -> tuple[str, int, str]:
        words = [w for w in rest if w not in MEMORY_WORDS and not w.startswith("L")]
        space = words.pop(0) if words[0] in SPACES else "generic"
        vector = int(words.pop(0)[1]) if words[0] in ("v2", "v4") else 1
        if len(words) != 1:
            raise Unknown("memory operation")
        return space, vector, words[0]

    def fault(self, kind: str) -> int:
        """The number of a new fault of the statement."""
        self.module.faults.append((kind, self.line, len(self.module.blocks) - 1, self.function.name))
        return len(self.module.faults) - 1
