"""Instructions that touch memory or other threads: loads, stores, atomics, barriers, shuffles, calls."""

from __future__ import annotations

import re

from .operands import Operands
from .words import MEMORY_WORDS, SPACES, Unknown, c_type, is_float, size_of


class Memory(Operands):
    def transfer(self, rest, use, where, what):
        """(C++ pointer, C++ type, its bytes, operands) of a load or store of one number or of a vector."""
        space, vector, suffix = self.memory_words(rest)
        names = [x.strip() for x in what.strip("{} ").split(",")]
        if len(names) != vector:
            raise Unknown("vector")
        n = size_of(suffix)
        return self.place(where, space, use, n * vector), c_type(suffix), n, names

    def op_ld(self, rest, args):
        where, type_name, n, names = self.transfer(rest, "load", args[1], args[0])
        if len(names) == 1:
            return self.set(names[0], f"get<{type_name}>({where})", type_name)
        reads = " ".join(self.set(x, f"get<{type_name}>(p + {i * n})", type_name) for i, x in enumerate(names))
        return f"{{ const unsigned char* p = {where}; {reads} }}"

    def op_ldu(self, rest, args):
        return self.op_ld(rest, args)

    def op_st(self, rest, args):
        where, type_name, n, names = self.transfer(rest, "store", args[0], args[1])
        writes = " ".join(f"put<{type_name}>(p + {i * n}, {self.value(x, type_name)});" for i, x in enumerate(names))
        return f"{{ unsigned char* p = {where}; {writes} }}"

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

    def op_bar(self, rest, args):
        if rest not in (["sync"], ["cta", "sync"]) or args != ["0"]:
            raise Unknown("barrier")
        self.function.synchronizes = True
        return f"t.barrier({self.line});"

    def op_barrier(self, rest, args):
        return self.op_bar([w for w in rest if w not in ("cta", "aligned")], args)

    def op_membar(self, rest, args):
        return "t.fence();"

    def op_fence(self, rest, args):
        return "t.fence();"

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
        place = self.place(where, space, "atomic", size_of(suffix))
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
