"""`python -m crosshead` is the program `crosshead`."""

import sys

from .programs import run

sys.exit(run("crosshead", ["crosshead", *sys.argv[1:]]))
