"""The verdicts on mutants: each in a tree where it was built and its judges ran, or beside others in one build."""

from __future__ import annotations

import json
import queue
import re
import subprocess
import threading
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import switches
from mutants import ROOT, Mutant, Switched, line_of, switched_rounds
from tree import Tree, first_failure, ran_nothing, tree_digest

REQUIRED_RATE = 0.9


@dataclass
class Verdict:
    label: str
    file: str
    line: int
    breaks: str
    verdict: str  # caught, survived, equivalent, broken
    judge: str = ""  # that was red
    detail: str = ""  # the test that failed, or why it is broken or equivalent
    seconds: float = 0.0


def say(text: str) -> None:
    print(text, flush=True)


def refused_numbers(tree: Tree, output: str) -> set[int]:
    """Numbers of the mutants beside the lines that the compiler does not accept."""
    numbers: set[int] = set()
    for path, line in re.findall(r"^(\S+?\.cpp):(\d+):\d+: error:", output, re.MULTILINE):
        lines = (tree.build / path).resolve().read_text().splitlines()
        at = int(line) - 1
        for near in (lines[at : at + 1], lines[max(0, at - 3) : at + 3]):
            found = {int(k) for k in re.findall(r"bb_mutation::on\((\d+)\)", "\n".join(near))}
            if found:
                numbers |= found
                break
    return numbers


