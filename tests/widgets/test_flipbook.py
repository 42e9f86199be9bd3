"""A flipbook without a page: what is taken, what is sent, and who follows in silence."""

import ipywidgets as widgets
import numpy as np
import pytest

from projflow_lite.widgets import Board
from projflow_lite.widgets.flipbook import Flipbook


@pytest.fixture
def book():
    board, slider = Board(), widgets.IntSlider(value=1, min=0, max=2)

    def draw(k):
        board.points("cloud", [[k, 0.5]])
        return f"page {k}"

    return Flipbook(slider, [board], draw), board, slider


def shown(board):
    return np.frombuffer(board.data, np.float32).tolist()


def opened(book):
    """What a page is sent when it asks for the pages, and what else is sent from then on."""
    sent = []
    book.send = lambda content, buffers=None: sent.append((content, buffers))
    book._handle_custom_msg({"type": "open"}, [])
    return sent


def test_it_opens_where_the_slider_is(book):
    flipbook, board, _ = book
    assert flipbook.words == "page 1"
    assert shown(board) == [1.0, 0.5]


def test_pages_hold_only_what_differs_between_them(book):
    flipbook, board, _ = book
    assert [set(page[board]) for page in flipbook.pages] == 3 * [{"data"}]
    assert [page[flipbook]["words"] for page in flipbook.pages] == ["page 0", "page 1", "page 2"]


def test_bytes_travel_beside_the_pages(book):
    flipbook, board, _ = book
    ((content, buffers),) = opened(flipbook)
    places = [page[board.model_id]["data"] for page in content["pages"]]
    assert places == [{"buffer": k} for k in range(3)]
    assert [np.frombuffer(b, np.float32)[0] for b in buffers] == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("asked", [False, True])
def test_the_widgets_follow_and_speak_only_to_a_page_without_pages(book, asked, monkeypatch):
    flipbook, board, slider = book
    if asked:
        opened(flipbook)
    said = []
    for widget in (board, flipbook):
        monkeypatch.setattr(widget, "_send", lambda message, buffers=None: said.append(message))
        monkeypatch.setattr(type(widget.comm), "kernel", object(), raising=False)
    slider.value = 2
    assert shown(board) == [2.0, 0.5]
    assert flipbook.words == "page 2"
    assert bool(said) != asked


def test_drawn_anew_it_is_sent_anew(book):
    flipbook, board, _ = book
    sent = opened(flipbook)
    flipbook._draw = lambda k: board.points("cloud", [[k, -1.0]]) or f"again {k}"
    flipbook.redraw()
    assert flipbook.words == "again 1"
    assert shown(board) == [1.0, -1.0]
    assert len(sent) == 2
    assert sent[1][0]["pages"][2][flipbook.model_id] == {"words": "again 2"}
