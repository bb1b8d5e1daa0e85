"""What the tests of the importers share: one call that reads a scene, and its card held against the keys of the source."""

import json
import os
import subprocess
from types import SimpleNamespace

import pytest

from barrierbench_analysis.program.imports import importers, verb
from barrierbench_analysis.program.imports.card import LISTS, is_below


def held(card, keys):
    """Every key of the source stands below exactly one pointer of the card, which has no others; what is unknown."""
    noted = [(name, pointer) for name in LISTS for entry in card[name] for pointer in entry["keys"]]
    for key in keys:
        assert len([pointer for _, pointer in noted if is_below(key, pointer)]) == 1, key
    for _, pointer in noted:
        assert any(is_below(key, pointer) for key in keys), pointer
    assert sum(card["counts"].values()) == len(keys)
    return [pointer for name, pointer in noted if name == "unknown"]


def entry_of(card, key):
    """The list that a key stands in, and its note."""
    return next((name, entry) for name in LISTS for entry in card[name] if any(is_below(key, p) for p in entry["keys"]))


@pytest.fixture
def imported(program, tmp_path, monkeypatch):
    """Reads a scene as the verb does: config, card, keys of the source, unknown keys. The program takes the config."""
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)

    def read(source, *words):
        out = tmp_path / "made" / "scene.json"
        assert verb.main([str(source), "--out", str(out), *words]) == 0
        card = json.loads(out.with_name("scene_card.json").read_text())
        keys = importers.importer_of(source, None).read(source, tmp_path / "again" / "scene.json", None)[1].keys
        config = json.loads(out.read_text())
        return SimpleNamespace(path=out, config=config, card=card, keys=keys, unknown=held(card, keys), scene=config["scene"])

    return read


@pytest.fixture
def refused(program, tmp_path, monkeypatch, capfd):
    """The message about a source that is refused, with exit code 2."""
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)

    def read(source, *words):
        assert verb.main([str(source), "--out", str(tmp_path / "made" / "scene.json"), *words]) == 2
        return capfd.readouterr().err

    return read


@pytest.fixture
def ran(program, tmp_path):
    """The record of a run of an imported config, and its last frame."""

    def run(path, *sets):
        from barrierbench_analysis.program.mesh_arrays import read_frame_file

        out = tmp_path / "run"
        words = [word for one in ("/threads=1", "/output/frames_every=1", *sets) for word in ("--set", one)]
        done = subprocess.run([program, "run", str(path), "--out", str(out), *words], capture_output=True, text=True, env=os.environ, check=False)
        assert done.returncode == 0, done.stderr
        frames = sorted((out / "frames").glob("step_*.ply"))
        return SimpleNamespace(record=json.loads((out / "run.json").read_text()), points=[read_frame_file(f).points for f in frames])

    return run
