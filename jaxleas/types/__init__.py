"""Values that cross rooms. This room imports nothing of ours."""

from jaxleas.types.errors import InputError, JaxleasError
from jaxleas.types.paths import GuidePath
from jaxleas.types.queries import Query
from jaxleas.types.root import RootMotion

__all__ = ["GuidePath", "InputError", "JaxleasError", "Query", "RootMotion"]
