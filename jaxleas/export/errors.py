"""The export's own failure."""

from jaxleas.types import JaxleasError


class ExportError(JaxleasError):
    """An artifact does not compute what the policy computes; nothing was written."""
