"""What legends, tables and captions say of a run: outcome, verdict on comparability, its rule."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from barrierbench_analysis.io.record_file import other_meanings

if TYPE_CHECKING:
    import pandas as pd

HOLLOW = (
    r"hollow markers: the run failed, is not valid, or a quantile (5, 50 or 95 % of the load) of"
    r" gap/$\hat{{d}}$ between two bodies at converged step ends is not within a factor {ratio:g} of"
    r" {reference}"
)
FAILED = (  # where all verdicts are of an earlier rule
    "hollow markers: the run failed, is not valid or not comparable"
)
VERDICT, JUDGED = (
    "comparability.verdict",
    (
        "comparable",
        "not_comparable",
    ),
)  # the field, and its words that a rule on gaps decides


def verdict_word(row: pd.Series) -> str:
    """Why the markers of a run are hollow: its outcome, or the program's verdict on comparability; else
    empty.
    """
    if row["outcome"] != "ok":
        return row["outcome"]
    return (
        row["comparability_verdict"]
        if row["comparability_verdict"] in ("not_valid", "not_comparable")
        else ""
    )


def earlier_rule(row: pd.Series) -> dict | None:
    """The rule by which comparability was judged in the version of the record (`since`, `before`); None where
    it is that of now, or nothing was compared.
    """
    if row.get("comparability_verdict") not in JUDGED or not row.get("schema_version"):
        return None
    return other_meanings(row["schema_version"]).get(VERDICT)


def judged_words(row: pd.Series) -> list[str]:
    """verdict_word, with the rule where it is another one than that of other records."""
    word, rule = verdict_word(row), earlier_rule(row)
    if rule is None:
        return [word] if word else []
    judged = f"{row['comparability_verdict']} by the rule before {rule['since']}"
    return [judged] if word in ("", row["comparability_verdict"]) else [word, judged]


def end_word(row: pd.Series) -> str:
    """Which residual the steps of a run end with that its step solver does not have to converge; else
    empty."""
    if row.get("convergence") != "not_asked":
        return ""
    median = row["end_error_tolerances_median"]
    size = "not measured" if median is None or median != median else f"{median:.2g} tolerances"
    return f"not asked to converge, residual {size}"


def name_of(row: pd.Series) -> str:
    """The legend's text: the series, the word of a run whose marker is hollow, and of one that does not
    converge.
    """
    words = judged_words(row) + [word for word in (end_word(row),) if word]
    return f"{row['series']} ({'; '.join(words)})" if words else row["series"]


def hollow_rule(runs: pd.DataFrame) -> str:
    """The rule of hollow markers in words; empty where no run of the group has a reference."""
    compared = runs[runs["comparability_reference_run"] != ""]
    if compared.empty:
        return ""
    names = runs.drop_duplicates("folder").set_index("folder")["series"]
    references = " or ".join(
        dict.fromkeys(names.get(folder, folder) for folder in compared["comparability_reference_run"])
    )
    rules = [earlier_rule(row) for _, row in compared.iterrows() if row["comparability_verdict"] in JUDGED]
    text = (
        FAILED
        if rules and all(rules)
        else HOLLOW.format(ratio=compared["comparability_max_ratio"].iloc[0], reference=references)
    )
    if rule := next(filter(None, rules), None):
        text += f"; by the rule before {rule['since']}, with reference {references}, {rule['before']}"
    return "\n".join(textwrap.wrap(text, 110))
