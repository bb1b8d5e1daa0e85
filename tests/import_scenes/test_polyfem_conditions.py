"""Scenes of PolyFEM: ids of bodies, sides that share edges, numbers of steps, d_hat without a value, and damaged conditions."""

import numpy as np
import pytest
from tests.import_scenes import sources
from tests.import_scenes.conftest import entry_of
from tests.import_scenes.test_polyfem import with_

SECOND = {"type": "SaintVenant", "id": 0, "E": 5e6, "nu": 0.3, "rho": 500}


def two_materials(folder, mesh, **changes):
    """A cube without a selection of its volume, and materials of the ids 1 and 0."""
    data = with_(geometry__0__mesh=mesh)
    del data["geometry"][0]["volume_selection"]
    data["materials"].append(SECOND)
    data["geometry"][0] |= changes
    path = sources.polyfem(folder, data)
    vtk(folder / "cube.vtk", sources.CUBE, sources.TETRAHEDRA)
    return path


def vtk(path, points, cells):
    rows = [" ".join(map(repr, p)) for p in points.tolist()]
    corners = [f"4 {' '.join(map(str, row))}" for row in cells.tolist()]
    head = ["# vtk DataFile Version 3.0", "cube", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(rows)} double", *rows]
    path.write_text("\n".join([*head, f"CELLS {len(cells)} {5 * len(cells)}", *corners, f"CELL_TYPES {len(cells)}", *["10"] * len(cells), ""]))


def density(made):
    return made.scene["bodies"][0]["material"]["solid_density_kg_per_m3"]


def test_cells_without_an_id_have_the_id_0(imported, tmp_path):
    assert density(imported(two_materials(tmp_path, "cube.vtk"))) == 500
    assert density(imported(two_materials(tmp_path, "cube.vtk", volume_selection={"id_offset": 1}))) == 1000


def msh41(folder, *groups):
    """A cube in MSH 4.1 with a point and volumes of these physical groups (of each, or none); its tetrahedra are in the first volume."""
    points, cells = sources.CUBE, sources.TETRAHEDRA
    volumes = [f"{k + 1} 0 0 0 1 1 1 {len(of)} {' '.join(map(str, of))} 0" for k, of in enumerate(groups)]
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Entities", f"1 0 0 {len(groups)}", "1 0 0 0 0", *volumes, "$EndEntities"]
    lines += ["$Nodes", f"1 {len(points)} 1 {len(points)}", f"3 1 0 {len(points)}", *map(str, range(1, len(points) + 1))]
    lines += [*(" ".join(map(repr, p)) for p in points.tolist()), "$EndNodes", "$Elements", f"1 {len(cells)} 1 {len(cells)}", f"3 1 4 {len(cells)}"]
    lines += [f"{k + 1} {' '.join(str(c + 1) for c in row)}" for k, row in enumerate(cells.tolist())]
    (folder / "groups.msh").write_text("\n".join([*lines, "$EndElements", ""]))


@pytest.mark.parametrize("groups, offset, rho", [([(1,)], 0, 1000), ([(1, 7)], 0, 1000), ([(1,)], -1, 500), ([()], 0, 500), ([()], 1, 1000), ([(1,), (1, 2)], 0, 1000)])
def test_the_physical_group_of_a_volume_is_its_id(imported, tmp_path, groups, offset, rho):
    msh41(tmp_path, *groups)
    assert density(imported(two_materials(tmp_path, "groups.msh", volume_selection={"id_offset": offset}))) == rho


def test_cells_of_msh_2_have_the_id_0(imported, tmp_path):
    assert density(imported(two_materials(tmp_path, "cube.msh"))) == 500


def test_a_file_of_several_ids_is_refused_where_they_decide(refused, tmp_path):
    msh41(tmp_path, (1,), (2,))
    message = "#/geometry/0/volume_selection: found None; allowed: 1, 0 (the mesh file has no single id that is read)"
    assert message in refused(two_materials(tmp_path, "groups.msh"))
    data = with_(geometry__0__mesh="groups.msh", initial_conditions__velocity=[{"id": 3, "value": [0, 0, 1]}])
    del data["geometry"][0]["volume_selection"]
    assert "#/geometry/0/volume_selection: found None; allowed: 3 (the mesh file" in refused(sources.polyfem(tmp_path, data))


