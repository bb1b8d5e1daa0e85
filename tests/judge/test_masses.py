"""What the vertices of a film weigh, against closed forms: tetrahedra, triangles and segments, each with its own density."""

import numpy as np
import pytest

from barrierbench_analysis.studies.judge.about import About
from barrierbench_analysis.studies.judge.physics import Physics
from barrierbench_analysis.program.trajectories.trajectory import Topology

BLOCK = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])  # two tetrahedra, of 1/6 and 1/3 m^3
TETRAHEDRA = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
SKIN = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]])
LEAF = np.array([[5, 0, 0], [7, 0, 0], [5, 3.0, 0]])  # 3 m^2
ROD = np.array([[9, 0, 0], [9, 2, 0], [9, 2, 5.0]])  # 2 and 5 m
REST = np.vstack([BLOCK, LEAF, ROD])
TOPOLOGY = Topology(
    len(REST), np.vstack([SKIN, [[5, 6, 7]]]), np.array([[8, 9], [9, 10]]), TETRAHEDRA, names=("block", "leaf", "rod"), first_vertex=(0, 5, 8)
)  # fmt: skip
OF_BLOCK = [1 / 24, 1 / 8, 1 / 8, 1 / 8, 1 / 12]  # m^3 of each vertex
OF_LEAF, OF_ROD = [1, 1, 1], [1, 3.5, 2.5]  # m^2, m


def masses(density: dict[str, float], topology: Topology = TOPOLOGY) -> np.ndarray:
    about = About(given=np.zeros(len(REST), bool), half_thickness_m=None, density=density, gravity_m_s2=(0, 0, -10.0))
    return Physics(topology, about, REST, [0.0, 0.1]).mass


def test_every_kind_of_cell_weighs_its_share_and_the_skin_of_a_solid_nothing():
    density = {"block": 7.0, "leaf": 0.3, "rod": 0.02}
    expected = np.concatenate([7.0 * np.array(OF_BLOCK), 0.3 * np.array(OF_LEAF), 0.02 * np.array(OF_ROD)])
    assert masses(density) == pytest.approx(expected, rel=1e-13)
    assert masses(density).sum() == pytest.approx(7.0 * 0.5 + 0.3 * 3 + 0.02 * 7, rel=1e-13)


def test_the_skin_changes_nothing_and_a_body_without_a_density_weighs_nothing():
    bare = Topology(
        TOPOLOGY.n_vertices,
        TOPOLOGY.triangles[-1:],
        TOPOLOGY.segments,
        TETRAHEDRA,
        names=TOPOLOGY.names,
        first_vertex=TOPOLOGY.first_vertex,
    )
    for name, first, last in (("block", 0, 5), ("leaf", 5, 8), ("rod", 8, 11)):
        mass = masses({name: 2.0})
        assert (mass[first:last] > 0).all() and mass.sum() == mass[first:last].sum()
        assert (mass == masses({name: 2.0}, bare)).all()
    hollow = Topology(
        TOPOLOGY.n_vertices,
        SKIN,
        TOPOLOGY.segments,
        TETRAHEDRA[:0],
        names=TOPOLOGY.names,
        first_vertex=TOPOLOGY.first_vertex,
    )
    area = 3 * 0.5 + 3 * np.sqrt(3) / 2  # the same triangles where there is no tetrahedron
    assert masses({"block": 2.0}, hollow).sum() == pytest.approx(2 * area, rel=1e-13)


def test_weight_and_motion_of_a_solid_with_a_skin_have_their_closed_form():
    about = About(
        given=np.zeros(len(REST), bool),
        half_thickness_m=None,
        density={"block": 6.0, "leaf": 0.5},
        gravity_m_s2=(0, 0, -10.0),
    )
    physics = Physics(TOPOLOGY, about, REST, [0.0, 0.1, 0.35])
    first, second = physics.of(0, REST), physics.of(1, REST + [0, 0.2, 0.3])
    third = physics.of(2, REST + [0.5, 0.2, -0.2])  # after 0.25 s, not 0.1
    heights = 6.0 * (np.array(OF_BLOCK) @ BLOCK[:, 2])  # kg m
    assert first["gravity_J"] == pytest.approx(10 * heights)
    assert second["gravity_J"] == pytest.approx(10 * (heights + (3 + 1.5) * 0.3))
    assert second["momentum_kg_m_s"] == pytest.approx([0, 4.5 * 2, 4.5 * 3])
    assert second["kinetic_J"] == pytest.approx(0.5 * 4.5 * (4 + 9))
    assert third["momentum_kg_m_s"] == pytest.approx([4.5 * 2, 0, -4.5 * 2])
    assert third["kinetic_J"] == pytest.approx(0.5 * 4.5 * (4 + 4))
