"""What the answers of the audit mean, in words."""

VERDICTS = {  # word: what it says; the first that holds is the verdict
    "not_finite": "a frame holds numbers that are none, so that it could not be judged",
    "penetrates": (
        "surfaces cross each other or an obstacle in a frame, or a vertex is on the other side of a closed"
        " body than before"
    ),
    "passes_between_frames": (
        "no frame shows a crossing of parts that are free, but on the straight line from one frame to the"
        " next something passes through something; what the program itself did between its frames is not"
        " known"
    ),
    "given_parts_cross": "only parts that the scene itself moves cross each other",
    "unproven": (
        "nothing was found, but not everything could be proven free: surfaces that touch, or nothing that"
        " could be judged"
    ),
    "clean": (
        "no frame shows a crossing, and nothing passes through anything on the straight line between frames"
    ),
}


CLEAN_STATES = "no frame shows a crossing; what happens between frames was not judged"


def meaning(record: dict) -> str:
    """What the verdict of a judgement says."""
    word = record["verdict"]
    return CLEAN_STATES if word == "clean" and record["states_only"] else VERDICTS[word]


def verdict_of(total: dict, frames: list[dict], states_only: bool) -> str:
    """A word of VERDICTS. states_only: what happens between frames is not judged."""
    beyond = sum(frame["obstacle_violations"] for frame in frames)
    between = total["passages"] + total["obstacle_violations"] - beyond
    given = sum(frame["given_faults"] for frame in frames) if states_only else total["given_faults"]
    holds = {
        "not_finite": total["not_finite"] > 0,
        "penetrates": total["crossings"] + beyond + total["changed_sides"] > 0,
        "passes_between_frames": between > 0 and not states_only,
        "given_parts_cross": given > 0,
        "unproven": total["judged"] == 0 or not total["self_test_passed"]
        or (total["unproven"] > 0 and not states_only),
        "clean": True,
    }  # fmt: skip
    return next(word for word, held in holds.items() if held)


def _kinds(frame: dict) -> list[tuple[str, int, str | None, float | None]]:
    """What may be found of a frame: words, how often, a pair, depth in m."""
    motion = frame.get("motion", {})
    beyond = max(-(frame.get("gap_obstacles_m") or 0.0), 0.0)
    passed = motion.get("passages", 0) + motion.get("obstacle_violations", 0)
    first = frame.get("first")
    sides = frame.get("changed_sides", 0)
    return [
        ("crossings", frame["crossings"], frame.get("deepest", first), frame.get("deepest_m")),
        ("beyond obstacles", frame["obstacle_violations"], first, beyond),
        ("changed sides", sides, frame.get("first_changed"), frame.get("depth_bodies_m")),
        ("given parts cross", frame["given_faults"], frame.get("first_given_fault"), None),
        ("passages before it", passed, motion.get("first"), None),
        ("unproven before it", motion.get("unproven", 0), None, None),
        ("not finite", int(not frame["finite"]), None, None),
    ]


BETWEEN = ("passages before it", "unproven before it")  # of the motion to a frame


def findings(frames: list[dict], labels: list[str], states_only: bool) -> list[dict]:
    """One row for each kind of thing that was found in a frame, in order, of what was judged."""
    return [
        {"frame": label, "what": what, "count": count, "pair": pair, "depth_m": depth}
        for frame, label in zip(frames, labels)
        for what, count, pair, depth in _kinds(frame)
        if count and not (states_only and what in BETWEEN)
    ]
