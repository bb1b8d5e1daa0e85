"""./bench engine list | NAME setup | NAME run SCENE --out DIR | compare [SPEC] | [NAME] cases."""

import argparse
import json
import shlex
import sys
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import fitted
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import finite_number, parser_of, set_argument

from . import environment, launch
from .card import Card, names, read_card
from .scene import SMALLEST, read

OK, NOT_CLEAN, NOT_RUN = 0, 1, 3
SPEC = ROOT / "configs/engines/compare.json"
DOC = """list: the engines of engines/, their variants, what they promise, whether they are installed.
NAME setup: makes the environment of one, from PyPI, below build/engines, and tries every variant (newton
compiles its kernels then: minutes); instant when it is there.
NAME run SCENE --out DIR: one scene, a config or a file of ./bench export-scene, and what ./bench judge says
of it; exit 0: clean, 1: not, 3: it did not run (outcome and log are said), 2: bad input.
compare [SPEC]: all scenes of configs/engines/compare.json under us and all engines: results/engines.json,
results/ENGINES.md, docs/engines.png, or those of the `name` of the spec; what was run is kept and not run
again. compare --starts N adds N jittered starts to what is there: the scatter of errors, depths and
crossings.
NAME cases: four scenes that public trackers report faults of, with the numbers that physics allows, under
one engine (barrierbench: this program); exit 0: all within, 1: not, 3: it is not installed. cases alone:
under all of them, in results/ENGINES_CASES.md; engines that are not installed are listed as skipped."""


def parse(argv: list[str]) -> argparse.Namespace:
    run = "./bench engine mujoco run configs/scenes/twist_cloth.json --out out/twist"
    parser = parser_of("engine", DOC, run, "./bench engine compare --scene hang")
    parser.add_argument(
        "words",
        nargs="+",
        metavar="WORD",
        help="list | NAME setup | NAME run SCENE | compare [SPEC] | [NAME] cases",
    )
    parser.add_argument("--out", type=Path, help="run: folder of frames.npz, engine.json, log.txt, judgement")
    parser.add_argument("--variant", help="run: one of the card (default: its first)")
    set_argument(parser, "run: override of the config")
    parser.add_argument(
        "--engine-set", action="append", default=[], metavar="NAME=VALUE", help="run: of the card"
    )
    parser.add_argument("--limit", type=finite_number, metavar="S", help="run: stopped after so many seconds")
    parser.add_argument(
        "--scene", action="append", default=[], help="compare: these scenes alone; writes no page"
    )
    parser.add_argument(
        "--runs",
        type=Path,
        default=ROOT / "results/runs/engines",
        help="compare, cases: folder of their runs",
    )
    parser.add_argument(
        "--starts",
        type=int,
        default=0,
        metavar="N",
        help="compare: the scenes of the spec's record again from N jittered starts; materials and seconds"
        " stay those of the record (default 0: the start of each scene alone)",
    )
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="ENGINE/VARIANT",
        help="compare --starts: runs these alone, beside ours; what the record has of others stays",
    )
    return parser.parse_args(argv)


def _list() -> int:
    rows = []
    for name in names():
        card = read_card(name)
        there = environment.why_not(card) or "installed"
        rows.append([name, card.data["version"], ", ".join(card.data["variants"]), there])
    print("\n".join(fitted(["engine", "version", "variants", ""], rows)))
    for name in names():
        promise = read_card(name).data["guarantee"]
        print(f"\n{name} promises: {promise['words']}\n  ({promise['citation']})")
    return OK


def _setup(card: Card) -> int:
    """Makes the environment and steps the smallest scene with every variant: what compiles does it now."""
    missing = environment.why_not(card)
    print(environment.setup(card), flush=True)
    for variant in card.data["variants"] if missing else ():
        done = launch.run(card, read(SMALLEST), environment.ENVIRONMENTS / f"{card.name}.check", variant)
        print(f"{card.name} {variant}: {done['outcome']} {done['detail']}".rstrip(), flush=True)
        if done["outcome"] != "ok":
            raise UserError(f"{card.name} is installed and does not run (log: {done['log']})")
    return OK


def _settings(card: Card, words: list[str]) -> dict:
    """NAME=VALUE of --engine-set; values are the adapter's to check. Errors: UserError."""
    out = {}
    for word in words:
        name, mark, value = word.partition("=")
        if not mark or name not in card.data["settings"]:
            raise UserError(
                f"--engine-set {word}: found {name!r}; allowed: {', '.join(card.data['settings'])}"
            )
        out[name] = value
    return out


