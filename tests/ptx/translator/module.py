"""A file of PTX: its variables and functions, and the C++ of all of it."""

from __future__ import annotations

import re

from .body import Body
from .source import Function, parse_params
from .words import Unknown, c_type, size_of, symbol


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
