"""Rows of the tables of results/GPU.md, from records of cards."""

from itertools import product

from barrierbench_analysis.tables.numbers import whole

from .gpu_evidence import OF_SOLVE

LARGE = "drape_1m"
MEMORY_RUN = ("dense_8m", "dense_184m")  # the second one: in records of 2026-11-26, of the same scene
MOST_KERNELS = 12
PLAIN = "plain_"  # in records until 2026-11-28: runs of which no kernel called a library
DIFFERENT = {False: "not the bits of the host", None: "whether it has the bits of the host is not known"}
CHECKS = ("memcheck", "racecheck", "initcheck", "synccheck")
COUNTERS = {
    "gpu__time_duration.sum": ("us", 1e-3),
    "dram__bytes.sum": ("DRAM, MB", 1e-6),
    "sm__warps_active.avg.pct_of_peak_sustained_active": ("occupancy, %", 1),
    "launch__registers_per_thread": ("registers", 1),
}
WORDS = {"passed": "passed", "failed": "**failed**", "timed_out": "**timed out**", "left_out": "not run"}


def number(value: float | None) -> str:
    return whole(value, none="not measured", comma=",")


def _scene(record: dict, name: str, key: str) -> float | None:
    scene = record["scenes"].get(name)
    return scene[key] if scene and scene["outcome"] == "ok" else None


def _memory_run(record: dict) -> str:
    scene = next((record["scenes"][name] for name in MEMORY_RUN if record["scenes"].get(name)), None)
    if scene is None:
        said = (record["parts"].get(name, {}).get("why") for name in MEMORY_RUN)
        return next(filter(None, said), "not run")
    return f"{scene['outcome']}, {scene['vertices']:,} vertices, {number(scene['contacts'])} contacts"


def copy_rate(record: dict, records: list[dict]) -> float:
    """B/s of a copy within the card: the largest that a record of this card has. Records until 2026-11-28
    measured it without a warm-up, two of four on a card with low clocks.
    """
    card = record["device"]["card"]
    return max(r["device"]["copy"]["on_the_card_Bps"] for r in records if r["device"]["card"] == card)


def card_rows(records: list[dict]) -> list[list[str]]:
    rows = []
    for record in records:
        device, card, commit = record["device"], record["card"], record["git_commit"][:10]
        driver, clock = card.get("driver_version") or device["driver"], card.get("clocks.max.sm", "not known")
        rate = number(1e-9 * copy_rate(record, records))
        timed = product(("drape_82k", LARGE), ("pcg_ms", "newton_ms"))
        times = [number(_scene(record, scene, key)) for scene, key in timed]
        row = [device["card"], record["date_utc"][:10], driver, clock, commit or "not known", rate]
        rows.append([*row, check_text(record), *times, _memory_run(record)])
    return rows


def fallen(record: dict) -> list[str]:
    """Parts that failed, with what they said last, and runs that have to have the host's bits and do not."""
    parts = [
        (name, part) for name, part in record["parts"].items() if part["status"] in ("failed", "timed_out")
    ]
    runs = [run for run in plain_runs(record) or record.get("same", []) if run["same_bits"] is not True]
    lines = [f"- {name}: {WORDS[part['status']]}: {part['why']}" for name, part in parts]
    return lines + [f"- {run['name']}: **{DIFFERENT[run['same_bits']]}**" for run in runs]


def plain_runs(record: dict) -> list[dict]:
    return [run for run in record.get("same", []) if run["name"].startswith(PLAIN)]


def judged(record: dict) -> list[str]:
    """What each test of the modules and each sanitizer launched."""
    return [f"- {name}: {part['judged']}" for name, part in record["parts"].items() if "judged" in part]


def check_text(record: dict) -> str:
    """Every check with its verdict, those with the same one together; what failed comes first."""
    of_word: dict[str, list[str]] = {}
    tests = sorted(name for name in record["parts"] if name.startswith("card_"))
    sanitized = sorted(name for name in record["parts"] if name.split("_")[0] in CHECKS)
    missing = [check for check in CHECKS if not any(name.split("_")[0] == check for name in sanitized)]
    for name in ("device_tests", *tests, *sanitized, *missing):
        part = record["parts"].get(name, {"status": "left_out"})
        of_word.setdefault(WORDS[part["status"]], []).append(name.replace("_", " "))
    order = ("**failed**", "**timed out**", "passed", "not run")
    return "; ".join(f"{', '.join(of_word[word])} {word}" for word in order if word in of_word)


def scene_rows(record: dict) -> list[list[str]]:
    """The timed scenes of a record, `.cpu` on the processor of the same machine."""
    rows = []
    for name, scene in record["scenes"].items():
        if scene is None:
            continue
        where = f"processor, {scene['linear_solver']}" if name.endswith(".cpu") else "card"
        sizes = scene["outcome"], f"{scene['vertices']:,}", number(scene["contacts"])
        counts = (str(scene[key]) for key in ("steps", "newton_iterations", "pcg_iterations"))
        times = (number(scene[key]) for key in ("step_s", "newton_ms", "pcg_ms"))
        proof = _share(scene.get("end_check_s"), scene["wall_s"])
        rows.append([name.removesuffix(".cpu"), where, *sizes, *counts, *times, proof])
    return rows


