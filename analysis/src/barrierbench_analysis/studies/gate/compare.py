"""Two records, or two folders of them, metric by metric: what differs, in which direction, and whether that
is a regression.

The first is the reference. No envelope is known for it, so numbers may move as far as the tolerances of their
kind allow (docs/results/method/gates.md). Exit codes: 0 nothing regressed, 1 something did, 2 the two cannot
be compared.
"""

from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.tables.archive import study

from . import configs, invariants, judge, meanings, report
from .determinism import same_state
from .finding import Finding, failures, without_subject
from .measure import measure
from .records import Run, find_runs, read_run


def _pairs(a: Path, b: Path, common: bool) -> list[tuple[str, Path, Path]]:
    old, new = find_runs(a), find_runs(b)
    if len(old) == len(new) == 1:
        return [(next(iter(new.values())).parent.name or "run", *old.values(), *new.values())]
    lonely = [f"{place}: only in {a}" for place in old.keys() - new.keys()] + [
        f"{place}: only in {b}" for place in new.keys() - old.keys()
    ]
    if lonely and not common:
        raise UserError(
            "\n".join([*sorted(lonely), "these records have no counterpart (--common: compare the others)"])
        )
    if not old.keys() & new.keys():
        raise UserError(f"{a} and {b} have no record in common")
    return [(place, old[place], new[place]) for place in sorted(old.keys() & new.keys())]


def compare(case: str, old: Run, new: Run, different_configs: bool = False) -> list[Finding]:
    """Raises UserError when the configs differ and that was not asked for."""
    differ = configs.differences(old.section("config"), new.section("config"))
    bare = [run.path for run in (old, new) if not run.section("config")]
    all_the_same = "(--different-configs: compare all the same)"
    if bare and not different_configs:
        raise UserError(
            f"{case}: {' and '.join(map(str, bare))}: no config, so that nothing says whether the two are"
            f" runs of one configuration {all_the_same}"
        )
    if differ and not different_configs:
        head = f"{case}: the configs differ in {len(differ)} settings {all_the_same}"
        raise UserError("\n  ".join([head, *differ]))
    findings = invariants.torn(case, old) + invariants.judge_stored(case, new)
    findings += meanings.of_other_version(case, [old, new], old.version, new.version)
    findings += same_state(case, old, new, bool(differ))
    same_kind = bool(old.made_by["compiler"]) and old.made_by == new.made_by
    another = bool(differ) or old.section("schema").get("version") != new.section("schema").get("version")
    new_verdict = judge.NOT_JUDGED if another else judge.NOT_IN_THE_REFERENCE
    before, now, not_compared = meanings.shared(
        case, judge.around(measure(old)), measure(new), old.version, new.version
    )
    return findings + not_compared + judge.numbers(case, before, now, same_kind, new_verdict)


@reported("gate compare")
def main(argv: list[str]) -> int:
    parser = parser_of("gate compare", __doc__)
    parser.add_argument(
        "a",
        type=Path,
        help="reference: a run.json, its folder, a folder of such folders, or an archive of one",
    )
    parser.add_argument("b", type=Path, help="what is judged")
    parser.add_argument(
        "--different-configs",
        action="store_true",
        help="compare although settings differ; they are listed all the same",
    )
    parser.add_argument(
        "--common", action="store_true", help="of two folders compare the records that both have"
    )
    report.verbose_argument(parser)
    parser.add_argument("--json", type=Path, metavar="FILE", help="the answer as JSON")
    args = parser.parse_args(argv)
    findings: list[Finding] = []
    with study(args.a, args.b) as (first, second):
        for case, a, b in _pairs(first, second, args.common):
            old, new = read_run(a), read_run(b)
            differ = configs.differences(old.section("config"), new.section("config"))
            for line in differ if args.different_configs else ():
                print(f"{case}: differs in {line}")
            findings += compare(case, old, new, args.different_configs)
    findings += without_subject(findings, ("I", "III"))
    report.say(findings, args.verbose)
    if args.json:
        report.write_json(args.json, "barrierbench.compare", findings, a=str(args.a), b=str(args.b))
    return 1 if failures(findings) else 0
