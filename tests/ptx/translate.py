#!/usr/bin/env python3
"""Translates the PTX that nvcc emits into C++ that runs on the CPU (runtime.hpp, machine.hpp).

    translate.py KERNELS.ptx KERNELS.cpp [--module NAME] [--faults]

One C++ function a kernel or device function, one variable a register, one goto a branch. Loads, stores, barriers and
shuffles are calls into the checked run time and carry their line of the PTX. Each straight-line piece of code leaves a
mark when it runs, so that what was executed can be counted. An instruction that is not known is an error that names
its line and text (exit code 2), never a guess.

With --faults every barrier, store, atomic, conditional jump ahead and shuffle can be broken, one at a time, by the
environment variable BB_PTX_FAULT=MODULE:NUMBER (inject_faults.py)."""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

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


@dataclass
class Parameter:
    name: str
    offset: int
    size: int


@dataclass
class Function:
    name: str
    entry: bool
    line: int
    params: list[Parameter]
    returns: list[Parameter]
    number: int = 0
    body: str | None = None
    shared_bytes: int = 0
    synchronizes: bool = False
    calls: set[str] = field(default_factory=set)
    first_block: int = 0
    n_blocks: int = 0
    code: list[str] = field(default_factory=list)

    def param_bytes(self) -> int:
        return max((p.offset + p.size for p in self.params), default=0)


def parse_params(text: str) -> list[Parameter]:
    out, at = [], 0
    for piece in filter(None, (p.strip() for p in text.split(","))):
        m = re.fullmatch(r"\.param\s+(?:\.align\s+(\d+)\s+)?\.([bfsu]\d+)(?:\s+\.ptr\b[^%$\w]*(?:\.\w+\s+)*(?:\.align\s+\d+)?)?\s+([\w$]+)(?:\[(\d+)\])?", piece)
        if not m:
            raise Unknown(f"parameter {piece}")
        size = size_of(m[2])
        align = int(m[1] or size)
        at = (at + align - 1) // align * align
        bytes_of = size * int(m[4] or 1)
        out.append(Parameter(m[3], at, bytes_of))
        at += bytes_of
    return out


def split_arguments(text: str) -> list[str]:
    out, depth, current = [], 0, ""
    for ch in text:
        depth += ch in "{[("
        depth -= ch in "}])"
        if ch == "," and depth == 0:
            out.append(current.strip())
            current = ""
        else:
            current += ch
    if current.strip():
        out.append(current.strip())
    return out


def statements(body: str, line: int):
    """Yields (kind, text, line): "statement" up to its ';', "label", "open", "close"."""
    start, text = line, ""
    for ch in body:
        if not text.strip():
            start, text = line, ""
        if ch == "\n":
            line += 1
        if ch in "{}" and not text.strip():
            yield ("open" if ch == "{" else "close"), ch, line
        elif ch == ";":
            yield "statement", " ".join(text.split()), start
            text = ""
        elif ch == ":" and re.fullmatch(r"\s*[$%\w]+", text):
            yield "label", text.strip(), start
            text = ""
        else:
            text += ch
    if text.strip():
        raise Unknown(f"unfinished statement '{text.strip()}'")


