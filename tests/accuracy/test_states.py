"""What is read of a run's motion: masses, centres and momenta with a closed form, and which way is up."""

from types import SimpleNamespace

import numpy as np
import pytest

from barrierbench_analysis.tables.accuracy.state import Motion
from barrierbench_analysis.io.errors import UserError


def motion(frames, scene=None, **bodies) -> Motion:
    """A triangle (body 0) and a rod of two edges (body 1)."""
    made = [
        {"name": "sheet", "material": {"density_kg_per_m2": 3.0}} | bodies.get("sheet", {}),
        {"name": "rod", "material": {"line_density_kg_per_m": 2.0}} | bodies.get("rod", {}),
    ]
    record = {"config": {"scene": {"name": "bodies", "bodies": made} | (scene or {})}, "scene": {"extent_m": 2.0}, "steps": []}
    shape = {"triangles": np.array([[0, 1, 2]]), "edges": np.array([[3, 4], [4, 5]]), "of_vertices": {"body": [0, 0, 0, 1, 1, 1]}}
    return Motion(record, tuple(SimpleNamespace(vertices=x, **shape) for x in frames), 0.5 * np.arange(len(frames)), ("sheet", "rod"))


START = np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0], [5, 0, 0], [5, 1, 0], [5, 1, 3]], float)


def test_a_triangle_gives_thirds_and_an_edge_halves():
    assert motion([START]).masses == pytest.approx([3.0, 3.0, 3.0, 1.0, 4.0, 3.0])  # 3 m^2, edges of 1 and 3 m
    assert motion([START]).masses.sum() == pytest.approx(3 * 3.0 + 2 * 4.0)


def test_centres_and_momentum():
    shift = np.array([0.0, 0.25, -1.0])
    moved = motion([START, START + shift])
    assert moved.com[0] == pytest.approx(np.array([[2 / 3, 1, 0], [5, 7 / 8, 9 / 8]]))
    assert moved.com[1] - moved.com[0] == pytest.approx(np.array([shift, shift]))
    assert moved.momentum(0, 1) == pytest.approx(17.0 * shift / 0.5)


@pytest.mark.parametrize("scene, up", [
    ({}, [0, 0, 1]), ({"planar": True}, [0, 1, 0]), ({"name": "drape2d"}, [0, 1, 0]), ({"name": "drape"}, [0, 0, 1]),
    ({"gravity_m_per_s2": [0, 3, -4]}, [0, -0.6, 0.8]), ({"gravity_m_per_s2": 2.5}, [0, 0, 1])])  # fmt: skip
def test_up_is_against_gravity(scene, up):
    assert motion([START], scene).up == pytest.approx(up)


def test_without_gravity_nothing_is_up():
    assert motion([START], {"gravity_m_per_s2": 0.0}).up is None


@pytest.mark.parametrize("edit", [{"rest_mesh": {"file": "a.obj"}}, {"material": {"density_kg_per_m2": 3.0, "lumping": "uniform"}}])
def test_other_masses_are_not_guessed(edit):
    with pytest.raises(UserError, match="sheet: masses are known where"):
        _ = motion([START], sheet=edit).masses
