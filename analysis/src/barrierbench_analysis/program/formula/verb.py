"""`bench formula`: what a formula is as a barrier."""

import argparse
import json

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.program.arguments import options, parser_of

from .compiled import compiled, compiled_policy, signs_of
from .grammar import POLICY, SHAPE, FormulaError

DOC = f"""
The formula is b in m^2 of the gap d and of d_hat (m), made of
{SHAPE.words}.
It is checked (unit, poles, sign, force, convexity, limits at d_hat and 0), differentiated, compiled and kept
in BARRIERBENCH_CACHE or ~/.cache/barrierbench. In a config:
"shape": {{"formula": "...", "at_zero": "infinite"}}, or the name formula:TEXT wherever a shape has a name.
With --policy it is the stiffness kappa of a contact in N/m instead, made of
{POLICY.words}: m and k are w^T M w and w^T H w over w^T w (kg and N/m; w the weighted normals of the free
vertices, M their masses, H the elastic Hessian), h the time step (s), c the weight of the inertia M/(c h^2).
In a config: "stiffness_policy": {{"name": "formula", "formula": "m/h^2 + k"}}. docs/guides/add-a-barrier.md.
"""


def parse(argv: list[str]) -> argparse.Namespace:
    parser = parser_of("formula", DOC)
    parser.formula_argument("formula", "TEXT")
    text = """
--at-zero: what it is meant to do as d -> 0
--policy: the formula is a stiffness, kappa in N/m
--json: the answer as JSON
--source: the C++ that was made of it instead"""
    options(parser, text, at_zero=("infinite", "finite"))
    args = parser.parse_args(argv)
    if args.policy and args.at_zero:
        raise UserError("--at-zero is of shapes, not of --policy")
    return args


@reported("formula")
def main(argv: list[str]) -> int:
    """0: a barrier; 2: none."""
    args = parse(argv)
    try:
        made = compiled_policy(args.formula) if args.policy else compiled(args.formula, args.at_zero)
    except FormulaError as error:
        raise UserError(f"{args.formula!r}: {error}", error.code) from None
    if args.source:
        print(input_file.read_text(made.library.with_suffix(".cpp")), end="")
    elif args.json:
        print(json.dumps({**made.about, "library": str(made.library)}, indent=1))
    else:
        print(policy_card(made.about) if args.policy else card(made.about))
        print(f"library     {made.library}")
    return 0


def policy_card(about: dict) -> str:
    """What there is to say of a stiffness."""
    reads, potential = ", ".join(about["symbols"]) or "nothing", "kappa b, since kappa does not depend on d"
    if about["reads_gap"]:
        error = f"{about['slope_error_rel']:.1e} of kappa/d"
        derived = '"potential": "derived" in a config'
        potential = f"-int kappa(s) b'(s) ds, with {derived}; d kappa/dd to {error}"
    return (
        f"formula     {about['formula']}\n"
        f"label       {about['label']}\n"
        f"kappa       reads {reads}; finite and not negative at all {about['points']} points of the"
        " check\n"
        f"            relative error {about['error_rel']:.1e}\n"
        f"potential   {potential}"
    )


def card(about: dict) -> str:
    """What there is to say of a formula, a line each."""
    terms, error = about["terms"], about["error_rel"]
    units = ("d_hat^2 ", "d_hat ", "")
    lines = [
        f"formula     {about['formula']}",
        f"name        formula:{about['formula']}",
        f"label       {about['label']}",
        f"at d = 0    {about['at_zero']}: b -> {about['b_at_zero']}",
        f"carries     {'any load' if about['capacity'] is None else 'at most ' + about['capacity']}",
        f"at d_hat    {about['smoothness_at_d_hat']} continuous derivatives",
        f"signs       {signs_of(about['unproven'])}",
        "with u = d/d_hat, e = 1 - u, l = -ln u:",
        *(
            f"  {name:<4}= {unit}({terms[name].replace('**', '^')})   relative error {error[name]:.1e}"
            for name, unit in zip(terms, units, strict=True)
        ),
    ]
    return "\n".join(lines)
