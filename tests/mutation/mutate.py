"""Puts plausible mistakes into the code one at a time and counts how many the tests catch.

    ./bench mutate                        every mutant; what one build can hold together is built together (switches.py)
    ./bench mutate --one-by-one           a build for every mutant: about half a minute of one core each
    ./bench mutate --only 'newton/*'      those whose room/name matches a pattern (repeatable)
    ./bench mutate --list                 the mutants, nothing is built
    ./bench mutate --check                only whether every text is still found, a second
    ./bench mutate --resume               keeps the verdicts of results.json that were made on this very tree
    ./bench mutate --jobs 2               of those built one by one that many at a time, each in a tree of its own

A mutant is an entry of one of the *.toml files beside this script:

    [[mutant]]
    name = "armijo_sign"                  unique within its file, which is its room
    file = "core/newton/line_search.cpp"
    find = '''a <= -b'''                 exact text, found exactly once in the file
    replace = '''a <= b'''
    breaks = "what would go wrong for a user, one sentence"
    judges = ["test_newton:LineSearch.*"] in this order until one is red: TARGET, TARGET:GTEST_FILTER or pytest:PATH
    equivalent = "why no test can see it" (optional: then it is expected to survive)

The working tree is copied to build/mutation/ and built there, so the mutants never touch the files you edit. First all
judges have to be green without a mutant. The verdicts: caught (a judge is red, crashes or runs out of time), survived,
equivalent (declared so, and it did survive), broken (the text is not found once, it does not compile, or a mutant
declared equivalent is caught). The exit code is 0 when nothing is broken and at least 90 % of the mutants that are not
equivalent are caught, 1 otherwise, 2 for wrong arguments or a baseline that is not green. Takes part in no `bench test`.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import queue
import re
import subprocess
import sys
import threading
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import switches
from tree import Tree, first_failure, ran_nothing, tree_digest

try:
    import tomllib
except ModuleNotFoundError:
    sys.exit("mutate: Python 3.11 or newer is needed, for tomllib")

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
REQUIRED_RATE = 0.9
FIELDS = {"name", "file", "find", "replace", "breaks", "judges", "equivalent"}


@dataclass(frozen=True)
class Mutant:
    room: str
    name: str
    file: str
    find: str
    replace: str
    breaks: str
    judges: tuple[str, ...]
    equivalent: str = ""

    @property
    def label(self) -> str:
        return f"{self.room}/{self.name}"

    def applied_to(self, text: str) -> str:
        """The file's text with the mistake in it. Raises ValueError when `find` is not there exactly once."""
        count = text.count(self.find)
        if count != 1:
            raise ValueError(f"{self.file}: the text to find is there {count} times, not once: {self.find!r}")
        return text.replace(self.find, self.replace)


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


# ---------------------------------------------------------------- mutants


def read_mutants(folder: Path) -> list[Mutant]:
    """All mutants, in the order of their files so that rebuilds are small. Exits with 2 for a malformed entry."""
    mutants = []
    for path in sorted(folder.glob("*.toml")):
        for entry in tomllib.loads(path.read_text())["mutant"]:
            unknown, missing = set(entry) - FIELDS, FIELDS - {"equivalent"} - set(entry)
            if unknown or missing or not entry["judges"] or entry["find"] == entry["replace"]:
                sys.exit(f"mutate: {path.name}: {entry.get('name')}: unknown {sorted(unknown)}, missing {sorted(missing)}, or it changes or asks nothing")
            mutants.append(Mutant(room=path.stem, **(entry | {"judges": tuple(entry["judges"])})))
    labels = [m.label for m in mutants]
    twice = sorted({label for label in labels if labels.count(label) > 1})
    if twice:
        sys.exit(f"mutate: named twice: {', '.join(twice)}")
    return sorted(mutants, key=lambda m: (m.file, labels.index(m.label)))


def line_of(mutant: Mutant, text: str) -> int:
    """Of the first line that differs, from 1."""
    at = text.find(mutant.find)
    old, new = mutant.find.splitlines(), mutant.replace.splitlines()
    same = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), 0)
    return text.count("\n", 0, max(at, 0)) + 1 + same


# ---------------------------------------------------------------- mutants of one build


@dataclass(frozen=True)
class Switched:
    """A mutant that a build holds beside others."""

    mutant: Mutant
    number: int  # the value of BB_MUTANT that switches it on
    text: str  # of its file, unchanged
    edit: switches.Edit


def switched_rounds(mutants: list[Mutant]) -> list[list[Switched]]:
    """Mutants that one build can hold; a mutant that overlaps another one's text goes into a later round."""
    rounds: list[list[Switched]] = []
    for number, mutant in enumerate(mutants, 1):
        text = (ROOT / mutant.file).read_text()
        edit = switches.switched(number, mutant.find, mutant.replace, text) if mutant.file.endswith(".cpp") and text.count(mutant.find) == 1 else None
        if edit is None:
            continue
        one = Switched(mutant, number, text, edit)
        free = (r for r in rounds if all(o.mutant.file != mutant.file or edit.end <= o.edit.start or edit.start >= o.edit.end for o in r))
        place = next(free, None)
        if place is None:
            place = []
            rounds.append(place)
        place.append(one)
    return rounds


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


