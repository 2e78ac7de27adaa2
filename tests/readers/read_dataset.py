"""Open datasets with everything that should open them, and compare what each one finds.

    python read_dataset.py DIR... [--expected FILE.json...]

Reads every table with pyarrow, pandas, polars, duckdb and Hugging Face datasets, and with deltalake and
polars where it was exported as a Delta table, every MCAP file with mcap and mcap-ros2-support, validates
croissant.json and reads records by it with mlcroissant, and runs the Python code of the data card. What is expected comes from
manifest.json and from the files themselves, which must agree with each other: checksums, counts,
splits, labels and units. With --expected, one file for each folder, also every value is compared with those of the file:

    {"units": {COLUMN: UNIT}, "tables": {PATH: {COLUMN: [VALUE]}},
     "mcap": {PATH: {"sample_rate_hz": X, "labels": {NAME: TEXT}, "units": {FIELD: UNIT},
                     "channels": {FIELD: [VALUE]}}}}

Exit status 1 and a line with the first difference of each dataset that has one.
"""

import argparse
import hashlib
import itertools
import json
import os
import re
import sys
import tempfile
from pathlib import Path

CACHE = tempfile.TemporaryDirectory()
os.environ.update(HF_HOME=CACHE.name, HF_HUB_OFFLINE="1", HF_DATASETS_OFFLINE="1")

import datasets  # noqa: E402  (reads the environment when imported)
import deltalake  # noqa: E402
import duckdb  # noqa: E402
import mlcroissant  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import polars as pl  # noqa: E402
import pyarrow as pa  # noqa: E402
import pyarrow.dataset  # noqa: E402
import pyarrow.parquet as pq  # noqa: E402
import yaml  # noqa: E402
from mcap.reader import make_reader  # noqa: E402
from mcap_ros2.decoder import DecoderFactory  # noqa: E402

SUBSETS = ("signals", "features")
# Folder of the log that makes a folder of Parquet files a Delta table.
DELTA = "_delta_log"
# A column whose name ends like this has a unit.
UNIT_SUFFIX = re.compile(r"_(m|s|hz|pa|n|rpm|rad|deg|kg|k|w|j|m_s|m_s2|rad_s|rad_s2|n_m|per_s)$")


class Difference(Exception):
    """Something is not what it should be."""


def same(found, expected, what):
    if found != expected:
        raise Difference(f"{what}: found {shorten(found)}, expected {shorten(expected)}")


def shorten(value):
    text = repr(value)
    return text if len(text) < 400 else text[:400] + "..."


# ---- columns, in one form for all libraries: (None or value) per row, lists as bytes of float32


def plain(values, nan_is_null=False):
    """Values as Python has them; recordings as the bytes of float32 samples."""

    def one(value):
        if isinstance(value, (list, tuple, np.ndarray, pl.Series)):
            if isinstance(value, pl.Series):
                same(value.dtype, pl.Float32, "type of samples in polars")
                value = value.to_numpy()
            if isinstance(value, np.ndarray):
                same(value.dtype, np.dtype("float32"), "type of samples")
            return np.asarray(value, dtype="float32").tobytes()
        if isinstance(value, np.generic):
            value = value.item()
        if nan_is_null and (value is None or value is pd.NA or value != value):
            return None
        return value

    return [one(value) for value in values]


def of_arrow(column):
    if not pa.types.is_list(column.type):
        return plain(column.to_pylist())
    same(column.type.value_type, pa.float32(), "type of samples in pyarrow")
    return plain(None if not row.is_valid else row.values.to_numpy() for row in column)


def equal_columns(found, expected, what):
    same(list(found), list(expected), f"columns of {what}")
    for name, values in expected.items():
        same(len(found[name]), len(values), f"rows of {what}, column {name}")
        for row, (a, b) in enumerate(zip(found[name], values)):
            if a != b and not (a != a and b != b):
                raise Difference(f"{what}, column {name}, row {row}: {shorten(a)} is not {shorten(b)}")


# ---- tables


