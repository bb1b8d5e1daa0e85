"""Choices of collision in whole runs: what is chosen is reported, and no choice hides a crossing."""

import json
from pathlib import Path

import pytest
from test_cli import bench, refused, write


def cloths(folder: Path, collisions: list[dict], *, speed: float = -1.0, dt: float = 0.01, steps: int = 12, **scene) -> Path:
    """A small cloth 5 cm above a large one, both without weight, thrown through it or onto it."""
    def cloth(name: str, n: int, size: float, z: float) -> dict:
        return {"name": name, "mesh": {"generator": "grid", "n_x": n, "n_y": n, "size_x_m": size, "size_y_m": size},
                "transform": {"translate_m": [0.013 * z, 0.029 * z, z]}, "material": {"model": "corotational"}}

    small = cloth("small", 3, 0.2, 0.05) | {"velocity_m_per_s": [0, 0, speed]}
    large = cloth("large", 4, 0.7, 0.0) | {"pins": [{"indices": [0, 3, 12, 15]}]}
    return write(folder / "cloths.json", {
        "schema": "barrierbench.config/1",
        "scene": {"bodies": [small, large], "gravity_m_per_s2": [0, 0, 0], "collisions": collisions} | scene,
        "formulation": {"name": "log", "d_hat_m": 0.01}, "matching": {"rule": "as_given"},
        "time": {"dt_s": dt, "steps": steps}})


def run(program: str, folder: Path, config: Path, *more: str) -> dict:
    done = bench(program, "run", config, "--out", folder / "run", "--progress", "none",
                 "--set", "/formulation/stiffness_policy/kappa_N_per_m=200", "--set", "/threads=1", *more)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "run" / "run.json").read_text())


def pair(kind: str) -> list[dict]:
    return [{"a": "small", "b": "large", "kind": kind}]


def touched(record: dict) -> int:
    return sum(step["contacts"]["total"] for step in record["steps"])


def test_in_full_they_hold_each_other(program, tmp_path):
    record = run(program, tmp_path, cloths(tmp_path, pair("ccd")))
    assert record["status"]["outcome"] == "ok" and touched(record) > 0
    other = tmp_path / "other"
    other.mkdir()
    plain = run(program, other, cloths(other, []))
    assert plain["summary"]["state_hash"] == record["summary"]["state_hash"], "ccd is what is not chosen"


@pytest.mark.parametrize("kind", ["off", "proximity", "static"])
def test_less_than_that_never_hides_a_crossing(program, tmp_path, kind):
    """Thrown so fast that a step is longer than the reach of the rows: 20 cm a step."""
    record = run(program, tmp_path, cloths(tmp_path, pair(kind), speed=-20.0))
    assert record["status"]["outcome"] == "penetration", record["status"]
    assert "passes through" in record["status"]["detail"] or "crosses" in record["status"]["detail"]
    assert record["audit"]["violations"] + record["audit"]["crossings"] > 0


def test_off_has_no_contact(program, tmp_path):
    record = run(program, tmp_path, cloths(tmp_path, pair("off")))
    assert record["status"]["outcome"] == "penetration" and touched(record) == 0
    plan = {line["item"]: line for line in record["plan"]}
    assert plan["collisions"]["active"] and plan["collisions"]["reason"] == "pairs of bodies: 1 off"


def test_a_state_that_intersects_is_not_accepted(program, tmp_path):
    """At 1 m/s a step of 10 ms ends in the middle of the other cloth; static stops there, proximity does not know."""
    record = run(program, tmp_path, cloths(tmp_path, pair("static")))
    assert record["audit"]["crossings"] == 0 and touched(record) > 0


def test_a_start_through_each_other_is_refused_by_the_audit(program, tmp_path):
    config = json.loads(cloths(tmp_path, pair("off")).read_text())
    config["scene"]["bodies"][0]["transform"] = {"angle_deg": 90, "axis": [1, 0, 0], "translate_m": [0.01, 0.02, 0.01]}
    record = run(program, tmp_path, write(tmp_path / "crossed.json", config))
    assert record["status"]["outcome"] == "initial_intersection"


def test_explain_says_what_every_pair_does_and_why(program, tmp_path):
    config = cloths(tmp_path, pair("auto") + [{"a": "large", "b": "large", "kind": "off"}])
    text = bench(program, "explain", config).stdout
    message = text.split("pairs of bodies\n")[1].split("\n\n")[0].splitlines()
    lines = {name: rest for name, *rest in (line.split(maxsplit=2) for line in message)}
    assert lines["large|small"] == ["audited", "auto: the surface of small is open"]
    assert lines["large|large"] == ["off", "as given"]
    assert lines["small|small"] == ["ccd", "by default"]
    assert "pairs of bodies\n" not in bench(program, "explain", cloths(tmp_path, [])).stdout


def guarantee(program, config, *more):
    lines = bench(program, "explain", config, *more).stdout.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("guarantee "))
    last = next(i for i, line in enumerate(lines) if line.startswith("matching "))
    return [line[10:] for line in lines[first:last]]


