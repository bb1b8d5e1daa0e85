"""A mass that falls onto barriers of one gap and is thrown back: the conservative motion of one degree of
freedom, by quadrature.

m g'' = n kappa |b'(g)| - m a, with g the gap, n contacts, a the acceleration towards the surface (0 in a free
impact; then m is the reduced mass). Energy conservation gives the turning point and dt/dg; the time within
the barrier is an integral whose integrand is made regular by g = g_min + s^2. Gauss-Kronrod to a relative
tolerance of 1e-11: what is said about times and gaps holds to about 1e-10.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from barrierbench_analysis.tables.accuracy.shapes import barrier

TOLERANCE = 1e-11
NODES, NODES_WEIGHTS = np.polynomial.legendre.leggauss(12)
NODES, NODES_WEIGHTS = (NODES + 1) / 2, NODES_WEIGHTS / 2  # on [0, 1]


@dataclass(frozen=True)
class BarrierBounce:
    """mass kg, n contacts of stiffness kappa (N/m) of one shape, acceleration a m/s^2; at t = 0 the gap is
    start >= d_hat (m) and shrinks at speed v0 (m/s, >= 0). a > 0 or v0 > 0. Errors: ValueError when the
    barrier cannot turn the mass round.
    """

    shape: str
    argument: str
    kappa: float
    d_hat: float
    mass: float
    contacts: int
    acceleration: float
    start: float
    v0: float = 0.0

    def _potential(self, gap: float) -> float:
        """J, zero at d_hat."""
        return self.contacts * self.kappa * barrier(self.shape, self.argument, gap, self.d_hat)[
            0
        ] + self.mass * self.acceleration * (gap - self.d_hat)

    @cached_property
    def entry_speed(self) -> float:
        return float(np.sqrt(self.v0**2 + 2 * self.acceleration * (self.start - self.d_hat)))

    @cached_property
    def entry_time(self) -> float:
        """s from the start to the gap d_hat."""
        if self.acceleration == 0:
            return (self.start - self.d_hat) / self.v0
        return (self.entry_speed - self.v0) / self.acceleration

    @cached_property
    def smallest_gap(self) -> float:
        energy, low = 0.5 * self.mass * self.entry_speed**2, 1e-14 * self.d_hat
        if self._potential(low) <= energy:
            raise ValueError(f"{self.shape}: {energy:g} J pass a barrier of {self._potential(low):g} J")
        return float(
            brentq(
                lambda g: self._potential(g) - energy, low, self.d_hat * (1 - 1e-15), xtol=1e-18, rtol=1e-15
            )
        )

    def _force(self, gap: float) -> float:
        """N, outwards."""
        return (
            self.contacts * self.kappa * -barrier(self.shape, self.argument, gap, self.d_hat)[1]
            - self.mass * self.acceleration
        )

    def _time_from_turn(self, s: float) -> float:
        """s: time between the smallest gap and g_min + s^2, within the barrier."""
        energy, low = 0.5 * self.mass * self.entry_speed**2, self.smallest_gap

        def integrand(r: float) -> float:
            way = r * r
            # E - U is the work of the force from the turning point on; close to it the difference would
            # cancel.

            mean_force = (
                NODES_WEIGHTS @ [self._force(low + way * x) for x in NODES]
                if way < 0.1 * low
                else (energy - self._potential(low + way)) / way
            )
            return 2 / np.sqrt(2 / self.mass * mean_force)

        return quad(integrand, 0.0, s, epsabs=0.0, epsrel=TOLERANCE, limit=200)[0]

    @cached_property
    def _depth(self) -> float:
        return float(np.sqrt(self.d_hat - self.smallest_gap))

    @cached_property
    def half_contact(self) -> float:
        """s from entering the barrier to the smallest gap."""
        return self._time_from_turn(self._depth)

    @cached_property
    def period(self) -> float:
        """s between two entries; infinite without an acceleration that brings the mass back."""
        return 2 * self.half_contact + (
            2 * self.entry_speed / self.acceleration if self.acceleration > 0 else np.inf
        )

    def gap(self, t: float) -> float:
        """m at the time t >= 0 (s)."""
        since = t - self.entry_time
        if since < 0:
            return self.start - self.v0 * t - 0.5 * self.acceleration * t * t
        since = since % self.period if np.isfinite(self.period) else since
        if since <= 2 * self.half_contact:
            from_turn = abs(since - self.half_contact)
            if from_turn >= self.half_contact * (1 - 1e-14):
                return self.d_hat
            s = (
                brentq(
                    lambda r: self._time_from_turn(r) - from_turn, 0.0, self._depth, xtol=1e-15, rtol=1e-13
                )
                if from_turn > 0
                else 0.0
            )
            return self.smallest_gap + s * s
        out = since - 2 * self.half_contact
        return self.d_hat + self.entry_speed * out - 0.5 * self.acceleration * out * out
