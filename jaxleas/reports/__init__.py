"""Reports: tables, pictures and pages of what was measured; nothing here measures or judges."""

from jaxleas.reports.figure_pictures import draw_figures
from jaxleas.reports.learning_curves import series
from jaxleas.reports.page import page_template
from jaxleas.reports.published import thesis
from jaxleas.reports.report import inline, write_report
from jaxleas.reports.table import align, percent
from jaxleas.reports.thesis_tables import thesis_tables

__all__ = [
    "align",
    "draw_figures",
    "inline",
    "page_template",
    "percent",
    "series",
    "thesis",
    "thesis_tables",
    "write_report",
]
