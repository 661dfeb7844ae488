# SPDX-License-Identifier: MIT
"""Pictures of the page of the paper's scenes."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

from post import paper_pictures
from post.style import Picture


def test_two_stories_may_be_drawn_at_the_same_time(tmp_path, monkeypatch):
    both_drawn = Barrier(2)

    def draw_sheet(run, folder):
        path = folder / "sheet.png"
        path.write_text(run)
        both_drawn.wait(10)
        return Picture(path, "cut", "caption")

    monkeypatch.setattr(paper_pictures, "draw_sheet", draw_sheet)
    monkeypatch.setattr(paper_pictures, "label_of", str)
    with ThreadPoolExecutor(2) as pool:
        drawn = pool.map(
            lambda name: paper_pictures.draw_story(name, tmp_path / "pictures", name, name),
            ["one", "two"],
        )
        assert [picture.path.read_text() for picture in drawn] == ["one", "two"]
    assert sorted(path.name for path in (tmp_path / "pictures").iterdir()) == ["one.png", "two.png"]
