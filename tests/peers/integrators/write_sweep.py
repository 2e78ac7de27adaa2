"""Writes a sweep to Parquet by one of the programs: SCRIPT CASES TOLERANCE FOLDER METHOD...

Prints for each method the CPU seconds a case: simulating and writing, without imports and compiling.
"""

import importlib
import sys
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

REVOLUTIONS = 20


def write(run, method, tolerance, clearances, path):
    """A row group a case: its number, clearance, and float32 samples."""
    schema = pa.schema([("case", pa.int32()), ("clearance", pa.float64()),
                        ("acceleration", pa.list_(pa.float32()))])
    with pq.ParquetWriter(path, schema, compression="zstd") as writer:
        for case, clearance in enumerate(clearances):
            samples = run(method, tolerance, REVOLUTIONS, clearance).astype(np.float32)
            row = {"case": [case], "clearance": [clearance], "acceleration": [samples]}
            writer.write_table(pa.table(row, schema=schema))


def main():
    script, cases, tolerance, folder, *methods = sys.argv[1:]
    run = importlib.import_module(script).run
    clearances = np.linspace(0.1e-3, 0.4e-3, int(cases))
    for method in methods:
        path = Path(folder) / f"{script}-{method}.parquet"
        run(method, 1e-3, 1, clearances[0])
        write(run, method, 1e-3, clearances[:1], path)
        start = time.process_time()
        write(run, method, float(tolerance), clearances, path)
        print((time.process_time() - start) / len(clearances))


if __name__ == "__main__":
    main()
