"""Datasets: written, read back, handed to classifiers."""

import os
import signal
import subprocess
import sys
import threading

import crosshead as ch
import numpy as np
import pytest


def test_the_bytes_are_those_of_the_program(dataset, sweep, tmp_path):
    program = [sys.executable, "-m", "crosshead", "gen-dataset", str(sweep), "--out", str(tmp_path / "again")]
    subprocess.run(program, check=True, capture_output=True)
    assert (tmp_path / "again" / "manifest.json").read_bytes() == (dataset.folder / "manifest.json").read_bytes()


def test_cases_have_labels_conditions_and_unknowns(dataset):
    cases = dataset.cases
    assert len(cases) == 12 == len(set(cases["case_id"]))
    assert set(cases.roles.values()) == {"identifier", "label", "condition", "unknown"}
    assert set(cases["fault"]) == {"none", "big_end", "big_end+small_end"}
    worn = cases["clearance_big_end_m"][cases["fault"] == "big_end"]
    assert ((1e-4 <= worn) & (worn <= 3e-4)).all()
    assert dataset.conditions("train").names[0] == "speed_rpm"
    assert dataset.unknowns("train").names == ["cylinder.exponent"]


def test_features_alone_reach_a_classifier(dataset):
    x, y, groups = dataset.xy("train")
    test, *_ = dataset.xy("test")
    assert len(x) + len(test) == 12
    assert x.shape[1] == test.shape[1] == len(dataset.feature_names)
    assert x.dtype == np.float64 and np.isfinite(x).mean() > 0.9
    # Nothing that describes the case is among them.
    assert not {"speed_rpm", "clearance_big_end_m", "cylinder.exponent", "missing"} & set(dataset.feature_names)
    rms = dataset.table("train")["crosshead_acceleration.rms_m_s2"]
    np.testing.assert_array_equal(x[:, dataset.feature_names.index("crosshead_acceleration.rms_m_s2")], rms)
    assert len(groups) == len(y) == len(x)
    with pytest.raises(ch.InputError, match="target: found 'speed_rpm', expected a label: fault"):
        dataset.xy("train", target="speed_rpm")
    with pytest.raises(ch.InputError, match="split: found 'validation', expected one of train, test"):
        dataset.xy("validation")


def test_no_group_is_in_two_splits(dataset):
    groups = {split: set(dataset.xy(split)[2]) for split in dataset.splits}
    assert not groups["train"] & groups["test"]


def test_signals_are_a_stream(dataset):
    pl, pa = pytest.importorskip("polars"), pytest.importorskip("pyarrow")
    signals = pl.DataFrame(dataset.signals("train", columns=["case_id", "crosshead_acceleration_m_s2"]))
    rows = sum(len(table) for table in dataset.signals("train"))
    assert len(signals) == rows == len(dataset.xy("train")[1])
    case = dataset.cases["case_id"][3]
    one = dataset.signals(case=case)
    assert list(one["case_id"]) == [case]
    # Read again as the files have it.
    all_of_it = pa.table(dataset.signals())
    (row,) = np.nonzero(np.array(all_of_it["case_id"].to_pylist()) == case)[0]
    expected = np.array(all_of_it["crosshead_acceleration_m_s2"][int(row)].as_py(), dtype="float32")
    np.testing.assert_array_equal(one["crosshead_acceleration_m_s2"][0], expected)
    with pytest.raises(ch.InputError, match="case: found 'case-9'"):
        dataset.signals(case="case-9")


def test_a_damaged_dataset_is_refused(sweep, tmp_path):
    dataset = ch.generate(sweep, out=tmp_path / "damaged")
    path = next(path for path in sorted((dataset.folder / "features").iterdir()))
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(ch.InputError, match=path.name):
        ch.Dataset(dataset.folder)
    with pytest.raises(ch.InputError, match="nothing"):
        ch.Dataset(tmp_path / "nothing")
    with pytest.raises(ch.InputError, match="damaged"):
        ch.generate(sweep, out=tmp_path / "damaged")


