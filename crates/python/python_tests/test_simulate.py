"""One run: its numbers, its memory, its errors, its interruption."""

import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import crosshead as ch
import numpy as np
import pytest


def test_a_run_is_that_of_the_command_line(machine, tmp_path):
    """The samples are those that `crosshead simulate` writes, bit by bit."""
    pyarrow = pytest.importorskip("pyarrow.parquet")
    run = ch.simulate(machine, revolutions=2, transient=3, seed=5, **{"joints.big_end.clearance": "0.15 mm"})
    arguments = ["--revolutions", "2", "--transient", "3", "--seed", "5", "--set", "joints.big_end.clearance=0.15 mm"]
    program = [sys.executable, "-m", "crosshead", "simulate", str(machine), *arguments, "--out", str(tmp_path / "run")]
    subprocess.run(program, check=True, capture_output=True)
    table = pyarrow.read_table(tmp_path / "run" / "signals.parquet")
    assert table.column_names == run.table.names
    for name in table.column_names:
        np.testing.assert_array_equal(table[name].to_numpy().astype(run.table[name].dtype), run.table[name])


def test_what_a_run_says(worn):
    assert worn.speed_rpm == pytest.approx(500, rel=1e-6)
    assert worn.sample_rate_hz == 10e3
    assert worn.clearances_m == {"small_end": pytest.approx(2e-4)}
    # Four revolutions of 0.12 s.
    assert len(worn.table) == 4800
    assert worn.table.units["crosshead_acceleration_m_s2"] == "m/s^2"
    assert worn.table.roles["crosshead_acceleration_m_s2"] == "signal"
    assert abs(worn.energy_residual) < 1e-6
    (chamber,) = worn.summary["chambers"]
    assert chamber["indicated_power_w"] == pytest.approx(2220, rel=0.01)


def test_the_crank_turns_as_its_sensor_says(worn):
    measured, true = worn.channels["crank_angle_rad"], worn.crank_angle_rad
    apart = np.angle(np.exp(1j * (measured - true)))
    # One step of the 16-bit encoder.
    assert np.abs(apart).max() < 2 * np.pi / 2**16


def test_the_journal_stays_near_its_circle(worn):
    motion = worn.motion
    radius = np.hypot(motion["true_small_end_offset_x_m"], motion["true_small_end_offset_y_m"])
    assert 0.5 * 2e-4 < np.median(radius) < 1.5 * 2e-4
    assert motion["true_small_end_normal_force_n"].max() > 1000
    assert "true_big_end_offset_x_m" not in motion


def test_no_copy_on_the_way_to_numpy_pyarrow_polars_and_torch(worn):
    """Each library holds the addresses of the samples that Rust has written."""
    name = "crosshead_acceleration_m_s2"
    samples = worn.channels[name]
    address = samples.__array_interface__["data"][0]
    assert not samples.flags.writeable
    assert worn.table[name].__array_interface__["data"][0] == address
    pa = pytest.importorskip("pyarrow")
    assert pa.table(worn.table)[name].chunk(0).buffers()[1].address == address
    pl = pytest.importorskip("polars")
    series = pl.DataFrame(worn.table)[name]
    assert series.to_numpy(allow_copy=False).__array_interface__["data"][0] == address


def test_no_copy_on_the_way_to_torch(worn):
    torch = pytest.importorskip("torch")
    samples = worn.channels["crosshead_acceleration_m_s2"]
    assert torch.from_dlpack(samples).data_ptr() == samples.__array_interface__["data"][0]


def test_samples_outlive_their_run(machine):
    samples = ch.simulate(machine, revolutions=1).channels["crosshead_acceleration_m_s2"]
    kept = samples.copy()
    # Whatever was freed is written over.
    for _ in range(3):
        ch.simulate(machine, revolutions=1, seed=1)
    np.testing.assert_array_equal(samples, kept)


def test_readers_in_one_line(worn):
    pa, pl, pd, duckdb = map(pytest.importorskip, ["pyarrow", "polars", "pandas", "duckdb"])
    table = worn.table
    peak = float(table["crosshead_acceleration_m_s2"].max())
    assert pa.table(table)["crosshead_acceleration_m_s2"].to_numpy().max() == peak
    assert pl.DataFrame(table)["crosshead_acceleration_m_s2"].max() == peak
    assert pd.DataFrame.from_arrow(table)["crosshead_acceleration_m_s2"].max() == peak
    samples = table  # duckdb finds it by its name
    found = duckdb.sql("select max(crosshead_acceleration_m_s2) from samples").fetchall()
    assert found == [(peak,)]


