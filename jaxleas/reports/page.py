"""The frame of all reports: one style, one way to fill a template."""

from importlib import resources
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Template

STYLE = "report.css"


def page_template(room: str, name: str) -> "Template":
    """Return a report's template; it is filled strictly, and `style` is shared by all reports.

    Args:
        room: package that contains the template.
        name: name of the template's file.
    """
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.globals["style"] = Markup(_text(__package__ or "", STYLE))  # ours: no escaping
    return environment.from_string(_text(room, name))


def _text(room: str, name: str) -> str:
    return resources.files(room).joinpath(name).read_text(encoding="utf-8")
