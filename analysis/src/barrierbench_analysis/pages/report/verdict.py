"""What the records say in plain words, and what they do not say. Every sentence is computed from them."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from barrierbench_analysis.tables.run_words import earlier_rule
from barrierbench_analysis.tables.words import counted, listed, number

from .comparison import METRICS, Beside, Factor, compared
from .expected import word_of
from .gather import Entry, Folder

GOOD, BAD, PLAIN, EXPECTED = "good", "bad", "plain", "expected"
IN_SENTENCES = ("cond_raw", "newton", "pcg")  # times are in the tables alone
CLAIM_SCENES = 3  # docs/results/method/claims.md: fewer decide nothing
MOST_GROUPS = 8


@dataclass(frozen=True)
class Sentence:
    text: str
    tone: str = PLAIN


def _are(count: int) -> str:
    return "is" if count == 1 else "are"


def _were(count: int) -> str:
    return "was" if count == 1 else "were"


def headline(folder: Folder) -> Sentence:
    runs = folder.entries
    failed = [run for run in runs if not run.good]
    bad = [run for run in failed if not run.failed_as_expected]
    lost = len(folder.lost) + len(folder.absent) + len(folder.earlier)
    if not failed and not lost:
        all_of = "The run" if len(runs) == 1 else f"All {len(runs)} runs"
        return Sentence(f"{all_of} ended ok and {_are(len(runs))} valid.", GOOD)
    good, foreseen = len(runs) - len(failed), len(failed) - len(bad)
    text = f"{good} of {counted(len(runs), 'run')} ended ok and {_are(good)} valid"
    if foreseen:
        text += f"; {foreseen} {_were(foreseen)} expected to fail and did"
    words = Counter(run.row["outcome"] if run.row["outcome"] != "ok" else "ok but not valid" for run in bad)
    if bad:
        text += "; " + listed([f"{n} ended {word}" for word, n in words.most_common()])
    if absent := len(folder.absent):
        text += f"; {counted(absent, 'run')} of the sweeps {'has' if absent == 1 else 'have'} no record yet"
    if folder.lost:
        text += f"; {counted(len(folder.lost), 'file')} cannot be read"
    if folder.earlier:
        text += f"; {counted(len(folder.earlier), 'record')} of an earlier sweep file left out"
    return Sentence(f"{text}.", BAD if bad or lost else GOOD)


def expectations(folder: Folder) -> Iterator[Sentence]:
    """Runs that were expected to fail: those that did, and those that ended ok nevertheless."""
    did = [f"{run.name} ({word_of(run.row)})" for run in folder.entries if run.failed_as_expected]
    if did:
        count = f"{counted(len(did), 'run')} {_were(len(did))}"
        yield Sentence(f"{count} expected to fail and did: {listed(did)}.", EXPECTED)
    if ended := [run.name for run in folder.entries if run.good and run.expected]:
        count = f"{counted(len(ended), 'run')} {_were(len(ended))}"
        yield Sentence(f"{count} expected to fail and ended ok: {listed(ended)}.", BAD)


def reserved(folder: Folder) -> Iterator[Sentence]:
    """Runs that ended ok with less than others promise."""
    runs = [run for run in folder.entries if run.reserved]
    if runs:
        names = listed([f"{run.name} ({', '.join(run.reserved)})" for run in runs])
        count = f"{counted(len(runs), 'run').capitalize()} of these {_are(len(runs))}"
        text = f"{count} ok with a reservation: {names}. What each of them means stands under Failures."
        yield Sentence(text, BAD)


def crossings(folder: Folder) -> Iterator[Sentence]:
    audited = [run for run in folder.entries if run.faults is not None]
    through = [run for run in audited if run.faults]
    is_expected = all(run.failed_as_expected for run in through)
    unproven = [run for run in audited if not run.faults and run.row.get("audit_unproven")]
    if through:
        names = listed([f"{run.name} ({run.faults})" for run in through])
        count = f"In {len(through)} of {counted(len(audited), 'audited run')}"
        text = f"{count} a surface passes through another: {names}"
        expected = Sentence(f"{text}, which is expected.", EXPECTED)
        yield expected if is_expected else Sentence(f"{text}.", BAD)
    elif audited:
        judged = sum(run.row["audit_judged"] for run in audited)
        all_of = "the audited run" if len(audited) == 1 else f"all {len(audited)} audited runs"
        text = (
            f"In {all_of} no surface passes through another: {judged:.3g} primitives were compared, in every"
        )
        yield Sentence(f"{text} accepted state and along every motion.", GOOD)
    if unproven:
        names = listed([run.name for run in unproven])
        yield Sentence(f"Not every motion could be certified in {names}.", BAD)
    if dark := len(folder.entries) - len(audited):
        text = f"Of {counted(dark, 'run')} nothing is known about crossings: not audited."
        yield Sentence(text, BAD)


def comparability(folder: Folder) -> Iterator[Sentence]:
    others = [run for run in folder.entries if folder.reference_of(run) is not run]
    words = Counter(run.row.get("comparability_verdict") for run in others)
    judged = words["comparable"] + words["not_comparable"]
    if not judged:
        text = "No record names a reference, so nothing here is compared with anything"
        yield Sentence(f"{text}: a sweep names it when it ends.")
        return
    ratios = {run.row["comparability_max_ratio"] for run in others if run.row.get("comparability_max_ratio")}
    within = listed([f"{ratio:g}" for ratio in sorted(ratios)])
    text = (
        f"Of {counted(judged, 'run')} that the program compared with a reference {words['comparable']}"
        f" {_are(words['comparable'])} comparable with it (contacts of every pair of bodies rest at gaps"
        f" within"
        f" a factor {within} of the reference's)"
    )
    if words["not_comparable"]:
        apart = [run.name for run in others if run.row.get("comparability_verdict") == "not_comparable"]
        text += f"; {len(apart)} {_are(len(apart))} not, and no factor is given for them: {listed(apart)}"
    rules = [rule for run in others if (rule := earlier_rule(run.row))]
    if rules:
        text += f"; {len(rules)} were judged by the rule before {rules[0]['since']}"
    yield Sentence(f"{text}.")


def _times(factor: Factor) -> str:
    mean = number(factor.mean, 2)
    if factor.n == 1:
        return f"{mean} times"
    return f"{mean} times ({number(factor.low, 2)} to {number(factor.high, 2)} in {factor.n} pairs)"


def _conditions(entries: list[Entry]) -> str:
    """Scene, matching and limit of these runs."""
    scenes = dict.fromkeys(run.row["scene"] for run in entries)
    rules = dict.fromkeys(
        f"{run.row['matching_rule']} at theta {run.row['matching_theta']:g}"
        if run.row.get("matching_theta") is not None and run.row["matching_rule"] != "as_given"
        else str(run.row["matching_rule"])
        for run in entries
        if run.row.get("matching_rule")
    )
    limits = {run.settings.get("/strain_limit/enabled") for run in entries}
    limit = {frozenset([True]): ", strain limit on", frozenset([False]): ", no strain limit"}
    return (
        f"scene {listed(list(scenes))}, stiffness by {listed(list(rules)) or 'no rule'}"
        f"{limit.get(frozenset(limits), '')}"
    )


def _beside_words(one: Beside) -> str:
    parts = [
        f"{metric.words} {_times(one.factors[metric.key])}"
        for metric in METRICS
        if metric.key in IN_SENTENCES and metric.key in one.factors
    ]
    return f"{one.contender}: {', '.join(parts)}" if parts else ""


def ratios(folder: Folder) -> Iterator[Sentence]:
    """A sentence a group: its conditions, its reference, and the factors of who may be compared with it."""
    found, rows = [], compared(folder)
    for group, entries in folder.groups.items():
        mine = [one for one in rows if one.group == group and one.factors]
        for reference in dict.fromkeys(one.reference for one in mine):
            words = [text for one in mine if one.reference == reference and (text := _beside_words(one))]
            if words:
                where = f"{group} ({_conditions(entries)}), over the reference {reference}"
                found.append(Sentence(f"{where}: {'; '.join(words)}."))
    yield from found[:MOST_GROUPS]
    if rest := len(found[MOST_GROUPS:]):
        yield Sentence(f"{counted(rest, 'more group')} of factors: in Comparison.")


def _one_of(folder: Folder, what: str) -> list:
    return list(dict.fromkeys(value for run in folder.entries if (value := run.row.get(what)) is not None))


def _about_scenes(folder: Folder) -> Iterator[str]:
    scenes: dict[str, set] = {}
    for run in folder.entries:
        scenes.setdefault(run.row["scene"], set()).add(run.row.get("scene_vertices"))
    if len(scenes) < CLAIM_SCENES:
        count = f"{'One scene' if len(scenes) == 1 else f'{len(scenes)} scenes'} ({listed(list(scenes))})"
        needed = f"a claim of this project needs {CLAIM_SCENES} (./bench study claims)"
        yield f"{count}: nothing is said about others; {needed}."
    one_mesh = {name: sizes for name, sizes in scenes.items() if len(sizes) == 1 and None not in sizes}
    if single := [f"{name}: {next(iter(sizes))} vertices" for name, sizes in one_mesh.items()]:
        yield f"One mesh a scene ({listed(single)}): nothing is said about finer or coarser ones."


def _about_conditions(folder: Folder) -> Iterator[str]:
    one = []
    for column, what in (("matching_theta", "theta"), ("dt_s", "time step (s)"), ("d_hat_m", "d_hat (m)")):
        values = _one_of(folder, column)
        if len(values) == 1:
            one.append(f"{what} {values[0]:g}")
    if one:
        yield f"One set of conditions: {listed(one)}; under others the factors may be other ones."
    seeds = ("/seeds/main", "/seeds/jitter_m")
    if len({tuple(map(run.settings.get, seeds)) for run in folder.entries}) == 1:
        yield "Every case ran from one start: how much its numbers scatter is not known."
    friction = {run.settings.get("/friction/mu") for run in folder.entries}
    if friction == {0.0} or friction == {0}:
        yield "The coefficient of friction is 0 in every config."


def _about_costs(folder: Folder) -> Iterator[str]:
    yield "A condition number or a count of iterations says nothing about seconds."
    timed = [run for run in folder.entries if run.wall_s is not None]
    machines, builds = (len(_one_of(folder, name)) for name in ("machine_id", "build_id"))
    if timed:
        most = Counter(run.row["config_id"] for run in timed).most_common(1)[0][1]
        of = f"{counted(most, 'repetition')} a case on {counted(machines, 'machine')}"
        yield f"Times are of {of}: they are shown and not judged."
    else:
        yield "Nothing was timed in a run that counts."
    if machines == 1:
        yield "One class of processors: on another rounding differs, and counts of iterations with it."
    if machines > 1 or builds > 1:
        yield f"Records of {counted(builds, 'build')} and {counted(machines, 'machine')} are side by side."
    loose = [run for run in folder.entries if run.row.get("convergence") == "not_asked"]
    if loose:
        count = f"{counted(len(loose), 'run').capitalize()} {_are(len(loose))}"
        names = listed([run.name for run in loose])
        words = "not asked to converge in a step, so fewer iterations there are not the same work"
        yield f"{count} {words}: {names}."


def limits(folder: Folder) -> list[str]:
    """What a reader might take from the page and must not."""
    return [*_about_scenes(folder), *_about_conditions(folder), *_about_costs(folder)]


def verdict(folder: Folder) -> list[Sentence]:
    """The headline first."""
    parts = (expectations, reserved, crossings, comparability, ratios)
    return [headline(folder), *(sentence for part in parts for sentence in part(folder))]