@pytest.mark.parametrize(("kind", "message"), [
    ("proximity", "they may pass through each other"),
    ("off", "contact does nothing between them"),
    ("static", "what passes through as a whole from one state to the next is not seen"),
    ("audited", "a step for which that is not proven is done again as if the pair were ccd"),
])
def test_explain_promises_of_every_pair_what_its_kind_bounds(program, tmp_path, kind, message):
    rest = [{"a": name, "b": name, "kind": kind} for name in ("large", "small")] if kind != "static" else []
    some = guarantee(program, cloths(tmp_path, pair(kind)))
    assert some[0].startswith("line_search, for 2 of 3 pairs of bodies (ccd): no surface passes through")
    assert some[1].startswith(f"1 pair ({kind}): ") and message in some[1] and len(some) == 2
    if rest:
        none = guarantee(program, cloths(tmp_path, pair(kind) + rest))
        assert none[0] == "line_search: of contact what follows, since no pair of bodies collides as ccd"
        assert none[1].startswith(f"3 pairs ({kind}): ") and len(none) == 2
    whole = guarantee(program, cloths(tmp_path, []))
    assert len(whole) == 1 and whole[0].startswith("line_search: no surface passes through another")


def test_explain_promises_nothing_of_states_that_the_step_solver_does_not_refuse(program, tmp_path):
    message = guarantee(program, cloths(tmp_path, pair("static")), "--set", "/step_solver/name=penalty", "--set",
                     "/formulation/shape=quadratic")
    assert message[0].startswith("penalty, for 2 of 3 pairs of bodies (ccd): none against passing through")
    assert message[1] == "1 pair (static): none: the step solver accepts states in which they intersect"


def test_audited_ends_as_ccd_whatever_an_iteration_passes_through(program, tmp_path):
    """Thrown 20 cm a step, with any number of threads: the step is done again, and nothing has passed at its end."""
    records = {}
    for name, kind, threads in [("audited", "audited", 1), ("two", "audited", 2), ("ccd", "ccd", 1)]:
        (tmp_path / name).mkdir()
        config = cloths(tmp_path / name, pair(kind), speed=-20.0, steps=3)
        records[name] = run(program, tmp_path / name, config, "--set", f"/threads={threads}")
    audited, summary = records["audited"], records["audited"]["summary"]
    assert audited["status"]["outcome"] == "ok", audited["status"]
    assert touched(audited) > 0 and audited["audit"]["judged"] > 0 and audited["audit"]["motion_pairs"] > 0
    assert summary["redone_audited"] == sum(step["redone_audited"] for step in audited["steps"]) > 0
    assert summary["audited_queries"] > 0 and summary["retries"] == 0
    assert {step["dt_s"] for step in audited["steps"]} == {0.01}
    assert records["two"]["summary"]["state_hash"] == summary["state_hash"]
    assert records["ccd"]["summary"]["redone_audited"] == records["ccd"]["summary"]["audited_queries"] == 0
    assert records["ccd"]["status"]["outcome"] == "ok"


def test_audited_goes_on_from_a_checkpoint_as_if_it_had_not_stopped(program, tmp_path):
    (tmp_path / "whole").mkdir()
    config = cloths(tmp_path, pair("audited"), speed=-20.0, steps=6)
    whole = run(program, tmp_path / "whole", config)
    assert whole["summary"]["redone_audited"] > 0
    (tmp_path / "cut").mkdir()
    run(program, tmp_path / "cut", config, "--step-limit", "1")
    for _ in range(20):
        again = run(program, tmp_path / "cut", config, "--step-limit", "1", "--resume")
        if again["status"]["outcome"] != "timeout":
            break
    assert again["status"]["outcome"] == "ok" and again["status"]["resumed_from_step"] > 0
    assert again["summary"]["state_hash"] == whole["summary"]["state_hash"]
    for part in ("redone_audited", "audited_queries", "ccd_queries", "newton_iterations"):
        assert again["summary"][part] == whole["summary"][part], part
    for part in ("states", "motions", "state_pairs", "motion_pairs", "judged", "crossings", "violations"):
        assert again["audit"][part] == whole["audit"][part], part


@pytest.mark.parametrize("settings", [
    {"name": "penalty", "/formulation/shape": "quadratic"},
    {"name": "pncg", "/step_solver/pncg_bound": "half_d_hat"},
])
def test_audited_is_refused_where_no_motion_is_bounded(program, tmp_path, settings):
    more = dict(settings)
    solver = more.pop("name")
    words = [f"/step_solver/name={solver}"] + [f"{pointer}={value}" for pointer, value in more.items()]
    chosen = [word for setting in words for word in ("--set", setting)]
    refused(bench(program, "check", cloths(tmp_path, pair("audited")), *chosen),
            "/scene/collisions/0/kind", f"the step solver {solver} bounds no motion")
    text = bench(program, "explain", cloths(tmp_path, pair("auto")), *chosen).stdout
    assert f"auto: the surface of small is open; the step solver {solver} bounds no motion" in text


def test_a_name_that_is_not_there(program, tmp_path):
    refused(bench(program, "check", cloths(tmp_path, [{"a": "smal", "b": "large", "kind": "off"}])),
            "/scene/collisions/0/a", "small, large")
