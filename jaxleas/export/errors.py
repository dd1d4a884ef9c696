"""The error of an export."""

from jaxleas.types import JaxleasError


class ExportError(JaxleasError):
    """An artifact computes something other than the policy does; nothing was written."""
