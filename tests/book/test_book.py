"""The built book as a reader has it: from a disk, without a network and without Python."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote, urldefrag, urlparse

import pytest
from bs4 import BeautifulSoup
from chapters import notebooks
from outputs import not_run

pytestmark = pytest.mark.browser

CHAPTERS = [path.stem for path in notebooks() if path.name not in not_run()]
VIEWS = 'script[type="application/vnd.jupyter.widget-view+json"]'
PIXELS = """(canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return Array.from(data).filter((_, i) => i % 4 === 1 && (i >> 2) % 17 === 0);
}"""


def changed(before, after) -> int:
    """How many of the sampled pixels differ clearly."""
    return sum(abs(a - b) > 12 for a, b in zip(before, after, strict=True))


def soup_of(path: Path) -> BeautifulSoup:
    return BeautifulSoup(path.read_text(encoding="utf-8"), "html.parser")


def html_of(book: Path) -> list[Path]:
    """All pages; the theme's own templates are none."""
    return [path for path in sorted(book.rglob("*.html")) if "_static" not in path.parts]


def pages(book: Path) -> list[Path]:
    """The pages that are written for readers; not the listings of source code."""
    return [path for path in html_of(book) if "_modules" not in path.parts]


@pytest.fixture(scope="module")
def soups(book) -> dict[Path, BeautifulSoup]:
    """Every page, parsed."""
    return {path: soup_of(path) for path in html_of(book)}


def test_every_link_of_the_book_leads_somewhere(book, soups):
    targets = {path: {tag["id"] for tag in soup.find_all(id=True)} for path, soup in soups.items()}
    broken, seen = [], 0
    for path, soup in soups.items():
        links = [
            tag.get("href") or tag.get("src")
            for tag in soup.find_all(["a", "img", "script", "link"])
        ]
        for link in filter(None, links):
            address, fragment = urldefrag(link)
            if urlparse(address).scheme:
                continue
            seen += 1
            target = (path.parent / unquote(urlparse(address).path)).resolve() if address else path
            if not target.exists():
                broken.append(f"{path.relative_to(book)} → {link}")
            elif fragment and target in targets and unquote(fragment) not in targets[target]:
                broken.append(f"{path.relative_to(book)} → {link} (no such place)")
    assert not broken, "\n".join(broken[:40])
    assert seen > 1000  # else this test looked at nothing


def test_no_page_loads_anything_from_another_host(soups):
    for path, soup in soups.items():
        for tag in soup.find_all(["script", "img", "link", "iframe"]):
            address = tag.get("src") or (tag.get("href") if tag.name == "link" else None) or ""
            assert not urlparse(address).scheme, f"{path.name}: {address}"


def test_every_page_opens_without_an_error_and_shows_its_formulas(book, leaf):
    rendered = 0
    for path in pages(book):
        page = leaf(str(path.relative_to(book)))
        state = page.evaluate("""() => ({
          wanted: document.querySelectorAll("span.math, div.math").length,
          made: document.querySelectorAll("mjx-container").length,
          failed: [...document.querySelectorAll("[data-mjx-error], mjx-merror")].map((x) => x.outerHTML.slice(0, 200)),
          dead: [...document.querySelectorAll(".live-failed")].map((x) => x.textContent),
        })""")
        assert not state["failed"], path.name
        assert not state["dead"], path.name
        assert state["made"] >= state["wanted"], path.name
        rendered += state["made"]
        page.context.close()
    assert rendered > 300


def wake(page) -> None:
    """Wait until every widget of a page has drawn itself."""
    page.wait_for_function("document.documentElement.dataset.live !== undefined")
    page.wait_for_function(
        "[...document.querySelectorAll('.live-anywidget')].every((el) => el.children.length)"
    )
    page.wait_for_timeout(300)


def alive(page, group) -> str | None:
    """Move something in a group of widgets; what is wrong, or None if its pictures answered."""
    group.scroll_into_view_if_needed()
    canvas = group.locator("canvas").first
    handle = group.locator(".pf-handle").first
    before = canvas.evaluate(PIXELS) if canvas.count() else None
    text = group.inner_text()
    if handle.count():
        box = handle.bounding_box()
        drag(page, box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 60, -40)
    elif group.locator(".pf-viewer canvas, .pf-metric canvas").count():
        canvas = group.locator(".pf-viewer canvas, .pf-metric canvas").first
        before = canvas.evaluate(PIXELS)
        box = canvas.bounding_box()
        drag(page, box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.3, 120, 30)
    elif group.locator("select:enabled").count():
        group.locator("select:enabled").first.press("ArrowDown")
    elif group.locator("input[type=range]:enabled").count():
        group.locator("input[type=range]:enabled").first.press("Home")
    else:
        return None if group.locator("canvas, svg").count() else "nothing to see"
    page.wait_for_timeout(600)
    if before is not None and changed(before, canvas.evaluate(PIXELS)) > 20:
        return None
    return None if group.inner_text() != text else "nothing changed"