def phase_rows(record: dict) -> tuple[list[str], list[list[str]]]:
    """Head and rows: every phase of the scenes that have them, ms a Newton iteration after the first step.
    Where phases are not synchronised, one may have what an earlier one launched.
    """
    timed = {
        name: scene["phases_ms"] for name, scene in record["scenes"].items() if (scene or {}).get("phases_ms")
    }
    rows = [
        [phase.removesuffix("_s").replace("_", " "), *(number(of.get(phase)) for of in timed.values())]
        for phase in dict.fromkeys(phase for of in timed.values() for phase in of)
    ]
    waiting = record.get("synchronized", [])
    return ["phase", *(f"{name}, synchronised" if name in waiting else name for name in timed)], rows


def counter_rows(record: dict) -> tuple[list[str], list[list[str]]]:
    """Head and rows: hardware counters of one launch of each kernel."""
    load, local = "l1tex__t_{}_pipe_lsu_mem_global_op_ld.sum", "l1tex__t_bytes_pipe_lsu_mem_local_op_{}.sum"
    rows = []
    for kernel in record.get("counters", []):
        requests, sectors = kernel.get(load.format("requests")), kernel.get(load.format("sectors"))
        spilled = [kernel[name] for name in map(local.format, ("ld", "st")) if name in kernel]
        row = [f"`{kernel['name']}`"]
        for name, (_, factor) in COUNTERS.items():
            row.append(number(kernel[name] * factor if name in kernel else None))
        row.append(number(sectors / requests if requests and sectors is not None else None))
        rows.append([*row, number(1e-6 * sum(spilled) if spilled else None)])
    return ["kernel", *(head for head, _ in COUNTERS.values()), "sectors a load", "local, MB"], rows


def stage_rows(record: dict) -> list[list[str]]:
    names = ("name", "exit_code", "seconds", "limit_s")
    return [[str(stage[name]) for name in names] for stage in record.get("stages", [])]


def _share(part: float | None, whole: float | None) -> str:
    return f"{100 * part / whole:.0f} %" if part is not None and whole else "not measured"


def _both(run: dict, key: str) -> str:
    values = run["card"][key], run["host"][key]
    card, host = (f"{one:,.0f}" if isinstance(one, (int, float)) else str(one) for one in values)
    return card if card == host else f"{card}, host {host}"


def same_rows(record: dict) -> list[list[str]]:
    """Runs of a card beside the host executor's."""
    rows = []
    for run in record.get("same", []):
        both = [_both(run, key) for key in ("outcome", "newton_iterations", "pcg_iterations", "contacts")]
        same = {True: "yes", False: "no", None: "not known"}[run["same_bits"]]
        rows.append([run["name"], f"{run['vertices']:,}", str(run["steps"]), *both, same])
    return rows


def mixes_idle(kernel: dict) -> bool:
    """Whether launches that did nothing may be in its sums: records until 2026-11-28 have no `idle`."""
    return kernel.get("idle") is None and kernel["name"].split("::")[-1] in OF_SOLVE


def kernel_rows(record: dict, copy: float) -> list[list[str]]:
    """copy: B/s of a copy on that card."""
    rows = []
    for kernel in record["kernels"][:MOST_KERNELS]:
        rate = kernel["Bps"]
        row = [f"`{kernel['name']}`", str(kernel["launches"])]
        if mixes_idle(kernel):
            rows.append([*row, *["not known"] * 4])
            continue
        a_launch = number(1e6 * kernel["seconds"] / max(kernel["launches"], 1))
        giga = number(None if rate is None else 1e-9 * rate)
        rows.append([*row, str(kernel.get("idle", 0)), a_launch, giga, _share(rate, copy)])
    return rows


def cost_rows(records: list[dict], prices: dict) -> list[list[str]]:
    """One row a kind of card; the newest record of it that ran the scene."""
    rows = []
    for card in prices["cards"]:
        timed = [record for record in records if _scene(record, LARGE, "step_s")]
        of_card = [r for r in timed if any(word in r["device"]["card"] for word in card["match"])]
        newest = max(of_card, key=lambda record: record["date_utc"], default=None)
        step_s, dt = (_scene(newest, LARGE, key) if newest else None for key in ("step_s", "dt_s"))
        price, currency = card["price_per_hour"], prices["currency"]
        known = price is not None and card["as_of"] and card["source"]
        text = "enter yours, with date and source, in results/gpu/prices.json"
        if known:
            text = f"{price:g} {currency} ({card['as_of']}, {card['source']})"
        a_second = "not measured" if step_s is None else "no price"
        if step_s and known:
            a_second = f"{number(step_s / dt / 3600 * price)} {currency}"
        rows.append([card["name"], text, number(None if step_s is None else 3600 / step_s), a_second])
    return rows