def read_table(path):
    """One file through pyarrow, compared with pandas and polars. The columns, and their units."""
    table = pq.read_table(path)
    expected = {name: of_arrow(table[name]) for name in table.column_names}

    with_pandas = pd.read_parquet(path)
    found = {name: plain(with_pandas[name], nan_is_null=True) for name in with_pandas}
    without_nan = {name: [None if v != v else v for v in values] for name, values in expected.items()}
    equal_columns(found, without_nan, f"{path} in pandas")

    with_polars = pl.read_parquet(path)
    found = {series.name: plain(series) for series in with_polars}
    equal_columns(found, expected, f"{path} in polars")

    fields = {f.name: (f.metadata or {}) for f in table.schema}
    units = {name: m[b"unit"].decode() for name, m in fields.items() if b"unit" in m}
    keys = pq.read_metadata(path).metadata
    same(json.loads(keys[b"units"]), units, f"{path}: units among the file's own keys")
    same(json.loads(table.schema.metadata[b"units"]), units, f"{path}: units of pyarrow's schema")
    same(with_pandas.attrs.get("units"), units, f"{path}: units in pandas")
    same(json.loads(pl.read_parquet_metadata(path)["units"]), units, f"{path}: units in polars")
    descriptions = {name: m[b"description"].decode() for name, m in fields.items()}
    same(json.loads(keys[b"descriptions"]), descriptions, f"{path}: descriptions")
    for name in table.column_names:
        if UNIT_SUFFIX.search(name) and name not in units:
            raise Difference(f"{path}: column {name} has no unit")
        if not descriptions[name]:
            raise Difference(f"{path}: column {name} has no description")
    return expected, units


def together(columns, more):
    if columns is None:
        return {name: list(values) for name, values in more.items()}
    same(list(more), list(columns), "columns of two files of one subset")
    for name, values in more.items():
        columns[name] += values
    return columns


def read_subset(folder, subset, expected):
    """All files of a subset: its columns by split. Also as one dataset of pyarrow and polars."""
    splits = {}
    for path in sorted(p for p in (folder / subset).iterdir() if p.name != DELTA):
        name = re.fullmatch(r"([a-z]+)-(\d{5})-of-(\d{5})\.parquet", path.name)
        if not name:
            raise Difference(f"{path} is no SPLIT-NNNNN-of-NNNNN.parquet")
        columns, units = read_table(path)
        same(set(columns["split"]) - {name[1]}, set(), f"{path}: other splits")
        if expected:
            place = path.relative_to(folder).as_posix()
            values = {column: plain(v) for column, v in expected["tables"][place].items()}
            equal_columns(columns, values, f"{path} against {place} of the expected values")
            wanted = {k: v for k, v in expected["units"].items() if k in columns}
            same(units, wanted, f"{path}: units")
        splits[name[1]] = together(splits.get(name[1]), columns)
    every = None
    for split in sorted(splits):
        every = together(every, splits[split])

    table = pyarrow.dataset.dataset(folder / subset).to_table()
    found = {name: of_arrow(table[name]) for name in table.column_names}
    equal_columns(found, every, f"{subset} as a dataset of pyarrow")
    same(pd.read_parquet(folder / subset).attrs.get("units"), units, f"{subset} as a whole: units in pandas")
    table = pl.scan_parquet(folder / subset / "*.parquet").collect()
    equal_columns({s.name: plain(s) for s in table}, every, f"{subset} scanned by polars")
    read_whole(folder / subset, every)
    return splits


def read_whole(table, every):
    """A folder of Parquet files by duckdb, and by the readers of Delta tables where it is one."""
    names = ", ".join(f'"{name}"' for name in every)
    query = f"SELECT {names} FROM read_parquet('{table}/*.parquet', filename=true) ORDER BY filename, file_row_number"
    query = query.replace("filename=true", "filename=true, file_row_number=true")
    found = duckdb.sql(query).to_arrow_table()
    equal_columns({name: of_arrow(found[name]) for name in every}, every, f"{table} in duckdb")
    if not (table / DELTA).is_dir():
        return
    delta = deltalake.DeltaTable(str(table))
    listed = sorted(pathlib_name(uri) for uri in delta.file_uris())
    same(listed, sorted(p.name for p in table.glob("*.parquet")), f"files of the Delta table {table}")
    same(delta.count(), len(next(iter(every.values()))), f"rows that the log of {table} states")
    for reader, found in [
        ("deltalake", delta.to_pyarrow_table()),
        ("polars", pl.read_delta(str(table)).to_arrow(compat_level=pl.CompatLevel.oldest())),
    ]:
        columns = {name: of_arrow(found[name].combine_chunks()) for name in found.column_names}
        equal_columns(in_order(columns), in_order(every), f"the Delta table {table} in {reader}")


