"""Films, contact sheets and snapshots of recordings, read back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from ahmss_viewer.app import ViewOptions, view
from ahmss_viewer.bench import display_rate
from ahmss_viewer.movie import Movie, check_writable
from ahmss_viewer.sheet import Sheet, layout
from PIL import Image

from ahmss.errors import CommandError, DataError

from .scenes import decode, record


def test_a_film_holds_every_frame_at_the_rate_of_the_recording(tmp_path: Path) -> None:
    recording = record(tmp_path / "a.ahmss", 34)
    seen: list[tuple[int, int]] = []
    options = ViewOptions(
        replay=recording,
        record=tmp_path / "a.mp4",
        sheet=tmp_path / "a.png",
        every=10,
        size=(160, 120),
        camera="front",
        fine=False,
    )
    report = view(options, lambda done, total: seen.append((done, total)))
    film, rate = decode(tmp_path / "a.mp4", (160, 120))
    assert len(film) == 34
    assert rate == 60.0
    assert seen[-1] == (34, 34)
    assert report.pictures == 34
    assert report.to_json()["files"] == [str(tmp_path / "a.mp4"), str(tmp_path / "a.png")]
    with Image.open(tmp_path / "a.png") as page:
        columns, rows = layout(4, (340, 255))
        assert page.size == (columns * 346 + 6, 30 + rows * 279 + 6)


def test_the_film_shows_the_motion_and_the_red_box(tmp_path: Path) -> None:
    recording = record(tmp_path / "a.ahmss", 30)
    view(ViewOptions(replay=recording, record=tmp_path / "a.mp4", size=(320, 240), fine=False))
    pictures, _ = decode(tmp_path / "a.mp4", (320, 240))
    for picture in (pictures[0], pictures[-1]):
        red = (picture[..., 0] > 90) & (picture[..., 0] > 2 * picture[..., 1])
        assert red.mean() > 0.005
    changed = np.abs(pictures[0] - pictures[-1]).max(axis=2) > 30
    assert 0.002 < changed.mean() < 0.2, "the arm moved and the camera did not"


def test_a_recording_is_filmed_with_cuts(tmp_path: Path) -> None:
    recording = record(tmp_path / "a.ahmss", 130)
    options = ViewOptions(
        replay=recording,
        record=tmp_path / "a.mp4",
        sheet=tmp_path / "a.png",
        size=(160, 120),
        camera="cuts",
        fine=False,
    )
    assert view(options).pictures == 130
    film, _ = decode(tmp_path / "a.mp4", (160, 120))
    assert (np.abs(film - film[:, :1, :1]).max(axis=3) > 60).mean(axis=(1, 2)).min() > 0.02, "somebody is in all of it"


def test_a_snapshot_is_of_its_time(tmp_path: Path) -> None:
    recording = record(tmp_path / "a.ahmss", 60)
    pictures = []
    for at in (0.0, 0.0, 0.9):
        options = ViewOptions(replay=recording, snapshot=tmp_path / "s.png", at=at, size=(160, 120), fine=False)
        view(options)
        with Image.open(tmp_path / "s.png") as image:
            assert image.size == (160, 120)
            pictures.append(np.asarray(image).astype(int))
    assert (pictures[0] == pictures[1]).all()
    assert (np.abs(pictures[0] - pictures[2]).max(axis=2) > 30).sum() > 20


def test_a_sheet_puts_its_tiles_in_rows_with_their_numbers() -> None:
    sheet = Sheet("title", columns=3)
    for k in range(7):
        sheet.add(np.full((40, 60, 3), 30 * k, np.uint8), 10 * k, k / 6)
    page = np.asarray(sheet.page())
    assert page.shape == (30 + 3 * (40 + 18 + 6) + 6, 3 * 66 + 6, 3)
    for k in range(7):
        left, top = 6 + (k % 3) * 66, 30 + (k // 3) * 64
        assert (page[top : top + 40, left : left + 60] == 30 * k).all()
        caption = page[top + 40 : top + 58, left : left + 60]
        assert caption.min() < 120, "a caption is under each tile"


@pytest.mark.parametrize("count", [1, 5, 24, 100])
def test_a_page_has_room_for_all_tiles(count: int) -> None:
    columns, rows = layout(count, (320, 180))
    assert columns * rows >= count > columns * (rows - 1)


def test_following_somebody_who_is_not_there_says_who_is(tmp_path: Path) -> None:
    recording = record(tmp_path / "a.ahmss", 3)
    with pytest.raises(CommandError, match=r'no human "anna".*there is: ken'):
        view(ViewOptions(replay=recording, snapshot=tmp_path / "s.png", follow="anna"))


def test_a_place_where_nothing_can_be_written_is_told_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(DataError, match="can't be written here"):
        view(ViewOptions(replay=tmp_path / "none.ahmss", record=tmp_path / "file" / "a.mp4"))
    with pytest.raises(DataError, match="can't be read"):
        view(ViewOptions(replay=tmp_path / "none.ahmss", record=tmp_path / "a.mp4"))
    assert not (tmp_path / "a.mp4").exists()


def test_checking_a_path_changes_no_file(tmp_path: Path) -> None:
    (tmp_path / "old.mp4").write_bytes(b"")
    check_writable(tmp_path / "old.mp4")
    check_writable(tmp_path / "new.mp4")
    assert [p.name for p in tmp_path.iterdir()] == ["old.mp4"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here to stand for a full disk")
def test_a_full_disk_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").symlink_to("/dev/full")
    chance = np.random.default_rng(0)

    def film() -> None:
        with Movie(tmp_path / "a.mp4", (640, 480), 30) as movie:
            for _ in range(40):
                movie.add(chance.integers(0, 255, (480, 640, 3), dtype=np.uint8))

    with pytest.raises(DataError, match=r"a\.mp4: the film can't be written: the disk is full"):
        film()


def test_a_camera_that_is_none_is_refused() -> None:
    with pytest.raises(CommandError, match='no camera "upside"; there is: auto'):
        ViewOptions(camera="upside")
    with pytest.raises(CommandError, match="8x8"):
        ViewOptions(size=(8, 8))


def test_the_bench_counts_pictures(tmp_path: Path) -> None:
    rate = display_rate(record(tmp_path / "a.ahmss", 5), (160, 120), 0.3)
    assert rate["pictures"] > 3
    assert rate["fps"] > 0
    assert rate["faces"] > 6000
