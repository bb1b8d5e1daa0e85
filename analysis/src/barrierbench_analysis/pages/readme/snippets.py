"""Every snippet of a page is run, or parsed by the program that it is for: what a reader copies works."""

import contextlib
import functools
import importlib
import io
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.start import in_shell, started

FENCE = re.compile(r"^```([^\n`]*)\n(.*?)^```[ ]*$", re.DOTALL | re.MULTILINE)
PLAIN = ("", "text")  # what is shown and not run: output, a file's layout
CHECKED_CONFIG = (
    "run",
    "data steps",
    "explain",
    "check",
    "study causes",
    "study match",
)  # first file: a config
SAFE = ("list", "help", "eval", "device")  # answer at once
SECONDS = 120
TOOLS = tuple("apt-get cd cp docker echo g++ git mkdir module pip python3 sbatch snakemake source".split())


@dataclass(frozen=True)
class Snippet:
    page: str
    line: int  # of its first line
    language: str
    text: str

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"


def snippets(text: str, page: str) -> list[Snippet]:
    return [
        Snippet(page, text.count("\n", 0, match.start(2)) + 1, match[1].strip(), match[2])
        for match in FENCE.finditer(text)
    ]


def _message(done: subprocess.CompletedProcess) -> str:
    """The last line that it printed."""
    return ["it printed nothing", *(done.stderr.strip() or done.stdout.strip()).splitlines()][-1]


def _fault(done: subprocess.CompletedProcess, good: tuple[int, ...] = (0,)) -> str:
    """Empty where it ended well."""
    return "" if done.returncode in good else _message(done)


def _settings(words: list[str]) -> list[str]:
    values = [words[k + 1] for k, word in enumerate(words[:-1]) if word == "--set"]
    return [word for value in values for word in ("--set", value)]


def _missing_files(words: list[str]) -> list[str]:
    named = re.compile(r"(configs|examples|tests|core|experiments|claims|docs)/[^=]*")
    return [word for word in words if named.fullmatch(word) and not any(ROOT.glob(word))]


@functools.cache
def _helped(row: verbs.Verb) -> subprocess.CompletedProcess:
    """VERB --help, of the program or of this package."""
    verb = row.name
    if row.word:
        return started(row.word, "--help", timeout=SECONDS)
    said, told = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(told):
        try:
            module = importlib.import_module(f"barrierbench_analysis.{row.module}")
            subject = [row.subject] if row.subject else []
            code = module.main([*subject, "--help"]) if row.own_help else 0
        except SystemExit as ended:  # of argparse
            code = ended.code
    if said.getvalue() or told.getvalue():
        return subprocess.CompletedProcess([verb, "--help"], code, said.getvalue(), told.getvalue())
    command = [
        sys.executable,
        str(ROOT / "analysis"),
        *verb.split(),
        "--help",
    ]  # a process of its own answers
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=SECONDS)


@functools.cache
def _tested_modules() -> set[str]:
    """The labels of ctest: what `bench test -L` takes."""
    files = (ROOT / "tests").rglob("CMakeLists.txt")
    return {
        name
        for file in files
        for name in re.findall(r"^\s*bb_test\((\w+)", input_file.read_text(file), re.MULTILINE)
    }


def _test_fault(rest: list[str]) -> str:
    """Of `./bench test ...`: a module is named by -L, and there."""
    if "-R" in rest:
        return "-R takes names of test cases, which change; -L takes a module"
    modules = [rest[k + 1] for k, word in enumerate(rest[:-1]) if word == "-L"]
    unknown = [module for module in modules if module not in _tested_modules()]
    return f"no tests of a module {unknown[0]}" if unknown else ""


def _command_fault(words: list[str]) -> str:
    """Of `./bench VERB ...`; empty when it is well."""
    try:
        call = verbs.call_of(words[1:])
    except UserError as error:
        return str(error)
    if call is None:
        return "" if words[1].startswith("-") else f"{words[1]}: no verb"
    row, rest, note = call
    if note:
        return note
    if row.name == "test" and (fault := _test_fault(rest)):
        return fault
    if missing := _missing_files(rest):
        return f"{missing[0]}: not there"
    if isinstance(row, verbs.Heading) or not (
        row.word or row.module and row.needs in (verbs.ENVIRONMENT, verbs.PROGRAM)
    ):
        return ""  # a list of sub-commands, of the script itself, or of a target that is built for it alone
    helped = _helped(row)
    if helped.returncode != 0:
        return _message(helped)
    flags = [word.split("=")[0] for word in rest if word.startswith("--")]
    if unknown := [flag for flag in flags if not re.search(rf"{flag}\b", helped.stdout)]:
        return f"{row.name} has no {unknown[0]}"
    if row.word in SAFE:
        return _fault(started(row.word, *rest, timeout=SECONDS), (0, 5))
    return ""


