"""What goes wrong: each message says the file, the line or key, what was found and what is expected."""


class LensproofError(Exception):
    """A command failed for no fault of its input: the disk is full, memory ran out."""


class InputError(LensproofError, ValueError):
    """An option, a file or an array that cannot be used."""
