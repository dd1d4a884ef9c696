"""The base of every configuration section: frozen, and strict about misspelt names."""

from collections.abc import Mapping

from pydantic import BaseModel, ConfigDict


class Strict(BaseModel):
    """A frozen section of a configuration that refuses unknown keys and non-finite numbers."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )

    @classmethod
    def former_names(cls) -> Mapping[str, str]:
        """Return present dotted names of fields by their former ones; files may use either."""
        return {}
