"""Mutants of C++ files that one build can hold together, each switched on by the environment variable BB_MUTANT.

A mutant is switched where its texts are whole statements, declarations with an initialiser, conditions or expressions;
BB_MUTANT=7 then takes the text of mutant 7 and every other value the text that stands in the file. So a few dozen
mutants cost one compilation, and the unchanged program is the same build with BB_MUTANT unset. What this module cannot
rewrite for sure, or what the compiler refuses, is left to a build of its own."""

from __future__ import annotations

import re
from dataclasses import dataclass

ENVIRONMENT = "BB_MUTANT"
PRELUDE = """#include <cstdlib>
namespace bb_mutation {
inline bool on(int k) {
  static const int chosen = [] {
    const char* text = std::getenv("BB_MUTANT");
    return text != nullptr ? std::atoi(text) : 0;
  }();
  return chosen == k;
}
}  // namespace bb_mutation
"""
TYPES = r"(?:const |static )*(?:double|int|bool|auto|float|std::size_t|long long|Positions|Vec3d|T|LinearReport)(?: ?[&*])? ?"
DECLARATION = re.compile(rf"^({TYPES}\w+ = )(.*);$", re.DOTALL)
CONDITION = re.compile(r"^((?:if|while) \()(.*)(\) \{)$", re.DOTALL)
RETURN = re.compile(r"^return (.*);$", re.DOTALL)
STATEMENT_WORD = re.compile(r"^(const|double|bool|int|auto|return|if|case|for|while|for_each\w*)\b")
INNER_DECLARATION = re.compile(rf"\n\s*{TYPES}\w+ ?[=({{;]")
ASSIGNMENT = re.compile(r"(?<![=<>!])=(?!=)")


@dataclass(frozen=True)
class Edit:
    """Replaces text[start:end] of a file by code that holds both variants."""

    start: int
    end: int
    code: str


def _balanced(text: str) -> bool:
    depth = 0
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        if depth < 0:
            return False
    return depth == 0


def _has_comma(text: str) -> bool:
    """A comma outside all brackets: the text is a list, not an expression."""
    depth = 0
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            return True
    return False


def _is_expression(text: str) -> bool:
    return bool(text) and _balanced(text) and not _has_comma(text) and not STATEMENT_WORD.match(text) and not ASSIGNMENT.search(text) \
        and text[0] not in "&|=,+*/)]" and text[-1] not in "&|=,+-*/(["


def _starts_statement(text: str, at: int) -> bool:
    """Whether a statement can begin at text[at]."""
    before = text[:at].rstrip(" ")
    if not before.endswith("\n"):
        head = before.rsplit("\n", 1)[-1]
        return before[-1:] in ("", ";", "{", "}") or re.search(r"(if|for|while) \(.*\)$", head) is not None
    line = before.rstrip("\n").rsplit("\n", 1)[-1].strip()
    return line == "" or "// " in line or line[-1] in ";{}:)"


def _both(k: int, find: str, replace: str) -> str | None:
    """Code that is `replace` when mutant k is on, else `find`; None where that is not sure to mean the same."""
    on = f"bb_mutation::on({k})"
    for pattern in (CONDITION, DECLARATION):
        old, new = pattern.match(find), pattern.match(replace)
        if old and new and old[1] == new[1] and _balanced(old[2]) and _balanced(new[2]):
            end = old[3] if pattern is CONDITION else ";"
            inner = f"{on} ? ({new[2]}) : ({old[2]})"
            return f"{old[1]}{inner}{end}"
    old, new = RETURN.match(find), RETURN.match(replace)
    if old and new:
        return f"if ({on}) return {new[1]};\nreturn {old[1]};"
    if find.endswith((";", "}")):
        if DECLARATION.match(find) or not _balanced(find) or re.match(r"^(const|double|int|auto|for_each\w*)\b", find) or INNER_DECLARATION.search(find):
            return None
        return f"if ({on}) {{\n{replace}\n}} else {{\n{find}\n}}"
    if _is_expression(find) and _is_expression(replace):
        return f"({on} ? ({replace}) : ({find}))"
    return None


def _whole_statement(text: str, find: str, replace: str) -> tuple[str, str]:
    """Both texts grown from the start of their line to the end of their statement."""
    at = text.find(find)
    after = at + len(find)
    start, end = text.rfind("\n", 0, at) + 1, text.find(";", after)
    while end >= 0 and not _balanced(text[start : end + 1]):
        end = text.find(";", end + 1)
    return text[start : end + 1], text[start:at] + replace + text[after : end + 1]


def switched(k: int, find: str, replace: str, text: str) -> Edit | None:
    """The edit of `text` that holds `find` and, as mutant k, `replace`; None when that is not possible for sure."""
    first = text.find(find) + len(find) - len(find.lstrip())
    if find.rstrip().endswith(";") and replace.rstrip().endswith(";") and not _starts_statement(text, first):
        find, replace = find.rstrip()[:-1], replace.rstrip()[:-1]
    code = _both(k, find.strip(), replace.strip())
    if code is None:
        find, replace = _whole_statement(text, find, replace)
        if text.count(find) != 1:
            return None
        code = _both(k, find.strip(), replace.strip())
    if code is None:
        return None
    start = text.find(find)
    lead, tail = find[: len(find) - len(find.lstrip())], find[len(find.rstrip()) :]
    return Edit(start, start + len(find), lead + code + tail)


def apply(text: str, edits: list[Edit]) -> str:
    """The file with all edits, which must not overlap."""
    for edit in sorted(edits, key=lambda e: -e.start):
        text = text[: edit.start] + edit.code + text[edit.end :]
    return PRELUDE + text
