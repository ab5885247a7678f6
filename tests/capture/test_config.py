"""A tracker's file: every template loads, and every mistake is named with its place."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.quaternion import rotate
from ahmss.capture.config import TransmitterConfig, load, template
from ahmss.capture.formats.layout import Layout
from ahmss.errors import DataError


@pytest.mark.parametrize("kind", ["fastrak", "liberty", "patriot", "ultratrak"])
def test_the_template_is_a_good_file(kind, tmp_path):
    file = tmp_path / "tracker.toml"
    file.write_text(template(kind))
    config = load(file)
    assert config.kind == kind
    assert config.rows == {number: number - 1 for number in range(1, 16)}
    carried = sorted(station for line in config.line for station in line.stations)
    assert carried == ([] if kind == "ultratrak" else list(range(1, 16)))


def test_lines_and_layout_of_four_fastraks(tmp_path):
    file = tmp_path / "tracker.toml"
    file.write_text(template("fastrak").replace('"quaternion"', '"euler"'))
    config = load(file)
    assert [len(line.stations) for line in config.line] == [4, 4, 4, 3]
    assert config.layout(config.line[3]) == Layout((2, 4, 1), "cm", 3)


def test_the_transmitter_stands_with_its_z_down():
    forward, right, down = np.eye(3)
    for upside_down, sign in ((False, -1.0), (True, 1.0)):
        turn = TransmitterConfig(facing_deg=90.0, upside_down=upside_down).rotation
        np.testing.assert_allclose(rotate(turn, forward), [0.0, 1.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(rotate(turn, right), [-sign, 0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(rotate(turn, down), [0.0, 0.0, sign], atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("hips = 1", "hisp = 1", 'stations.hisp .*no such link, did you mean "hips"'),
        ("hips = 1", "hips = 2", "stations .*station 2 can't be on hips, spine at once"),
        ("hips = 1", "hips = 16", "stations.hips .*no line has station 16"),
        ("baud =", "bauds =", r"line.0..bauds .*no key .bauds. here, .*allowed: baud, parity, port, stations"),
        ("rate = 120", "rate = 0", "rate .*0 frames a second; give 1 to 1000"),
        ("[1, 0, 0]", "[0, 0, 0]", "hemisphere .*points nowhere"),
        ('format = "binary"', 'format = "ascii"', "format .*liberty is read in binary"),
        ('kind = "liberty"', 'kind = "libertine"', "kind"),
        ('kind = "liberty"', 'kind = "patriot"', "15 of them; a patriot has 1 to 2"),
        ('kind = "liberty"', 'kind = "ultratrak"', "line.*ULTRATRAK sends datagrams"),
        ("stations = [1, 2,", "stations = [1, 1,", "line.*stations .*1 is on another line too"),
    ],
)
def test_a_mistake_is_named_with_its_place(old, new, message, tmp_path):
    text = template("liberty")
    assert old in text
    file = tmp_path / "tracker.toml"
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(DataError, match=f"tracker.toml: .*{message}"):
        load(file)
