"""Calibrates every formulation by one matching rule on one scene, runs each, and says whether their outcomes
may be compared.

The program does the mathematics: its calibration run finds the loads, its matching rule turns them into
stiffness, and it judges the outcomes when the runs are over (docs/theory/barriers.md and audit.md).
Here they are requested and shown; match.json beside the records keeps the answer.

Exit codes: 0 all are comparable, 1 some are not, 2 bad input, or nothing to compare.
"""

import argparse
import json
from pathlib import Path

from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import finite_number, parser_of, plugin_argument, set_argument
from barrierbench_analysis.studies.kit.formulations import REFERENCE, VARY, label, preset, settings
from barrierbench_analysis.studies.kit.runs import (
    Sweep,
    check_equal,
    check_varied,
    collect,
    inputs_sha256,
    run,
    sweep,
)
from barrierbench_analysis.tables.numbers import significant

DEFAULT = ("log", "quadratic", "cubic", "cubic_dynamic_lagged", "cubic_dynamic_consistent")
RULES = ("equal_force", "equal_curvature")
SCHEMA = "barrierbench.match/1"
COLUMNS = "formulation,contact,load (N),limit,smallest gap,farthest from log,outcome,verdict".split(",")
KEPT = """rule theta load_source load_N contact contact_step contact_answer contacts_left_out left_out_contact
left_out_N kappa_N_per_m scale capacity_N limit_load_source limit_load_N_per_m limit_stiffness_N_per_m
limit_scale pilot_note""".split()  # of the section `matching` of a record


def make_sweep(config: Path, formulations: list[str], rule: str, theta: float, vary: str) -> Sweep:
    """One case a formulation, the log first: it is the reference, whether it was named or not."""
    base = read_object(config)
    chosen = base.get("formulation")
    d_hat = chosen.get("d_hat_m") if isinstance(chosen, dict) else None
    names = list(dict.fromkeys([REFERENCE, *formulations]))
    if names == [REFERENCE]:
        raise UserError(
            f"--formulations: found {REFERENCE} alone; a formulation to compare with it is needed"
        )
    for name in names:
        preset(name)
    cases = [
        {"label": label(name), "set": settings(name, vary, d_hat)}
        | ({"reference": True} if name == REFERENCE else {})
        for name in names
    ]
    common = {"/matching/rule": rule, "/matching/theta": theta, "/passes/time": True, "/passes/audit": True}
    return sweep("match", config, common, cases)


def _row(name: str, record: dict) -> dict:
    """What match.json says of a formulation; numbers as the record has them."""
    matching, judged = record["matching"], record["comparability"]
    comparable, why = judged["verdict"] == "comparable", judged["reason"]
    if not record["audit"]["enabled"] or record["audit"]["judged"] == 0:
        comparable, why = False, "the audit judged nothing, so that a crossing would not be seen"
    return {
        "formulation": name,
        "run_id": record["ids"]["run_id"],
        "matching": {key: matching.get(key) for key in KEPT},
        "gap_min_rel": judged.get("gap_rel"),
        "gap_ratio": judged.get("ratio"),
        **{key: judged.get(key) for key in ("pair", "pair_quantile", "pair_ratio")},
        "outcome": record["status"]["outcome"],
        "crossings": record["audit"]["crossings"],
        "newton_iterations": record["summary"]["newton_iterations"],
        "verdict": "comparable" if comparable else "not_comparable",
        "why": why,
    }


def judge(made: Sweep, records: dict[str, dict], vary: str) -> dict:
    """The content of match.json. Errors: UserError where the reference never is in contact, or records are
    not of one config.
    """
    check_equal(records)
    check_varied(records[made.notes[0]], vary, "--vary limit")
    rows = [_row(note.partition(": ")[2], records[note]) for note in made.notes]
    reference = rows[0]
    if reference["outcome"] == "ok" and reference["gap_min_rel"] is None:
        scene = records[made.notes[0]]["labels"]["scene"]
        raise UserError(
            f"scene {scene!r}: no contact at the end of any step with {REFERENCE}: there is no gap to"
            " compare; a scene whose bodies touch is needed (or more steps: --set /time/steps=N)"
        )
    first = records[made.notes[0]]
    return {
        "schema": SCHEMA,
        "scene": first["labels"]["scene"],
        "reference": REFERENCE,
        "vary": vary,
        "rule": first["matching"]["rule"],
        "theta": first["matching"]["theta"],
        "max_gap_ratio": first["comparability"]["max_ratio"],
        "formulations": rows,
    }


