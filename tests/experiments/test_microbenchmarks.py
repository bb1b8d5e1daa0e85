"""The suite times every kind of element where it has a force: none is at rest, and none of the registries is missing."""

import json
import re
import subprocess
from pathlib import Path

import pytest

CORE = Path(__file__).resolve().parents[2] / "core"


def registered(file, word):
    return re.findall(rf"^{word}\((\w+),", (CORE / file).read_text(), re.M)


def models(program, section):
    return re.findall(r"^  (\w+)", subprocess.run([program, "list", section], capture_output=True, text=True, check=True).stdout, re.M)


def requested(program):
    """Terms of the registries, and the benchmarks of their elements; those of contact are of their own kind (contact/...)."""
    named = {"external_force": ["weight"], "pull": ["soft_pin"], "springs": ["spring"], "cloth_springs": ["cloth_spring"], "hinges": ["hinge"], "rods": ["rod"],
             "membrane": models(program, "membranes"), "tetrahedra": [f"{name}_solid" for name in models(program, "solids")],
             "friction": [f"friction_{law}" for law in registered("energy/friction_laws/registry.inc", "ENTRY")]}
    terms = [*registered("terms/registry.inc", "ENTRY"), *registered("terms/registry.inc", "LAGGED"), *registered("model/scene/parts/registry.inc", "PART")]
    assert set(named) < set(terms) and all(named.values())
    return {term: named.get(term, [term]) for term in terms if term != "contact"}


def test_every_kind_of_element_is_timed_where_it_pushes(program, build_folder):
    suite = build_folder / "experiments/microbenchmarks/barrierbench_microbenchmarks"
    if not suite.exists():
        pytest.skip(f"{suite} is not built (./bench build)")
    words = ["--benchmark_filter=energy/.*/gradient_and_hessian", "--benchmark_min_time=0.001", "--benchmark_format=json"]
    done = subprocess.run([suite, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = {one["name"].split("/")[1]: one for one in json.loads(done.stdout)["benchmarks"]}
    expected = [name for names in requested(program).values() for name in names]
    assert sorted(found) == sorted(expected) and len(expected) > 20
    for name, one in found.items():
        assert one["items"] > 1000 and one["s_per_item"] > 0 and one["gradient"] > 0, name
