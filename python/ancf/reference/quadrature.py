"""Quadrature on unit intervals, squares and cubes: tensor products of Gauss and Lobatto rules."""

from dataclasses import dataclass
from functools import reduce

import numpy as np

from .arrays import FloatArray


@dataclass(frozen=True)
class Rule:
    """A quadrature rule: points of shape (points, dimensions) and weights of shape (points,)."""

    points: FloatArray
    weights: FloatArray


def gauss(n: int) -> Rule:
    """Gauss-Legendre rule with n points on [0, 1]."""
    x, weights = np.polynomial.legendre.leggauss(n)
    return Rule((x[:, None] + 1) / 2, weights / 2)


def lobatto3() -> Rule:
    """Gauss-Lobatto rule with three points on [0, 1]: the ends and the middle (Simpson's rule)."""
    return Rule(np.array([[0.0], [0.5], [1.0]]), np.array([1.0, 4.0, 1.0]) / 6)


def product(*rules: Rule) -> Rule:
    """Tensor product of rules on [0, 1], one a dimension; the first varies fastest."""
    grids = np.meshgrid(*(rule.points[:, 0] for rule in reversed(rules)), indexing="ij")
    weights = reduce(np.multiply.outer, (rule.weights for rule in reversed(rules)))
    return Rule(np.stack([grid.ravel() for grid in reversed(grids)], axis=1), np.ravel(weights))


def square(rule: Rule) -> Rule:
    """Tensor product of a rule on [0, 1] with itself; xi varies fastest."""
    return product(rule, rule)
