"""Folders of results."""

from __future__ import annotations

import json
import os
import pathlib
import tempfile
from collections.abc import Iterable
from typing import Any

from .errors import InputError
from .kinds import AnyPath


class Folder:
    """A folder of results: given by the user, or a temporary one that goes with this object."""

    def __init__(self, path: AnyPath | None = None) -> None:
        self._temporary = None
        if path is None:
            self._temporary = tempfile.TemporaryDirectory(prefix="crosshead-")
            path = self._temporary.name
        self.path = pathlib.Path(path)

    def read(self, name: str) -> dict[str, Any]:
        """The content of a JSON file."""
        path = self.path / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: {error}") from error


def paths(one_or_several: AnyPath | Iterable[AnyPath]) -> list[str]:
    """Paths as a list of texts."""
    if isinstance(one_or_several, (str, os.PathLike)):
        return [os.fspath(one_or_several)]
    return [os.fspath(path) for path in one_or_several]
