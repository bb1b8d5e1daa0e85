"""No file of C++ includes itself by way of others, and a header with its .cpp is one file in this."""

import re
from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("core", "barriers", "experiments", "python/src", "tests")
INCLUDE = re.compile(r'^\s*#\s*include "([^"]+)"', re.M)
# Circles that stand. A circle that is broken leaves this list, and none comes in.
STANDING = """
barriers/formulas barriers/shapes/registry
core/base/parameters/check core/base/parameters/parameter
core/base/record/kept_hash core/base/record/provenance
core/exec/cuda/device core/exec/cuda/device_executor
core/linear/block_scaling core/linear/condition core/linear/condition_dense core/linear/extreme_pairs core/linear/scaled_matrix core/linear/spectrum_end
core/linear/block_system core/linear/gather_map core/linear/reduction
core/linear/cg_runs core/linear/conjugate_gradients core/linear/definiteness core/linear/linear_solver core/linear/preconditioner core/linear/solve_detail
core/linear/executor/block_jacobi core/linear/executor/executor_preconditioner core/linear/executor/multilevel_schwarz
core/model/mesh/mesh_objects core/model/mesh/raw_mesh core/model/mesh/read_mesh
core/newton/newton_system core/newton/newton_view
core/terms/contact core/terms/linear_contact
experiments/cli/sweep_cases experiments/cli/sweep_spec
experiments/config/document experiments/config/methods experiments/config/parse experiments/config/presets experiments/config/sections
experiments/matrix/side_car experiments/matrix/system_file
experiments/run/calibration experiments/run/calibration_demand experiments/run/calibration_replay experiments/run/calibration_run experiments/run/fill_record experiments/run/pass experiments/run/passes experiments/run/runner
experiments/run/device_run experiments/run/method
tests/ptx/machine tests/ptx/machine_state
"""


def includes() -> set[tuple[str, str]]:
    files = [p for folder in FOLDERS for p in sorted((ROOT / folder).rglob("*")) if p.suffix in (".cpp", ".hpp", ".cu", ".inc")]
    return {(str(path.relative_to(ROOT)), name) for path in files for name in INCLUDE.findall(path.read_text())}


def circles(arrows: set[tuple[str, str]]) -> list[list[str]]:
    """The groups of nodes that reach each other."""
    names = sorted({name for arrow in arrows for name in arrow})
    number = {name: i for i, name in enumerate(names)}
    rows, columns = ([number[arrow[side]] for arrow in arrows] for side in (0, 1))
    graph = csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(names), len(names)))
    _, group = connected_components(graph, directed=True, connection="strong")
    found = {}
    for name, label in zip(names, group):
        found.setdefault(label, []).append(name)
    return sorted(nodes for nodes in found.values() if len(nodes) > 1)


def stem(name: str) -> str:
    return re.sub(r"\.(cpp|hpp|cu)$", "", name)


def test_a_circle_is_found_through_a_third_file():
    assert circles({("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")}) == [["a", "b", "c"]]


def test_files_include_each_other_in_one_direction():
    arrows = includes()
    assert len(arrows) > 4000
    assert circles(arrows) == []
    units = {(stem(a), stem(b)) for a, b in arrows if stem(a) != stem(b)}
    assert circles(units) == [line.split() for line in STANDING.strip().splitlines()]
