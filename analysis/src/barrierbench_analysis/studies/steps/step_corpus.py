"""./bench study step-corpus: the states of results/steps, their record results/steps.json, results/STEPS.md
and docs/steps.png.
"""

from pathlib import Path

from barrierbench_analysis.io.errors import UserError, passed_on, reported
from barrierbench_analysis.io.json_file import read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import check_folder, write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.start import started

from .step_corpus_figure import paint
from .step_corpus_page import page
from .step_corpus_states import make

SCHEMA = "barrierbench.step_corpus/1"
RESULTS = ROOT / "results"
DOC = """Makes the states from configs/steps/corpus.json, takes each by every step solver and Hessian
(`./bench data steps --corpus`), and writes the page and the figure."""


def take(states: Path, record: Path) -> None:
    """An earlier record is replaced when all states are taken."""
    part = record.with_name("steps.part.json")
    done = started("steps", "--corpus", str(states), "--out", str(part), "--progress", "none")
    if done.returncode != 0:
        kept = f"; {part} has the states that were taken" if part.exists() else ""
        raise UserError(done.stderr.strip() + kept, passed_on(done.returncode))
    part.replace(record)


def write_page(results: Path) -> None:
    record = read_of_schema(results / "steps.json", SCHEMA, "; ./bench data steps --corpus --out makes it")
    write_whole(results / "STEPS.md", page(record))
    paint(record, (ROOT / "docs" if results.resolve() == RESULTS.resolve() else results) / "steps.png")


@reported("study step-corpus")
def main(argv: list[str]) -> int:
    parser = parser_of("study step-corpus", DOC)
    parser.add_argument(
        "--spec", type=Path, default=ROOT / "configs/steps/corpus.json", help="the list of states"
    )
    parser.add_argument(
        "--results", type=Path, default=RESULTS, help="folder of steps/, steps.json and STEPS.md"
    )
    part = parser.add_mutually_exclusive_group()
    part.add_argument("--make", action="store_true", help="only the states")
    parser.add_argument(
        "--only", default="", metavar="NAME,...", help="with --make: these states alone, by name"
    )
    part.add_argument("--take", action="store_true", help="only record, page and figure, of the states there")
    part.add_argument("--table", action="store_true", help="only page and figure, from the record there")
    args = parser.parse_args(argv)
    only = [name for name in args.only.split(",") if name]
    if only and not args.make:
        raise UserError("--only: --make is needed with it")
    check_folder(args.results)
    if not (args.take or args.table):
        make(args.spec, args.results / "steps", only)
    if not (args.make or args.table):
        take(args.results / "steps", args.results / "steps.json")
    if not args.make:
        write_page(args.results)
    return 0