def test_a_start_velocity_is_of_the_id_of_the_file(imported, tmp_path):
    data = with_(initial_conditions__velocity=[{"id": 3, "value": [0, 0, 1]}, {"id": 0, "value": [1, 0, 0]}])
    del data["geometry"][0]["volume_selection"]
    assert imported(sources.polyfem(tmp_path, data)).scene["bodies"][0]["velocity_m_per_s"] == [1, 0, 0]


def test_one_material_needs_no_id(imported, tmp_path):
    data = with_()
    del data["geometry"][0]["volume_selection"]
    assert density(imported(sources.polyfem(tmp_path, data))) == 1000


@pytest.mark.parametrize("tend, dt, steps", [(0.25, 0.1, 3), (0.24, 0.1, 3), (0.3, 0.1, 3), (1.1, 0.1, 11), (0.05, 0.1, 1)])
def test_steps_reach_the_end(imported, tmp_path, tend, dt, steps):
    """The source takes the whole number above the quotient; 1.1 / 0.1 is above 11 by rounding alone."""
    assert imported(sources.polyfem(tmp_path, with_(time={"dt": dt, "tend": tend}))).config["time"]["steps"] == steps


def without_d_hat(scale, **contact):
    data = with_(geometry__0__transformation={"translation": [0, 0.105, 0], "scale": scale})
    del data["contact"]["dhat"]
    data["contact"] |= contact
    return data


def test_a_default_d_hat_above_the_shortest_edge_is_a_part_of_it(imported, tmp_path):
    made = imported(sources.polyfem(tmp_path, without_d_hat(5e-4)))
    assert made.config["formulation"]["d_hat_m"] == pytest.approx(0.8 * 5e-4)
    assert "is above the shortest edge" in made.card["defaults"][0]["why"]
    made = imported(sources.polyfem(tmp_path, without_d_hat(5e-4, dhat_percentage=0.5)))
    assert made.config["formulation"]["d_hat_m"] == pytest.approx(0.5 * 5e-4)
    assert entry_of(made.card, "/contact/dhat_percentage")[0] == "mapped"
    made = imported(sources.polyfem(tmp_path, without_d_hat(0.2)))
    assert made.config["formulation"]["d_hat_m"] == 1e-3


def test_damping_and_a_fixed_stiffness_have_rows_of_their_own(imported, tmp_path):
    solver = {"contact": {"barrier_stiffness": 1e5}, "rayleigh_damping": [{"form": "elasticity", "stiffness_ratio": 0.1}]}
    made = imported(sources.polyfem(tmp_path, with_(solver=solver)))
    assert entry_of(made.card, "/solver/contact/barrier_stiffness") == (
        "changed",
        {"keys": ["/solver/contact/barrier_stiffness"], "count": 1, "was": 1e5, "became": "adaptive", "why": "kappa is fixed in the source, and adapts here"},
    )
    kind, entry = entry_of(made.card, "/solver/rayleigh_damping/0/form")
    assert kind == "not_mapped" and "no Rayleigh damping" in entry["consequence"]
    made = imported(sources.polyfem(tmp_path, with_(solver={"contact": {"barrier_stiffness": "adaptive"}})))
    assert entry_of(made.card, "/solver/contact/barrier_stiffness")[0] == "mapped"


# --- sides

SIDES = [{"id": 4, "axis": "y", "position": 0.2}, {"id": 5, "axis": "x", "position": 0.09}]
TOP, RIGHT = [2, 3, 6, 7], [4, 5, 6, 7]  # vertices of CUBE with y = 0.5, and with x = 0.5


def held(imported, folder, *conditions):
    data = with_(geometry__0__surface_selection=SIDES)
    data["boundary_conditions"]["dirichlet_boundary"] = list(conditions)
    return imported(sources.polyfem(folder, data))


def test_vertices_of_two_conditions_have_the_first_one(imported, tmp_path):
    made = held(imported, tmp_path, {"id": 4, "value": [0, 0, 0]}, {"id": 5, "value": ["t", 0, 0]})
    first, second = made.scene["bodies"][0]["pins"]
    assert (first["indices"], second["indices"]) == (TOP, [4, 5])
    kind, entry = entry_of(made.card, "/boundary_conditions/dirichlet_boundary/1/id")
    assert kind == "changed" and entry["became"] == "all its vertices but 2"
    assert entry_of(made.card, "/boundary_conditions/dirichlet_boundary/1/value")[0] == "mapped"


