"""The programs `crosshead` and `gen-dataset`: the same code as the package, called with a command line."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import sysconfig

from . import _crosshead


def crosshead() -> None:
    """The program `crosshead`."""
    sys.exit(run("crosshead", sys.argv))


def gen_dataset() -> None:
    """The program `gen-dataset`."""
    sys.exit(run("gen-dataset", sys.argv))


def run(name: str, arguments: list[str]) -> int:
    """Does what the arguments say, the first of which is the program's name, and returns the exit status."""
    # Rust stops work at Ctrl-C; a verb that does not is ended by it, as any program is.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _crosshead.program(name, arguments)


def name_program() -> None:
    """Tells the package where its own program is, which tries single cases in processes of their own."""
    scripts = sysconfig.get_path("scripts")
    found = shutil.which("crosshead", path=scripts)
    if found:
        _crosshead.set_program(os.path.abspath(found))
