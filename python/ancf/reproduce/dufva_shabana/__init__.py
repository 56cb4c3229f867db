"""K. Dufva and A. A. Shabana, Analysis of thin plate structures using the absolute nodal coordinate formulation.

Proc. IMechE Part K 219 (2005) 345-355: every example of its section 8.
"""

from ancf.reproduce.dufva_shabana.report import reproduce

__all__ = ["reproduce"]