class Module:
    def __init__(self, text: str, name: str, with_faults: bool = False):
        self.name = name
        self.faults: list[tuple[str, int, int, str]] | None = [] if with_faults else None  # kind, line, block, function
        self.functions: dict[str, Function] = {}
        self.n_functions = 0
        self.constants: dict[str, tuple[int, str, list[str], int]] = {}  # name -> align, C type, values, count
        self.shared: dict[str, tuple[int, int]] = {}  # of the module: name -> align, bytes
        self.blocks: list[list[int]] = []  # line, instructions
        self.parse(re.sub(r"//[^\n]*", "", text))

    def parse(self, text: str) -> None:
        at = 0
        pattern = re.compile(r"\s*(?:(\.(?:version|target|address_size|file)\b[^\n]*)|((?:\.\w+\s+)*?\.(?:entry|func)\b)|((?:\.\w+\s+)*?\.(?:global|const|shared)\b[^;]*;)|$)")
        while at < len(text):
            m = pattern.match(text, at)
            line = text.count("\n", 0, at) + 1
            if not m:
                raise Unknown(f"line {line}: {text[at:at + 80].strip().splitlines()[0]}")
            if m.end() == at:
                break
            at = m.end()
            if m[3]:
                self.parse_variable(" ".join(m[3].split()), line)
            elif m[2]:
                at = self.parse_function(text, at, m[2])

    def parse_variable(self, text: str, line: int) -> None:
        m = re.fullmatch(r"(?:\.(?:visible|weak|extern|common)\s+)*\.(global|const|shared)\s+(?:\.align\s+(\d+)\s+)?\.([bfsu]\d+)\s+([\w$]+)(?:\[(\d*)\])?(?:\s*=\s*(.*))?;", text)
        if not m or ".extern" in text:
            raise Unknown(f"line {line}: {text}")
        count = int(m[5] or 1)
        if m[1] == "shared":
            self.shared[m[4]] = (int(m[2] or size_of(m[3])), count * size_of(m[3]))
            return
        values = [v.strip() for v in (m[6] or "0").strip("{} ").split(",")]
        if not all(re.fullmatch(r"-?\d+|0x[0-9a-fA-F]+|0[dDfF][0-9a-fA-F]+", v) for v in values):
            raise Unknown(f"line {line}: {text[:100]}")
        values = [f"f64(0x{v[2:]}ull)" if v[:2] in ("0d", "0D") else f"f32(0x{v[2:]}u)" if v[:2] in ("0f", "0F") else v for v in values]
        self.constants[m[4]] = (int(m[2] or size_of(m[3])), c_type(m[3]), values, count)

    def parse_function(self, text: str, at: int, words: str) -> int:
        line = text.count("\n", 0, at) + 1
        m = re.compile(r"\s*(?:\(([^)]*)\))?\s*([\w$]+)\s*(?:\(([^)]*)\))?").match(text, at)
        end = at = m.end()
        function = Function(m[2], ".entry" in words, line, parse_params(m[3] or ""), parse_params(m[1] or ""))
        while text[end] not in "{;":
            end += 1
        if text[end] == "{":
            depth, begin = 1, end + 1
            while depth:
                end += 1
                depth += (text[end] == "{") - (text[end] == "}")
            function.body = text[begin:end]
            function.line = text.count("\n", 0, begin) + 1
        if function.name not in self.functions or function.body is not None:
            self.n_functions += 1
            function.number = self.n_functions
            self.functions[function.name] = function
        return end + 1

    def translate(self) -> None:
        for function in self.functions.values():
            if function.body is None:
                raise Unknown(f"line {function.line}: {function.name} has no body")
            Body(self, function).translate()
        changed = True
        while changed:  # what a function that is called needs, its caller needs
            changed = False
            for f in self.functions.values():
                for g in f.calls:
                    if self.functions[g].synchronizes and not f.synchronizes:
                        f.synchronizes = changed = True

    def cpp(self) -> str:
        out = [f"// Translated from the PTX of {self.name}.", "#include <cfenv>", '#include "tests/ptx/machine.hpp"', "namespace ptx {", "namespace {"]
        out.append(f"unsigned char hit[{max(1, len(self.blocks))}];")
        if self.faults is not None:
            out.append(f'const int fault = chosen_fault("{self.name}");')
        for name, (align, type_name, values, count) in self.constants.items():
            out.append(f"alignas({align}) constexpr {type_name} {symbol(name)}[{count}] = {{{', '.join(values)}}};")
        for f in self.functions.values():
            if not f.entry:
                out.append(f"void function_{f.number}(Thread& t, const unsigned char* args, unsigned char* ret);")
        for f in self.functions.values():
            out += f.code
        out.append("constexpr CodeBlock blocks[] = {" + ", ".join(f"{{{line}, {n}}}" for line, n in self.blocks) + "};")
        for f in self.functions.values():
            if f.entry and f.params:
                out.append(f"constexpr Kernel::Parameter params_{f.number}[] = {{" + ", ".join(f"{{{p.offset}, {p.size}}}" for p in f.params) + "};")
        out.append("const Kernel kernels[] = {")
        for f in self.functions.values():
            run = f"entry_{f.number}" if f.entry else "nullptr"
            params = f"params_{f.number}" if f.entry and f.params else "{}"
            sync = "true" if f.synchronizes else "false"
            out.append(f'  {{"{f.name}", {run}, {f.param_bytes()}, {f.shared_bytes}, {sync}, {params}, {f.first_block}, {f.n_blocks}}},')
        out.append("};")
        constants = "{}"
        if self.constants:
            constants = "constants"
            out.append("const Constant constants[] = {" + ", ".join(f"{{{symbol(c)}, sizeof {symbol(c)}}}" for c in self.constants) + "};")
        faults = "{}"
        if self.faults:
            faults = "faults"
            out.append("const Fault faults[] = {" + ", ".join(f'{{"{kind}", {line}, {block}, "{name}"}}' for kind, line, block, name in self.faults) + "};")
        out += [f'const Registration registration(Module{{"{self.name}", kernels, blocks, hit, {constants}, {faults}}});', "}", "}", ""]
        return "\n".join(out)


def symbol(name: str) -> str:
    return "v_" + name.replace("$", "_S_").replace("%", "_P_")


