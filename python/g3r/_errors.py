"""Exceptions of g3r. All derive from `Error`; what they say is one line of plain text."""


class Error(Exception):
    """Base of all errors of g3r."""


class InputError(Error, ValueError):
    """The data or an option cannot be used: too few points, a damaged file, an option out of range."""


class NoFaces(InputError):
    """A file that is no mesh, in contrast to one whose faces cannot be used."""


class FileError(Error, OSError):
    """A file could not be created, read or written. The text names the file and the system's reason."""


class FileMissingError(FileError, FileNotFoundError):
    """An input file does not exist or may not be read."""


class UnavailableError(Error, RuntimeError):
    """The request is sound, but this build or this machine cannot serve it."""


class Cancelled(Error):
    """The progress callback returned False."""
