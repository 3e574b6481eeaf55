"""The one exception that the command line turns into a single line and exit code 2."""


class UserError(Exception):
    """Bad input. The text says what was wrong, where, and what to do, in one line."""


class Unavailable(Exception):
    """A compiler or driver that is not on this machine. The text says how to install it."""