def _config_fault(words: list[str]) -> str:
    call = verbs.call_of(words[1:])
    verb, files = call.row.name if call else "", [word for word in words[2:] if word.startswith("configs/")]
    if verb in CHECKED_CONFIG and files:
        if "--plugin" in words:
            return ""  # of a library that the lines before it build
        if any("cudss" in word or '"cuda"' in word or "dense_8m" in word for word in words):
            return ""  # needs a card, or minutes
        how = "explain" if any("/device" in word for word in words) else "check"
        return _fault(started(how, str(ROOT / files[0]), *_settings(words), timeout=SECONDS))
    if verb == "sweep" and files:
        return _fault(started("sweep", str(ROOT / files[0]), "--dry-run", *_settings(words), timeout=SECONDS))
    return ""


def _is_there(command: str) -> bool:
    """Whether a file of the tree or a known tool. A path outside the tree is a placeholder for a place of the
    reader's: whether this machine has it says nothing.
    """
    path = ROOT / os.path.normpath(os.path.expanduser(command))
    return command in TOOLS or not path.is_relative_to(ROOT) or path.exists()


def _shell_faults(snippet: Snippet) -> list[str]:
    faults = []
    for k, line in enumerate(snippet.text.splitlines()):
        for command in re.split(r"&&", line):
            try:
                words = shlex.split(command, comments=True)
            except ValueError as error:  # a quote that is open, or a line that goes on in the next
                faults.append(f"{snippet.page}:{snippet.line + k}: {command.strip()}: {error}")
                continue
            if not words:
                continue
            if "|" in words and "./bench" in words:
                fault = _fault(in_shell(command, cwd=ROOT, timeout=SECONDS))
            elif words[0].endswith("bench") and len(words) > 1:
                fault = _command_fault(words) or _config_fault(words)
            elif words[0] == "python3" and words[1:] and (ROOT / words[1]).is_file():
                fault = "the system's Python may lack the packages: .venv/bin/python"
            else:
                fault = "" if _is_there(words[0]) else f"{words[0]}: not there"
            if fault:
                faults.append(f"{snippet.page}:{snippet.line + k}: {command.strip()}: {fault}")
    return faults


def _spec_faults(snippet: Snippet, file: Path, kind: str) -> list[str]:
    """Of a file that Python reads: held against its schema."""
    try:
        read_spec(file, kind)
    except (UserError, OSError) as error:
        return [f"{snippet.place}: {error}"]
    return []


def _json_faults(snippet: Snippet) -> list[str]:
    try:
        data = json.loads(snippet.text)
    except ValueError as error:
        return [f"{snippet.place}: not JSON: {error}"]
    kind = str(data.get("schema", "")).partition("/")[0].removeprefix("barrierbench.")
    with tempfile.TemporaryDirectory() as folder:  # as if the file lay at the root of the tree
        (Path(folder) / "configs").symlink_to(ROOT / "configs")
        file = Path(folder) / "snippet.json"
        file.write_text(snippet.text)
        if kind not in ("", "config", "sweep"):
            return _spec_faults(snippet, file, kind)
        words = ["sweep", str(file), "--dry-run"] if kind == "sweep" else ["check", str(file)]
        done = started(*words, timeout=SECONDS)
    return [] if done.returncode == 0 else [f"{snippet.place}: {_message(done)}"]


def _python_faults(snippet: Snippet, before: str) -> list[str]:
    """In a folder with one small record where the page has its demo, after those `before` it on the page."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["run", str(ROOT / "configs/scenes/resting_block_1d.json"), "--out", "results/runs/demo/one"]
        words += ["--set", "/time/steps=2", "--set", "/passes/diagnose=true"]
        made = started(*words, cwd=folder, timeout=SECONDS)
        if made.returncode != 0:
            return [f"{snippet.place}: {_message(made)}"]
        path = f"{ROOT / 'analysis/src'}:{ROOT / 'build/release/python'}"
        how = {"cwd": folder, "env": {**os.environ, "PYTHONPATH": path}, "capture_output": True, "text": True}
        words = [sys.executable, "-c", before + snippet.text]
        done = subprocess.run(words, check=False, timeout=SECONDS, **how)
    return [] if done.returncode == 0 else [f"{snippet.place}: {_message(done)}"]


def faults(text: str, page: str) -> list[str]:
    """What does not work, with page and line; a fence of a language that nothing checks as well."""
    judges = {"sh": _shell_faults, "json": _json_faults}
    found, before = [], ""
    for snippet in snippets(text, page):
        if snippet.language == "python":
            wrong = _python_faults(snippet, before)
            before += "" if wrong else f"{snippet.text}\n"
            found += wrong
        elif snippet.language in judges:
            found += judges[snippet.language](snippet)
        elif snippet.language not in PLAIN:
            found.append(
                f"{snippet.place}: a fence of {snippet.language!r}, which nothing checks; allowed:"
                f" {', '.join(judges)}, python, and {PLAIN[1]} for what is no snippet"
            )
    return found