def pathlib_name(uri):
    return uri.rsplit("/", 1)[-1]


def in_order(columns):
    """The rows in the order of their content: a Delta table has none."""
    keys = [name for name in ("bifurcation", "case_id", "window", "value", "direction") if name in columns]
    rows = range(len(columns[keys[0]]))
    order = sorted(rows, key=lambda row: [repr(columns[name][row]) for name in keys])
    return {name: [values[row] for row in order] for name, values in columns.items()}


def read_diagrams(folder):
    """The bifurcation diagrams, which have no splits: to datasets all of them are split train."""
    every = None
    for path in sorted(p for p in (folder / "bifurcations").glob("*") if p.name != DELTA):
        same(path.suffix, ".parquet", f"{path}: kind of file")
        columns, _ = read_table(path)
        same(set(columns["bifurcation"]), {path.stem}, f"{path}: names of diagrams")
        every = together(every, columns)
    if every:
        read_whole(folder / "bifurcations", every)
    return {"bifurcations": {"train": every}} if every else {}


def read_with_datasets(folder, tables):
    """Hugging Face datasets: the configurations of the data card, and the one it takes by itself."""
    card = yaml.safe_load((folder / "README.md").read_text().split("---\n")[1])
    configs = card.get("configs", [])
    def has_rows(columns):
        return bool(next(iter(columns.values())))

    tables = {name: splits for name, splits in tables.items() if any(map(has_rows, splits.values()))}
    if not tables:
        return same(configs, [], "configurations of a dataset without rows")
    same(sorted(c["config_name"] for c in configs), sorted(tables), "configurations of the data card")
    default = [c["config_name"] for c in configs if c.get("default")]
    same(default, [s for s in SUBSETS if s in tables][:1], "the default configuration")
    for name in [*tables, None]:
        loaded = datasets.load_dataset(str(folder), *([name] if name else []))
        splits = {k: v for k, v in tables[name or default[0]].items() if has_rows(v)}
        same(sorted(loaded), sorted(splits), f"splits of {name} in datasets")
        for split, columns in splits.items():
            rows = loaded[split]
            table = rows.with_format("arrow")[:]
            found = {column: of_arrow(table[column]) for column in table.column_names}
            classes = {column: f for column, f in rows.features.items() if isinstance(f, datasets.ClassLabel)}
            same(list(classes), [c for c in ["fault"] if c in columns], f"classes of {name}/{split} in datasets")
            for column, label in classes.items():
                found[column] = [label.int2str(value) for value in found[column]]
                same(len(set(label.names)), label.num_classes, f"names of the classes of {column}")
            equal_columns(found, columns, f"{name}/{split} in datasets")
            if len(rows) > 0:
                row = {c: classes[c].int2str(v) if c in classes else v for c, v in rows[0].items()}
                first = {column: plain([value]) for column, value in row.items()}
                wanted = {column: values[:1] for column, values in columns.items()}
                equal_columns(first, wanted, f"first row of {name}/{split} in datasets")


# ---- Croissant

RECORDS = 3


def read_with_croissant(folder, manifest, tables):
    """croissant.json is valid, has the checksums of the manifest, and gives the records of the tables."""
    path = folder / "croissant.json"
    # It raises where the metadata is not valid.
    dataset = mlcroissant.Dataset(jsonld=str(path))
    metadata = dataset.metadata
    same(list(metadata.issues.errors), [], f"errors in {path}")
    sums = {file["path"]: file["sha256"] for file in manifest["files"]}
    files = [f for f in metadata.distribution if isinstance(f, mlcroissant.FileObject)]
    same({f.content_url: f.sha256 for f in files}, {p: s for p, s in sums.items() if p.endswith(".parquet")}, str(path))
    same([r.name for r in metadata.record_sets], list(tables), f"record sets of {path}")
    for name, splits in tables.items():
        every = {column: sum((c[column] for c in splits.values()), []) for column in next(iter(splits.values()))}
        if not next(iter(every.values())):
            continue
        key = [column for column in ("case_id", "window", "value", "direction", "bifurcation") if column in every]
        rows = list(zip(*(every[column] for column in key)))
        for record in itertools.islice(dataset.records(name), RECORDS):
            found = {column.removeprefix(f"{name}/"): of_croissant(value) for column, value in record.items()}
            row = rows.index(tuple(found[column] for column in key))
            wanted = {column: values[row : row + 1] for column, values in every.items()}
            equal_columns({column: [value] for column, value in found.items()}, wanted, f"a record of {name} by {path}")


