"""A chain of equal springs with equal masses at its inner nodes, hung at two ends: the discrete elastic
catenary in closed form.

The horizontal force H is the same in every spring; the vertical one changes by m g from spring to spring. A
spring under the force T has the length l0 + T/k along it. The two numbers that are left, H and the vertical
force of the first spring, are those with which the springs reach from one end to the other: two equations,
solved to rounding.
"""

import numpy as np
from scipy.optimize import root

from barrierbench_analysis.io.errors import UserError


def chain_nodes(
    segments: int, rest_length: float, stiffness: float, node_weight: float, span: np.ndarray
) -> np.ndarray:
    """Nodes [segments + 1, 2] m (x, height) from (0, 0) to span.

    rest_length: of one spring, m; stiffness: of one spring, N/m; node_weight: m g of an inner node, N.
    Errors: UserError.
    """
    span = np.asarray(span, float)
    order = np.arange(segments)

    def legs(unknown: np.ndarray) -> np.ndarray:
        force = np.stack([np.full(segments, unknown[0]), unknown[1] + node_weight * order], axis=1)
        size = np.linalg.norm(force, axis=1)[:, None]
        return force * (rest_length / size + 1 / stiffness)

    weight = node_weight * (segments - 1)
    for guess in (0.1, 0.3, 1.0, 3.0, 10.0):
        found = root(
            lambda u: (legs(u * weight).sum(axis=0) - span) / (segments * rest_length),
            np.array([guess, -0.5]),
            tol=1e-15,
        )
        if np.abs(legs(found.x * weight).sum(axis=0) - span).max() < 1e-12 * segments * rest_length:
            return np.vstack([np.zeros(2), np.cumsum(legs(found.x * weight), axis=0)])
    raise UserError(f"no equilibrium of {segments} springs over {span} m found: {found.message}")
