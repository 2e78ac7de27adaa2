"""Count the rows of a dataset, finished or not, with every reader: each must find so many, and no case twice.

    python count_rows.py DIR ROWS

Whatever a crash left beside the data must not be met. Exit status 1 and a message at the first difference.
"""

import os
import sys
import tempfile
from pathlib import Path

CACHE = tempfile.TemporaryDirectory()
os.environ.update(HF_HOME=CACHE.name, HF_HUB_OFFLINE="1", HF_DATASETS_OFFLINE="1")

import datasets  # noqa: E402  (reads the environment when imported)
import duckdb  # noqa: E402
import pandas as pd  # noqa: E402
import polars as pl  # noqa: E402
import pyarrow.dataset  # noqa: E402

COLUMNS = ["case_id", "window"]


def loaded(*arguments, **options):
    """The rows of all splits that Hugging Face datasets finds."""
    splits = datasets.load_dataset(*arguments, cache_dir=tempfile.mkdtemp(dir=CACHE.name), **options)
    return [row for split in splits.values() for row in split.select_columns(COLUMNS).to_list()]


def readers(folder):
    """Each way to the rows of a folder of Parquet files, as lists of cases and windows."""
    glob = f"{folder}/*.parquet"
    yield "pyarrow, folder", lambda: pyarrow.dataset.dataset(folder).to_table(columns=COLUMNS).to_pylist()
    yield "pandas, folder", lambda: pd.read_parquet(folder, columns=COLUMNS).to_dict("records")
    yield "polars, folder", lambda: pl.scan_parquet(folder).select(COLUMNS).collect().to_dicts()
    yield "polars, glob", lambda: pl.scan_parquet(glob).select(COLUMNS).collect().to_dicts()
    for pattern in [glob, f"{folder}/**/*.parquet"]:
        query = f"SELECT case_id, \"window\" FROM read_parquet('{pattern}')"
        yield f"duckdb, {pattern}", lambda query=query: duckdb.sql(query).to_arrow_table().to_pylist()
    yield "datasets, folder", lambda: loaded(str(folder))
    yield "datasets, glob", lambda: loaded("parquet", data_files=glob)


def main():
    folder, rows = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    datasets.disable_progress_bars()
    for subset in ["signals", "features"]:
        for reader, read in readers(folder / subset):
            found = [(row["case_id"], row["window"]) for row in read()]
            if len(found) != rows or len(set(found)) != rows:
                sys.exit(f"{subset}: {reader}: {len(found)} rows, {len(set(found))} different, not {rows}")
            print(f"{subset}: {reader}: {rows} rows")


if __name__ == "__main__":
    main()
