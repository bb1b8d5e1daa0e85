"""pncg through the program: what its two bounds let happen, what its record says, what does not go with it."""

import pytest
from test_cli import bench, refused
from test_step_solver_baselines import run, shot

from barrierbench_analysis.io.record_file import read_record

SOFT = [word for one in ("/formulation/name=log", "/formulation/stiffness_policy/kappa_N_per_m=1", "/step_solver/max_iterations=2000",
                         "/scene/bodies/0/transform/translate_m=[0.1,0.1,0.0525]") for word in ("--set", one)]  # fmt: skip
PUBLISHED = ["--set", "/step_solver/pncg_bound=half_d_hat"]


def test_what_is_fast_passes_as_published_and_not_with_accd(program, tmp_path):
    """Steps of half of d_hat come to a quarter of it before the sheet, where the soft barrier does not stop the next one."""
    record = run(program, shot(tmp_path, 0), tmp_path / "guarded", "pncg", *SOFT)
    assert record["status"]["outcome"] == "ok", record["status"]
    assert record["audit"]["judged"] and not record["audit"]["crossings"] + record["audit"]["violations"] + record["audit"]["unproven"]
    assert record["summary"]["gap_min_m"] > 0 and record["summary"]["solver"]["pncg_bounds"] > 0
    through = run(program, shot(tmp_path, 0), tmp_path / "published", "pncg", *SOFT, *PUBLISHED)
    assert through["status"]["outcome"] == "penetration" and "sheet" in through["status"]["detail"], through["status"]
    assert through["summary"]["solver"]["pncg_bounds"] > 0


def test_a_record_says_where_a_step_ended_and_how_far_that_is_from_the_solution(program, tmp_path):
    apart = []
    for epsilon in (1e-12, 1e-2):
        record = run(program, shot(tmp_path, 0), tmp_path / f"{epsilon}", "pncg", *SOFT, "--set", f"/step_solver/pncg_epsilon={epsilon}")
        counted = record["summary"]["solver"]
        assert set(counted) == {"pncg_bounds", "pncg_rises", "pncg_fall"} and 0 < counted["pncg_fall"] <= epsilon
        assert counted["pncg_rises"] == 0 and record["summary"]["convergence"] == "not_asked"
        assert record["summary"]["linear_solves"] == record["summary"]["factorizations"] == record["summary"]["hessian_fallbacks"] == 0
        read_record(tmp_path / f"{epsilon}" / "run.json")  # every number is one that the schema allows
        apart.append(record["summary"]["end_error_tolerances"]["max"])
    assert 0 < apart[0] < apart[1]
    line = run(program, shot(tmp_path, 0), tmp_path / "other", "line_search")
    assert not [name for name in line["config"]["step_solver"] if name.startswith("pncg")]


def test_list_and_explain_say_what_it_guarantees(program, tmp_path):
    message = bench(program, "explain", shot(tmp_path, 0), "--set", "/step_solver/name=pncg").stdout
    line = next(line for line in message.splitlines() if line.startswith("guarantee "))
    assert line.split()[1] == "pncg:" and "half_d_hat, as published, none" in line
    assert line.split(": ", 1)[1] in bench(program, "list", "step_solvers").stdout


@pytest.mark.parametrize(("words", "message"), [
    (["/step_solver/pncg_epsilon=1"], ["/step_solver/pncg_epsilon"]),
    (["/step_solver/pncg_bound=ccd"], ["/step_solver/pncg_bound", "half_d_hat"]),
    (["/step_solver/pncg_preconditioner=mas"], ["/step_solver/pncg_preconditioner", "block_jacobi"]),
    (["/step_solver/saddle=escape"], ["/step_solver/saddle"]),
    (["/contact/step_bound=per_vertex"], ["/contact/step_bound"]),
])
def test_what_does_not_go_with_it_is_refused_by_name(program, tmp_path, words, message):
    sets = [word for each in words for word in ("--set", each)]
    refused(bench(program, "check", shot(tmp_path, 0), "--set", "/step_solver/name=pncg", *sets), *message)
