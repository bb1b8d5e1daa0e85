"""The page of the catalogue: results/CATALOGUE.md."""

from __future__ import annotations

from barrierbench_analysis.io.text_table import markdown

from .entry import Entry
from .formulations import ABOUT, FORMULATIONS


def _text(words: str) -> str:
    return words.replace("|", "/").replace("\n", " ")


def _cell(row: dict | None) -> str:
    """Outcome and seconds; bold where it is not `ok`, or a check is red. A rejected scene is as it should
    be.
    """
    if row is None:
        return "-"
    text = f"{row['outcome']}, {row['seconds']:g} s"
    if row["red"]:
        return f"**{text}, red: {', '.join(word.split(':')[0] for word in row['red'])}**"
    return text


def _by_label(kept: dict) -> dict[str, dict]:
    return {row["formulation"]: row for row in kept["rows"]}


def markdown_page(
    asked: list[Entry], scenes: dict[str, dict], robust: dict[str, list[dict]], has_picture: bool
) -> str:
    """The whole page, of all scenes that there are results of."""
    picture = ["![The end of every mini scene](../docs/catalogue.png)", ""] if has_picture else []
    here = [entry for entry in asked if entry.name in scenes]
    text = [
        *_head(asked, here, scenes),
        *picture,
        *_outcomes(here, scenes),
        *_red(here, scenes),
        *_robust(robust),
        *_described(here, scenes),
    ]
    return "\n".join(text)


def _head(asked: list[Entry], here: list[Entry], scenes: dict[str, dict]) -> list[str]:
    """What was run, when and where, and how a cell is read."""
    abouts = [scenes[entry.name]["about"] for entry in here]
    dates, machines, commits = (
        ", ".join(sorted({about[key] for about in abouts})) for key in ("date", "machine", "commit")
    )
    rows = [row for entry in here for row in scenes[entry.name]["rows"]]
    return [
        "# Catalogue",
        "",
        (
            f"Written by `./bench study catalogue`. {dates}, {machines}; commit {commits}. The scenes of"
            f" configs/catalogue at the size mini, {len(here)} of {len(asked)}; {len(rows)} runs,"
            f" {sum(not row['red'] for row in rows)} of which end as expected."
        ),
        "",
        (
            "A cell has the outcome and seconds from start to end, other programs beside it. It is bold where"
            " an expectation of the scene is red: not fulfilled, or without a subject. Fixed stiffnesses are"
            " matched to the loads that a scene names; "
            + "; ".join(f"`{label}`: {words}" for label, words in ABOUT.items())
            + "."
        ),
        "",
    ]


def _outcomes(here: list[Entry], scenes: dict[str, dict]) -> list[str]:
    return [
        "## Outcomes",
        "",
        *markdown(
            ["scene", "vertices/triangles with a membrane", *FORMULATIONS],
            [
                [
                    entry.name,
                    f"{scenes[entry.name]['about']['vertices']}/{scenes[entry.name]['about']['triangles']}",
                    *(_cell(_by_label(scenes[entry.name]).get(label)) for label in FORMULATIONS),
                ]
                for entry in here
            ],
        ),
        "",
    ]


def _described(here: list[Entry], scenes: dict[str, dict]) -> list[str]:
    """Of every scene where it comes from, what it stresses, how it deviates and what was seen."""
    text = ["## Scenes", ""]
    for entry in here:
        log = _by_label(scenes[entry.name]).get("log", {"seen": []})
        text += [
            f"### {entry.name}: {entry.data['title']}",
            "",
            f"From {entry.data['source']}. Stresses {entry.data['stresses']}.",
            "",
            *(f"- deviates: {word}." for word in entry.data["deviations"]),
            *(f"- seen with log: {_text(word)}." for word in log["seen"]),
            "",
        ]
    return text


def _red(here: list[Entry], scenes: dict[str, dict]) -> list[str]:
    lines = [
        [
            entry.name,
            row["formulation"],
            row["outcome"],
            _text("; ".join(row["red"]))[:300],
            _text(row["detail"])[:200],
        ]
        for entry in here
        for row in scenes[entry.name]["rows"]
        if row["red"]
    ]
    table = (
        markdown(["scene", "formulation", "outcome", "red", "what the record says"], lines)
        if lines
        else ["Nothing."]
    )
    return ["## Not as expected", "", *table, ""]


def _robust(robust: dict[str, list[dict]]) -> list[str]:
    if not robust:
        return []
    lines = [
        [
            name,
            row["formulation"],
            f"{row['passed']} of {row['seeds']}",
            f"{row['jitter_m']:g}",
            _text(row["failed"]),
        ]
        for name, rows in robust.items()
        for row in rows
    ]
    head = ["scene", "formulation", "passed", "jitter (m)", "what failed"]
    return [
        "## Jittered starts",
        "",
        "Written by `./bench study robust`: a seed passes when its run ends `ok` without a crossing, or, of"
        " a scene"
        " that must be rejected, when it is.",
        "",
        *markdown(head, lines),
        "",
    ]
