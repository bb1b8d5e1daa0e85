"""A Python class as a stiffness policy, for small scenes: every evaluation calls Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .given import reals
from .python_sources import is_name, remember

Doubles = NDArray[np.float64]


@dataclass
class ContactRows:
    """The n contacts at which a policy is evaluated. Of its four places the first n_free are free vertices;
    what the others hold has no meaning. Arrays belong to the run and are gone when the call is over.
    """

    n_free: NDArray[np.int32]  # [n] 1 to 4
    weight: Doubles  # [n, 4] w_i: grad_i d = w_i normal
    normal: Doubles  # [n, 3] unit
    d: Doubles  # [n] gap, m
    d_hat: Doubles  # [n] m
    mass: Doubles  # [n, 4] kg
    hessian: Doubles | None  # [n, 12, 12] elastic, N/m; None unless needs_hessian
    h: float  # time step, s
    c: float  # of the inertia M/(c h^2); 0: none

    @cached_property
    def w(self) -> Doubles:
        """[n, 4, 3] weighted normals, 0 at places that are not free."""
        free = np.arange(4) < self.n_free[:, None]
        return np.where(free, self.weight, 0.0)[:, :, None] * self.normal[:, None, :]

    @cached_property
    def w_sq(self) -> Doubles:
        """[n] w^T w."""
        return np.einsum("nij,nij->n", self.w, self.w)

    @cached_property
    def m(self) -> Doubles:
        """[n] w^T M w/(w^T w), kg."""
        free = np.arange(4) < self.n_free[:, None]
        return np.einsum("nij,nij,ni->n", self.w, self.w, np.where(free, self.mass, 0.0)) / self.w_sq

    @cached_property
    def k(self) -> Doubles:
        """[n] w^T H w/(w^T w), N/m. Errors: ConfigError where the policy has not set needs_hessian."""
        if self.hessian is None:
            raise _error("", "k without needs_hessian", "a policy with needs_hessian = True")
        w = self.w.reshape(-1, 12)
        places = np.repeat(np.arange(4) < self.n_free[:, None], 3, axis=1)
        blocks = np.where(places[:, :, None] & places[:, None, :], self.hessian, 0.0)
        return np.einsum("ni,nij,nj->n", w, blocks, w) / self.w_sq


def _error(name: str, found: str, allowed: str) -> _core.ConfigError:
    return _core.ConfigError(f"stiffness policy {name}: found {found}; allowed: {allowed}")


def _kappa(name: str, policy: Any, rows: ContactRows) -> Doubles:
    """Errors: what the policy raises; ConfigError with the contact where kappa is not a number >= 0."""
    found = policy.kappa(rows)
    numbers = reals(found, f"stiffness policy {name}: kappa")
    try:
        kappa = np.broadcast_to(numbers, rows.d.shape)
    except ValueError:
        raise _error(name, f"kappa of shape {numbers.shape}", f"numbers of shape {rows.d.shape}, that of d") from None
    wrong = ~(np.isfinite(kappa) & (kappa >= 0))
    if wrong.any():
        at = int(np.flatnonzero(wrong)[0])
        raise _error(name, f"kappa = {kappa[at]} N/m at d = {rows.d[at]:.6g} m", "finite numbers >= 0")
    return kappa


def _filler(name: str, policy: Any) -> Callable[..., None]:
    def fill(n_free, weight, normal, d, d_hat, mass, hessian, h, c, kappa):
        kappa[:] = _kappa(name, policy, ContactRows(n_free, weight, normal, d, d_hat, mass, hessian, h, c))

    return fill


def _check(name: str, policy: Any, needs_hessian: bool) -> None:
    """One contact of one free vertex."""
    one, place = np.ones(1), np.array([[1.0, 0, 0, 0]])
    hessian = np.zeros((1, 12, 12)) if needs_hessian else None
    if hessian is not None:
        hessian[0, 0, 0] = 100.0
    rows = ContactRows(
        np.ones(1, np.int32), place, np.array([[1.0, 0, 0]]), 0.004 * one, 0.01 * one, place, hessian, 0.01, 1.0
    )
    _kappa(name, policy, rows)


def register_policy(policy: Any) -> str:
    """Makes a Python object a stiffness policy that configs name, until the process ends; returns the name.

    policy: has `name` (snake_case) and `kappa(rows)`, which gets ContactRows and returns kappa in N/m, [n] or one
    number; and `needs_hessian` = True where it reads `rows.k` or `rows.hessian`. When it is evaluated (every iteration,
    or once a step) is the config's `refresh`. What it raises ends the step that called it, and the run is where it was
    before that step. The same name again replaces the object. Errors: ConfigError that names what does not hold;
    what `kappa` raises for a first contact of one vertex that it is tried with.

    >>> class Inertia:
    ...     name = "inertia_of_python"
    ...     def kappa(self, rows):
    ...         return rows.m / (rows.c * rows.h**2)
    >>> register_policy(Inertia())
    'inertia_of_python'
    """
    name = getattr(policy, "name", None)
    if not is_name(name):
        raise _error(str(name), f"name {name!r}", "a snake_case word")
    if not callable(getattr(policy, "kappa", None)):
        raise _error(name, type(policy).__name__, "an object with kappa(rows)")
    needs_hessian = getattr(policy, "needs_hessian", False)
    if not isinstance(needs_hessian, bool):
        raise _error(name, f"needs_hessian {needs_hessian!r}", "True or False")
    _check(name, policy, needs_hessian)
    doc = inspect.getdoc(policy) or "a policy of Python"
    _core.register_policy(name, doc.splitlines()[0], needs_hessian, _filler(name, policy))
    remember(policy, name)
    return name
