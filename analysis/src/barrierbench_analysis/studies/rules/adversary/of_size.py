"""Statements of the study at size: the outcomes of its questions and its laws, with their thresholds as they
were registered.
"""

import math
import re
from dataclasses import replace

from barrierbench_analysis.studies.kit.study.page import rows_of
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.rules.at_size import questions
from barrierbench_analysis.studies.rules.at_size.laws import BLOCK_BOUND, MOST, laws
from barrierbench_analysis.studies.rules.at_size.loads import of_label
from barrierbench_analysis.studies.rules.at_size.pairs import CUBIC, LOG, THETA, Rows
from barrierbench_analysis.studies.rules.at_size.stops import RULES

from .region import Region
from .size_region import AT, NAME, region, study
from .statement import Left, Side, Statement

ROUNDING = 1e-9  # of the eigenvalue of law 2, as the law reads it
OFTEN = re.compile(r"(\w+) (more|less) often than log")
SIDES = {
    "vanishes": Side("within", *questions.VANISHES),
    "persists": Side("above", questions.PERSISTS),
    "grows": Side("above", 0.0),
    "equivalent": Side("within", *questions.ALIKE),
    CUBIC: Side("above", 0.0),
    LOG: Side("below", high=0.0),
}


def _ends(side: Side) -> str:
    """Of a ratio, in words."""
    ends = [f"{math.exp(x):.3g}" for x in (side.low, side.high) if math.isfinite(x)]
    kind = "at most" if side.kind == "within" and len(ends) == 1 else side.kind
    return f"{kind} {' to '.join(ends)}"


def _ratio(
    label: str, says: str, what: str, side: Side, metric: str, region: Region, sizes: list[str]
) -> Statement:
    """Of the log over the cubic; of two sizes its growth from the second to the first."""
    over = f" at {sizes[0]} over that at {sizes[1]}" if len(sizes) > 1 else ""
    return Statement(
        label=label,
        says=says,
        threshold=f"log/cubic of {what}{over} {_ends(side)}",
        side=side,
        arms=tuple(f"{name}{AT}{size}" for size in sizes for name in (LOG, CUBIC)),
        compares="ratio",
        metric=metric,
        region=region,
    )


def _conditioning(of: Study, about: dict, word: str) -> list[Statement]:
    where = region(of, about, "diagnosed", THETA, ("shell", "rod"))
    says = f"raw condition numbers, shells and rods: `{word}`"
    what = "the 95th percentile of cond"
    return [_ratio("question-1", says, what, SIDES[word], "size_cond_p95", where, [about["size"]])]


def _newton(of: Study, about: dict, word: str) -> list[Statement]:
    sizes = [about["grown_size"], about["size"]]
    where = region(of, about, "audited", THETA, fixed=("d_hat_m",))  # which each size has its own
    says = f"the ratio of Newton iterations: `{word}` with size"
    return [_ratio("question-2", says, "Newton iterations", SIDES[word], "size_newton", where, sizes)]


def _work(of: Study, about: dict, word: str) -> list[Statement]:
    where, found = region(of, about, "pcg", THETA), []
    for what in ("products", "seconds"):
        says = f"{what} until {RULES['velocity']}: `{word}`"
        metric = f"size_{what}"
        found.append(_ratio(f"question-4-{what}", says, what, SIDES[word], metric, where, [about["size"]]))
    return found


def _robustness(of: Study, about: dict, word: str) -> list[Statement]:
    """A statement for each formulation in the word, at the theta of the changed loads."""
    theta = next(g["thetas"][0] for g in of.about["groups"] if of_label(g["setting"]))
    where, found = region(of, about, "audited", theta), []
    for arm, more in OFTEN.findall(word):
        first, second = (arm, LOG) if more == "more" else (LOG, arm)
        found.append(
            Statement(
                label=f"question-5-{arm}",
                says=f"`{arm} {more} often than log` ends ok",
                threshold=f"{first} ends ok where {second} does",
                side=None,
                arms=(f"{first}{AT}{about['size']}", f"{second}{AT}{about['size']}"),
                compares="outcomes",
                metric="",
                region=where,
            )
        )
    return found


QUESTIONS = {1: _conditioning, 2: _newton, 4: _work, 5: _robustness}
UNLIKE = {
    3: "it compares shares of causes, whose largest is one of all scenes together",
    6: "it compares masks with each other over scenes",
}


def of_questions(of: Study, about: dict, rows: Rows) -> tuple[list[Statement], list[Left]]:
    """The words that the kept rows decide; where they decide none, those that the spec names."""
    found, left = [], []
    for answer in questions.answers(rows):
        source = f"`{NAME}`, question {answer.number}"
        if answer.number in UNLIKE:
            left.append(Left(source, answer.name, UNLIKE[answer.number]))
            continue
        decided = answer.outcome not in (questions.UNDECIDED, questions.NO_RUNS)
        word = answer.outcome if decided else about["unless_decided"][str(answer.number)]
        of_word = QUESTIONS[answer.number](of, about, word)
        found += [replace(one, source=source, verdict=answer.outcome) for one in of_word]
    return found, left


def _law(of: Study, about: dict, number: int) -> Statement:
    size = [about["size"]]
    if number == 3:
        side, where = Side("within", high=math.log(MOST)), region(of, about, "audited", THETA)
        made = _ratio("law-3", "", "Newton iterations", side, "size_newton", where, size)
        return replace(made, refuted_by=2)
    two = {"label": f"law-{number}", "arms": (f"{LOG}{AT}{size[0]}", f"{CUBIC}{AT}{size[0]}")}
    two["region"] = region(of, about, "diagnosed")
    if number == 1:
        says = "ln(cond log/cubic), largest of a run, has the sign of 1/theta - 2 sqrt(f_hi/f_lo)"
        return Statement(**two, threshold=says, side=None, compares="sign", metric="size_cond_most")
    side = Side("within", high=BLOCK_BOUND * (1 + ROUNDING))
    says = f"the largest eigenvalue, block-Jacobi scaled, is at most {BLOCK_BOUND:g}"
    return Statement(
        **two, threshold=says, side=side, compares="level", metric="size_bj_lambda_max", refuted_by=1
    )


def of_laws(of: Study, about: dict, rows: Rows) -> tuple[list[Statement], list[Left]]:
    """The laws that the kept rows do not refute."""
    found, left = [], []
    for law in laws(rows):
        source = f"`{NAME}`, law {law.number}"
        if law.is_refuted:
            left.append(Left(source, law.name, "the kept runs of the study refute it"))
        else:
            made = _law(of, about, law.number)
            found.append(replace(made, source=source, verdict=law.verdict, says=law.name))
    return found, left


def of_size(about: dict) -> tuple[list[Statement], list[Left]]:
    """By the kept rows of the study; none of it has to be run."""
    of = study()
    rows = Rows(of, rows_of(of))
    pairs = [made(of, about, rows) for made in (of_questions, of_laws)]
    return [one for found, _ in pairs for one in found], [one for _, left in pairs for one in left]
