"""Pages of results."""

from __future__ import annotations

import html
import os
import pathlib
import webbrowser

from . import _crosshead
from .kinds import AnyPath


class Page:
    """An HTML page. A notebook shows it; `show()` opens it in a browser."""

    def __init__(self, path: AnyPath) -> None:
        self.path = pathlib.Path(path)

    def __fspath__(self) -> str:
        return str(self.path)

    @property
    def html(self) -> str:
        """Its content."""
        return self.path.read_text(encoding="utf-8")

    def show(self) -> bool:
        """Opens it in a browser."""
        return webbrowser.open(self.path.absolute().as_uri())

    def _repr_html_(self) -> str:
        content = html.escape(self.html, quote=True)
        return f'<iframe srcdoc="{content}" style="width: 100%; height: 600px; border: 0"></iframe>'

    def __repr__(self) -> str:
        return f"<crosshead.Page: {self.path}>"


def page(folder: AnyPath, out: AnyPath | None = None) -> Page:
    """The page of what `folder` holds: a dataset, a calibration, wear or an explanation.

    out: the file to write. By default `report.html` in the folder.
    """
    out = os.path.join(folder, "report.html") if out is None else os.fspath(out)
    _crosshead.page(os.fspath(folder), out)
    return Page(out)