def _run(card: Card, path: Path, options: argparse.Namespace) -> int:
    from .judged import judge

    variants = card.data["variants"]
    variant = options.variant or next(iter(variants))
    if variant not in variants:
        raise UserError(f"--variant: found {variant!r}; allowed: {', '.join(variants)}")
    if options.out is None:
        raise UserError("--out DIR is needed")
    scene = read(path, options.overrides)
    done = launch.run(card, scene, options.out, variant, _settings(card, options.engine_set), options.limit)
    print(f"{card.name} {variant}: {done['outcome']}: {launch.OUTCOMES[done['outcome']]}")
    if done["outcome"] not in ("ok", "not_finite"):
        print(f"{done['detail']}\nlog: {done['log']}")
        return NOT_RUN
    record = done["run"] | {"judged": judge(options.out, scene)}
    write_whole(options.out / "run.json", json.dumps(record, indent=1) + "\n")
    found = record["judged"]
    print(f"{record['stepping_s']:.3g} s of steps; verdict {found['verdict']} ({options.out / 'judgement'})")
    print(f"promised: {card.data['guarantee']['words']}")
    return OK if found["verdict"] == "clean" else NOT_CLEAN


def _compare(spec: Path, options: argparse.Namespace, argv: list[str]) -> int:
    from .compare import NAME, compared, read_study
    from .figure import paint
    from .report import text_of
    from .starts import earlier, with_kept_starts, with_starts

    say = lambda line: print(f"engine: {line}", file=sys.stderr, flush=True)  # noqa: E731
    study = read_study(spec, options.runs, options.scene, say)
    name = study.spec.get("name", NAME)
    kept = ROOT / f"results/{name}.json"
    if options.starts < 0:
        raise UserError(f"--starts: found {options.starts}; allowed: from 0")
    if options.only and not options.starts:
        raise UserError("--only goes with --starts")
    if options.starts:
        command, before = shlex.join(["./bench", "engine", *argv]), earlier(kept, study)
        if options.only and "command_of_starts" in before:
            command = f"{before['command_of_starts']}`, then `{command}"
        record = with_starts(study, before, options.starts, options.only) | {"command_of_starts": command}
    else:
        record = compared(study) | {"command": shlex.join(["./bench", "engine", *argv])}
        record = with_kept_starts(record, kept)
    record = json.loads(json.dumps(record, allow_nan=False).replace(f"{ROOT}/", ""))  # no path of a machine
    text, page = json.dumps(record, indent=1) + "\n", text_of(record)
    if options.scene:
        print(page)
        return OK
    write_whole(kept, text)
    write_whole(ROOT / f"results/{name.upper()}.md", page)
    paint(record, ROOT / f"docs/{name}.png")
    print(f"results/{name}.json\nresults/{name.upper()}.md\ndocs/{name}.png")
    return OK


def _cases(engines: list[str], options: argparse.Namespace, argv: list[str]) -> int:
    """Of all engines, on a page; of one alone the table is printed."""
    from .cases import HEADER, REFUSED, SKIPPED, all_engines, cells_of, is_well, page_of, rows_of

    say = lambda line: print(f"engine: {line}", file=sys.stderr, flush=True)  # noqa: E731
    rows = rows_of(engines or all_engines(), options.runs / "cases", say)
    print("\n".join(fitted(HEADER, [cells_of(row) for row in rows])))
    if not engines:
        command = shlex.join(["./bench", "engine", *argv])
        page = page_of(rows, command).replace(f"{ROOT}/", "")  # no path of a machine
        write_whole(ROOT / "results/ENGINES_CASES.md", page)
        print("results/ENGINES_CASES.md")
    if all(row["outcome"] in (SKIPPED, REFUSED) for row in rows):  # nothing was judged
        return NOT_RUN
    return OK if all(map(is_well, rows)) else NOT_CLEAN


@reported("engine")
def main(argv: list[str]) -> int:
    options = parse(argv)
    match options.words:
        case ["list"]:
            return _list()
        case ["compare"]:
            return _compare(SPEC, options, argv)
        case ["compare", spec]:
            return _compare(Path(spec), options, argv)
        case ["cases"]:
            return _cases([], options, argv)
        case [name, "cases"]:
            return _cases([name], options, argv)
        case [name, "setup"]:
            return _setup(read_card(name))
        case [name, "run", scene]:
            return _run(read_card(name), Path(scene), options)
    allowed = "list, NAME setup, NAME run SCENE, compare [SPEC], [NAME] cases"
    raise UserError(f"found {' '.join(options.words)!r}; allowed: {allowed}")