def test_the_same_value_on_two_sides_changes_nothing(imported, tmp_path):
    made = held(imported, tmp_path, {"id": 4, "value": [0, 0, 0]}, {"id": 5, "value": [0, 0, 0]})
    assert sorted(np.concatenate([pin["indices"] for pin in made.scene["bodies"][0]["pins"]])) == [2, 3, 4, 5, 6, 7]
    assert entry_of(made.card, "/boundary_conditions/dirichlet_boundary/1/id")[0] == "mapped"
    made = held(imported, tmp_path, {"id": [4, 5], "value": [0, 0, 0]})
    assert [pin["indices"] for pin in made.scene["bodies"][0]["pins"]] == [[2, 3, 4, 5, 6, 7]]


# --- damaged input


@pytest.mark.parametrize(
    "selection, message",
    [
        ({"id": 4, "axis": "w", "position": 0}, "/axis: found 'w'; allowed: x, y, z or 1, 2, 3"),
        ({"id": 4, "axis": 0, "position": 0}, "/axis: found 0; allowed: x, y, z or 1, 2, 3"),
        ({"id": 4, "axis": "x", "position": "a"}, "/position: found 'a'; allowed: a number"),
        ({"threshold": "a"}, "/threshold: found 'a'; allowed: a number"),
        ({"threshold": 0.1, "id_offset": 0.5}, "/id_offset: found 0.5; allowed: a whole number"),
        ({"id": 4, "box": 3}, "/box: found 3; allowed: two corners"),
        ({"id": 4, "center": [0, 0, 0], "radius": "a"}, "/radius: found 'a'; allowed: a number"),
        ({"id": 4, "p1": [0, 0, 0], "p2": [0, 0, 0], "radius": 1}, "/p2: found [0, 0, 0]; allowed: another point than p1"),
        ({"id": 4, "normal": [0, 0, 0]}, "/normal: found [0, 0, 0]; allowed: three numbers that are not all 0"),
    ],
)
def test_damaged_selections(refused, tmp_path, selection, message):
    assert f"scene.json#/geometry/0/surface_selection{message}" in refused(sources.polyfem(tmp_path, with_(geometry__0__surface_selection=selection)))


@pytest.mark.parametrize(
    "more, message",
    [
        ({"interpolation": "linear"}, "/interpolation: found 'linear'; allowed: an object with a type"),
        ({"interpolation": {"type": "piecewise_linear", "points": [0, 1]}}, "/interpolation/values: found None; allowed: an array of numbers"),
        ({"interpolation": {"type": "piecewise_linear", "points": [0, 1], "values": [1]}}, "allowed: as many values as points"),
        ({"dimension": True}, "/dimension: found True; allowed: an array"),
    ],
)
def test_damaged_conditions(refused, tmp_path, more, message):
    data = with_(geometry__0__surface_selection=4)
    data["boundary_conditions"]["dirichlet_boundary"] = [{"id": 4, "value": [0, "t", 0], **more}]
    found = refused(sources.polyfem(tmp_path, data))
    assert "scene.json#/boundary_conditions/dirichlet_boundary/0" in found and message in found


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"time__integrator": 3}, "#/time/integrator: found 3; allowed: ImplicitEuler"),
        ({"time__integrator": {"type": ["BDF"]}}, "#/time/integrator: found {'type': ['BDF']}; allowed: ImplicitEuler"),
        ({"units": {"length": ["m"]}}, "#/units/length: found ['m']; allowed: m, dm"),
        ({"geometry__0__unit": ["m"]}, "#/geometry/0/unit: found ['m']; allowed: m, dm"),
        ({"materials__0__type": ["NeoHookean"]}, "#/materials/0/type: found ['NeoHookean']; allowed: NeoHookean"),
        ({"geometry__0__transformation": {"rotation": [1, 2, 3], "rotation_mode": 3}}, "/rotation_mode: found 3; allowed: letters"),
        ({"geometry__0__n_refs": "a"}, "#/geometry/0/n_refs: found 'a'; allowed: a whole number"),
        ({"geometry__0__volume_selection": {"id_offset": "a"}}, "#/geometry/0/volume_selection/id_offset: found 'a'; allowed: a whole"),
    ],
)
def test_damaged_values(refused, tmp_path, changes, message):
    assert message in refused(sources.polyfem(tmp_path, with_(**changes)))
