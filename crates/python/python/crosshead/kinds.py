"""Types of arguments."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Union

if TYPE_CHECKING:
    from .calibrate import Calibration
    from .explain_gap import Explanation
    from .machine import Machine
    from .wear import Wear

AnyPath = Union[str, "os.PathLike[str]"]
"""A path."""

AnyMachine = Union[AnyPath, "Machine", "Calibration", "Explanation", "Wear"]
"""A machine: the path of its file, or what has one."""

Progress = Union[bool, Callable[[str, int, Union[int, None], str], object], None]
"""Whether progress is drawn, or a function ``(what, done, total, message)`` that is called with it."""

Json = dict[str, Any]
"""What a JSON object holds."""
