"""Calibration, explanation and wear: objects of what the program writes."""

import json

import crosshead as ch
import pytest

STIFFNESS = "joints.big_end.contact.stiffness"


@pytest.fixture(scope="module")
def calibration(bundle, tmp_path_factory):
    return ch.calibrate(bundle, out=tmp_path_factory.mktemp("calibration") / "calibrated")


def test_a_calibration_says_what_it_found(calibration):
    found = calibration.parameters[STIFFNESS]
    assert found.identifiable and found.low < found.value < found.high
    # The truth stands beside the recordings, for tests alone.
    assert found.value == pytest.approx(2.068e10, rel=0.01)
    assert float(calibration.machine[STIFFNESS].split()[0]) == pytest.approx(found.value, rel=1e-9)
    assert calibration.not_identifiable == []
    assert calibration.noise["crosshead_acceleration_m_s2"]["of_signal"] == pytest.approx(0.02, rel=0.02)
    assert calibration.model_is_adequate
    assert calibration.fit["calibrated"] < 1.2 < calibration.fit["nominal"]
    assert "<html" in calibration.page().html


def test_a_calibration_is_opened_again(calibration, bundle):
    again = ch.Calibration(calibration.folder)
    assert again.parameters == calibration.parameters
    # The same call computes nothing: the file stays as it is.
    path = calibration.folder / "calibration.json"
    before = path.stat().st_mtime_ns
    ch.calibrate(bundle, out=calibration.folder)
    assert path.stat().st_mtime_ns == before
    with pytest.raises(ch.InputError, match="calibration.json"):
        ch.Calibration(calibration.folder.parent)


def test_a_bundle_has_a_nominal_machine(bundle, calibration):
    nominal = ch.Machine.from_bundle(bundle)
    stiffness = float(nominal[STIFFNESS].split()[0])
    assert stiffness == calibration.parameters[STIFFNESS].nominal
    assert nominal.speed_rpm == pytest.approx(400)
    with pytest.raises(ch.InputError, match="recordings.yaml"):
        ch.Machine.from_bundle(bundle.parent)


def test_without_a_folder_a_calibration_stands_in_a_temporary_one(bundle):
    found = ch.calibrate(bundle, evaluations=3, optimiser="levenberg_marquardt")
    folder = found.folder
    assert (folder / "machine.yaml").exists()
    del found
    assert not folder.exists()


def test_a_dataset_draws_from_the_calibration(calibration, sweep, tmp_path):
    own = tmp_path / "sweep.yaml"
    text = sweep.read_text()
    own.write_text(text[: text.index("vary:")])
    dataset = ch.generate(own, machine=calibration, out=tmp_path / "ds")
    column = f"{STIFFNESS}_n_m15"
    assert dataset.roles[column] == "unknown"
    drawn = dataset.cases[column]
    found = calibration.parameters[STIFFNESS]
    half = (found.high - found.low) / 2
    assert len(set(drawn)) > 1 and abs(drawn - found.value).max() < 3 * half
    # No channel that the recordings lack.
    assert sorted(dataset.channels) == sorted(calibration.noise)
    copied = json.loads((dataset.folder / "calibration" / "calibration.json").read_text())
    assert copied == calibration.results
    best = ch.generate(own, machine=calibration, uncertainty="ignored", out=tmp_path / "best")
    assert column not in best.roles
    with pytest.raises(ch.InputError, match="uncertainty"):
        ch.generate(own, machine=calibration, uncertainty="some", out=tmp_path / "wrong")


@pytest.mark.parametrize(
    "settings, message",
    [
        ({"parameters": ["joints.big_end.contact.stifness"]}, "stifness"),
        ({"parameters": {STIFFNESS: ["100 GN/m^1.5", "1 GN/m^1.5"]}}, "the lesser first"),
        ({"relation": "eq6"}, "relation: found 'eq6'"),
        ({"hold_out": ["run99"]}, "run99"),
        ({"evaluations": 0}, "evaluations: found 0"),
    ],
)
def test_wrong_settings(bundle, settings, message):
    with pytest.raises(ch.InputError) as raised:
        ch.calibrate(bundle, **settings)
    assert message in str(raised.value)


def test_a_folder_without_recordings(tmp_path):
    with pytest.raises(ch.InputError, match="recordings.yaml"):
        ch.calibrate(tmp_path)
    with pytest.raises(ch.InputError, match="recordings.yaml"):
        ch.explain_gap(tmp_path)


def test_an_interrupted_calibration_raises(bundle):
    def interrupt(what, done, total, message):
        if done > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ch.calibrate(bundle, optimiser="cma_es", progress=interrupt)


def test_a_gap_is_explained(diagnosis, tmp_path):
    hidden = diagnosis.parent / "example-hidden-effect"
    explanation = ch.explain_gap(hidden, out=tmp_path / "explained")
    assert explanation.verdict in ("explained", "partly-explained")
    assert explanation.effects
    gap = explanation.gap
    assert gap["after"] < 0.5 * gap["before"]
    assert explanation.machine.name
    assert "<html" in explanation.page().html
    again = ch.Explanation(tmp_path / "explained")
    assert again.results == explanation.results
    with pytest.raises(ch.InputError, match="is already there"):
        ch.explain_gap(hidden, out=tmp_path / "explained")


def test_wear_is_estimated(bundle, calibration, tmp_path):
    wear = ch.estimate_wear(bundle, machine=calibration, out=tmp_path / "wear")
    for joint in ["joints.big_end", "joints.small_end"]:
        assert wear.joints[joint]["verdict"] != "worn"
    assert "<html" in wear.page().html
    assert ch.Wear(tmp_path / "wear").joints == wear.joints
    with pytest.raises(ch.InputError, match="worn_from: found 1"):
        ch.estimate_wear(bundle, machine=calibration, worn_from=1)
