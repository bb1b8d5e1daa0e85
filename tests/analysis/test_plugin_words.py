"""--plugin of the verbs that run the program: handed on before the program's own verb, each file with its whole path."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from barrierbench_analysis.tables import causes
from barrierbench_analysis.pages.claims import verb as claims
from barrierbench_analysis.studies.kit.study import verb as study
from barrierbench_analysis.studies.matching import match

ROOT = Path(__file__).resolve().parents[2]
STAND_IN = """#!{python}
import json, sys
with open({log!r}, "a") as log:
    log.write(json.dumps(sys.argv[1:]) + "\\n")
sys.exit("it runs nothing")
"""
CONFIG = str(ROOT / "configs/scenes/resting_block_1d.json")


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """asked(verb, *words) -> what this verb requested of a program that runs nothing, from a folder with two plugins."""
    stand_in, log = tmp_path / "program", tmp_path / "log"
    stand_in.write_text(STAND_IN.format(python=sys.executable, log=str(log)))
    stand_in.chmod(0o755)
    (tmp_path / "here").mkdir()
    for file in (tmp_path / "here/one.so", tmp_path / "two.so"):
        file.touch()
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(stand_in))
    monkeypatch.setattr(claims, "FILE", tmp_path / "claims.jsonl")

    def call(verb, *words) -> list[list[str]]:
        log.unlink(missing_ok=True)
        assert verb([*map(str, words), "--plugin", "one.so", "--plugin", "../two.so"]) == 2
        return [json.loads(line) for line in log.read_text().splitlines()]

    return call


VERBS = {"match": (match.main, "sweep", [CONFIG, "--out", "out"]), "study": (study.main, "sweep", [ROOT / "configs/pareto/quick.json", "--out", "out"]),
         "claims of records": (claims.main, "sweep", ["K3", "--runs", "runs"]), "claims of functions": (claims.main, "eval", ["H8", "--runs", "runs"]),
         "causes": (causes.main, "run", [CONFIG, "--out", "out"])}


@pytest.mark.parametrize("name", VERBS)
def test_a_plugin_is_handed_to_the_program(asked, tmp_path, name):
    main, verb, words = VERBS[name]
    given = asked(main, *words)
    assert given
    for arguments in given:
        assert arguments[:5] == ["--plugin", str(tmp_path / "here/one.so"), "--plugin", str(tmp_path / "two.so"), verb], arguments


def test_a_formulation_of_a_plugin_is_matched(program, build_folder, tmp_path, monkeypatch):
    plugin = build_folder / "examples/plugins/plugin_inverse_shape.so"
    if not plugin.exists():
        pytest.skip(f"{plugin} is not built")
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    formulation = {"formulation": {"shape": "inverse", "argument": "gap", "stiffness_policy": {"name": "fixed"}, "d_hat_m": 0.01}}
    (tmp_path / "inverse.json").write_text(json.dumps(formulation))
    words = [CONFIG, "--formulations", str(tmp_path / "inverse.json"), "--vary", "contact", "--set", "/time/steps=30", "--out", str(tmp_path / "out")]
    assert match.main([*words, "--plugin", str(plugin)]) in (0, 1)
    rows = json.loads((tmp_path / "out/match.json").read_text())["formulations"]
    assert [row["formulation"] for row in rows] == ["log", "inverse"] and rows[1]["matching"]["kappa_N_per_m"] > 0
    for path in (tmp_path / "out").glob("*/run.json"):
        (named,) = json.loads(path.read_text())["provenance"]["plugins"]
        assert named["file"].endswith("plugin_inverse_shape.so")
    assert match.main([*words, "--out", str(tmp_path / "without")]) == 2  # nobody else knows the shape


def test_a_shape_of_a_plugin_has_no_kernels_and_is_refused_on_a_card(program, build_folder, tmp_path):
    plugin = build_folder / "examples/plugins/plugin_inverse_shape.so"
    if not plugin.exists():
        pytest.skip(f"{plugin} is not built")
    config = tmp_path / "a.json"
    config.write_text(json.dumps({
        "schema": "barrierbench.config/1", "scene": {"name": "drape", "n": 4}, "time": {"steps": 2}, "device": "cuda",
        "formulation": {"shape": "inverse", "argument": "gap", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 100}}}))
    run = [program, "--plugin", str(plugin), "run", str(config), "--out", str(tmp_path / "out")]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stdout == "", done.stderr
    assert f'{config}#/formulation/shape: found "inverse", which has no kernel of its own; allowed: a shape that ./bench list shapes names, or a formula, on a card' in done.stderr, done.stderr
    assert "shapes of plugins" in done.stderr and "run with device cpu or host" in done.stderr and done.stderr.count("#/") == 1, done.stderr
    assert not (tmp_path / "out").exists()
    on_host = [*run, "--set", '/device="host"']
    done = subprocess.run(on_host, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "#/strain_limit/shape: found inverse" in done.stderr, done.stderr
    for words in ([*on_host, "--set", "/strain_limit/enabled=false"], [*run, "--set", '/device="cpu"']):
        done = subprocess.run([*words, "--replace"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