class Body:
    """Translates one function."""

    def __init__(self, module: Module, function: Function):
        self.module, self.function = module, function
        self.scopes: list[dict[str, tuple[str, str]]] = [{}]  # register -> C++ name, type
        self.stems: list[dict[str, str]] = [{}]  # "%fd" of "%fd<12>" -> type
        self.declared: dict[str, str] = {}
        self.buffers: list[dict[str, tuple[str, int]]] = [{}]  # .param inside a call
        self.buffer_lines: list[str] = []
        self.local: dict[str, tuple[int, int]] = {}
        self.local_bytes = 0
        self.shared: dict[str, int] = {}
        self.targets: dict[str, list[str]] = {}
        self.labels: set[str] = set()
        self.label_scope: list[dict[str, str]] = [{}]
        self.code: list[str] = []
        self.n_scopes = 0
        self.uses_carry = False
        self.line = 0
        self.block_open = False
        self.params = {p.name: p for p in function.params}
        self.returns = {p.name: p for p in function.returns}
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

    # --- structure
    def translate(self) -> None:
        f = self.function
        self.scope_ids = [0]
        self.function.first_block = len(self.module.blocks)
        every = list(statements(f.body, f.line))
        self.positions = {text: i for i, (kind, text, _) in enumerate(every) if kind == "label"}
        self.every = every
        for self.index, (kind, text, self.line) in enumerate(every):
            try:
                self.one(kind, text)
            except Unknown as error:
                raise Unknown(f"line {self.line}: {text}: {error}") from None
        f.n_blocks = len(self.module.blocks) - f.first_block
        head = f"void entry_{f.number}(Thread& t) {{" if f.entry else f"void function_{f.number}(Thread& t, [[maybe_unused]] const unsigned char* args, [[maybe_unused]] unsigned char* ret) {{"
        out = [f"// {f.name}", head]
        by_type: dict[str, list[str]] = {}
        for cpp, type_name in self.declared.items():
            by_type.setdefault(type_name, []).append(cpp)
        for type_name, names in by_type.items():
            for i in range(0, len(names), 12):
                start = "{NAN}" if is_float(type_name) else "{}"  # what is read before it is set shows
                out.append(f"  {type_name} " + ", ".join(n + start for n in names[i : i + 12]) + ";")
        if self.uses_carry:
            out.append("  uint32_t carry = 0;")
        out += self.buffer_lines
        if self.local_bytes:
            out.append(f"  Local<{self.local_bytes}> local(t);")
        f.code = [*out, *self.code, "}"]

    def one(self, kind: str, text: str) -> None:
        if kind == "open":
            self.n_scopes += 1
            self.scope_ids.append(self.n_scopes)
            self.scopes.append({}), self.buffers.append({}), self.label_scope.append({})
        elif kind == "close":
            self.scope_ids.pop(), self.scopes.pop(), self.buffers.pop(), self.label_scope.pop()
        elif kind == "label":
            self.code.append(f"{self.label(text)}:;")
            self.block_open = False
        elif text.startswith("."):
            self.directive(text)
        elif ":" in text and re.match(r"[$\w]+\s*:\s*\.branchtargets", text):
            name, targets = text.split(":", 1)
            self.targets[name.strip()] = [x.strip() for x in targets.replace(".branchtargets", "").split(",")]
        elif text:
            self.statement(text)

    def label(self, name: str) -> str:
        if not name.startswith("$L__") and len(self.scope_ids) > 1:
            return "L" + name.replace("$", "_").replace("%", "_") + f"_s{self.scope_ids[-1]}"
        return "L" + name.replace("$", "_").replace("%", "_")

    def directive(self, text: str) -> None:
        if m := re.fullmatch(r"\.reg\s+\.(\w+)\s+(.*)", text):
            if m[1] not in REGISTER_TYPES:
                raise Unknown(f"register type .{m[1]}")
            for name in m[2].split(","):
                name = name.strip()
                if n := re.fullmatch(r"([%\w$]+)<(\d+)>", name):
                    self.declare([f"{n[1]}{i}" for i in range(int(n[2]))], REGISTER_TYPES[m[1]])
                else:
                    self.declare([name], REGISTER_TYPES[m[1]])
        elif m := re.fullmatch(r"\.(local|shared)\s+(?:\.align\s+(\d+)\s+)?\.([bfsu]\d+)\s+([\w$]+)(?:\[(\d+)\])?", text):
            align, size = int(m[2] or size_of(m[3])), size_of(m[3]) * int(m[5] or 1)
            if m[1] == "shared":
                self.add_shared(m[4], align, size)
            else:
                at = (self.local_bytes + align - 1) // align * align
                self.local[m[4]] = (at, size)
                self.local_bytes = at + size
        elif m := re.fullmatch(r"\.param\s+(?:\.align\s+(\d+)\s+)?\.([bfsu]\d+)\s+([\w$]+)(?:\[(\d+)\])?", text):
            cpp = f"{m[3]}_s{self.scope_ids[-1]}"
            size = size_of(m[2]) * int(m[4] or 1)
            self.buffers[-1][m[3]] = (cpp, size)
            self.buffer_lines.append(f"  alignas(16) unsigned char {cpp}[{size}];")
        elif m := re.fullmatch(r"\.branchtargets\s+(.*)", text):
            raise Unknown("branch targets without a label")
        elif not re.match(r"\.(pragma|loc|maxntid|minnctapersm|reqntid)\b", text):
            raise Unknown("directive")

    def statement(self, text: str) -> None:
        m = re.fullmatch(r"(?:@(!?)([%\w]+)\s+)?([a-z][\w.:]*)\s*(.*)", text)
        if not m:
            raise Unknown("statement")
        guard = f"if ({m[1]}{self.register(m[2])[0]}) " if m[2] else ""
        op, args = m[3], split_arguments(m[4])
        if not self.block_open:
            self.module.blocks.append([self.line, 0])
            self.code.append(f"hit[{len(self.module.blocks) - 1}] = 1;")
            self.block_open = True
        self.module.blocks[-1][1] += 1
        words = op.split(".")
        jump = words[0] in ("bra", "brx", "ret", "exit", "trap")
        code = self.jump(words, args) if jump else self.instruction(words, args, m[4])
        if guard and not jump:  # counted as executed only when the guard held
            self.module.blocks[-1][1] -= 1
            self.module.blocks.append([self.line, 1])
            code = f"hit[{len(self.module.blocks) - 1}] = 1; {code}"
            self.block_open = False
        guard, code = self.with_fault(words, guard, code, args)
        self.code.append(f"{guard}{{ {code} }}" if guard else code)
        if jump:
            self.block_open = False

    def with_fault(self, words: list[str], guard: str, code: str, args: list[str]) -> tuple[str, str]:
        """What a fault can switch off."""
        if self.module.faults is None:
            return guard, code
        name = words[0]
        if name in ("bar", "barrier"):
            ahead = next((text for kind, text, _ in self.every[self.index + 1 :] if kind == "statement"), "")
            return guard, f"if (fault != {self.fault('last barrier' if ahead == 'ret' else 'barrier')}) {{ {code} }}"
        if name in ("atom", "red"):
            return guard, f"if (fault != {self.fault('atomic')}) {{ {code} }}"
        if name == "st" and not {"local", "param"} & set(words):
            return guard, f"if (fault != {self.fault('store')}) {{ {code} }}"
        if name == "bra" and guard and self.positions.get(args[0], 0) > self.index:
            return f"{guard[:-2]} && fault != {self.fault('guard')}) ", code
        return guard, code

    def fault(self, kind: str) -> int:
        """The number of a new fault of the statement."""
        self.module.faults.append((kind, self.line, len(self.module.blocks) - 1, self.function.name))
        return len(self.module.faults) - 1

    def jump(self, words: list[str], args: list[str]) -> str:
        if words[0] in ("ret", "exit"):
            return "return;"
        if words[0] == "trap":
            return f't.fail("trap", {self.line});'
        if words[0] == "bra":
            return self.go(args[0])
        if words[:2] == ["brx", "idx"]:
            cases = " ".join(f"case {i}: {self.go(target)}" for i, target in enumerate(self.targets[args[1]]))
            return f"switch ({self.value(args[0], 'uint32_t')}) {{ {cases} default: t.fail(\"a branch table is left\", {self.line}); }}"
        raise Unknown("jump")

    def go(self, name: str) -> str:
        back = f"t.loop({self.line}); " if self.positions.get(name, self.index) <= self.index else ""
        return f"{back}goto {self.label(name)};"

    # --- instructions
    def instruction(self, words: list[str], args: list[str], raw: str) -> str:
        name, rest = words[0], words[1:]
        method = getattr(self, "op_" + name, None)
        if method is None:
            raise Unknown("instruction")
        if name == "call":
            return self.op_call(rest, raw)
        return method(rest, args)

    def only(self, rest: list[str], *allowed: str) -> None:
        for word in rest:
            if word not in allowed:
                raise Unknown(f".{word}")

    def place(self, text: str, space: str, store: bool, n_bytes: int) -> str:
        """A C++ pointer to what [base+offset] names."""
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
            if store:
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
        if base in self.module.constants and not store:
            return f"(const unsigned char*)({address})"
        return f"t.{'store' if store else 'load'}_{space}({address}, {n_bytes}, {self.line})"

    def memory_words(self, rest: list[str]) -> tuple[str, int, str]:
        words = [w for w in rest if w not in MEMORY_WORDS and not w.startswith("L")]
        space = words.pop(0) if words[0] in SPACES else "generic"
        vector = int(words.pop(0)[1]) if words[0] in ("v2", "v4") else 1
        if len(words) != 1:
            raise Unknown("memory operation")
        return space, vector, words[0]

    def op_ld(self, rest, args):
        space, vector, suffix = self.memory_words(rest)
        type_name, n = c_type(suffix), size_of(suffix)
        where = self.place(args[1], space, False, n * vector)
        names = [x.strip() for x in args[0].strip("{} ").split(",")]
        if len(names) != vector:
            raise Unknown("vector")
        if vector == 1:
            return self.set(names[0], f"get<{type_name}>({where})", type_name)
        reads = " ".join(self.set(x, f"get<{type_name}>(p + {i * n})", type_name) for i, x in enumerate(names))
        return f"{{ const unsigned char* p = {where}; {reads} }}"

    def op_ldu(self, rest, args):
        return self.op_ld(rest, args)

    def op_st(self, rest, args):
        space, vector, suffix = self.memory_words(rest)
        type_name, n = c_type(suffix), size_of(suffix)
        where = self.place(args[0], space, True, n * vector)
        names = [x.strip() for x in args[1].strip("{} ").split(",")]
        if len(names) != vector:
            raise Unknown("vector")
        writes = " ".join(f"put<{type_name}>(p + {i * n}, {self.value(x, type_name)});" for i, x in enumerate(names))
        return f"{{ unsigned char* p = {where}; {writes} }}"

    def op_mov(self, rest, args):
        self.only(rest[:-1])
        suffix = rest[-1]
        type_name = c_type(suffix)
        if args[0].startswith("{"):
            names = [x.strip() for x in args[0].strip("{} ").split(",")]
            width = 8 * size_of(suffix) // len(names)
            value = self.value(args[1], f"uint{8 * size_of(suffix)}_t")
            parts = " ".join(self.set(x, f"(uint{width}_t)(w >> {width * i})", f"uint{width}_t") for i, x in enumerate(names))
            return f"{{ const uint64_t w = {value}; {parts} }}"
        if args[1].startswith("{"):
            names = [x.strip() for x in args[1].strip("{} ").split(",")]
            width = 8 * size_of(suffix) // len(names)
            whole = " | ".join(f"(uint64_t){self.value(x, f'uint{width}_t')} << {width * i}" for i, x in enumerate(names))
            return self.set(args[0], f"(uint{8 * size_of(suffix)}_t)({whole})", f"uint{8 * size_of(suffix)}_t")
        return self.set(args[0], self.value(args[1], type_name), type_name)

    def carry(self, rest: list[str]) -> tuple[bool, str]:
        self.uses_carry = True
        return "cc" in rest, rest[-1]

    def sum(self, rest, args, sign, with_carry):
        suffix = rest[-1]
        type_name = c_type(suffix)
        a, b = self.value(args[1], type_name), self.value(args[2], type_name)
        if is_float(type_name):
            if rest[0] in ROUNDING:
                minus = "-" if sign == "-" else ""
                return self.set(args[0], f"add_directed({a}, {minus}({b}), {ROUNDING[rest[0]]})", type_name)
            self.only(rest[:-1], "rn")
            return self.set(args[0], f"{a} {sign} {b}", type_name)
        self.only(rest[:-1], "cc")
        u = f"uint{suffix[1:]}_t"
        a, b = self.value(args[1], u), self.value(args[2], u)
        if not with_carry and "cc" not in rest:
            return self.set(args[0], f"({u})({a} {sign} {b})", u)
        out, _ = self.carry(rest)
        function = "add_carry" if sign == "+" else "sub_borrow"
        before = "carry" if with_carry else "0u"
        return f"{{ uint32_t next; " + self.set(args[0], f"{function}<{u}>({a}, {b}, {before}, next)", u) + (" carry = next; }" if out else " }")

    def op_add(self, rest, args):
        return self.sum(rest, args, "+", False)

    def op_addc(self, rest, args):
        return self.sum(rest, args, "+", True)

    def op_sub(self, rest, args):
        return self.sum(rest, args, "-", False)

    def op_subc(self, rest, args):
        return self.sum(rest, args, "-", True)

    def product(self, how: str, suffix: str, args) -> tuple[str, str]:
        """Text and type of an integer product."""
        type_name = c_type(suffix)
        width = 8 * size_of(suffix)
        if how == "wide":
            wide = type_name.replace(str(width), str(2 * width))
            return f"({wide})({wide}){self.value(args[1], type_name)} * ({wide}){self.value(args[2], type_name)}", wide
        if how == "hi":
            return f"mul_hi<{type_name}>({self.value(args[1], type_name)}, {self.value(args[2], type_name)})", type_name
        if how == "lo":
            u = f"uint{width}_t"
            return f"({u})((uint64_t){self.value(args[1], u)} * (uint64_t){self.value(args[2], u)})", u
        raise Unknown(f".{how}")

    def op_mul(self, rest, args):
        suffix = rest[-1]
        type_name = c_type(suffix)
        if is_float(type_name):
            a, b = self.value(args[1], type_name), self.value(args[2], type_name)
            if rest[0] in ROUNDING:
                return self.set(args[0], f"mul_directed({a}, {b}, {ROUNDING[rest[0]]})", type_name)
            self.only(rest[:-1], "rn")
            return self.set(args[0], f"{a} * {b}", type_name)
        return self.set(args[0], *self.product(rest[0], suffix, args))

    def op_mad(self, rest, args):
        if is_float(c_type(rest[-1])):
            return self.op_fma(rest, args)
        return self.multiply_add(rest, args, False)

    def op_madc(self, rest, args):
        return self.multiply_add(rest, args, True)

    def multiply_add(self, rest, args, with_carry):
        text, type_name = self.product(rest[0], rest[-1], args)
        u = type_name if type_name.startswith("u") else "u" + type_name
        text, c = convert(text, type_name, u), self.value(args[3], u)
        if type_name != u:  # a narrower addend has a sign
            c = convert(self.value(args[3], type_name), type_name, u)
        if not with_carry and "cc" not in rest:
            return self.set(args[0], f"({u})({text} + {c})", u)
        out, _ = self.carry(rest)
        before = "carry" if with_carry else "0u"
        return f"{{ uint32_t next; " + self.set(args[0], f"add_carry<{u}>({text}, {c}, {before}, next)", u) + (" carry = next; }" if out else " }")

    def op_fma(self, rest, args):
        type_name = c_type(rest[-1])
        a, b, c = (self.value(x, type_name) for x in args[1:4])
        if rest[0] in ROUNDING:
            return self.set(args[0], f"fma_directed({a}, {b}, {c}, {ROUNDING[rest[0]]})", type_name)
        self.only(rest[:-1], "rn")
        return self.set(args[0], f"std::fma({a}, {b}, {c})", type_name)

    def op_div(self, rest, args):
        return self.quotient(rest, args, "/")

    def op_rem(self, rest, args):
        return self.quotient(rest, args, "%")

    def quotient(self, rest, args, sign):
        type_name = c_type(rest[-1])
        a, b = self.value(args[1], type_name), self.value(args[2], type_name)
        if is_float(type_name):
            self.only(rest[:-1], "rn")
            return self.set(args[0], f"{a} {sign} {b}", type_name)
        self.only(rest[:-1])
        return f'if ({b} == 0) t.fail("division by zero", {self.line}); ' + self.set(args[0], f"({type_name})({a} {sign} {b})", type_name)

    def op_rcp(self, rest, args):
        type_name = c_type(rest[-1])
        a = self.value(args[1], type_name)
        if rest[0] == "approx" and rest[-1] == "f64":
            return self.set(args[0], f"rcp_approx({a})", type_name)
        self.only(rest[:-1], "rn")
        return self.set(args[0], f"1 / {a}", type_name)

    def op_sqrt(self, rest, args):
        type_name = c_type(rest[-1])
        self.only(rest[:-1], "rn")
        return self.set(args[0], f"std::sqrt({self.value(args[1], type_name)})", type_name)

    def op_rsqrt(self, rest, args):
        type_name = c_type(rest[-1])
        self.only(rest[:-1], "approx", "ftz")
        text = f"rsqrt_approx({self.value(args[1], 'double')})" if type_name == "double" else f"1 / std::sqrt({self.value(args[1], 'float')})"
        return self.set(args[0], text, type_name)

    def approximate(self, rest, args, function):
        self.only(rest[:-1], "approx", "ftz")
        if rest[-1] != "f32":
            raise Unknown(rest[-1])
        return self.set(args[0], f"{function}({self.value(args[1], 'float')})", "float")

    def op_lg2(self, rest, args):
        return self.approximate(rest, args, "std::log2")

    def op_ex2(self, rest, args):
        return self.approximate(rest, args, "std::exp2")

    def op_neg(self, rest, args):
        type_name = c_type(rest[-1])
        self.only(rest[:-1])
        if is_float(type_name):
            return self.set(args[0], f"-{self.value(args[1], type_name)}", type_name)
        u = f"uint{rest[-1][1:]}_t"
        return self.set(args[0], f"({u})(0 - {self.value(args[1], u)})", u)

    def op_abs(self, rest, args):
        type_name = c_type(rest[-1])
        self.only(rest[:-1])
        a = self.value(args[1], type_name)
        if is_float(type_name):
            return self.set(args[0], f"std::fabs({a})", type_name)
        u = f"uint{rest[-1][1:]}_t"
        return self.set(args[0], f"({u})({a} < 0 ? 0 - {self.value(args[1], u)} : {self.value(args[1], u)})", u)

    def op_copysign(self, rest, args):
        type_name = c_type(rest[-1])  # the sign is that of the first
        return self.set(args[0], f"std::copysign({self.value(args[2], type_name)}, {self.value(args[1], type_name)})", type_name)

    def extreme(self, rest, args, function):
        self.only(rest[:-1])
        type_name = c_type(rest[-1])
        return self.set(args[0], f"{function}<{type_name}>({self.value(args[1], type_name)}, {self.value(args[2], type_name)})", type_name)

    def op_min(self, rest, args):
        return self.extreme(rest, args, "min_of")

    def op_max(self, rest, args):
        return self.extreme(rest, args, "max_of")

    def bitwise(self, rest, args, sign):
        self.only(rest[:-1])
        type_name = c_type(rest[-1])
        return self.set(args[0], f"({type_name})({self.value(args[1], type_name)} {sign} {self.value(args[2], type_name)})", type_name)

    def op_and(self, rest, args):
        return self.bitwise(rest, args, "&")

    def op_or(self, rest, args):
        return self.bitwise(rest, args, "|")

    def op_xor(self, rest, args):
        return self.bitwise(rest, args, "^")

    def op_not(self, rest, args):
        type_name = c_type(rest[-1])
        sign = "!" if type_name == "bool" else "~"
        return self.set(args[0], f"({type_name})({sign}{self.value(args[1], type_name)})", type_name)

    def op_shl(self, rest, args):
        u = f"uint{rest[-1][1:]}_t"
        return self.set(args[0], f"shift_left<{u}>({self.value(args[1], u)}, {self.value(args[2], 'uint32_t')})", u)

    def op_shr(self, rest, args):
        type_name = c_type(rest[-1])
        return self.set(args[0], f"shift_right<{type_name}>({self.value(args[1], type_name)}, {self.value(args[2], 'uint32_t')})", type_name)

    def op_shf(self, rest, args):
        direction, how = rest[0], rest[1]
        a, b, n = (self.value(x, "uint32_t") for x in args[1:4])
        count = f"({n} & 31u)" if how == "wrap" else f"min_of<uint32_t>({n}, 32u)"
        both = f"((uint64_t){b} << 32 | {a})"
        text = f"(uint32_t)(({both} << {count}) >> 32)" if direction == "l" else f"(uint32_t)({both} >> {count})"
        return self.set(args[0], text, "uint32_t")

    def op_prmt(self, rest, args):
        self.only(rest, "b32")
        return self.set(args[0], f"permute({', '.join(self.value(x, 'uint32_t') for x in args[1:4])})", "uint32_t")

    def op_bfi(self, rest, args):
        type_name = c_type(rest[-1])
        a, b = self.value(args[1], type_name), self.value(args[2], type_name)
        return self.set(args[0], f"insert_bits<{type_name}>({a}, {b}, {self.value(args[3], 'uint32_t')}, {self.value(args[4], 'uint32_t')})", type_name)

    def op_bfe(self, rest, args):
        type_name = c_type(rest[-1])
        return self.set(args[0], f"extract_bits<{type_name}>({self.value(args[1], type_name)}, {self.value(args[2], 'uint32_t')}, {self.value(args[3], 'uint32_t')})", type_name)

    def op_clz(self, rest, args):
        u = c_type(rest[-1])
        return self.set(args[0], f"(uint32_t)std::countl_zero({self.value(args[1], u)})", "uint32_t")

    def op_popc(self, rest, args):
        u = c_type(rest[-1])
        return self.set(args[0], f"(uint32_t)std::popcount({self.value(args[1], u)})", "uint32_t")

    def op_brev(self, rest, args):
        u = c_type(rest[-1])
        n = 8 * size_of(rest[-1])
        return f"{{ {u} a = {self.value(args[1], u)}, b = 0; for (int i = 0; i < {n}; ++i) b |= (a >> i & 1) << ({n - 1} - i); " + self.set(args[0], "b", u) + " }"

    def op_setp(self, rest, args):
        type_name = c_type(rest[-1])
        how, both = rest[0], rest[1:-1]
        self.only(both, "and", "or", "xor")
        a, b = self.value(args[1], type_name), self.value(args[2], type_name)
        if how in OPPOSITE and is_float(type_name):
            text = f"!({a} {OPPOSITE[how]} {b})"
            if how in ("equ",):
                text = f"!({a} < {b} || {a} > {b})"
            if how == "neu":
                text = f"!({a} == {b})"
        elif how in ("nan", "num"):
            text = f"({a} != {a} || {b} != {b})" if how == "nan" else f"({a} == {a} && {b} == {b})"
        elif how == "ne" and is_float(type_name):
            text = f"({a} < {b} || {a} > {b})"
        elif how in COMPARE:
            text = f"({a} {COMPARE[how]} {b})"
        else:
            raise Unknown(f".{how}")
        names = [x.strip() for x in args[0].split("|")]
        combine = {"and": "&&", "or": "||", "xor": "!="}[both[0]] if both else None
        third = self.value(args[3], "bool") if both else None
        out = self.set(names[0], f"({text} {combine} {third})" if both else text, "bool")
        if len(names) > 1:
            out = f"{{ const bool c = {text}; " + self.set(names[0], f"(c {combine} {third})" if both else "c", "bool") + " " + self.set(names[1], f"(!c {combine} {third})" if both else "!c", "bool") + " }"
        return out

    def op_selp(self, rest, args):
        type_name = c_type(rest[-1])
        return self.set(args[0], f"{self.value(args[3], 'bool')} ? {self.value(args[1], type_name)} : {self.value(args[2], type_name)}", type_name)

    def op_cvta(self, rest, args):
        to, space = (True, rest[1]) if rest[0] == "to" else (False, rest[0])
        a = self.value(args[1], "uint64_t")
        if space == "shared":
            a = f"({a} {'-' if to else '+'} shared_window)"
        elif space == "param":
            a = f"({a} {'-' if to else '+'} (uint64_t)t.params)"
        elif space not in ("global", "local", "const"):
            raise Unknown(f".{space}")
        return self.set(args[0], a, "uint64_t")

    def op_cvt(self, rest, args):
        target, source = rest[-2], rest[-1]
        mode = rest[:-2]
        to, of = c_type(target), c_type(source)
        if target[0] == "b" or source[0] == "b":
            raise Unknown("cvt of bits")
        a = self.value(args[1], of)
        whole = {"rni": "std::nearbyint", "rzi": "std::trunc", "rmi": "std::floor", "rpi": "std::ceil"}
        if is_float(to) and is_float(of):
            if not mode and size_of(target) >= size_of(source) or mode == ["rn"]:
                return self.set(args[0], f"({to}){a}", to)
            if len(mode) == 1 and mode[0] in whole and to == of:
                return self.set(args[0], f"{whole[mode[0]]}({a})", to)
        elif is_float(of):
            if len(mode) == 1 and mode[0] in whole:
                return self.set(args[0], f"to_integer<{to}>({whole[mode[0]]}({a}))", to)
        elif is_float(to):
            if mode == ["rn"]:
                return self.set(args[0], f"({to}){a}", to)
            if len(mode) == 1 and mode[0] in ROUNDING and to == "double" and size_of(source) <= 8 and source != "u64":
                return self.set(args[0], f"to_double_directed({a}, {ROUNDING[mode[0]]})", to)
        elif not mode:
            return self.set(args[0], f"({to}){a}", to)
        raise Unknown("conversion")

    def op_bar(self, rest, args):
        if rest not in (["sync"], ["cta", "sync"]) or args != ["0"]:
            raise Unknown("barrier")
        self.function.synchronizes = True
        return f"t.barrier({self.line});"

    def op_barrier(self, rest, args):
        return self.op_bar([w for w in rest if w not in ("cta", "aligned")], args)

    def op_membar(self, rest, args):
        return ";"  # one thread runs at a time

    def op_fence(self, rest, args):
        return ";"

    def op_shfl(self, rest, args):
        if rest[0] != "sync" or rest[1] not in ("up", "down", "bfly", "idx") or rest[2] != "b32":
            raise Unknown("shuffle")
        self.function.synchronizes = True
        names = [x.strip() for x in args[0].split("|")]
        value, b, c, members = (self.value(x, "uint32_t") for x in args[1:5])
        if self.module.faults is not None:
            b = f"({b} ^ (fault == {self.fault('shuffle')} ? 3u : 0u))"
        call = f"t.shuffle(Thread::{rest[1]}, {value}, {b}, {c}, {members}, &inside, {self.line})"
        predicate = " " + self.set(names[1], "inside", "bool") if len(names) > 1 else ""
        return f"{{ bool inside = false; {self.set(names[0], call, 'uint32_t')}{predicate} }}"

    def op_atom(self, rest, args):
        return self.atomic(rest, args[0], args[1], args[2:])

    def op_red(self, rest, args):
        return self.atomic(rest, "_", args[0], args[1:])

    def atomic(self, rest, result, where, values):
        words = [w for w in rest if w not in MEMORY_WORDS and w != "acq_rel"]
        space = words.pop(0) if words[0] in SPACES else "generic"
        how, suffix = words
        type_name = c_type(suffix)
        if is_float(type_name):
            raise Unknown("floating-point atomics depend on the order")
        if space not in ("global", "generic"):
            raise Unknown(f"atomics in .{space}")
        u = f"uint{suffix[1:]}_t"
        b = self.value(values[0], type_name)
        new = {
            "add": f"({u})(({u})old + ({u})({b}))",
            "min": f"min_of<{type_name}>(old, {b})",
            "max": f"max_of<{type_name}>(old, {b})",
            "and": f"(old & {b})",
            "or": f"(old | {b})",
            "xor": f"(old ^ {b})",
            "exch": b,
            "cas": f"(old == {b} ? {self.value(values[1], type_name) if len(values) > 1 else ''} : old)",
        }.get(how)
        if new is None:
            raise Unknown(f".{how}")
        place = self.place(where, space, True, size_of(suffix))
        keep = "" if result == "_" else " " + self.set(result, "old", type_name)
        return f"{{ unsigned char* p = {place}; const {type_name} old = get<{type_name}>(p); put<{type_name}>(p, ({type_name}){new});{keep} }}"

    def op_call(self, rest, raw):
        self.only(rest, "uni")
        m = re.fullmatch(r"(?:\(\s*([\w$]+)\s*\)\s*,\s*)?([\w$]+)\s*(?:,\s*\(([^)]*)\))?", raw.strip())
        if not m or m[2] not in self.module.functions:
            raise Unknown("call")
        callee = self.module.functions[m[2]]
        self.function.calls.add(m[2])
        args = [x.strip() for x in (m[3] or "").split(",") if x.strip()]
        if len(args) != len(callee.params):
            raise Unknown("number of arguments")
        out = [f"alignas(16) unsigned char args_[{max(1, callee.param_bytes())}];"]
        for arg, param in zip(args, callee.params):
            cpp, size = next(scope[arg] for scope in reversed(self.buffers) if arg in scope)
            if size != param.size:
                raise Unknown("size of an argument")
            out.append(f"memcpy(args_ + {param.offset}, {cpp}, {size});")
        into = "nullptr"
        if m[1]:
            into = next(scope[m[1]] for scope in reversed(self.buffers) if m[1] in scope)[0]
        out.append(f"function_{callee.number}(t, args_, {into});")
        return "{ " + " ".join(out) + " }"


def translate(text: str, name: str, with_faults: bool = False) -> str:
    """C++ of the PTX; name: what messages call it. Errors: Unknown."""
    module = Module(text, name, with_faults)
    module.translate()
    return module.cpp()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("ptx", type=Path)
    parser.add_argument("cpp", type=Path)
    parser.add_argument("--module", help="its name in messages (the file's by default)")
    parser.add_argument("--faults", action="store_true", help="with switches that break one instruction at a time")
    args = parser.parse_args()
    try:
        args.cpp.write_text(translate(args.ptx.read_text(), args.module or args.ptx.stem, args.faults))
    except Unknown as error:
        print(f"{args.ptx}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