class Campaign:
    def __init__(self, mutants: list[Mutant], keep: list[Verdict], results: Path, ninja_jobs: int):
        self.mutants, self.results, self.ninja_jobs = mutants, results, ninja_jobs
        self.verdicts = {v.label: v for v in keep}
        self.judges = sorted({judge for m in mutants for judge in m.judges})
        self.baseline: dict[str, float] = {}  # seconds a judge, green and without a mutant
        self.lock = threading.Lock()
        self.digest, self.start = tree_digest(ROOT), time.monotonic()

    def check_baseline(self, tree: Tree) -> str:
        """Builds and runs every judge on the unchanged tree. Returns what is wrong, empty when all are green."""
        tree.synchronise(ROOT)
        for step in (tree.configure, lambda: tree.make(self.judges, max(self.ninja_jobs, 2))):
            code, output = step()
            if code != 0:
                return f"the unchanged tree does not build:\n{output[-3000:]}"
        for judge in self.judges if not self.baseline else []:
            start = time.monotonic()
            code, output = tree.judge(judge, 900)
            if code != 0 or ran_nothing(judge, code, output):
                return f"{judge} is not green without a mutant (exit {code}): {first_failure(output)}\n{output[-2000:]}"
            self.baseline[judge] = round(time.monotonic() - start, 2)
            say(f"baseline  {judge}  {self.baseline[judge]:.1f} s")
        return ""

    def try_mutant(self, tree: Tree, mutant: Mutant) -> Verdict:
        path = tree.folder / mutant.file
        original = path.read_text()
        verdict = Verdict(mutant.label, mutant.file, line_of(mutant, original), mutant.breaks, "survived")
        start = time.monotonic()
        try:
            path.write_text(mutant.applied_to(original))
            self.ask_judges(tree, mutant, verdict)
        finally:
            path.write_text(original)
        return self.settled(mutant, verdict, start)

    def settled(self, mutant: Mutant, verdict: Verdict, start: float) -> Verdict:
        """The verdict with its time; a mutant that is declared equivalent has to survive."""
        if mutant.equivalent and verdict.verdict != "broken":
            caught = verdict.verdict == "caught"
            verdict.detail = f"declared equivalent, but {verdict.detail}" if caught else mutant.equivalent
            verdict.verdict = "broken" if caught else "equivalent"
        verdict.seconds = round(time.monotonic() - start, 1)
        return verdict

    def note(self, verdict: Verdict) -> None:
        with self.lock:
            self.verdicts[verdict.label] = verdict
            say(f"{verdict.verdict:<10} {verdict.label}  {verdict.seconds:.0f} s  {verdict.judge}  {verdict.detail}")
            self.write()

    def try_together(self, tree: Tree) -> str:
        """Judges all mutants that one build can hold. Returns what is wrong with such a build, empty when it is green."""
        for chosen in switched_rounds([m for m in self.mutants if m.label not in self.verdicts]):
            built = self.build_together(tree, chosen)
            judges = sorted({judge for one in built for judge in one.mutant.judges})
            for judge in judges:
                code, output = tree.judge(judge, 900)
                if code != 0:
                    return f"{judge} is not green in the build that holds all mutants, with none of them on: {first_failure(output)}"
            for one in built:
                start = time.monotonic()
                verdict = Verdict(one.mutant.label, one.mutant.file, line_of(one.mutant, one.text), one.mutant.breaks, "survived")
                tree.environment[switches.ENVIRONMENT] = str(one.number)
                self.ask_judges(tree, one.mutant, verdict, build=False)
                del tree.environment[switches.ENVIRONMENT]
                self.note(self.settled(one.mutant, verdict, start))
            tree.synchronise(ROOT)
        return ""

    def build_together(self, tree: Tree, chosen: list[Switched]) -> list[Switched]:
        """Builds the judges of these mutants with all of them in. Leaves out, and returns without, what the compiler refuses."""
        while chosen:
            for file in {one.mutant.file for one in chosen}:
                mine = [one for one in chosen if one.mutant.file == file]
                tree.write(file, switches.apply(mine[0].text, [one.edit for one in mine]))
            code, output = tree.make(sorted({judge for one in chosen for judge in one.mutant.judges}), max(self.ninja_jobs, 2))
            if code == 0:
                break
            refused = refused_numbers(tree, output)
            say(f"not together: {', '.join(one.mutant.label for one in chosen if one.number in refused) or first_failure(output)}")
            tree.synchronise(ROOT)
            chosen = [one for one in chosen if one.number not in refused] if refused else []
        return chosen

    def ask_judges(self, tree: Tree, mutant: Mutant, verdict: Verdict, build: bool = True) -> None:
        for judge in mutant.judges:  # built one by one: the first is mostly enough
            code, output = tree.make([judge], self.ninja_jobs) if build else (0, "")
            if code != 0:
                verdict.verdict, verdict.detail = "broken", f"does not compile: {first_failure(output)}"
                return
            code, output = tree.judge(judge, 30 + 5 * self.baseline[judge])
            if code != 0:
                verdict.verdict, verdict.judge = "caught", judge
                verdict.detail = first_failure(output) or f"exit {code}"
                return

    def work(self, tree: Tree, files: queue.SimpleQueue) -> None:
        while True:
            try:
                group = files.get_nowait()
            except queue.Empty:
                return
            for mutant in group:
                self.note(self.try_mutant(tree, mutant))

    def ordered(self) -> list[Verdict]:
        return [self.verdicts[m.label] for m in self.mutants if m.label in self.verdicts]

    def counts(self) -> dict[str, int]:
        done = [v.verdict for v in self.ordered()]
        return {name: done.count(name) for name in ("caught", "survived", "equivalent", "broken")}

    def rate(self) -> float | None:
        """Share of caught mutants among those that are not equivalent; None when there is none."""
        n = self.counts()
        judged = n["caught"] + n["survived"] + n["broken"]
        return n["caught"] / judged if judged else None

    def write(self) -> None:
        commit = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "HEAD"], capture_output=True, text=True, check=False)
        record = {"commit": commit.stdout.strip(), "tree": self.digest, "seconds": round(time.monotonic() - self.start, 1),
                  "baseline_s": self.baseline, "counts": self.counts(), "rate": self.rate(),
                  "mutants": [asdict(v) for v in self.ordered()]}
        self.results.parent.mkdir(parents=True, exist_ok=True)
        self.results.write_text(json.dumps(record, indent=1) + "\n")


def table(campaign: Campaign) -> str:
    """One line a mutant, then a line for each table of mutants and the sums."""
    lines = [f"{v.verdict:<10} {v.label:<44} {v.file}:{v.line}\n{'':11}{v.breaks}" + (f"\n{'':11}-> {v.detail}" if v.verdict != "caught" else "")
             for v in campaign.ordered()]
    lines.append(f"\n{'table':<14}{'caught':>8}{'survived':>10}{'equivalent':>12}{'broken':>8}")
    tables = sorted({v.label.split("/")[0] for v in campaign.ordered()})
    for name in tables:
        own = [v.verdict for v in campaign.ordered() if v.label.split("/")[0] == name]
        lines.append(f"{name:<14}{own.count('caught'):>8}{own.count('survived'):>10}{own.count('equivalent'):>12}{own.count('broken'):>8}")
    n, rate = campaign.counts(), campaign.rate()
    lines.append(f"{'all':<14}{n['caught']:>8}{n['survived']:>10}{n['equivalent']:>12}{n['broken']:>8}")
    lines.append(f"caught of those that are not equivalent: {'none ran' if rate is None else f'{100 * rate:.1f} %'}, at least {100 * REQUIRED_RATE:.0f} % are required")
    return "\n".join(lines)