def _stiffness(kappa: float | None, scale: float | None) -> str:
    if kappa is not None:
        return significant(kappa, 4, unit=" N/m")
    return "as given" if scale is None else f"own x {scale:.4g}"


def _farthest(row: dict) -> str:
    """The pair of bodies whose gaps differ most from the log's, and how many times."""
    return "-" if row["pair_ratio"] is None else f"x {row['pair_ratio']:.3g}, {row['pair']}"


def text(answer: dict) -> str:
    """The table, and a line for each that is not comparable."""
    matched = answer["formulations"][0]["matching"]  # of the log
    head = (
        f"{answer['rule']}, theta {answer['theta']:g}; scene {answer['scene']}; load of"
        f" {matched['load_source']}"
    )
    if matched["contact"]:
        head += f": {matched['contact']} at the end of step {matched['contact_step']:g}"
    if matched["pilot_note"]:
        head += f" ({matched['pilot_note']})"
    lines, reasons = [], []
    for row in answer["formulations"]:
        m = row["matching"]
        limit = _stiffness(m["limit_stiffness_N_per_m"], m["limit_scale"])
        lines.append(
            (
                row["formulation"],
                _stiffness(m["kappa_N_per_m"], m["scale"]),
                significant(m["load_N"], 4),
                limit if m["limit_load_N_per_m"] is not None else "-",
                significant(row["gap_min_rel"], 4, unit=" d_hat"),
                _farthest(row),
                row["outcome"],
                row["verdict"],
            )
        )
        reasons += [f"{row['formulation']}: {row['why']}"] if row["verdict"] != "comparable" else []
    return "\n".join([head, *aligned(COLUMNS, lines), *reasons])


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "study match",
        __doc__,
        "./bench study match configs/scenes/drape2d.json",
        "./bench study match configs/scenes/drape.json --formulations cubic quadratic --vary limit",
    )
    parser.add_argument(
        "config",
        type=Path,
        help="a config, e.g. configs/scenes/drape2d.json; its formulation and matching are replaced",
    )
    parser.add_argument(
        "--formulations",
        nargs="+",
        default=list(DEFAULT),
        metavar="NAME",
        help=(
            "presets of configs/formulations, formulas as shapes, formula:TEXT, or files like the presets,"
            " NAME.json, of a shape of a plugin, say (default: %(default)s); log always runs"
        ),
    )
    parser.add_argument(
        "--rule", choices=RULES, default="equal_force", help="matching rule (default: %(default)s)"
    )
    parser.add_argument(
        "--theta",
        type=finite_number,
        default=0.1,
        metavar="T",
        help="gap/d_hat at which forces are equal, in (0, 1) (default: %(default)s)",
    )
    parser.add_argument(
        "--vary",
        choices=VARY,
        default="both",
        help="what takes the formulation; the other keeps the log (default: %(default)s)",
    )
    set_argument(parser, "override in every run")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder of the records (default: results/runs/match/CONFIG-HASH)",
    )
    plugin_argument(parser)
    return parser.parse_args(argv)


@reported("study match")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    if not 0 < args.theta < 1:
        raise UserError(f"--theta: found {args.theta:g}; a number in (0, 1) is needed")
    made = make_sweep(args.config, args.formulations, args.rule, args.theta, args.vary)
    digest = of_text(
        "\n".join([made.text, inputs_sha256(made, args.overrides, args.plugin), *args.overrides])
    )[:8]
    out = args.out or ROOT / "results" / "runs" / "match" / f"{args.config.stem}-{digest}"
    run(made, out, args.overrides, args.plugin)
    answer = judge(made, collect(made, out), args.vary)
    write_whole(out / "match.json", json.dumps(answer, indent=1) + "\n")
    print(text(answer))
    return 0 if all(row["verdict"] == "comparable" for row in answer["formulations"]) else 1