def of_croissant(value):
    """A value as the tables have it: texts are bytes there, lists are numbers."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, (list, np.ndarray)):
        return np.asarray(value, dtype="float32").tobytes()
    return plain([value], nan_is_null=True)[0]


# ---- MCAP


def read_mcap(path):
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        attachments = {a.name: a.data for a in reader.iter_attachments()}
        times, samples, definition = [], [], None
        for schema, channel, message, sample in reader.iter_decoded_messages():
            same(channel.topic, "/crosshead", f"{path}: topic")
            same(sample.stamp.sec * 10**9 + sample.stamp.nanosec, message.log_time, f"{path}: stamp")
            if definition is None:
                definition = schema.data.decode()
                fields = re.findall(r"^float32 (\w+)(?: # (.+))?$", definition, re.MULTILINE)
            times.append(message.log_time)
            samples.append([getattr(sample, name) for name, _ in fields])
    if not samples:
        raise Difference(f"{path} has no messages")
    channels = np.asarray(samples, dtype="float32").T
    units = {name: unit for name, unit in fields if unit}
    for name, _ in fields:
        if UNIT_SUFFIX.search(name) and name not in units:
            raise Difference(f"{path}: channel {name} has no unit")
    return metadata, attachments, times, dict(zip([name for name, _ in fields], channels)), units


def equal_label(text, value, what):
    """Labels are text; one without a value is left out, so that there is always a value here."""
    if isinstance(value, float):
        return same(float(text), value, what)
    same(text, str(value).lower() if isinstance(value, bool) else str(value), what)


def check_mcap(folder, path, tables, expected):
    metadata, attachments, times, channels, units = read_mcap(path)
    labels = metadata["labels"]
    same(labels["case_id"], path.stem, f"{path}: case_id")
    same(attachments["sweep.yaml"], (folder / "sweep.yaml").read_bytes(), f"{path}: sweep.yaml")
    rate = float(labels["sample_rate_hz"])
    if any(abs(t - i * 1e9 / rate) > 1 for i, t in enumerate(times)):
        raise Difference(f"{path}: the times are not those of {rate} samples per second")
    for subset in tables.values():
        for split, columns in subset.items():
            rows = [i for i, case in enumerate(columns["case_id"]) if case == path.stem]
            for name in set(labels) & set(columns):
                for row in rows:
                    equal_label(labels[name], columns[name][row], f"{path}: label {name}")
    if expected:
        wanted = expected["mcap"][path.relative_to(folder).as_posix()]
        same(rate, wanted["sample_rate_hz"], f"{path}: sample rate")
        same(labels, wanted["labels"], f"{path}: labels")
        same(units, wanted["units"], f"{path}: units")
        found = {name: values.tolist() for name, values in channels.items()}
        equal_columns(found, wanted["channels"], str(path))
    return labels["case_id"]


# ---- the whole


def check_manifest(folder):
    manifest = json.loads((folder / "manifest.json").read_text())
    for entry in manifest["files"]:
        content = (folder / entry["path"]).read_bytes()
        same(len(content), entry["bytes"], f"{entry['path']}: size")
        same(hashlib.sha256(content).hexdigest(), entry["sha256"], f"{entry['path']}: sha256")
    listed = {entry["path"] for entry in manifest["files"]} | {"manifest.json"}
    if (folder / "SHA256SUMS").exists():
        sums = dict(reversed(line.split("  ", 1)) for line in (folder / "SHA256SUMS").read_text().splitlines())
        expected = {entry["path"]: entry["sha256"] for entry in manifest["files"]}
        expected["manifest.json"] = hashlib.sha256((folder / "manifest.json").read_bytes()).hexdigest()
        same(sums, expected, "SHA256SUMS")
        listed.add("SHA256SUMS")
    present = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    # The pages are made from the dataset afterwards: nobody has to list them.
    pages = {"report.html", "chaos.html", "features.html"}
    present = {p for p in present if p not in pages and not p.startswith("figures/")}
    present = {p for p in present if DELTA not in p}
    same(sorted(p for p in present if not p.startswith("_")), sorted(listed), "files of the folder")
    same(manifest["counts"]["failed"], len(manifest["failed"]), "failed cases")
    return manifest


def check_counts(manifest, tables):
    """Every table has the rows that the manifest counts, and no case is in two splits."""
    rows = {entry["path"]: entry["rows"] for entry in manifest["files"] if "rows" in entry}
    for subset, splits in tables.items():
        total = sum(count for path, count in rows.items() if path.startswith(subset + "/"))
        same(sum(len(c["case_id"]) for c in splits.values()), total, f"rows of {subset}")
        home = {}
        for split, columns in splits.items():
            counted = {f: n for f, n in manifest["counts"]["rows"].get(split, {}).items() if n}
            faults = {f: columns["fault"].count(f) for f in set(columns["fault"])}
            same(faults, counted, f"{subset}/{split}: rows by fault")
            for case in columns["case_id"]:
                same(split, home.setdefault(case, split), f"split of {case}")
    if len(tables) == 2:
        for split, columns in tables["signals"].items():
            features = tables["features"][split]
            for name in set(columns) & set(features):
                same(features[name], columns[name], f"{name} of signals and features, {split}")


def run_card(folder):
    """The Python code of the data card, as a user would paste it."""
    blocks = re.findall(r"```python\n(.*?)```", (folder / "README.md").read_text(), re.DOTALL)
    if not blocks:
        raise Difference("the data card shows no way to load the dataset")
    os.chdir(folder)
    for block in blocks:
        exec(compile(block, "README.md", "exec"), {})
    return len(blocks)


def read_dataset(folder, expected):
    manifest = check_manifest(folder)
    subsets = [subset for subset in SUBSETS if (folder / subset).is_dir()]
    tables = {subset: read_subset(folder, subset, expected) for subset in subsets}
    recordings = sorted((folder / "mcap").glob("*")) if (folder / "mcap").is_dir() else []
    if not tables and not recordings:
        raise Difference(f"{folder} holds neither tables nor MCAP files")
    check_counts(manifest, tables)
    diagrams = read_diagrams(folder)
    read_with_datasets(folder, {**tables, **diagrams})
    if (folder / "croissant.json").exists():
        read_with_croissant(folder, manifest, {**tables, **diagrams})
    cases = [check_mcap(folder, path, tables, expected) for path in recordings]
    if cases and "features" in tables:
        known = {case for columns in tables["features"].values() for case in columns["case_id"]}
        same(set(cases), known, "cases of mcap/ and of features/")
    blocks = run_card(folder)

    for subset, splits in tables.items():
        counts = ", ".join(f"{len(c['case_id'])} {split}" for split, c in splits.items())
        print(f"{subset}: {counts} rows, alike in pyarrow, pandas, polars, duckdb and datasets")
    for splits in diagrams.values():
        print(f"bifurcations: {len(splits['train']['value'])} rows, alike in all")
    print(f"{len(cases)} MCAP files, {blocks} pieces of code of the data card")


def main():
    arguments = argparse.ArgumentParser(description="Open datasets with every reader.")
    arguments.add_argument("folders", type=Path, nargs="+", metavar="DIR")
    arguments.add_argument("--expected", type=Path, nargs="+", metavar="FILE")
    arguments = arguments.parse_args()
    folders = [folder.resolve() for folder in arguments.folders]
    expected = arguments.expected and [json.loads(path.read_text()) for path in arguments.expected]

    datasets.disable_progress_bars()
    differences = 0
    for folder, values in zip(folders, expected or [None] * len(folders), strict=True):
        try:
            read_dataset(folder, values)
        except Difference as difference:
            print(f"read_dataset.py: {difference}", file=sys.stderr)
            differences += 1
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
