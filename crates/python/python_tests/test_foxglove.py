"""The layout for Foxglove shows what MCAP files have."""

import json
import pathlib
import re

import crosshead as ch
import pytest

LAYOUT = pathlib.Path(__file__).parents[3] / "pipelines" / "notebooks" / "foxglove-layout.json"


def paths(panel):
    """The message paths of a panel."""
    axis = [panel["xAxisPath"]] if "xAxisPath" in panel else []
    topic = [panel["topicPath"]] if "topicPath" in panel else []
    return [path["value"] for path in panel.get("paths", []) + axis] + topic


def leaves(layout):
    """The panels that the layout arranges."""
    return [layout] if isinstance(layout, str) else leaves(layout["first"]) + leaves(layout["second"])


def test_every_path_of_the_layout_is_in_the_files(sweep, tmp_path):
    reader = pytest.importorskip("mcap.reader")
    own = tmp_path / "sweep.yaml"
    own.write_text(sweep.read_text().replace("count: 12", "count: 1") + "format: mcap\n")
    dataset = ch.generate(own, out=tmp_path / "ds")
    (file,) = (dataset.folder / "mcap").iterdir()
    with open(file, "rb") as stream:
        summary = reader.make_reader(stream).get_summary()
    there = set()
    for channel in summary.channels.values():
        fields = re.findall(r"^float32 (\w+)", summary.schemas[channel.schema_id].data.decode(), re.MULTILINE)
        there |= {channel.topic, *(f"{channel.topic}.{field}" for field in fields)}
    layout = json.loads(LAYOUT.read_text())
    asked = [path for panel in layout["configById"].values() for path in paths(panel)]
    assert len(asked) >= 5 and set(asked) <= there
    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
