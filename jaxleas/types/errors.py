"""The package's exceptions: each message is one sentence a person can act on."""


class JaxleasError(Exception):
    """A failure that its reader can mend; the command line prints it alone and exits with 2."""


class InputError(JaxleasError):
    """What was given cannot be used: the message says what, where, and what would do."""
