"""Instructions that compute: sums, products, roots, bits, comparisons, conversions."""

from __future__ import annotations

from .operands import Operands
from .words import COMPARE, OPPOSITE, ROUNDING, Unknown, c_type, convert, is_float, size_of


class Arithmetic(Operands):
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
        return "{ uint32_t next; " + self.set(args[0], f"{function}<{u}>({a}, {b}, {before}, next)", u) + (" carry = next; }" if out else " }")

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
        return "{ uint32_t next; " + self.set(args[0], f"add_carry<{u}>({text}, {c}, {before}, next)", u) + (" carry = next; }" if out else " }")

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
