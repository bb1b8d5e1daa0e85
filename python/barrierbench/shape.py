"""Barrier shapes b(d; d_hat) with derivatives, contacts under a load, matching rules."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .given import finite_reals, real, reals


class Terms(NamedTuple):
    """A shape at gaps, for kappa = 1; exactly 0 from d_hat on."""

    b: NDArray[np.float64]  # m^2
    db: NDArray[np.float64]  # m, <= 0
    d2b: NDArray[np.float64]  # 1


class Equilibrium(NamedTuple):
    """One contact of stiffness kappa at rest under a load."""

    above_capacity: bool  # the shape cannot carry the load; d_m and stiffness are None
    d_m: float | None
    stiffness_N_per_m: float | None  # kappa b''(d); negative where the force falls towards contact
    capacity_N: float | None  # largest kappa |b'|; None: unbounded


def shapes() -> list[str]:
    """Names of all shapes; `NAME:A` has an exponent A.

    >>> shapes()[:3]
    ['log', 'log_squared', 'quadratic']
    """
    return _core.shape_names()


class Shape:
    """A shape by its name, on the gap or on the squared gap (`argument="squared_gap"`).

    The functions are those that runs call. Errors: ConfigError for an unknown name (the nearest is named).

    >>> cubic = Shape("cubic")
    >>> b, db, d2b = cubic([0.0, 0.005, 0.01], 0.01)
    >>> db.tolist()
    [-0.02, -0.005, 0.0]
    >>> Shape("cubik")
    Traceback (most recent call last):
        ...
    ConfigError: shape: found "cubik"; allowed: one of log, ... (did you mean cubic?)
    """

    def __init__(self, name: str, argument: str = "gap"):
        self._barrier = _core.Barrier(name, argument)

    def __repr__(self) -> str:
        return f"Shape({self.name!r}, argument={self.argument!r})"

    @property
    def name(self) -> str:
        return self._barrier.name

    @property
    def doc(self) -> str:
        return self._barrier.doc

    @property
    def argument(self) -> str:
        """gap or squared_gap."""
        return self._barrier.argument

    @property
    def smoothness_at_d_hat(self) -> int:
        """Number of continuous derivatives at d = d_hat, as the shape declares it."""
        return self._barrier.smoothness_at_d_hat

    @property
    def infinite_at_zero(self) -> bool:
        """Whether b grows beyond all bounds as d -> 0."""
        return self._barrier.infinite_at_zero

    def __call__(self, d: ArrayLike, d_hat: ArrayLike) -> Terms:
        """b, b', b'' at gaps d >= 0 (m) with activation distances d_hat > 0 (m), broadcast against each other.

        The results have the broadcast shape; () for two numbers. At d = 0 a shape without bound has inf, -inf, inf.
        Cost: O(n), no copy of contiguous float64. Errors: ConfigError naming the element that is out of range.
        """
        gap, width = np.broadcast_arrays(reals(d, "d"), finite_reals(d_hat, "d_hat"))
        found = self._barrier.terms(np.ascontiguousarray(gap).ravel(), np.ascontiguousarray(width).ravel())
        return Terms(*(column.reshape(gap.shape) for column in found))

    def rho(self, u: float) -> float:
        """d_hat b''/|b'| at d = u d_hat, 0 < u < 1: a contact that bears f has the stiffness rho f/d_hat.

        >>> Shape("cubic").rho(0.5)
        4.0
        """
        return self._barrier.rho(real(u, "u"))

    def equilibrium(self, kappa: float, d_hat: float, load: float) -> Equilibrium:
        """The largest gap (m) at which kappa |b'| = load. kappa N/m, d_hat m, load N, all > 0."""
        return Equilibrium(*self._barrier.equilibrium(real(kappa, "kappa"), real(d_hat, "d_hat"), real(load, "load")))

    def equal_force(self, d_hat: float, load: float, theta: float = 0.1) -> float:
        """Matching rule equal_force: kappa (N/m) = load/|b'(theta d_hat)|, load in N.

        >>> round(Shape("cubic").equal_force(d_hat=0.01, load=1.0, theta=0.5), 9)
        200.0
        """
        return self._barrier.equal_force(real(d_hat, "d_hat"), real(load, "load"), real(theta, "theta"))

    def equal_curvature(self, d_hat: float, curvature: float, theta: float = 0.5) -> float:
        """Matching rule equal_curvature: kappa (N/m) = curvature/b''(theta d_hat), curvature in N/m."""
        return self._barrier.equal_curvature(real(d_hat, "d_hat"), real(curvature, "curvature"), real(theta, "theta"))
