"""The pages as Markdown."""

import json
import re
from collections.abc import Iterable

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.program import verbs

from . import MARK, kinds
from .fields import Field
from .settings import Place

SETTING_HEADS = ("key", "allowed", "default", "unit", "meaning")
FIELD_HEADS = ("field", "unit", "meaning")
QUERY_HEADS = ("query field", "allowed", "default", "meaning")
VERB_HEADS = ("verb", "what it does", "example")
ANSWER_HEADS = ("answer field", "allowed", "meaning")


def prose(text: str) -> str:
    """Text of the program in which Markdown and HTML have no marks, outside of backticks."""
    parts = text.split("`")
    for k in range(0, len(parts), 2):
        parts[k] = re.sub(r"<(?=[A-Za-z/!])", "&lt;", parts[k].replace("*", r"\*"))
    return "`".join(parts)


def code(text: str) -> str:
    """Text in backticks; empty where there is none."""
    return f"`{text}`" if text else ""


def value(text: str) -> str:
    """A default: in backticks where it is a JSON value, else words of the program."""
    try:
        json.loads(text)
    except ValueError:
        return prose(text)
    return code(text)


def choices(text: str) -> str:
    """What is allowed, each of several names in backticks."""
    if text.startswith('"'):
        return code(text)
    names = text.removeprefix("one of ")
    return prose(text) if names == text else "one of " + ", ".join(code(name) for name in names.split(", "))


def page(title: str, *blocks: str) -> str:
    """A page with its mark. blocks: paragraphs, headings and tables."""
    return "\n\n".join([f"# {title}\n{MARK}", *blocks]) + "\n"


def place_block(place: Place) -> str:
    """Heading, meaning and table of the settings of one object."""
    rows = [
        [code(s.name), choices(s.allowed), value(s.default), prose(s.unit), prose(s.meaning)]
        for s in place.settings
    ]
    table = ["", *markdown(SETTING_HEADS, rows)] if rows else []
    meaning = ["", prose(place.meaning)] if place.meaning else []
    return "\n".join([f"## {code(place.pointer)}", *meaning, *table])


def field_block(name: str, found: Iterable[Field]) -> str:
    """Heading and table of the fields of one section; the field of the section itself is its sentence."""
    found = list(found)
    sentence = next((f.meaning for f in found if f.name in (name, f"{name}[]")), "")
    rows = [
        [code(f.name), f.unit, prose(f.meaning)] for f in found if not sentence or f.meaning is not sentence
    ]
    said = ["", f"{sentence[:1].upper()}{prose(sentence[1:])}."] if sentence else []
    table = ["", *markdown(FIELD_HEADS, rows)] if rows else []
    return "\n".join([f"## {code(name)}", *said, *table])


def eval_page(schema: dict) -> str:
    """Every kind of query with its fields and those of its answer."""
    blocks = [
        "`./bench eval [FILE]` answers one JSON query a line with one JSON object a line, in the same order;"
        " without FILE it reads the standard input. Points are in metres. Every query has the field `kind`."
        " It may have `id`, which is echoed, and `precision`, `double` (default) or `float`. A number that is"
        " not finite is null, and `status` names what it is. A line that cannot be answered gets"
        ' `{"id": ..., "error": ...}`, and the exit code is 2. `./bench eval --schema` prints the JSON'
        " Schema."
    ]
    for name, query, answer in kinds.kinds(schema):
        blocks.append(f"## {code(name)}")
        if text := query.get("description"):
            blocks.append(prose(text))
        asked = [
            [code(field), words, default if default == "required" else code(default), prose(meaning)]
            for field, words, default, meaning in kinds.rows(schema, query)
        ]
        answered = kinds.rows(schema, answer)
        told = [[code(field), words, prose(meaning)] for field, words, _, meaning in answered]
        blocks += ["\n".join(markdown(QUERY_HEADS, asked)), "\n".join(markdown(ANSWER_HEADS, told))]
    return page("Kinds of eval", *blocks)


def verbs_page(found: Iterable[verbs.Verb]) -> str:
    """One table a group; the guide docs/guides/verbs.md shows them in use."""
    found, blocks = list(found), []
    for group, words in verbs.GROUPS.items():
        rows = [
            [code(f"./bench {v.name} {v.arguments}".strip()), prose(v.help), code(v.example)]
            for v in found
            if v.group == group
        ]
        blocks.append("\n".join([f"## {group}: {words}", "", *markdown(VERB_HEADS, rows)]))
    return page(
        "Verbs",
        "`./bench help` prints this list, and `./bench VERB --help` every option of a verb."
        " [All verbs in use](../guides/verbs.md) is the guide.",
        *blocks,
    )
