"""Labelled recordings of reciprocating compressors with worn bearings.

    import crosshead as ch
    run = ch.simulate("machine.yaml", **{"joints.small_end.clearance": "0.2 mm"})
    run.plot()

Values of machine and sweep files carry their units; what comes back is SI, and names end in the unit. Tables are Arrow tables:
polars, pandas, pyarrow and duckdb read them without a copy. Wrong input raises `InputError`, work that fails `Error`; Ctrl-C
stops any work.
"""

from ._crosshead import Table, __version__
from .angle import over_crank_angle
from .calibrate import Calibration, Parameter, calibrate
from .dataset import Dataset
from .domain_gap import DomainGap, TellingFeature, domain_gap
from .errors import Error, InputError
from .explain_gap import Explanation, explain_gap
from .features import Features, features
from .generate import generate
from .machine import Machine
from .page import Page
from .programs import name_program as _name_program
from .signal_batches import SignalBatches
from .simulate import Run, simulate
from .wear import Wear, estimate_wear

_name_program()

__all__ = [
    "Calibration",
    "Dataset",
    "DomainGap",
    "Error",
    "Explanation",
    "Features",
    "InputError",
    "Machine",
    "Page",
    "Parameter",
    "Run",
    "SignalBatches",
    "Table",
    "TellingFeature",
    "Wear",
    "__version__",
    "calibrate",
    "domain_gap",
    "estimate_wear",
    "explain_gap",
    "features",
    "generate",
    "over_crank_angle",
    "simulate",
]