def test_an_interrupted_dataset_is_resumed(sweep, dataset, tmp_path):
    """Ctrl-C between two shards; what resumes it ends with the bytes of an undisturbed run."""

    def interrupt(what, done, total, message):
        if what == "cases" and done > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ch.generate(sweep, out=tmp_path / "ds", threads=1, progress=interrupt)
    assert not (tmp_path / "ds" / "manifest.json").exists()
    resumed = ch.generate(sweep, out=tmp_path / "ds", existing="resume")
    assert resumed.manifest == dataset.manifest


def test_a_machine_takes_the_place_of_the_sweeps_own(sweep, machine, tmp_path):
    fast = ch.Machine(machine).replace(speed="600 rpm")
    dataset = ch.generate(
        sweep, machine=fast, channels=["crosshead_acceleration_m_s2", "crank_angle_rad"], out=tmp_path / "fast"
    )
    assert set(dataset.cases["speed_rpm"]) == {600.0}
    assert dataset.channels == ["crosshead_acceleration_m_s2", "crank_angle_rad"]
    with pytest.raises(ch.InputError, match="crosshead_acceleration_m_s2'"):
        ch.generate(sweep, channels=["crosshead_accelaration_m_s2"], out=tmp_path / "other")


def test_windows_over_the_crank_angle(dataset):
    signals, first, y = dataset.over_crank_angle("train", samples_per_revolution=128)
    assert all(signal.shape == (len(dataset.channels) - 1, 4 * 128) for signal in signals)
    # The pressure rests at the suction pressure at bottom dead centre, and is highest before top dead centre.
    pressure = [c for c in dataset.channels if c != "crank_angle_rad"].index("cylinder_pressure_pa")
    for window, begins in zip(signals, first):
        bottom = window[pressure][(64 - begins) % 128 :: 128]
        top = window[pressure][(124 - begins) % 128 :: 128]
        assert (top > 2 * bottom).all()
    with pytest.raises(ch.InputError, match="channels: found 'x'"):
        dataset.over_crank_angle("train", channels=["x"])


def test_any_recordings_over_the_crank_angle_are_those_of_the_dataset(dataset):
    channels = ["crosshead_acceleration_m_s2"]
    expected, begins, _ = dataset.over_crank_angle("train", samples_per_revolution=128, channels=channels)
    files = sorted((dataset.folder / "signals").glob("train-*"))
    found, first = ch.over_crank_angle(files, channels, samples_per_revolution=128)
    assert len(found) == len(expected) > 0
    np.testing.assert_array_equal(np.concatenate(found, axis=1), np.concatenate(expected, axis=1))
    np.testing.assert_array_equal(first, begins)
    with pytest.raises(ch.InputError, match="channels: found 'x', expected some of case_id"):
        ch.over_crank_angle(files, ["x"])


def test_torch_gets_pieces_of_one_length(dataset):
    torch = pytest.importorskip("torch")
    windows = dataset.torch("train", samples_per_revolution=64)
    signal, label = windows[0]
    assert signal.shape == (len(dataset.channels) - 1, 3 * 64) and signal.dtype == torch.float32
    assert windows.classes[int(label)] == dataset.xy("train")[1][0]
    assert not torch.equal(windows[0][0], windows[0][0])
    fixed = dataset.torch("train", samples_per_revolution=64, start="top-dead-centre")
    assert torch.equal(fixed[0][0], fixed[0][0])


def test_features_of_its_own_recordings_are_those_of_the_dataset(dataset):
    features = ch.features(dataset.folder, like=dataset)
    assert features.names == dataset.feature_names
    # Files in order of their names, as the dataset's table.
    expected = np.vstack([dataset.xy(split)[0] for split in sorted(dataset.splits)])
    np.testing.assert_array_equal(features.X, expected)


