"""Folders of results with a machine and a page."""

from __future__ import annotations

import os
import pathlib
from typing import ClassVar

from .errors import InputError
from .folder import Folder
from .kinds import AnyPath, Json
from .machine import Machine
from .page import Page, page


class Results:
    """What a verb that reads recordings has written into a folder."""

    FILE: ClassVar[str]
    """The file of its numbers."""

    def __init__(self, folder: AnyPath | Folder) -> None:
        self._folder = folder if isinstance(folder, Folder) else Folder(folder)
        self.results: Json = self._folder.read(self.FILE)
        """The content of that file."""

    @classmethod
    def new_folder(cls, out: AnyPath | None) -> Folder:
        """The folder to write into, which has no such results yet."""
        folder = Folder(out)
        file = folder.path / cls.FILE
        if file.exists():
            raise InputError(f"{file} is already there; `{cls.__name__}(folder)` opens it")
        return folder

    @property
    def folder(self) -> pathlib.Path:
        """The folder of its files."""
        return self._folder.path

    @property
    def machine(self) -> Machine:
        """The machine with what was found."""
        return Machine(self.folder / "machine.yaml")

    def page(self, out: AnyPath | None = None) -> Page:
        """Writes its page, and returns it."""
        return page(os.fspath(self.folder), out)
