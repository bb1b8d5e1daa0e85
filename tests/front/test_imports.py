"""A verb begins with what it needs: libraries that take seconds to load are loaded by what uses them."""

import subprocess
import sys

import pytest

from barrierbench_analysis.io.places import ROOT

TABLES, DRAWING, SHAPES = ("pandas",), ("matplotlib.pyplot",), ("scipy", "jsonschema")
UNUSED = {
    "front.door": ("numpy", *TABLES, *DRAWING, *SHAPES),
    "studies.judge.verb": (*TABLES, *DRAWING, "jsonschema"),
    "figures.pictures.render": (*TABLES, *SHAPES, "meshio"),
    "figures.pictures.stills": (*TABLES, *SHAPES, "meshio"),
    "pages.report.verb": ("scipy", "jsonschema"),
    "pages.play.verb": (*TABLES, *SHAPES, "meshio"),
    "studies.catalogue.scenes": (*TABLES, *DRAWING, "jsonschema"),
    "program.formula.verb": ("numpy", "sympy"),
}


@pytest.mark.parametrize("module, unused", UNUSED.items())
def test_a_verb_does_not_load_what_it_does_not_need_at_its_start(module, unused):
    asked = f"import sys; sys.path.insert(0, {str(ROOT / 'analysis/src')!r}); import barrierbench_analysis.{module}; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True).stdout.split()
    assert f"barrierbench_analysis.{module}" in loaded
    assert not [name for name in unused if name in loaded]
