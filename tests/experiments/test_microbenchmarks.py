"""The suite times every kind of element where it has a force: none is at rest, and none is missing."""

import json
import subprocess

import pytest

KINDS = "rod cloth_spring stitch inertia weight soft_pin air_drag inflation friction_smoothed_coulomb friction_capped restitution".split()


def test_every_kind_of_element_is_timed_where_it_pushes(build_folder):
    suite = build_folder / "experiments/microbenchmarks/barrierbench_microbenchmarks"
    if not suite.exists():
        pytest.skip(f"{suite} is not built (./bench build)")
    words = [f"--benchmark_filter=energy/({'|'.join(KINDS)})/", "--benchmark_min_time=0.001", "--benchmark_format=json"]
    done = subprocess.run([suite, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = {one["name"].split("/")[1]: one for one in json.loads(done.stdout)["benchmarks"]}
    assert set(found) == set(KINDS)
    for name, one in found.items():
        assert one["items"] > 1000 and one["s_per_item"] > 0 and one["gradient"] > 0, name
