"""How far a number may move: envelopes from perturbed copies, and distributions for numbers that are
chaotic."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import ks_2samp

from .metrics import Metric

CHAOTIC_SPREAD = 0.30  # largest - smallest of the copies over their median: beyond it a value says nothing
ENOUGH_COPIES = 5  # for quantiles; fewer leave the tolerance of the metric alone
KS_LEVEL = 1e-3


@dataclass(frozen=True)
class Envelope:
    value: float  # median of the copies
    lower: float
    upper: float
    n: int
    sample: tuple[float, ...] = ()  # of a chaotic number, whose distribution is compared instead


def is_chaotic(metric: Metric, values: np.ndarray) -> bool:
    spread = float(values.max() - values.min())
    if metric.unit == "log10":
        return spread > np.log10(1 + CHAOTIC_SPREAD)
    if metric.unit == "share":
        return False  # a word of a few copies: its envelope is wide enough, and no wider than all of them
    return spread > CHAOTIC_SPREAD * abs(float(np.median(values)))


def calibrate(metric: Metric, values) -> Envelope:
    """[q05 - 1.5 IQR, q95 + 1.5 IQR] of the copies, no tighter than the metric's tolerance round their
    median. The sample is kept where it is chaotic. A gap has its quantiles in the logarithm, so that no
    scatter lets it reach 0. Requires at least one finite value.
    """
    values = np.sort(np.asarray(values, dtype=float))
    if len(values) == 0 or not np.isfinite(values).all():
        raise ValueError(f"{metric.name}: needs finite values, has {values.tolist()}")
    middle = float(np.median(values))
    lower, upper = metric.tolerance.around(middle)
    if len(values) < ENOUGH_COPIES:
        return Envelope(middle, min(lower, float(values[0])), max(upper, float(values[-1])), len(values))
    logarithmic = metric.tolerance.logarithmic and (values > 0).all()
    q05, q25, q75, q95 = np.quantile(np.log(values) if logarithmic else values, [0.05, 0.25, 0.75, 0.95])
    reach = 1.5 * (q75 - q25)
    ends = q05 - reach, q95 + reach
    low, high = np.exp(ends) if logarithmic else ends
    sample = tuple(values.tolist()) if is_chaotic(metric, values) else ()
    return Envelope(middle, min(lower, float(low)), max(upper, float(high)), len(values), sample)


def scatter_above(values) -> float:
    """q95 + 1.5 IQR of the copies alone."""
    q25, q75, q95 = np.quantile(np.asarray(values, dtype=float), [0.25, 0.75, 0.95])
    return float(q95 + 1.5 * (q75 - q25))


def ks_p_value(old, new) -> float:
    """Of the two-sample Kolmogorov-Smirnov test, exact for samples of this size."""
    return float(ks_2samp(old, new, method="exact").pvalue)
