"""A time step as a step solver of Python sees it: E at an iterate, a direction, the motion along it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from .given import real, reals

Doubles = NDArray[np.float64]


class Trial(NamedTuple):
    """What a trial state is against the iterate."""

    change: float  # E(x + alpha dx) - E(x), J
    rounding: float  # J; a change that is no larger than that is noise

    def falls_by(self, least: float) -> bool:
        """Whether E falls by `least` (J, >= 0) or more, or its change is noise.

        >>> Trial(-2.0, 1e-9).falls_by(1.0), Trial(-0.5, 1e-9).falls_by(1.0), Trial(1e-12, 1e-9).falls_by(1.0)
        (True, False, True)
        """
        return self.change <= -least or abs(self.change) <= self.rounding


class Step:
    """One time step of n vertices: E(x) is to be made small, from `x_start` on, without a surface that passes another.

    A step is a loop over `iterations()`. Each has E, its gradient and its matrix at `x`, then one direction, which is
    `solve()` or set by hand, and then one motion along it: `bound()`, `trial(alpha)` or `feasible(alpha)`, `accept()`.
    What is called in another order is a RuntimeError. Arrays are read-only views or copies, as stated; views move with
    the iterates. After `advance` nothing of a step may be called; an error of the run inside of it ends it.
    """

    def __init__(self, core: _core.Step, counters: tuple[str, ...] = ()):
        self._core = core
        self.counts: dict[str, float] = dict.fromkeys(counters, 0.0)
        """The counters that the step solver declares, 0 at the start of a step."""
        self.detail = ""
        """One sentence on how the step ended, for the record; empty: what the program knows of it."""
        self._free: NDArray[np.bool_] | None = None

    @property
    def index(self) -> int:
        """Number of the step, from 0."""
        return self._core.index

    @property
    def h(self) -> float:
        """Length of the step, s."""
        return self._core.h

    @property
    def max_iterations(self) -> int:
        """/step_solver/max_iterations."""
        return self._core.max_iterations

    @property
    def tolerance(self) -> float:
        """h times /step_solver/tol_velocity_m_per_s, m: how near to the solution a step has to end."""
        return self._core.tolerance

    @property
    def free(self) -> NDArray[np.bool_]:
        """[n, 3]: False where a coordinate is prescribed, or locked in a planar scene. n_free are True."""
        if self._free is None:
            self._free = self._core.fixed() == 0
        return self._free

    @property
    def x(self) -> Doubles:
        """[n, 3] m, a view: the iterate."""
        return self._core.x

    @property
    def x_start(self) -> Doubles:
        """[n, 3] m: the state at the start of the step."""
        return self._core.x_start

    @property
    def x_tilde(self) -> Doubles:
        """[n, 3] m: where inertia alone would lead (docs/theory/incremental-potential.md)."""
        return self._core.x_tilde

    @property
    def target(self) -> Doubles:
        """[n, 3] m, read at prescribed vertices: their poses at the end of the step."""
        return self._core.target

    @property
    def at_target(self) -> bool:
        """Whether every prescribed vertex is at its pose. Until then their motion does work, and E may grow."""
        return self._core.at_target()

    def iterations(self) -> Iterator[int]:
        """Begins iterations 0, 1, ...: E, gradient and matrix are assembled at `x`. Ends after `max_iterations`."""
        while self._core.next():
            yield self._core.iteration()

    @property
    def energy(self) -> float:
        """E at the iterate, J. To compare states use `trial`, which keeps the digits of their difference."""
        return self._core.energy()

    @property
    def gradient(self) -> Doubles:
        """[n, 3] N, a view: of E where the iteration began, at prescribed coordinates too."""
        return self._core.gradient

    def system(self) -> tuple[Any, Doubles]:
        """A and b of the Newton direction A s = b over the n_free free coordinates, in their order in `x`.

        A: scipy.sparse.csr_matrix, N/m, symmetric, the Hessian as /hessian chooses (every element clamped to a positive
        semi-definite one unless the config says otherwise). b: N, -gradient, with the motion of prescribed vertices
        lifted to it. Copies. Before the direction of the iteration. Needs scipy.
        """
        from scipy import sparse

        starts, rows, values, right_side = self._core.system()
        n = right_side.size
        lower = sparse.csc_matrix((values, rows, starts), shape=(n, n))
        return (lower + sparse.tril(lower, -1, format="csc").T).tocsr(), right_side

    def solve(self) -> str | None:
        """The direction of /linear_solver; None, or the word that ends the step where it is of no use.

        Where the matrix is not positive definite it is brought nearer to the clamped one, as for steps of the program.
        """
        return self._core.solve()

    @property
    def direction(self) -> Doubles:
        """[n, 3] m, a copy. Set: [n, 3], of which free coordinates are read, or [n_free]; once an iteration.

        Prescribed vertices go to their poses whatever is set. Errors: ConfigError for another shape or a number that is
        not finite.
        """
        return self._core.direction()

    @direction.setter
    def direction(self, dx: Any) -> None:
        given = reals(dx, "direction")
        if given.shape == self.free.shape:
            given = given[self.free]
        n_free = int(self.free.sum())
        if given.shape != (n_free,):
            raise _core.ConfigError(
                f"direction: found shape {np.shape(dx)}; allowed: {self.free.shape}, or ({n_free},) of free coordinates"
            )
        if not np.isfinite(given).all():
            at = int(np.flatnonzero(self.free)[np.flatnonzero(~np.isfinite(given))[0]])
            raise _core.ConfigError(
                f"direction: found a number that is not finite at vertex {at // 3}, {'xyz'[at % 3]}; allowed: m"
            )
        self._core.set_direction(np.ascontiguousarray(given))

    @property
    def slope(self) -> float:
        """gradient . direction over free coordinates, J: negative where E falls."""
        return self._core.slope()

    @property
    def error(self) -> float:
        """How far x + direction is estimated to be from the solution, m, by how fast directions shrink."""
        return self._core.error()

    def bound(self) -> float:
        """The largest part of the motion in [0, 1] that is free of contact and keeps the strain limit (ACCD)."""
        return self._core.bound()

    def trial(self, alpha: float) -> Trial | None:
        """E at x + alpha direction against E at x; None where that state is not feasible.

        alpha: in (0, 1], up to `bound()` where that was called. A motion whose bound was not computed is judged by
        its end alone and may pass through a surface. Errors: ValueError for another alpha (ConfigError is one).
        """
        found = self._core.trial(real(alpha, "alpha"))
        return None if found is None else Trial(*found)

    def feasible(self, alpha: float) -> bool:
        """`trial` without energies: whether x + alpha direction is feasible."""
        return self._core.feasible(real(alpha, "alpha"))

    def accept(self) -> None:
        """The state of the last trial, which was feasible, becomes the iterate: `x` is there, the motion is over."""
        self._core.accept()

    def converged(self) -> bool:
        """Whether the step may end here: `error` was below `tolerance`, with prescribed vertices at their poses, at a
        known rate of convergence, and the whole direction was taken, or one that is shorter than `tolerance`.

        The rule is that of line_search, stricter in one point: a rate has to be known.
        """
        return self._core.converged()
