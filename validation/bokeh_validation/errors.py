"""Define the two exceptions that the command line turns into a single line and exit code 2."""


class UserError(Exception):
    """Report bad input. The text says in one line what was wrong, where, and what to do."""


class Unavailable(Exception):
    """Report a compiler or driver that this machine lacks. The text says how to install it."""
