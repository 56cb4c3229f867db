"""Quadrature on the unit square: tensor products of Gauss and Lobatto rules."""

from dataclasses import dataclass

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


def square(rule: Rule) -> Rule:
    """Tensor product of a rule on [0, 1] with itself; xi varies fastest."""
    x = rule.points[:, 0]
    eta, xi = np.meshgrid(x, x, indexing="ij")
    return Rule(np.stack([xi.ravel(), eta.ravel()], axis=1), np.outer(rule.weights, rule.weights).ravel())
