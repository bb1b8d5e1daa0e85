"""The runs of mini scenes that a study asks for."""

from collections.abc import Callable, Iterator

from barrierbench_analysis.studies.kit.study.spec import Case, Study, product

from .entry import Entry, entries


def cells(study: Study, more: Callable[[Entry], dict] = lambda entry: {}) -> Iterator[Case]:
    """Each mini scene (about/scenes; all without it) with every combination of the axes and seeds of the
    spec. more: settings of a scene. The base of the study has no section that a scene does not set.
    """
    for entry in entries(study.about.get("scenes", [])):
        own = {
            f"/{key}": value for key, value in entry.config().items() if key not in ("schema", "name", "doc")
        }
        own |= study.data.get("set", {}) | more(entry)
        for case in product(study):
            place, expect = {"scene": entry.name, **case.place}, {"expect": entry.data["expect"]}
            yield Case(place, own | case.settings, against=expect)
