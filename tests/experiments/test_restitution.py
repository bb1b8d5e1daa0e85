"""A bounce that keeps a share of its speed, in a whole run of the program."""

import json
import subprocess
from pathlib import Path

import pytest

from analysis.accuracy.state import read_motion

SCENE = Path(__file__).resolve().parents[2] / "configs" / "scenes" / "half_bounce.json"


def peak(program: str, folder: Path, *words: str) -> float:
    """Height of the first peak after the contact, as a share of the height of fall, both from where the contact begins."""
    d_hat = json.loads(SCENE.read_text())["formulation"]["d_hat_m"]
    done = subprocess.run(
        [program, "run", str(SCENE), "--out", str(folder), "--progress", "none", "--set", "/output/frames_every=20", *words],
        capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    motion = read_motion(folder)
    assert motion.record["status"]["outcome"] == "ok"
    assert sum(step["contacts"]["total"] > 0 for step in motion.record["steps"]) > 50, "steps in contact"
    height = motion.x[:, :, 2].mean(axis=1) - d_hat
    lowest = int(height.argmin())
    highest = lowest + int(height[lowest:].argmax())
    assert height[lowest] < 0 and highest < len(height) - 1, "the run ends behind the peak"
    return height[highest] / height[0]


def test_half_of_the_speed_is_a_quarter_of_the_height(program, tmp_path):
    """Less, for the weight that acts during the contact, and since the load is one step old."""
    assert peak(program, tmp_path / "run") == pytest.approx(0.25, abs=0.03)


def test_without_it_the_height_is_kept(program, tmp_path):
    assert peak(program, tmp_path / "run", "--set", "/scene/obstacles/0/restitution=1") == pytest.approx(1, abs=0.03)


def test_what_it_takes_is_what_the_bounce_loses(program, tmp_path):
    """The step says what restitution took; the integrator takes some too, as a bounce without restitution shows."""
    def of(name: str, e: float) -> tuple[float, list]:
        folder = tmp_path / name
        peak(program, folder, "--set", f"/scene/obstacles/0/restitution={e}")
        steps = json.loads((folder / "run.json").read_text())["steps"]
        energies = [step["kinetic_J"] + step["gravity_J"] + step["contact_J"] + step["elastic_J"] for step in steps]
        return energies[0] - energies[-1], [step["restitution_dissipation_J"] for step in steps]

    lost, taken = of("half", 0.5)
    lost_without, none = of("all", 1)
    assert all(work is None for work in none), "nothing is damped"
    assert all(work >= 0 for work in taken) and sum(work > 0 for work in taken) > 50
    assert sum(taken) == pytest.approx(lost - lost_without, rel=0.05)
