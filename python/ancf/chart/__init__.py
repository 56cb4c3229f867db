"""The work-precision chart of a scene: what each accuracy costs, and which settings to take.

`measure` runs the scene in many variants, `write_chart` leaves pictures, tables and a page.
"""

from ancf.chart.axes import default_axes, read_axes
from ancf.chart.labels import Label
from ancf.chart.measure import Chart, measure
from ancf.chart.points import Rival
from ancf.chart.report import write_chart

__all__ = ["Chart", "Label", "Rival", "default_axes", "measure", "read_axes", "write_chart"]
