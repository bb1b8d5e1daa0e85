"""The records below a folder, or in an archive of ./bench data archive, held against their files. Of every
record: it is read as strictly as for a comparison; config_id and run_id are those of what it holds; counts
and largest values of its summary are those of its steps; its outcome agrees with its checks and its audit;
every file that it names is there with the sha256 that it names; and no other file lies in its folder but, of
a run that was cut, its checkpoint, whose contents are not judged. Of every sweep: each case has its record,
and no record is of no case. A number that is none of these may be edited unseen: --rerun N makes N of the
runs again, chosen by --seed, and asks for the same state and the same numbers to the last bit; --archive FILE
holds every file against those that were packed.

Exit codes: 0 nothing is wrong, 1 something is, or nothing was judged, 2 no folder, no archive.
"""

import argparse
import random
import tempfile
from collections import Counter
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.record_file import RecordError, leaves
from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.program.arguments import count_from_0, parser_of
from barrierbench_analysis.program.start import require_program, started
from barrierbench_analysis.studies.gate.determinism import same_state
from barrierbench_analysis.studies.gate.records import read_run
from barrierbench_analysis.tables.archive import read_manifest, study

from .held import Held, against, held_folder
from .named import meshes

SAME, DIFFERS, NOT_JUDGED = "same", "differs", "not judged"
FOUND = ("scene", "matching", "audit", "validity", "summary", "steps")  # sections with what a run has found
OF_THE_MACHINE = set(
    "time wall_s solve_s unaccounted_s time_s surface_gap_time_s start_check_s peak_rss_bytes".split()
)


def _arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("verify", __doc__, "./bench verify strip.zip --rerun 2")
    parser.add_argument(
        "study", type=Path, metavar="STUDY", help="a folder with records, or an archive of one"
    )
    parser.add_argument(
        "--rerun", type=count_from_0, default=0, metavar="N", help="make N runs again (default: 0)"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the choice of these runs (default: 1)")
    parser.add_argument("--archive", type=Path, metavar="FILE.zip", help="an archive of this folder")
    return parser.parse_args(argv)


def _rerun(path: Path) -> tuple[str, str]:
    """Makes a run again: same, differs or not judged, and what was found."""
    with tempfile.TemporaryDirectory(prefix="barrierbench-verify-") as scratch:
        again = Path(scratch) / "again"
        done = started("run", str(path), "--out", str(again), "--progress", "none")
        try:
            old, new = read_run(path), read_run(again)
        except RecordError:
            message = (
                done.stderr.strip() or done.stdout.strip() or "the program printed nothing"
            ).splitlines()[-1]
            return DIFFERS, f"exit code {done.returncode}: {message}"
        (state,) = same_state("", old, new, False)
        if state.verdict == "not_judged":
            return NOT_JUDGED, state.note
    unlike = differences(old.record, new.record)
    more = f" (and {len(unlike) - 1} more)" if len(unlike) > 1 else ""
    return (DIFFERS, unlike[0] + more) if unlike else (SAME, "")


def found_by(record: dict) -> dict[str, object]:
    """Place -> every value that a run has found, without times and what else of the machine it says. Its
    inputs count by their contents: it names them from its folder, which is another one.
    """
    known = {"status": {"outcome": record["status"]["outcome"]}, **{name: record[name] for name in FOUND}}
    known["scene"] = {**known["scene"], "mesh_sha256": sorted(set(meshes(record).values()))}
    return {
        place: value
        for place, value in leaves(known)
        if not {part.removesuffix("_status") for part in place.split("/")} & OF_THE_MACHINE
    }


def differences(old: dict, new: dict) -> list[str]:
    """What two records of one run do not share."""
    before, now = found_by(old), found_by(new)
    return [
        f"{place} is {before.get(place, 'not there')} and {now.get(place, 'not there')} in the rerun"
        for place in dict.fromkeys([*before, *now])
        if before.get(place, NOT_JUDGED) != now.get(place, NOT_JUDGED)
    ]


def rerun(held: Held, root: Path, most: int, seed: int) -> Counter:
    """Makes a seeded sample of the records again in which nothing is wrong."""
    require_program()
    chosen = random.Random(seed).sample(held.good, min(most, len(held.good)))
    counts = Counter()
    for path in chosen:
        verdict, why = _rerun(path)
        counts[verdict] += 1
        if verdict == DIFFERS:
            held.add("rerun differs", path, root, why)
        elif verdict == NOT_JUDGED:
            print(f"{path.relative_to(root)}: the rerun is not judged: {why}")
    return counts


def report(held: Held, reruns: Counter, requested: int) -> int:
    """Prints what is wrong and the counts; the exit code."""
    if held.wrong:
        print("\n".join(fitted(["what", "file", "found"], [list(one) for one in held.wrong])))
    kinds = Counter(kind for kind, _, _ in held.wrong)
    wrong = ", ".join(f"{n} {kind}" for kind, n in sorted(kinds.items())) or "nothing wrong"
    print(
        f"judged: {held.records} records with {held.files} files, {held.ids} ids and {held.sums} numbers of"
        f" summaries; {held.cases} cases of sweeps; {held.listed} files against an archive"
    )
    if held.outside:
        print(
            f"not judged: {sum(map(len, held.outside.values()))} inputs of {len(held.outside)} records lie"
            " outside the archive, and these records cannot be run again from it"
        )
    if requested:
        print(
            f"reruns: {reruns.total()} of {requested} requested: {reruns[SAME]} the same to the last bit,"
            f" {reruns[DIFFERS]} differ, {reruns[NOT_JUDGED]} not judged"
        )
    idle = not held.judged or (requested and not reruns[SAME] + reruns[DIFFERS])
    print(f"verify: {wrong}" if not idle else f"verify: {wrong}, and red: nothing was judged")
    return 1 if held.wrong or idle else 0


@reported("verify")
def main(argv: list[str]) -> int:
    args = _arguments(argv)
    with study(args.study) as (root,):
        held = held_folder(root, of_archive=root != args.study)
        if args.archive:
            if held.of_archive:
                raise UserError(
                    f"--archive: found {args.study}, an archive itself; a folder is needed with it"
                )
            against(root, read_manifest(args.archive), held)
        reruns = rerun(held, root, args.rerun, args.seed) if args.rerun else Counter()
        return report(held, reruns, args.rerun)
