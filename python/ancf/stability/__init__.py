"""Where methods fail: maps over step and stiffness, and a suite of cases in which such programs fail."""

from ancf.stability.report import write_map
from ancf.stability.scan import Map, scan
from ancf.stability.suite import run_suite

__all__ = ["Map", "run_suite", "scan", "write_map"]
