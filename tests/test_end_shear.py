"""A cantilever under a dead end shear, bent far.

K. Y. Sze, X. H. Liu, S. H. Lo, Popular benchmark problems for geometric nonlinear analysis of shells, Finite Elem.
Anal. Des. 40 (2004) 1551-1569: L 10, b 1, h 0.1, E 1.2e6, nu 0, total force 4 at the tip. Their table is of
shear-flexible elements; the inextensible elastica at full load is exact but for stretch. 16 x 1 elements `thin36`.
"""

import numpy as np
import pytest

import ancf

# Load factor, -U and W of the tip.
TABLE = np.array(
    [
        (0.05, 0.026, 0.663),
        (0.10, 0.103, 1.309),
        (0.15, 0.224, 1.922),
        (0.20, 0.381, 2.493),
        (0.25, 0.563, 3.015),
        (0.30, 0.763, 3.488),
        (0.35, 0.971, 3.912),
        (0.40, 1.184, 4.292),
        (0.45, 1.396, 4.631),
        (0.50, 1.604, 4.933),
        (0.55, 1.807, 5.202),
        (0.60, 2.002, 5.444),
        (0.65, 2.190, 5.660),
        (0.70, 2.370, 5.855),
        (0.75, 2.541, 6.031),
        (0.80, 2.705, 6.190),
        (0.85, 2.861, 6.335),
        (0.90, 3.010, 6.467),
        (0.95, 3.151, 6.588),
        (1.00, 3.286, 6.698),
    ]
)
ROUNDING = 5e-4
ELASTICA = (3.28941, 6.69964)


@pytest.fixture(scope="module")
def tip() -> np.ndarray:
    """-U and W at the load factors of the table, shape (20, 2)."""
    strip = ancf.Rectangle(
        size=(10.0, 1.0), divisions=(16, 1), thickness=0.1, material=ancf.Material(E=1.2e6, nu=0.0), element="thin36"
    )
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, 4.0))],
        probes=[ancf.Probe(name="tip", at=(10.0, 0.5), quantity="displacement")],
    )
    result = ancf.solve_static(model, load_factors=TABLE[:, 0].tolist())
    return result.probes["tip"].value[1:, [0, 2]] * [-1, 1]


def test_the_published_table(tip: np.ndarray) -> None:
    """Within 0.3 % and the rounding of the table at all twenty loads."""
    error = np.abs(tip - TABLE[:, 1:])
    assert np.all(error < 3e-3 * TABLE[:, 1:] + ROUNDING), error / TABLE[:, 1:]


def test_the_elastica(tip: np.ndarray) -> None:
    np.testing.assert_allclose(tip[-1], ELASTICA, rtol=1e-3)
