"""The package's exceptions: each message is one sentence that tells the user what to do."""


class JaxleasError(Exception):
    """A failure that the user can fix; the command line prints its message and exits with 2."""


class InputError(JaxleasError):
    """An unusable input: the message says what is wrong, where, and what would be right."""


class OwnCodeError(InputError):
    """The user's own code raised an exception, or does not keep the protocol of what it is."""
