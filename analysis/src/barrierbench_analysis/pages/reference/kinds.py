"""The kinds of `bench eval`, read from its JSON Schema: each with the fields of a query and of its answer."""

from collections.abc import Iterator

EVERY = ("kind", "id", "precision", "status")  # of every query or answer; told once
BOUNDS = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}


def resolved(schema: dict, node: dict) -> dict:
    """A node with what it refers to laid underneath."""
    name = node.get("$ref", "").rpartition("/")[2]
    return schema["$defs"][name] | {k: v for k, v in node.items() if k != "$ref"} if name else node


def _length(node: dict) -> str:
    least, most = node.get("minItems"), node.get("maxItems")
    if least is None and most is None:
        return ""
    return f"{least} " if least == most else f"{least or 0} to {'any' if most is None else most} "


def allowed(schema: dict, node: dict) -> str:
    """What a value may be, in words."""
    node = resolved(schema, node)
    if "enum" in node:
        return "one of " + ", ".join(f"`{value}`" for value in node["enum"])
    if "const" in node:
        return f"`{node['const']}`"
    kind = node.get("type", "any")
    if kind == "array":
        of = allowed(schema, node.get("items", {}))
        return f"list of {_length(node)}({of})"
    words = " or ".join(kind) if isinstance(kind, list) else kind
    bounds = [f"{sign} {node[key]:g}" for key, sign in BOUNDS.items() if key in node]
    return " ".join([words, " and ".join(bounds)]).strip()


def kinds(schema: dict) -> Iterator[tuple[str, dict, dict]]:
    """Name, query and answer of every kind, in the order of the schema."""
    for node in schema["oneOf"]:
        name = node["$ref"].partition("query_")[2]
        yield name, schema["$defs"][f"query_{name}"], schema["$defs"][f"answer_{name}"]


def rows(schema: dict, of: dict) -> list[list[str]]:
    """Field, allowed, default or `required`, meaning: of a query or an answer, without what all have."""
    needed, found = of.get("required", []), []
    for name, node in of.get("properties", {}).items():
        if name in EVERY:
            continue
        whole = resolved(schema, node)
        default = "required" if name in needed else str(whole.get("default", ""))
        found.append([name, allowed(schema, node), default, whole.get("description", "")])
    return found
