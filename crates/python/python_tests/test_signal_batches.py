"""Recordings of a sweep without a folder."""

import gc
import os
import pathlib
import signal
import threading
import time

import crosshead as ch
import numpy as np
import pytest


@pytest.fixture
def long(sweep, tmp_path):
    """A sweep of more cases than are simulated ahead."""
    path = tmp_path / "long.yaml"
    path.write_text(sweep.read_text().replace("count: 12", "count: 600"))
    return path


def of(tables, name):
    return np.concatenate([table[name] for table in tables])


def test_the_rows_are_those_of_the_dataset(sweep, dataset):
    pl = pytest.importorskip("polars")
    with ch.generate(sweep) as batches:
        assert batches.cases == 12 and batches.roles["crosshead_acceleration_m_s2"] == "signal"
        tables = list(batches)
        assert batches.done == 12 and batches.failed == []
    found = pl.concat([pl.DataFrame(table) for table in tables]).sort("case_id")
    written = pl.DataFrame(dataset.signals()).sort("case_id")
    assert found.columns == written.columns == batches.names
    # Every value, the samples bit by bit.
    assert found.equals(written)
    assert list(found["case_id"]) == sorted(dataset.cases["case_id"])


def test_nothing_is_written(sweep, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    list(ch.generate(sweep))
    assert list(pathlib.Path(tmp_path).iterdir()) == []


def test_libraries_read_it_as_a_stream(sweep):
    pa, pl = pytest.importorskip("pyarrow"), pytest.importorskip("polars")
    reader = pa.RecordBatchReader.from_stream(ch.generate(sweep))
    assert sum(batch.num_rows for batch in reader) == 12
    assert len(pl.DataFrame(ch.generate(sweep))) == 12
    batches = ch.generate(sweep)
    list(batches)
    with pytest.raises(ch.Error, match="at their end"):
        pa.RecordBatchReader.from_stream(batches)


def threads():
    return len(os.listdir("/proc/self/task")) if os.path.exists("/proc/self/task") else 0


def settled(expected, seconds=20):
    """Whether the process comes down to so many threads."""
    ends = time.monotonic() + seconds
    while threads() > expected and time.monotonic() < ends:
        time.sleep(0.05)
    return threads() <= expected


def test_abandoned_it_ends(long):
    before = threads()
    batches = ch.generate(long)
    next(batches)
    del batches
    gc.collect()
    assert settled(before)
    with ch.generate(long) as batches:
        next(batches)
    assert settled(before)
    assert list(batches) == []
    assert batches.done < 600


def test_ctrl_c_ends_it(long):
    batches = ch.generate(long, progress=False)
    next(batches)
    started = time.monotonic()
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        for _ in batches:
            pass
    assert time.monotonic() - started < 30
    assert list(batches) == []


def test_a_progress_that_raises_ends_it(long):
    def stop(what, done, total, message):
        assert (what, total) == ("cases", 600)
        raise RuntimeError("enough")

    batches = ch.generate(long, progress=stop)
    with pytest.raises(RuntimeError, match="enough"):
        next(batches)
    assert list(batches) == []


def test_a_machine_and_channels_of_its_own(sweep, machine):
    fast = ch.Machine(machine).replace(speed="600 rpm")
    channels = ["crosshead_acceleration_m_s2", "crank_angle_rad"]
    tables = list(ch.generate(sweep, machine=fast, channels=channels))
    assert set(of(tables, "speed_rpm")) == {600.0}
    assert [name for name, role in tables[0].roles.items() if role == "signal"] == channels


def test_what_needs_a_folder(sweep, bundle, tmp_path):
    with pytest.raises(ch.InputError, match="existing: found 'resume' without a folder"):
        ch.generate(sweep, existing="resume")
    own = tmp_path / "own.yaml"
    own.write_text(f"{sweep.read_text()}calibrate: {{bundle: {bundle}}}\n")
    with pytest.raises(ch.InputError, match="calibrate: the sweep calibrates its machine, which needs a folder"):
        ch.generate(own)
