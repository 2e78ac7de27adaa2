#!/usr/bin/env python3
"""Makes the recordings of the corpus, a few samples each: make.py [FOLDER]. Needs numpy, pyarrow, scipy, mcap, h5py."""

import io
import json
import pathlib
import struct
import sys

import h5py
import numpy
import pyarrow
import pyarrow.parquet as parquet
import scipy.io
from mcap.writer import CompressionType, Writer

CORPUS = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "corpus")
SAMPLES = 12
WAVE = numpy.round(numpy.sin(numpy.arange(SAMPLES)), 3)


def keep(kind, name, content):
    (CORPUS / kind).mkdir(parents=True, exist_ok=True)
    (CORPUS / kind / name).write_bytes(content)


def csv():
    rows = [(i / 1000, x, 30.0 * i) for i, x in enumerate(WAVE)]
    lines = lambda cell, between: "".join(between.join(cell(x) for x in row) + "\n" for row in rows)
    plain = lambda x: f"{x:.4f}"
    keep("csv", "units.csv", ("time_s,acc [m/s^2],crank_angle_deg\n" + lines(plain, ",")).encode())
    german = "\ufeff# recorded\n\nZeit [ms];Druck (bar);Ort\n" + lines(lambda x: plain(x).replace(".", ","), ";")
    keep("csv", "semicolons.csv", german.encode())
    keep("csv", "bare.csv", "".join(f"{x}\n" for x in WAVE).encode() + b"\n\n1e-3\n")
    quoted = '"a, ""b""","c"\r\n' + "".join(f'"{x}",\r\n' for x in WAVE)
    keep("csv", "quoted.csv", quoted.encode())
    keep("csv", "latin.csv", "p [\xb5bar]\tname\n1\tx\n".encode("latin-1"))


def chunk(name, body):
    return name + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)


def wav():
    form = lambda code, channels, bits: struct.pack(
        "<HHIIHH", code, channels, 8000, 8000 * channels * bits // 8, channels * bits // 8, bits
    )
    riff = lambda name, *parts: chunk(name, b"WAVE" + b"".join(parts))
    whole = (WAVE * 30000).astype("<i2").tobytes()
    keep("wav", "i16.wav", riff(b"RIFF", chunk(b"fmt ", form(1, 1, 16)), chunk(b"LIST", b"odd"), chunk(b"data", whole)))
    extensible = form(0xFFFE, 2, 64) + struct.pack("<HHIH", 22, 64, 3, 3) + bytes(14)
    real = WAVE.astype("<f8").tobytes()
    keep("wav", "f64.wav", riff(b"RIFF", chunk(b"fmt ", extensible), chunk(b"data", real)))
    keep("wav", "u8.wav", riff(b"RIFF", chunk(b"fmt ", form(1, 3, 8)), chunk(b"data", bytes(range(36)))))
    keep("wav", "i24.wav", riff(b"RIFF", chunk(b"fmt ", form(1, 1, 24)), chunk(b"data", bytes(range(36)))))
    sizes = struct.pack("<QQQI", 200, len(whole), SAMPLES, 0)
    parts = [chunk(b"ds64", sizes), chunk(b"fmt ", form(1, 1, 16)), b"data" + struct.pack("<I", 0xFFFFFFFF) + whole]
    keep("wav", "rf64.wav", riff(b"RF64", *parts))


def mat():
    content = {
        "acc": WAVE,
        "t": numpy.arange(SAMPLES) / 1000.0,
        "both": numpy.stack([WAVE, -WAVE]).astype("f4"),
        "whole": numpy.arange(SAMPLES, dtype="i2"),
        "fs": 1000.0,
        "rpm": 500,
        "note": "text",
        "cell": numpy.array([1, "a"], dtype=object),
        "complex": WAVE * 1j,
    }
    for compressed, name in [(False, "plain.mat"), (True, "compressed.mat")]:
        out = io.BytesIO()
        scipy.io.savemat(out, content, do_compression=compressed)
        # The first bytes say when it was made.
        keep("mat", name, b"MATLAB 5.0 MAT-file".ljust(116) + out.getvalue()[116:])


