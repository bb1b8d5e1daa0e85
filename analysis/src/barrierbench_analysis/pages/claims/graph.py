"""Verdicts as edges of the public graph of claims (alecjacobson/mesh-elasticity-solver-benchmark,
claims/schema.md): nodes are methods, an edge says that one is claimed to be better than another in one
dimension, and how well the claim stands. Names of their nodes are used where the methods are theirs
(graph.json). The file is JSON, and so YAML as well, which is what that graph is written in.
"""

import json
from pathlib import Path

from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.spec_file import checked
from barrierbench_analysis.studies.claims.judge import Answer
from barrierbench_analysis.studies.claims.sizes import Sizes, of_parts, of_sweeps
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import HOLDS, IN_PART, NOT, ONLY_IF, OPEN, Judged
from barrierbench_analysis.studies.claims.words import interval

from .parts_file import DIGITS, unit_of

FILE = Path(__file__).with_suffix(".json")
KIND = "claims_graph"  # of the schema
LINK = "results/CLAIMS.csv"
STATUS = {HOLDS: "validated", IN_PART: "qualified", ONLY_IF: "qualified", NOT: "refuted", OPEN: "unvalidated"}
NOT_RUN = "self-claimed"  # what waits for something that is not built, so that no run was made
GUARANTEE = {"yes": "yes", "approximate": "approx"}


def _status(a: Answer, judged: Judged) -> str:
    return NOT_RUN if not a.parts else STATUS[judged.verdict]


def _parts_in_words(parts: list[Judged]) -> str:
    """What each deciding part says, and its verdict."""
    return "; ".join(f"{j.says}: {j.verdict}" for j in parts if not j.beside)


def _notes(a: Answer, parts: list[Judged], sizes: Sizes | None) -> str:
    basis = a.state.why if parts is a.confirmed_parts else a.why_exploratory or "closed form"
    found = [_parts_in_words(parts), sizes.mark if sizes else "", f"conditions: {_slices(parts)}", basis]
    if "conditioning" in a.claim.dimension:
        found.append("condition numbers stand under the dimension convergence, the nearest of the graph")
    return ". ".join(filter(None, found))


def _slices(parts: list[Judged]) -> str:
    found = dict.fromkeys(j.slice for j in parts if not j.beside and j.slice)
    return " | ".join(found) if found else "none"


def _evidence(j: Judged, table: Table) -> str:
    sizes = of_sweeps([j.sweep], table) if j.sweep else None
    scenes = f"; {j.scenes} scenes" if j.scenes else ""
    return f"{j.measures}: {interval(j)}{scenes}{f'; {sizes.words}' if sizes else ''}"


def _measured(a: Answer, j: Judged, table: Table) -> dict:
    """The number of a part, with what made it. A closed form has no sweep, sizes and commit."""
    sizes = of_sweeps([j.sweep], table) if j.sweep else None
    rule = next(part for part in a.claim.parts if part["says"] == j.says)
    found = {name: getattr(j, name) for name in ("value", "lower", "upper")}
    return {
        **{name: x if x is None else float(f"{x:.{DIGITS}g}") for name, x in found.items()},
        "unit": unit_of(rule),
        "scenes": j.scenes,
        "unknowns": [sizes.least, sizes.largest] if sizes else [],
        "sweep": j.sweep,
        "commit": table.sweeps[j.sweep].about["commit"] if j.sweep else "",
        "link": LINK,
    }


def _number_of(a: Answer, parts: list[Judged], number: int) -> Judged | None:
    """The part of this number of the claim among those that its verdict rests on. None without a value."""
    says = a.claim.parts[number - 1]["says"]
    return next((j for j in parts if j.says == says and j.value is not None), None)


def _edges(a: Answer, source: str, target: str, dimensions: dict[str, int], table: Table) -> list[dict]:
    """One for each dimension of a claim, with the number of a part of it. All have the verdict of the whole
    claim: the confirmed one where there is one.
    """
    judged, parts = (a.confirmed, a.confirmed_parts) if a.confirmed else (a.verdict, a.parts)
    how = "closed form" if a.proven else "confirmed scenes" if a.confirmed else "exploratory"
    whole = {
        "status": _status(a, judged),
        "guarantee_preserved": GUARANTEE[a.claim.guarantee],
        "claim": a.claim.sentence,
        "source": a.claim.source,
        "assessed_by": f"barrierbench ({how})",
        "notes": _notes(a, parts, of_parts(parts, table)),
        "claim_id": a.claim.id,
        "verdict": judged.verdict,
    }
    edges = []
    for dimension, number in dimensions.items():
        j = _number_of(a, parts, number)
        found = {"evidence": _evidence(j, table), "measured": _measured(a, j, table)} if j else {}
        edge = {"from": source, "to": target, "dimension": dimension, **whole}
        edges.append({**edge, "evidence": "", "measured": None, **found})
    return edges


def graph(answers: list[Answer], table: Table) -> dict:
    """The nodes that some edge names, and the edges. Errors: KeyError for a claim that graph.json does not
    have; UserError for a graph that is none by its schema.
    """
    known = read_object(FILE)
    edges = [edge for a in answers for edge in _edges(a, *known["edges"][a.claim.id], table)]
    used = {edge[end] for edge in edges for end in ("from", "to")}
    nodes = [node for node in known["nodes"] if node["id"] in used]
    return checked({"nodes": nodes, "edges": edges}, FILE, KIND)


def text(answers: list[Answer], table: Table) -> str:
    return json.dumps(graph(answers, table), indent=1, ensure_ascii=False) + "\n"
