"""What the schema of a record says of one value: its type, its words, its minimum, and the same of what lies
below. It is applied to every value of every record, so the common answer is quick.
"""

from __future__ import annotations

import json
import math
from functools import cached_property

from . import fields

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def shown(value) -> str:
    return json.dumps(value)[:60]


class RecordRule:
    """A rule of the schema as it is applied to every value of a record, looked up once."""

    def __init__(self, rule: dict) -> None:
        while "$ref" in rule:
            rule = fields.schema("run")["$defs"][rule["$ref"].rsplit("/", 1)[1]]
        self.rule, self.words, self.minimum = rule, rule.get("enum"), rule.get("minimum")
        kinds = rule.get("type", ())
        self.kinds = [kinds] if isinstance(kinds, str) else kinds
        self.types = tuple(TYPES[kind] for kind in self.kinds if kind in TYPES)
        self.number, self.integer = "number" in self.kinds, "integer" in self.kinds
        self.required = rule.get("required", ())
        # Most values are of a type that needs no second look, or numbers only held against a minimum.
        numbers = {int, float} if self.number else {int} if self.integer else set()
        self.counted = numbers if self.words is None else set()
        self.least = -math.inf if self.minimum is None else self.minimum
        self.plain = set(self.types) - {dict, list} if self.words is None else set()

    @cached_property
    def known(self) -> dict[str, RecordRule]:
        return {name: RecordRule(below) for name, below in self.rule.get("properties", {}).items()}

    @cached_property
    def other(self) -> RecordRule | None:
        other = self.rule.get("additionalProperties")
        return RecordRule(other) if isinstance(other, dict) else None

    @cached_property
    def items(self) -> RecordRule | None:
        return RecordRule(self.rule["items"]) if self.rule.get("items") else None

    def fault(self, value, complete: bool, words: bool) -> str:
        """What is wrong with the first value that is not as the schema says, behind its place; empty when
        all is well. complete: every field has to be there. words: only the words of the schema are allowed; a
        later version may have more. Unknown fields are passed over.
        """
        if self.words is not None:
            if value in self.words or not words and isinstance(value, str):
                return ""
            return f": found {shown(value)}; allowed: {', '.join(map(str, self.words))}"
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        right = isinstance(value, self.types) or (
            is_number and (self.number or self.integer and value == int(value))
        )
        if self.kinds and not right:
            return f": found {shown(value)}; allowed: {' or '.join(self.kinds)}"
        if is_number:
            few = self.minimum is not None and value < self.minimum
            return f": found {value}; allowed: {self.minimum} or more" if few else ""
        if isinstance(value, dict):
            return self._object_fault(value, complete, words)
        if isinstance(value, list) and self.items:
            for k, below in enumerate(value):
                if fault := self.items.fault(below, complete, words):
                    return f"/{k}{fault}"
        return ""

    def _object_fault(self, value: dict, complete: bool, words: bool) -> str:
        if complete:
            for name in self.required:
                if name not in value:
                    return f": no field {name}; allowed: a record as it was written"
        known, other = self.known, self.other
        for name, below in value.items():
            inner = known.get(name, other)
            if inner is None:
                continue
            kind = type(below)
            if kind in inner.plain or (kind in inner.counted and below >= inner.least):
                continue
            if fault := inner.fault(below, complete, words):
                return f"/{name}{fault}"
        return ""
