"""Which settings of two configs differ. The number of threads and the jitter of the start change no
method."""

from .records import Run, leaves

NO_METHOD = ("/threads", "/seeds/main", "/seeds/jitter_m")
OF_THE_RUN = ("/passes/", "/output/")


def settings(config: dict) -> dict[str, object]:
    return {
        place: value
        for place, value in leaves(config)
        if place not in NO_METHOD and not place.startswith(OF_THE_RUN)
    }


def differences(old: dict, new: dict) -> list[str]:
    """Settings that both have with unlike values, and those that only one has, each a line."""
    a, b = settings(old), settings(new)
    lines = [f"{p}: {a[p]!r} and {b[p]!r}" for p in sorted(a.keys() & b.keys()) if a[p] != b[p]]
    lines += [f"{p}: {a[p]!r} and absent" for p in sorted(a.keys() - b.keys())]
    return lines + [f"{p}: absent and {b[p]!r}" for p in sorted(b.keys() - a.keys())]


def contradictions(old: dict, new: dict) -> list[str]:
    """As differences(), but a setting that only the later program knows is no contradiction: it has its
    default.
    """
    return [line for line in differences(old, new) if ": absent and " not in line]


def scene_size(run: Run) -> dict[str, object]:
    return {
        place: value
        for place, value in leaves(run.section("scene"))
        if place != "/extent_m" and not place.startswith("/mesh_sha256")
    }
