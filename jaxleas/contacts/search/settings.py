"""Settings of the search by forward sets."""

from jaxleas.contacts.programs.settings import ProgramSettings


class AstarSettings(ProgramSettings):
    """Settings of the search by forward sets."""
