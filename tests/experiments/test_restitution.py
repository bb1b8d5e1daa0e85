"""A bounce that keeps a share of its speed, in whole runs of the program."""

import json
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

from barrierbench_analysis.tables.accuracy.state import read_motion

SCENE = Path(__file__).resolve().parents[2] / "configs" / "scenes" / "half_bounce.json"


class Bounce(NamedTuple):
    peak: float  # height of the first peak after the contact, as a share of the height of fall, both from where the contact begins
    lost: float  # J, from the first step to the last
    taken: list  # J a step, what restitution says that it took


def bounce(program: str, folder: Path, *words: str) -> Bounce:
    d_hat = json.loads(SCENE.read_text())["formulation"]["d_hat_m"]
    done = subprocess.run(
        [program, "run", str(SCENE), "--out", str(folder), "--progress", "none", "--set", "/output/frames_every=20", *words],
        capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    motion = read_motion(folder)
    assert motion.record["status"]["outcome"] == "ok"
    steps = motion.record["steps"]
    assert sum(step["contacts"]["total"] > 0 for step in steps) > 50, "steps in contact"
    height = motion.x[:, :, 2].mean(axis=1) - d_hat
    lowest = int(height.argmin())
    highest = lowest + int(height[lowest:].argmax())
    assert height[lowest] < 0 and highest < len(height) - 1, "the run ends behind the peak"
    energies = [step["kinetic_J"] + step["gravity_J"] + step["contact_J"] + step["elastic_J"] for step in (steps[0], steps[-1])]
    return Bounce(height[highest] / height[0], energies[0] - energies[1], [step["restitution_dissipation_J"] for step in steps])


@pytest.fixture(scope="module")
def half(program, tmp_path_factory) -> Bounce:
    """The scene as it is, which keeps half of the speed."""
    return bounce(program, tmp_path_factory.mktemp("half"))


@pytest.fixture(scope="module")
def whole(program, tmp_path_factory) -> Bounce:
    """All of the speed: no restitution."""
    return bounce(program, tmp_path_factory.mktemp("whole"), "--set", "/scene/obstacles/0/restitution=1")


def test_half_of_the_speed_is_a_quarter_of_the_height(half):
    """Less, for the weight that acts during the contact, and since the load is one step old."""
    assert json.loads(SCENE.read_text())["scene"]["obstacles"][0]["restitution"] == 0.5
    assert half.peak == pytest.approx(0.25, abs=0.03)


def test_without_it_the_height_is_kept(whole):
    assert whole.peak == pytest.approx(1, abs=0.03)


def test_what_it_takes_is_what_the_bounce_loses(half, whole):
    """The step says what restitution took; the integrator takes some too, as a bounce without restitution shows."""
    assert all(work is None for work in whole.taken), "nothing is damped"
    assert all(work >= 0 for work in half.taken) and sum(work > 0 for work in half.taken) > 50
    assert sum(half.taken) == pytest.approx(half.lost - whole.lost, rel=0.05)
