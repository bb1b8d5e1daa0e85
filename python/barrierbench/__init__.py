"""Contact barriers compared in one Newton and CCD pipeline. SI units everywhere; docs/guides/python.md is the guide.

shape         values and derivatives of barriers, what a contact does under a load, matching rules
geometry      distances of pairs with gradient and Hessian, continuous collision detection (ACCD)
condition     condition numbers of sparse symmetric matrices
scene         what can be named in a config; configs with every default; scenes as numpy arrays
simulation    runs a step at a time, with callbacks and records
python_shapes, python_policies, python_step_solvers  a Python class as a shape, a stiffness policy, a step solver
step          the time step that a step solver of Python moves
queries       the queries of `bench eval`, in this process; eval is the verb itself: python -m barrierbench.eval
records       records as tables, judge and claims: the package barrierbench-analysis
"""

from __future__ import annotations

import os as _os
import warnings as _warnings
from pathlib import Path as _Path

# OpenBLAS chooses its kernel while it is loaded, and each kernel adds in another order: as the program does.
_os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")

# Where pip installed the package, presets, methods and scenes lie beside it.
_configs = _Path(__file__).resolve().parent / "configs"
if _configs.is_dir():
    _os.environ.setdefault("BARRIERBENCH_CONFIGS", str(_configs))

from . import _core  # noqa: E402

if _os.environ["OPENBLAS_CORETYPE"] == "Haswell" and _core.blas_kernel() != "Haswell":
    _warnings.warn(
        f"OpenBLAS runs its kernel {_core.blas_kernel()}, not Haswell: results may differ in their last bits"
        " from those of the program. Import barrierbench before what loads OpenBLAS.",
        RuntimeWarning,
        stacklevel=2,
    )

from ._core import ConfigError, RecordError  # noqa: E402
from .condition import Condition, condition_number  # noqa: E402
from .geometry import accd, distance, edge_edge, point_edge, point_point, point_triangle  # noqa: E402
from .python_policies import ContactRows, register_policy  # noqa: E402
from .python_shapes import register_shape  # noqa: E402
from .python_step_solvers import register_step_solver  # noqa: E402
from .queries import evaluate  # noqa: E402
from .scene import Scene, build_scene, parts, resolve, scenes  # noqa: E402
from .shape import Shape, shapes  # noqa: E402
from .simulation import Simulation, run  # noqa: E402
from .step import Step, Trial  # noqa: E402

__version__: str = _core.version

__all__ = [
    "Condition",
    "ConfigError",
    "ContactRows",
    "RecordError",
    "Scene",
    "Shape",
    "Simulation",
    "Step",
    "Trial",
    "accd",
    "build_scene",
    "condition_number",
    "distance",
    "edge_edge",
    "evaluate",
    "parts",
    "point_edge",
    "point_point",
    "point_triangle",
    "register_policy",
    "register_shape",
    "register_step_solver",
    "resolve",
    "run",
    "scenes",
    "shapes",
]
