"""From the text of a formula to a library that the program loads."""

import contextlib
import importlib
import signal
from collections.abc import Callable, Iterator

from . import cache
from .grammar import POLICY, Formula, FormulaError, read

SECONDS_TO_CHECK = 60


def compiled(text: str, declared: str | None = None) -> cache.Compiled:
    """declared: what `at_zero` says, or None. Cost: 0.1 s from the cache, else some seconds. Errors:
    FormulaError.
    """
    found = _kept(read(text), _made)
    if declared is not None and declared != found.about["at_zero"]:
        allowed = f'"{found.about["at_zero"]}": b -> {found.about["b_at_zero"]} at d = 0'
        raise FormulaError(f'at_zero "{declared}"', allowed)
    return found


def signs_of(unproven: list[str]) -> str:
    """How b > 0, b' < 0 and b'' >= 0 are known."""
    if not unproven:
        return "b > 0, b' < 0, b'' >= 0 are proven for d/d_hat from 1e-15 to 1 - 1e-15 (interval arithmetic)"
    more = f", and in {len(unproven) - 3} more ranges" if len(unproven) > 3 else ""
    return f"not proven, only sampled, for {'; '.join(unproven[:3])}{more}"


def compiled_policy(text: str) -> cache.Compiled:
    """The same of a stiffness, kappa in N/m of a contact."""
    return _kept(read(text, POLICY), _made_policy)


def _kept(formula: Formula, make: Callable[[Formula, str, list[str]], cache.Compiled]) -> cache.Compiled:
    """From the cache, else made."""
    words = cache.command()
    key = cache.key_of(formula, words)
    return cache.find(key) or make(formula, key, words)


def _made_policy(formula: Formula, key: str, words: list[str]) -> cache.Compiled:
    policy = _of_sympy("policy")
    with _within(SECONDS_TO_CHECK):
        kappa = policy.kappa_of(formula)
        points = policy.check(kappa)
    label, symbols = cache.label_of(formula), policy.symbols_of(kappa)
    about = {"formula": formula.text, "label": label, "points": points, "symbols": symbols}
    about["reads_gap"] = "d" in symbols
    text = policy.cpp(label.replace("-", "_"), formula.text, kappa)
    return cache.make(key, words, text, about, lambda library: policy.judge(library, kappa))


def _of_sympy(*names: str):
    """Modules that import sympy, which a formula of the cache does not need."""
    try:
        found = [importlib.import_module(f".{name}", __package__) for name in names]
    except ImportError as error:
        raise FormulaError(
            f"no Python package {error.name}", "the environment that ./bench setup makes"
        ) from None
    return found[0] if len(found) == 1 else found


def _made(formula: Formula, key: str, words: list[str]) -> cache.Compiled:
    accuracy, checks, source, symbolic = _of_sympy("accuracy", "checks", "source", "symbolic")
    with _within(SECONDS_TO_CHECK):
        terms = symbolic.terms_of(formula)
        ends = checks.check(terms, None)
        label = cache.label_of(formula)
        text = source.cpp(label.replace("-", "_"), formula.text, terms, ends)
    b_at_zero, capacity = f"{ends.at_zero[0]:.6g} d_hat^2", f"{-ends.at_zero[1]:.6g} kappa d_hat"
    if ends.kind == checks.INFINITE:
        b_at_zero, capacity = "infinity", None
    about = {"formula": formula.text, "label": label, "at_zero": ends.kind, "b_at_zero": b_at_zero}
    about |= {"capacity": capacity, "smoothness_at_d_hat": ends.smoothness, "unproven": list(ends.unproven)}
    about["terms"] = {name: str(x) for name, x in zip(checks.NAMES, terms.precise, strict=True)}
    return cache.make(key, words, text, about, lambda library: {"error_rel": accuracy.check(library, terms)})


@contextlib.contextmanager
def _within(seconds: int) -> Iterator[None]:
    """Limits of odd formulas may be looked for without end. Seconds are those of the processor."""

    def over(*_: object) -> None:
        raise FormulaError(f"a formula whose limits are not found within {seconds} s", "a simpler formula")

    before = signal.signal(signal.SIGPROF, over)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
