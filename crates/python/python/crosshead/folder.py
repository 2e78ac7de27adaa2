"""Folders of results."""

import json
import os
import pathlib
import tempfile

from .errors import InputError


class Folder:
    """A folder of results: given by the user, or a temporary one that goes with this object."""

    def __init__(self, path=None, prefix="crosshead-"):
        self._temporary = None
        if path is None:
            self._temporary = tempfile.TemporaryDirectory(prefix=prefix)
            path = self._temporary.name
        self.path = pathlib.Path(path)

    def read(self, name):
        """The content of a JSON file."""
        path = self.path / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: {error}") from error


def paths(one_or_several):
    """Paths as a list of texts."""
    if isinstance(one_or_several, (str, os.PathLike)):
        return [os.fspath(one_or_several)]
    return [os.fspath(path) for path in one_or_several]
