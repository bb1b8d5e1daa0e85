"""One function: its scopes, labels, guards and jumps; the instructions are those of Arithmetic and Memory."""

from __future__ import annotations

import re

from .arithmetic import Arithmetic
from .memory import Memory
from .source import Function, split_arguments, statements
from .words import REGISTER_TYPES, Unknown, is_float, size_of


class Body(Arithmetic, Memory):
    """Translates one function."""

    def __init__(self, module, function: Function):
        super().__init__(module, function)
        self.buffer_lines: list[str] = []
        self.targets: dict[str, list[str]] = {}
        self.code: list[str] = []
        self.block_open = False

    def translate(self) -> None:
        f = self.function
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
            self.scopes.append({}), self.buffers.append({})
        elif kind == "close":
            self.scope_ids.pop(), self.scopes.pop(), self.buffers.pop()
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
        if name in ("membar", "fence"):
            return guard, f"if (fault != {self.fault('fence')}) {{ {code} }}"
        if name in ("atom", "red"):
            return guard, f"if (fault != {self.fault('atomic')}) {{ {code} }}"
        if name == "st" and not {"local", "param"} & set(words):
            return guard, f"if (fault != {self.fault('store')}) {{ {code} }}"
        if name == "bra" and guard and self.positions.get(args[0], 0) > self.index:
            return f"{guard[:-2]} && fault != {self.fault('guard')}) ", code
        return guard, code

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