def drag(page, x: float, y: float, dx: float, dy: float) -> None:
    page.mouse.move(x, y)
    page.mouse.down()
    for share in (0.3, 0.6, 1.0):
        page.mouse.move(x + share * dx, y + share * dy)
    page.mouse.up()


@pytest.mark.parametrize("name", CHAPTERS)
def test_every_widget_of_a_chapter_is_alive(name, leaf, artefacts):
    page = leaf(f"chapters/{name}.html")
    wake(page)
    groups = page.locator(".live-view")
    assert groups.count() == page.locator(VIEWS).count()
    wrong = {k: alive(page, groups.nth(k)) for k in range(groups.count())}
    assert not any(wrong.values()), wrong
    assert page.locator(".live-failed").count() == 0
    plots = page.locator(".live-plot")
    drawn = page.locator(".live-plot .main-svg")
    assert plots.count() == 0 or drawn.count() >= plots.count()
    page.screenshot(path=artefacts / f"book_{name}.png")


def test_a_dragged_point_settles_where_the_answer_is_pythons_own(leaf):
    """In notebook 2 the wish is hard, so the new point must lie on the wish's line."""
    page = leaf("chapters/02_the_projection.html")
    wake(page)
    board = page.locator(".live-view").first
    board.scroll_into_view_if_needed()
    box = board.locator('.pf-handle[data-name="x1_hat"]').bounding_box()
    drag(page, box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 90, 55)
    page.wait_for_timeout(900)
    wished, got = page.evaluate("""() => {
      const text = document.querySelector(".live-view .live-html").textContent;
      return text.match(/= (-?[0-9.]+)/g).slice(0, 2).map((found) => Number(found.slice(2)));
    }""")
    assert wished == got
    place = page.evaluate("""() => {
      const [recording] = Live.records.recordings.filter(({ trait }) => trait === "x1_hat");
      const handle = Live.models.get(recording.control).get("handles").find(({ name }) => name === "x1_hat");
      return { at: handle.at, stops: recording.stops };
    }""")
    assert place["at"] in place["stops"]


def test_what_needs_python_says_so_beside_it(leaf):
    page = leaf("chapters/00_start_here.html")
    wake(page)
    studio = page.locator(".live-view", has=page.locator(".pf-pad"))
    assert "Python" in studio.locator(".live-note").inner_text()
    assert (
        studio.locator(".live-row").locator("select:enabled, input:enabled, button:enabled").count()
        == 0
    )
    asleep = studio.locator(".live-asleep")
    assert asleep.count() >= 3
    assert asleep.first.get_attribute("title") == "Needs Python, which does not run in this page"
    style = "(node) => getComputedStyle(node.querySelector('select, input, button')).borderTopStyle"
    assert asleep.first.evaluate(style) == "dashed"
    # A motion for the drawn example was made when the book was built: it can be turned.
    assert "m" in studio.locator(".pf-status").inner_text()


def test_search_finds_the_kinematic_metric(leaf):
    page = leaf("search.html?q=kinematic+metric")
    page.wait_for_selector("#search-results li a")
    found = page.locator("#search-results li").all_inner_texts()
    assert any("metric" in each.lower() for each in found)
    page.locator("#search-results li a").first.click()
    page.wait_for_load_state()
    assert "kinematic" in page.locator("body").inner_text().lower()


@pytest.mark.parametrize("name", ["index", "equations/projflow", "reference/equations",
                                  "chapters/03_the_skeletons_metric"])  # fmt: skip
def test_ink_stands_out_from_paper_by_day_and_by_night(name, leaf, artefacts):
    """And screenshots, to be looked at."""
    page = leaf(f"{name}.html")
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_function("(it) => document.documentElement.dataset.theme === it", arg=scheme)
        page.wait_for_timeout(500)
        page.screenshot(path=artefacts / f"book_{Path(name).name}_{scheme}.png")
        ink, paper = page.evaluate("""() => {
          const brightness = (colour) => Math.max(...colour.match(/[0-9.]+/g).slice(0, 3).map(Number));
          const colour = (of, name) => brightness(getComputedStyle(document.querySelector(of))[name]);
          return [colour("article p", "color"), colour("body", "backgroundColor")];
        }""")
        assert (paper > 200 and ink < 100) if scheme == "light" else (paper < 90 and ink > 180)