# ---------------------------------------------------------------- verdicts


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


def say(text: str) -> None:
    print(text, flush=True)


def table(campaign: Campaign) -> str:
    """One line a mutant, then a line a room and the sums."""
    lines = [f"{v.verdict:<10} {v.label:<44} {v.file}:{v.line}\n{'':11}{v.breaks}" + (f"\n{'':11}-> {v.detail}" if v.verdict != "caught" else "")
             for v in campaign.ordered()]
    lines.append(f"\n{'room':<14}{'caught':>8}{'survived':>10}{'equivalent':>12}{'broken':>8}")
    rooms = sorted({v.label.split("/")[0] for v in campaign.ordered()})
    for room in rooms:
        own = [v.verdict for v in campaign.ordered() if v.label.split("/")[0] == room]
        lines.append(f"{room:<14}{own.count('caught'):>8}{own.count('survived'):>10}{own.count('equivalent'):>12}{own.count('broken'):>8}")
    n, rate = campaign.counts(), campaign.rate()
    lines.append(f"{'all':<14}{n['caught']:>8}{n['survived']:>10}{n['equivalent']:>12}{n['broken']:>8}")
    lines.append(f"caught of those that are not equivalent: {'none ran' if rate is None else f'{100 * rate:.1f} %'}, at least {100 * REQUIRED_RATE:.0f} % are required")
    return "\n".join(lines)


# ---------------------------------------------------------------- command line


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="bench mutate", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", metavar="PATTERN", help="room/name, with * and ?")
    parser.add_argument("--list", action="store_true", help="the mutants, nothing is built")
    parser.add_argument("--check", action="store_true", help="only whether every text is found once")
    parser.add_argument("--resume", action="store_true", help="keep verdicts made on the very same files")
    parser.add_argument("--one-by-one", action="store_true", help="a build for every mutant")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time, each in its own copy of the tree (1)")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "mutation", help="folder of the copies and of results.json")
    return parser.parse_args()


def check_texts(mutants: list[Mutant]) -> int:
    bad = 0
    for mutant in mutants:
        try:
            mutant.applied_to((ROOT / mutant.file).read_text())
        except (ValueError, OSError) as error:
            say(f"broken     {mutant.label}: {error}")
            bad += 1
    say(f"{len(mutants)} mutants, {bad} broken")
    return 1 if bad or not mutants else 0


def kept(results: Path, mutants: list[Mutant]) -> list[Verdict]:
    """Verdicts of an earlier run over exactly these files; mutants and tests are files of the tree too."""
    if not results.is_file():
        return []
    record = json.loads(results.read_text())
    if record["tree"] != tree_digest(ROOT):
        say("the tree has changed since results.json was written: every mutant is tried again")
        return []
    labels = {m.label for m in mutants}
    return [Verdict(**v) for v in record["mutants"] if v["label"] in labels]


def find_data() -> Path | None:
    """The optional test data, which the copies would look for beside themselves."""
    given = os.environ.get("BARRIERBENCH_DATA")
    data = Path(given) if given else ROOT.parent / "shared" / "data"
    return data.resolve() if data.is_dir() else None


def main() -> int:
    arguments = parse_arguments()
    mutants = read_mutants(HERE)
    if arguments.only:
        mutants = [m for m in mutants if any(fnmatch.fnmatch(m.label, pattern) for pattern in arguments.only)]
    if not mutants or arguments.jobs < 1:
        print("mutate: nothing to do: no mutant matches, or --jobs is below 1", file=sys.stderr)
        return 2
    if arguments.list:
        say("\n".join(f"{m.label:<46} {m.file}  {m.breaks}" for m in mutants))
        return 0
    if arguments.check:
        return check_texts(mutants)

    results = arguments.out / "results.json"
    campaign = Campaign(mutants, kept(results, mutants) if arguments.resume else [], results, ninja_jobs=2 if arguments.jobs == 1 else 1)
    trees = [Tree(arguments.out / f"tree{k}", find_data()) for k in range(arguments.jobs)]
    for tree in trees:
        if wrong := campaign.check_baseline(tree):
            print(f"mutate: {wrong}", file=sys.stderr)
            return 2
    if not arguments.one_by_one and (wrong := campaign.try_together(trees[0])):
        print(f"mutate: {wrong}", file=sys.stderr)
        return 2
    groups: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        if mutant.label not in campaign.verdicts:
            groups.setdefault(mutant.file, []).append(mutant)
    files: queue.SimpleQueue = queue.SimpleQueue()
    for group in groups.values():
        files.put(group)
    workers = [threading.Thread(target=campaign.work, args=(tree, files)) for tree in trees]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    campaign.write()
    say("\n" + table(campaign))
    say(f"{len(mutants)} mutants in {time.monotonic() - campaign.start:.0f} s; {results}")
    rate = campaign.rate()
    return 0 if campaign.counts()["broken"] == 0 and rate is not None and rate >= REQUIRED_RATE else 1


if __name__ == "__main__":
    sys.exit(main())
