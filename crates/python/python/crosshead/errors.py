"""What is raised."""


class Error(Exception):
    """The work failed: a machine that cannot be simulated, a file that cannot be written."""


class InputError(Error, ValueError):
    """The input or the arguments are wrong. The message says where, what was found, and what is expected."""
