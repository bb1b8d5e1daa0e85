"""The verb device answers on any machine: exit 0 with a card, 5 with the reason where there is none."""

import json
import subprocess
from pathlib import Path

import pytest

PROGRAM = Path(__file__).resolve().parents[2] / "build/release/experiments/barrierbench"

pytestmark = pytest.mark.skipif(not PROGRAM.exists(), reason="the program is not built")


def device(*arguments):
    return subprocess.run([PROGRAM, "device", *arguments], capture_output=True, text=True, check=False)


def test_json_and_words_say_the_same():
    requested, message = device("--json", "--measure"), device()
    found = json.loads(requested.stdout)
    assert requested.returncode == message.returncode == (0 if found["usable"] else 5)
    assert found["schema"] == "barrierbench.device/1" and requested.stderr == message.stderr == ""
    if found["usable"]:
        assert found["card"] in message.stdout and found["copy"]["on_the_card_Bps"] > 1e9
    else:
        assert found["why"] and found["why"] in message.stdout and found["copy"] is None
        assert any(word in found["why"] for word in ("without CUDA", "driver", "card"))