def hdf5():
    for name, version in [("earliest.h5", "earliest"), ("latest.h5", "latest")]:
        out = io.BytesIO()
        with h5py.File(out, "w", libver=version) as file:
            file.attrs["fs"] = 1000
            file["run/acc"] = WAVE.astype(">f4")
            file["run/acc"].attrs["units"] = "m/s^2"
            file["run/rpm"] = 500.0
            both = numpy.stack([WAVE, -WAVE], 1)
            packed = {"compression": "gzip", "shuffle": True, "fletcher32": True, "chunks": (5, 1)}
            file.create_dataset("run/both", data=both, maxshape=(None, 2), **packed)
            file["run/again"] = h5py.SoftLink("/run/acc")
            file["note"] = "text"
        keep("hdf5", name, out.getvalue())


def mcap():
    definition = b"std_msgs/Header header\nint16 count\nfloat64 acc # m/s^2\nfloat32 p\n"
    head = bytes([0, 1, 0, 0]) + struct.pack("<iII", 1, 2, 2) + b"a\0"
    for name, compression, encoding in [
        ("plain.mcap", CompressionType.NONE, "cdr"),
        ("zstd.mcap", CompressionType.ZSTD, "cdr"),
        ("json.mcap", CompressionType.NONE, "json"),
    ]:
        out = io.BytesIO()
        writer = Writer(out, compression=compression, enable_crcs=False, use_chunking=True)
        writer.start(profile="ros2", library="corpus")
        schema = writer.register_schema("a", "ros2msg" if encoding == "cdr" else "jsonschema", definition)
        channel = writer.register_channel("/a", encoding, schema, {"k": "v"})
        writer.add_metadata("labels", {"fault": "none", "speed_rpm": "500", "sample_rate_hz": "1000"})
        for i, x in enumerate(WAVE):
            body = head + struct.pack("<h", i) + bytes(6) + struct.pack("<df", x, -x)
            if encoding == "json":
                body = json.dumps({"acc": x, "p": -x, "name": "a"}).encode()
            writer.add_message(channel, 10**6 * i, body, 10**6 * i)
        writer.finish()
        keep("mcap", name, out.getvalue())


def tables():
    lists = pyarrow.table(
        {
            "case_id": ["a", "b", "c"],
            "speed_rpm": [500.0, 400.0, None],
            "sample_rate_hz": [1000.0] * 3,
            "acc": pyarrow.array([WAVE, WAVE[:5], []], pyarrow.list_(pyarrow.float32())),
            "p": pyarrow.array([WAVE, WAVE[:5], []], pyarrow.large_list(pyarrow.float64())),
        }
    )
    columns = pyarrow.table(
        {
            "time_s": numpy.arange(SAMPLES) / 1000,
            "acc": WAVE.astype("f4"),
            "count": pyarrow.array([None] + list(range(1, SAMPLES)), pyarrow.uint16()),
            "fault": pyarrow.array(["none"] * SAMPLES).dictionary_encode(),
            "worn": [i % 2 == 0 for i in range(SAMPLES)],
        }
    )
    options = {
        "plain": {"compression": "none", "use_dictionary": False},
        "zstd": {"compression": "zstd", "row_group_size": 2},
        "snappy": {"compression": "snappy", "data_page_version": "2.0", "write_page_index": True},
        "delta": {
            "compression": "none",
            "use_dictionary": False,
            "column_encoding": {"case_id": "DELTA_BYTE_ARRAY", "fault": "DELTA_BYTE_ARRAY"},
        },
    }
    for kind, table in [("lists", lists), ("columns", columns)]:
        for name, chosen in options.items():
            chosen = dict(chosen)
            if "column_encoding" in chosen:
                own = {c: e for c, e in chosen["column_encoding"].items() if c in table.column_names}
                chosen["column_encoding"] = own
            out = io.BytesIO()
            parquet.write_table(table, out, **chosen)
            keep("parquet", f"{kind}-{name}.parquet", out.getvalue())


for make in [csv, wav, mat, hdf5, mcap, tables]:
    make()
