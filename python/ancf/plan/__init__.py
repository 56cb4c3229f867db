"""No more model than a scene needs: the cheapest one whose error is below a tolerance, and the evidence."""

from ancf.plan.planner import plan
from ancf.plan.report import Plan, Row

__all__ = ["Plan", "Row", "plan"]
