"""The Python environment of an engine: a folder below build/, made by `bench engine NAME setup` alone."""

import shutil
import subprocess
import sys
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole

from .card import Card

ENVIRONMENTS = ROOT / "build/engines"  # git ignores it


def folder(card: Card) -> Path:
    return ENVIRONMENTS / card.name


def python(card: Card) -> Path:
    return folder(card) / "bin/python"


def _recipe(card: Card) -> str:
    """What it has to be made of; its copy says that it is."""
    return f"{folder(card)}\n{input_file.read_text(card.requirements)}"


def why_not(card: Card) -> str:
    """Empty where it is installed as its requirements say, else what is missing."""
    made = folder(card) / "recipe"
    if not python(card).exists() or not made.exists():
        return f"not installed: ./bench engine {card.name} setup"
    if input_file.read_text(made) != _recipe(card):
        return f"installed from other requirements: ./bench engine {card.name} setup"
    return ""


def _said(command: list[str], log: Path) -> None:
    """Runs it with what it says in a log. Errors: UserError with the path of the log and its last line."""
    with log.open("a") as file:
        done = subprocess.run(command, stdout=file, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        last = (input_file.read_text(log).strip().splitlines() or ["nothing was said"])[-1]
        raise UserError(f"{' '.join(command[:4])} ended with {done.returncode}: {last} (log: {log})")


def setup(card: Card) -> str:
    """Makes the environment, anew where requirements have changed; what was done. Errors: UserError."""
    if not why_not(card):
        return f"{card.name}: is there, {folder(card)}"
    log = ENVIRONMENTS / f"{card.name}.setup.log"
    shutil.rmtree(folder(card), ignore_errors=True)
    ENVIRONMENTS.mkdir(parents=True, exist_ok=True)
    log.unlink(missing_ok=True)
    base = getattr(sys, "_base_executable", sys.executable)
    _said([base, "-m", "venv", str(folder(card))], log)
    pip = [str(python(card)), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    _said([*pip, "-r", str(card.requirements)], log)
    _said([str(python(card)), "-c", f"import {card.data['module']}"], log)
    write_whole(folder(card) / "recipe", _recipe(card))
    return f"{card.name}: installed in {folder(card)}"