def test_the_same_seed_gives_the_same_samples(machine):
    def samples(seed):
        return ch.simulate(machine, revolutions=1, seed=seed).channels["crosshead_acceleration_m_s2"]

    np.testing.assert_array_equal(samples(1), samples(1))
    assert (samples(1) != samples(2)).any()


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"joints.smal_end.clearance": "0.2 mm"}, "did you mean 'small_end'?"),
        ({"joints.small_end.clearance": "0.2 s"}, "found '0.2 s' (a duration), expected a length"),
        ({"joints.small_end.clearance": 0.2}, "joints.small_end.clearance: found 0.2"),
        ({"sample_rate": "3 m"}, "sample_rate: found '3 m' (a length), expected a frequency"),
        ({"sample_rate": 10}, "sample rate: found 10 Hz, expected at least"),
        ({"revolutions": 0}, "revolutions: found 0, expected 1 or more"),
        ({"tolerance": 1}, "tolerance: found 1, expected a number from 1e-14 to 1e-2"),
    ],
)
def test_wrong_arguments(machine, arguments, message):
    with pytest.raises(ch.InputError) as raised:
        ch.simulate(machine, **arguments)
    assert message in str(raised.value)


def test_wrong_input_is_a_value_error_with_file_and_line(tmp_path, machine):
    with pytest.raises(ValueError, match=r"nowhere.yaml: cannot be read: there is no such file"):
        ch.simulate(tmp_path / "nowhere.yaml")
    wrong = tmp_path / "machine.yaml"
    text = machine.read_text()
    wrong.write_text(text.replace("length: 600 mm", "length: 600 ms", 1))
    line = next(i for i, row in enumerate(wrong.read_text().splitlines(), 1) if "600 ms" in row)
    with pytest.raises(ch.InputError, match=rf"machine.yaml:{line}:\d+: rod.length"):
        ch.simulate(wrong)
    with pytest.raises(ch.InputError, match="expected a Machine, a path"):
        ch.simulate(3)


def test_a_machine_is_changed_and_written(machine, tmp_path):
    original = ch.Machine(machine)
    worn = original.replace(**{"joints.big_end.clearance": "0.3 mm", "speed": "420 rpm"})
    assert original["joints.big_end.clearance"] == "ideal"
    assert worn["joints.big_end.clearance"] == "0.3 mm"
    assert worn.speed_rpm == pytest.approx(420)
    worn.save(tmp_path / "worn.yaml")
    again = ch.Machine(tmp_path / "worn.yaml")
    assert again.to_yaml() == worn.to_yaml() == ch.Machine.from_yaml(worn.to_yaml()).to_yaml()


def test_ctrl_c_ends_a_run(machine):
    """A run of hours ends within a second of the signal."""
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        ch.simulate(machine, revolutions=5000, transient=1_000_000, progress=False)
    assert time.monotonic() - started < 5


def test_other_threads_run_meanwhile(machine):
    """The interpreter's lock is free: another thread counts on while a run is computed."""
    counts, done = [], threading.Event()

    def count():
        while not done.is_set():
            counts.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    started = time.monotonic()
    ch.simulate(machine, revolutions=40, progress=False)
    ended = time.monotonic()
    done.set()
    thread.join()
    inside = [t for t in counts if started < t < ended]
    assert len(inside) > 100 * (ended - started)


def test_progress_is_called_and_may_end_the_work(machine):
    seen = []

    def stop(what, done, total, message):
        seen.append((what, done, total))
        if done > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        ch.simulate(machine, transient=0, revolutions=5000, progress=stop)
    assert seen[-1][0] == "% simulated" and seen[-1][2] == 100


def test_a_run_is_drawn(worn, tmp_path):
    pytest.importorskip("matplotlib").use("agg")
    figure = worn.plot()
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert "crosshead acceleration\nm/s^2" in labels and "cylinder pressure\nPa" in labels
    figure.savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").stat().st_size > 10_000


def test_the_programs_are_inside(machine, tmp_path):
    scripts = pathlib.Path(sys.executable).parent
    for program in ["crosshead", "gen-dataset"]:
        path = scripts / program
        if not path.exists():
            pytest.skip("the package is not installed")
        version = subprocess.run([path, "--version"], check=True, capture_output=True, text=True).stdout
        assert version == f"{program} {ch.__version__}\n"
        wrong = subprocess.run([path, "nowhere.yaml"], capture_output=True, text=True)
        assert wrong.returncode == 2
    wrong = subprocess.run([scripts / "crosshead", "simulate", tmp_path / "no.yaml"], capture_output=True, text=True)
    assert wrong.returncode == 2
    assert wrong.stderr == f"error: {tmp_path / 'no.yaml'}: cannot be read: there is no such file\n"