def test_recordings_that_do_not_fit_raise_with_what_differs(dataset, machine, tmp_path):
    def written(**options):
        path = tmp_path / "run.parquet"
        run = ch.simulate(machine, **options)
        pytest.importorskip("pyarrow.parquet").write_table(pytest.importorskip("pyarrow").table(run.table), path)
        return path

    with pytest.raises(ch.InputError, match="sample rate: found 20000 Hz, expected 10000 Hz as in the dataset"):
        ch.features(written(revolutions=4, sample_rate="20 kHz"), like=dataset)
    with pytest.raises(ch.InputError, match="less than a window"):
        ch.features(written(revolutions=2), like=dataset)
    # A longer recording is cut into windows of the dataset's length.
    assert len(ch.features(written(revolutions=13), like=dataset)) == 3
    with pytest.raises(
        ch.InputError, match="channels: found crosshead_acceleration, expected .*cylinder_pressure.* as in the dataset"
    ):
        ch.features(written(revolutions=4), like=dataset, columns=["crosshead_acceleration_m_s2", "crank_angle_rad"])
    with pytest.raises(ch.InputError, match="window"):
        ch.features(written(revolutions=4), like=dataset, window="1 s")


def test_the_domain_gap_is_that_of_scikit_learn(dataset):
    ensemble = pytest.importorskip("sklearn.ensemble")
    from sklearn.model_selection import cross_val_score

    random = np.random.default_rng(1)
    simulated, measured = random.normal(size=(1500, 12)), random.normal(size=(1500, 12))
    measured[:, :4] = 1.3 * measured[:, :4] + 0.3 * measured[:, 4:8] * measured[:, :4]
    simulated[::7, 5] = np.nan

    def rows(values):
        return values.T.tolist(), [str(i) for i in range(len(values))]

    names = [f"feature{i}" for i in range(12)]
    auc, folds, _ = ch._crosshead.domain_gap(names, rows(simulated), rows(measured), 5, 0)
    peer = ensemble.HistGradientBoostingClassifier(random_state=0)
    x, y = np.vstack([simulated, measured]), np.repeat([0, 1], 1500)
    expected = cross_val_score(peer, x, y, cv=5, scoring="roc_auc")
    assert 0.55 < expected.mean() < 0.9
    # The standard error of an area of 600 rows is 0.02, that of the mean of five folds 0.01.
    assert abs(auc - expected.mean()) < 0.02, (auc, folds, expected)


def test_the_domain_gap_sees_a_difference_and_none(dataset, machine, sweep, tmp_path):
    sweep_of = tmp_path / "sweep.yaml"
    sweep_of.write_text(sweep.read_text().replace("count: 12", "count: 30"))
    simulated = ch.generate(sweep_of, out=tmp_path / "simulated")
    again = tmp_path / "again.yaml"
    again.write_text(sweep_of.read_text().replace("seed: 7", "seed: 8"))
    alike = ch.generate(again, out=tmp_path / "alike")
    gap = ch.domain_gap(simulated, ch.features(alike.folder, like=simulated))
    assert 0.3 < gap.auc < 0.7
    louder = ch.Machine(machine).replace(**{"sensors.crosshead_acceleration.noise.rms": "20 %"})
    other = ch.generate(again, machine=louder, out=tmp_path / "louder")
    gap = ch.domain_gap(simulated, ch.features(other.folder, like=simulated))
    assert gap.auc > 0.95
    assert any("crosshead_acceleration" in telling.feature for telling in gap.features[:3])
    with pytest.raises(ch.InputError, match="measured: expected Features"):
        ch.domain_gap(simulated, other)


def test_a_page_is_written(dataset, tmp_path):
    page = dataset.page(tmp_path / "page.html")
    assert "<html" in page.html and "iframe" in page._repr_html_()


def test_ctrl_c_ends_a_sweep(sweep, tmp_path):
    long = tmp_path / "sweep.yaml"
    long.write_text(sweep.read_text().replace("count: 12", "count: 5000").replace("shard_size: 6", "shard_size: 500"))
    timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        ch.generate(long, out=tmp_path / "long", progress=False)
