"""Whether what a record says of its end agrees with what it says was found: its outcome and `valid` with the
checks of its validity and with the counts of its audit.
"""

from barrierbench_analysis.io import fields

CUT = ("oom", "kernel_failed", "timeout")  # a run that is not over stays what it is, whatever the audit found


def _ranks_below_penetration(outcome: str) -> bool:
    """By the order of the words in the schema, most specific first."""
    words = fields.schema("run")["$defs"]["Status"]["properties"]["outcome"]["enum"]
    return words.index(outcome) > words.index("penetration")


def _of_validity(record: dict) -> list[str]:
    status, validity = record["status"], record["validity"]
    passed = {check["name"]: check["pass"] for check in validity["checks"]}
    outcome, all_passed = status["outcome"], bool(passed) and all(passed.values())
    found = [
        f"{place} is {str(valid).lower()}, and of its {len(passed)} checks {sum(passed.values())} passed"
        for place, valid in (("status/valid", status["valid"]), ("validity/valid", validity["valid"]))
        if valid != all_passed
    ]
    if passed.get("outcome_ok", outcome == "ok") != (outcome == "ok"):
        verdict = "passed" if passed["outcome_ok"] else "failed"
        found.append(f"status/outcome is {outcome}, and its check outcome_ok {verdict}")
    return found


def _of_audit(record: dict) -> list[str]:
    audit, outcome = record["audit"], record["status"]["outcome"]
    if not audit["enabled"]:
        return []
    decides = ["obstacle_violations"]  # of the contact model `points`; what surfaces do decides nothing there
    if audit.get("obstacles_judge", "surface") == "surface":
        decides += ["crossings", "violations"]
    counts = {name: audit[name] for name in decides}
    found = ", ".join(f"{count} {name}" for name, count in counts.items())
    if any(counts.values()) and _ranks_below_penetration(outcome) and outcome not in CUT:
        return [f"status/outcome is {outcome}, and its audit has {found}"]
    if outcome == "penetration" and not any(counts.values()):
        return [f"status/outcome is penetration, and its audit has {found}"]
    open_counts = ["scene_faults", *(["unproven"] if "crossings" in counts else [])]
    if outcome == "ok" and (left := {name: n for name in open_counts if (n := audit[name])}):
        return [f"status/outcome is ok, and its audit has {n} {name}" for name, n in left.items()]
    if outcome == "ok" and not audit["judged"]:
        return ["status/outcome is ok, and its audit judged nothing"]
    return []


def contradictions(record: dict) -> list[str]:
    """What of the record cannot both be so, in sentences."""
    return _of_validity(record) + _of_audit(record)
