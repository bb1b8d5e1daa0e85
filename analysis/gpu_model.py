"""What a Newton iteration on a card should take, from the bytes that it has to move: a prediction to be held
against the first record of a card, not a measurement.

    python -m barrierbench_analysis.gpu_model    prints the table of docs/device.md
"""

from __future__ import annotations

from dataclasses import dataclass

from .text_table import markdown

# Bytes a second of a device-to-device copy: H100 SXM and H200, published measurements; A100 80 GB by the
# same part (0.9) of
# its data sheet.
COPY_RATES = {"A100 80 GB": 1.83e12, "H100": 3.0e12, "H200": 4.3e12}
PART_OF_COPY = 0.8  # that kernels are assumed to reach
ITERATIONS = {
    "block Jacobi": 1100,
    "Schwarz": 450,
}  # of conjugate gradients to 1e-3, from CPU runs of stacked sheets
SCHWARZ_COST = 1.15  # of an iteration, over block Jacobi


@dataclass(frozen=True)
class Size:
    name: str
    vertices: float
    triangles: float
    contacts: float
    blocks_a_contact: float  # upper blocks of the contact part that are stored

    @property
    def blocks(self) -> float:
        """Blocks of both triangles: 13 a vertex of cloth with bending, and those of contacts."""
        return 13 * self.vertices + 2 * self.blocks_a_contact * self.contacts


SIZES = [
    Size("drape", 81.9e3, 161e3, 0.4e6, 2.2),
    Size("1M vertices, 10M contacts", 1e6, 2e6, 10e6, 1.1),
    Size("184M contacts", 8.2e6, 16.4e6, 184.1e6, 0.49),
]


def solver_bytes(size: Size) -> float:
    """Of an iteration of conjugate gradients: 72 B and an index a block; 336 B a vertex: 48 in the product,
    216 in the update with its block-Jacobi factor, 72 in the direction.
    """
    return 76 * size.blocks + 336 * size.vertices


def assembly_bytes(size: Size) -> float:
    """Of everything else in an iteration: three candidates a contact, sorted; rows of 138 B, written once and
    read three times, for iterate and trial; ten contributions a row of 4 B and 60 B of its row; pairs of two
    motions; blocks written and read; trees of 43 B a primitive, passed eight times; elements, 1 KB a
    triangle.
    """
    candidates = 3 * 8 * (2 + 12)
    rows = 2 * 138 * 4
    blocks = 10 * 64
    bound = 3 * 200
    trees = 43 * 8 * (size.vertices + 2.5 * size.triangles)
    return (
        (candidates + rows + blocks + bound) * size.contacts
        + 144 * size.blocks
        + trees
        + 1024 * size.triangles
    )


def pattern_bytes(size: Size) -> float:
    """Of a new pattern: ten keys a row with their sources, sorted in eight passes."""
    return 10 * 12 * 2 * 8 * size.contacts


def newton_seconds(size: Size, rate: float, preconditioner: str) -> tuple[float, float]:
    """(solve, everything else) with a new pattern."""
    effective = PART_OF_COPY * rate
    cost = SCHWARZ_COST if preconditioner == "Schwarz" else 1
    solve = ITERATIONS[preconditioner] * cost * solver_bytes(size) / effective
    return solve, (assembly_bytes(size) + pattern_bytes(size)) / effective


def seconds_text(seconds: float) -> str:
    value, unit = (seconds, "s") if seconds >= 1 else (1e3 * seconds, "ms")
    return f"{value:.0f} {unit}" if value >= 100 else f"{value:.2g} {unit}"


def table() -> str:
    rows = []
    for size in SIZES:
        for card, rate in COPY_RATES.items():
            iteration = solver_bytes(size) / (PART_OF_COPY * rate)
            _, rest = newton_seconds(size, rate, "block Jacobi")
            whole = [sum(newton_seconds(size, rate, name)) for name in ITERATIONS]
            times = [seconds_text(value) for value in (iteration, rest, *whole)]
            rows.append([size.name, f"{solver_bytes(size) / 1e9:.3g} GB", card, *times])
    head = ["scene", "bytes an iteration of PCG", "card", "PCG iteration", "all but the solve"]
    head += ["Newton iteration, block Jacobi", "with Schwarz"]
    return "\n".join(markdown(head, rows)) + "\n"


if __name__ == "__main__":
    print(table(), end="")
