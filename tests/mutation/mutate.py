"""Puts plausible mistakes into the code one at a time and counts how many the tests catch.

    ./bench dev mutate                        every mutant; what one build can hold together is built together (switches.py)
    ./bench dev mutate --one-by-one           a build for every mutant: about half a minute of one core each
    ./bench dev mutate --only 'newton/*'      those whose table/name matches a pattern (repeatable)
    ./bench dev mutate --list                 the mutants, nothing is built
    ./bench dev mutate --check                only whether every text is still found, a second
    ./bench dev mutate --resume               keeps the verdicts of results.json that were made on this very tree
    ./bench dev mutate --jobs 2               of those built one by one that many at a time, each in a tree of its own

A mutant is an entry of one of the *.toml files beside this script:

    [[mutant]]
    name = "armijo_sign"                  unique within its file, the table
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
import sys
import threading
import time
from pathlib import Path

from campaign import REQUIRED_RATE, Campaign, Verdict, say, table
from mutants import ROOT, Mutant, read_mutants
from tree import Tree, tree_digest

HERE = Path(__file__).resolve().parent


def parse_arguments() -> argparse.Namespace:
    about = "Puts mistakes into the code one at a time and counts those that the tests catch.\n\nexample:\n  ./bench dev mutate --only 'newton/armijo*'"
    parser = argparse.ArgumentParser(prog="bench dev mutate", usage="bench dev mutate [OPTIONS]", description=about, epilog=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", metavar="PATTERN", help="table/name, with * and ?")
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
