"""What a Newton iteration on a card should take, from the bytes that it has to move: a prediction to be held
against the first record of a card, not a measurement of one. How much there is to move is measured: contacts,
candidates, blocks and iterations are those of runs that are named in results/gpu_model_inputs.json.

    python -m barrierbench_analysis.studies.device.gpu_model    prints the table of docs/device.md
    python -m barrierbench_analysis.studies.device.gpu_model --inputs NAME RUN [RUN]... COSTS
        reads records of one scene (run.json, one a preconditioner) and what scale_costs printed of it, with
        SCALE_COSTS_KERNELS=1 and errors in the same file, and prints an entry of that file
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown

INPUTS = ROOT / "results" / "gpu_model_inputs.json"
# Bytes a second of a device-to-device copy: H100 SXM and H200, published measurements; A100 80 GB by the
# same part (0.9) of
# its data sheet.
COPY_RATES = {"A100 80 GB": 1.83e12, "H100": 3.0e12, "H200": 4.3e12}
PART_OF_COPY = 0.8  # that kernels are assumed to reach
PRECONDITIONERS = {
    "block Jacobi": "block_jacobi",
    "multilevel Schwarz": "multilevel_schwarz",
}  # as the table and as a record name them
SCHWARZ_COST = 1.15  # of an iteration, over block Jacobi: assumed
RENAMED = {"schwarz": "multilevel_schwarz"}  # what records before 3.9.0 say
NO_RECORD = "no record"


@dataclass(frozen=True)
class Measured:
    """Of one scene, at the size that it was run at."""

    source: str
    contacts_a_vertex: float
    candidates_a_contact: float
    blocks_a_contact: float  # upper blocks of the contact part that are stored
    newton_a_step: float
    pcg_a_newton: dict[str, float]  # preconditioner, as a record names it


@dataclass(frozen=True)
class Size:
    name: str
    vertices: float
    triangles: float
    measured: str  # the entry of gpu_model_inputs.json whose mesh and layers it has

    def inputs(self, known: dict[str, Measured]) -> Measured | None:
        return known.get(self.measured)


SIZES = [
    Size("drape_82k", 81.9e3, 161e3, "drape_82k"),
    Size("drape_1m", 1e6, 2e6, "drape_1m"),
    Size("packed_8m", 8.2e6, 16.4e6, "packed_patch"),
    Size("dense_8m", 8.2e6, 16.4e6, "dense_patch"),
]


def read_inputs(path: Path = INPUTS) -> dict[str, Measured]:
    return {name: Measured(**entry) for name, entry in json.loads(input_file.read_text(path)).items()}


def contacts(size: Size, m: Measured) -> float:
    return m.contacts_a_vertex * size.vertices


def blocks(size: Size, m: Measured) -> float:
    """Blocks of both triangles: 13 a vertex of cloth with bending, and those of contacts."""
    return 13 * size.vertices + 2 * m.blocks_a_contact * contacts(size, m)


def solver_bytes(size: Size, m: Measured) -> float:
    """Of an iteration of conjugate gradients: 72 B and an index a block; 336 B a vertex: 48 in the product,
    216 in the update with its block-Jacobi factor, 72 in the direction.
    """
    return 76 * blocks(size, m) + 336 * size.vertices


def assembly_bytes(size: Size, m: Measured) -> float:
    """Of everything else in an iteration: candidates, sorted; rows of 138 B, written once and
    read three times, for iterate and trial; ten contributions a row of 4 B and 60 B of its row; pairs of two
    motions; blocks written and read; trees of 43 B a primitive, passed eight times; elements, 1 KB a
    triangle.
    """
    candidates = m.candidates_a_contact * 8 * (2 + 12)
    rows, contributions, bound = 2 * 138 * 4, 10 * 64, 3 * 200
    of_contacts = (candidates + rows + contributions + bound) * contacts(size, m)
    trees = 43 * 8 * (size.vertices + 2.5 * size.triangles)
    return of_contacts + 144 * blocks(size, m) + trees + 1024 * size.triangles


def pattern_bytes(size: Size, m: Measured) -> float:
    """Of a new pattern: ten keys a row with their sources, sorted in eight passes."""
    return 10 * 12 * 2 * 8 * contacts(size, m)


def newton_seconds(size: Size, m: Measured, rate: float, preconditioner: str) -> tuple[float, float]:
    """(solve, everything else) with a new pattern. preconditioner: as a record names it."""
    effective = PART_OF_COPY * rate
    cost = SCHWARZ_COST if preconditioner == "multilevel_schwarz" else 1
    solve = m.pcg_a_newton[preconditioner] * cost * solver_bytes(size, m) / effective
    return solve, (assembly_bytes(size, m) + pattern_bytes(size, m)) / effective


def seconds_text(seconds: float) -> str:
    value, unit = (seconds, "s") if seconds >= 1 else (1e3 * seconds, "ms")
    return f"{value:.0f} {unit}" if value >= 100 else f"{value:.2g} {unit}"


def rows_of(size: Size, known: dict[str, Measured]) -> list[list[str]]:
    m = size.inputs(known)
    if m is None:
        return [[size.name, NO_RECORD, "", "", "", "", ""]]
    out = []
    for card, rate in COPY_RATES.items():
        moved = solver_bytes(size, m), assembly_bytes(size, m) + pattern_bytes(size, m)
        texts = [seconds_text(of / (PART_OF_COPY * rate)) for of in moved]
        for name in PRECONDITIONERS.values():
            known_one = name in m.pcg_a_newton
            texts.append(seconds_text(sum(newton_seconds(size, m, rate, name))) if known_one else NO_RECORD)
        out.append([size.name, f"{moved[0] / 1e9:.3g} GB", card, *texts])
    return out


def inputs_text(size: Size, known: dict[str, Measured]) -> str:
    m = size.inputs(known)
    if m is None:
        return f"- {size.name}: no record of its contacts and iterations, so nothing is predicted"
    there = {name: m.pcg_a_newton[key] for name, key in PRECONDITIONERS.items() if key in m.pcg_a_newton}
    solves = ", ".join(f"{iterations:.3g} ({name})" for name, iterations in there.items())
    parts = [
        f"{m.contacts_a_vertex:.3g} contacts a vertex ({contacts(size, m) / 1e6:.3g} million)",
        f"{m.candidates_a_contact:.3g} candidates and {m.blocks_a_contact:.3g} stored blocks a contact",
        f"{m.newton_a_step:.3g} Newton iterations a step",
        f"{solves} of conjugate gradients a Newton iteration",
    ]
    return f"- {size.name}: {', '.join(parts)}: {m.source}"


def table() -> str:
    known = read_inputs()
    head = ["scene", "bytes an iteration of PCG", "card", "PCG iteration", "all but the solve"]
    head += [f"Newton iteration, {name}" for name in PRECONDITIONERS]
    rows = [row for size in SIZES for row in rows_of(size, known)]
    inputs = ["Inputs:", *(inputs_text(size, known) for size in SIZES), ""]
    return "\n".join([*inputs, *markdown(head, rows)]) + "\n"


def costs_of(text: str) -> tuple[float, float]:
    """(candidates, stored blocks) a contact, of the last iteration that scale_costs printed both of."""
    candidates = blocks_a_row = 0.0
    for part in text.split("{")[1:]:
        line = json.loads("{" + part[: part.index("}") + 1])
        streamed = (row.split() for row in part.splitlines() if row.endswith("GatherStreamed"))
        blocks_both = [float(second) / float(first) for first, second, *_ in streamed]
        if blocks_both and line["rows"]:
            blocks_a_row = blocks_both[0] / 2 / line["rows"]
            candidates = line["candidates"] / line["rows"]
    return candidates, blocks_a_row


def measure(source: str, records: list[dict], costs: str) -> dict:
    """An entry of gpu_model_inputs.json."""
    first = records[0]
    candidates, blocks_a_contact = costs_of(costs)
    solves = {}
    for r in records:
        name = r["config"]["linear_solver"]["resident_preconditioner"]
        solves[RENAMED.get(name, name)] = r["summary"]["linear_per_solve"]
    contacts_of = first["summary"]["contacts"]
    return {
        "source": source,
        "contacts_a_vertex": contacts_of["sum"] / contacts_of["n"] / first["scene"]["vertices"],
        "candidates_a_contact": candidates,
        "blocks_a_contact": blocks_a_contact,
        "newton_a_step": first["summary"]["newton_iterations"] / first["summary"]["steps"],
        "pcg_a_newton": {name: each["sum"] / each["n"] for name, each in solves.items()},
    }


def main(argv: list[str]) -> int:
    if argv[:1] == ["--inputs"] and len(argv) >= 4:
        *runs, costs = [Path(name) for name in argv[2:]]
        records = [json.loads(input_file.read_text(run)) for run in runs]
        run_id, steps = records[0]["ids"]["run_id"][:12], records[0]["summary"]["steps"]
        source = f"run {run_id} of {argv[1]} on the host executor, {steps} steps"
        print(json.dumps(measure(source, records, input_file.read_text(costs)), indent=2))
        return 0
    print(table(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
