"""The viewer's ES module in a blank page: no Jupyter, no kernel, no network."""

from __future__ import annotations

import pytest
from stage import changed, contrast, count_colour, mount, picture, update, walking, wished

from projflow_lite.widgets import Viewer

pytestmark = pytest.mark.browser

MET = (11, 122, 59)
MISSED = (198, 40, 40)


def frame_shown(page) -> int:
    return int(page.locator("input[type=range]").input_value())


def test_playing_moves_the_picture_and_pausing_stops_it(open_page):
    page = open_page()
    mount(page, Viewer(walking()))
    first = picture(page)
    page.wait_for_timeout(300)
    assert changed(first, picture(page)) > 50
    page.get_by_label("Pause").click()
    still = picture(page)
    page.wait_for_timeout(200)
    assert changed(still, picture(page)) == 0
    assert page.evaluate("model.get('playing')") is False
    assert page.evaluate("model.get('frame')") == frame_shown(page)


def test_scrubbing_shows_the_frame_and_tells_the_kernel(open_page):
    page = open_page()
    mount(page, Viewer(walking(), playing=False))
    before = picture(page)
    slider = page.get_by_role("slider", name="Frame")
    slider.fill("30")
    page.wait_for_timeout(100)
    assert changed(before, picture(page)) > 50
    assert page.evaluate("model.get('frame')") == 30
    assert slider.get_attribute("aria-valuetext") == "frame 30, 1.50 seconds"
    assert "frame 30 / 59" in page.locator(".pf-bar").first.inner_text()


def test_keyboard(open_page):
    page = open_page()
    mount(page, Viewer(walking(), playing=False))
    page.locator("canvas").focus()
    for key, frame in [
        ("ArrowRight", 1),
        ("ArrowUp", 11),
        ("ArrowLeft", 10),
        ("End", 59),
        ("Home", 0),
    ]:
        page.keyboard.press(key)
        page.wait_for_timeout(40)
        assert frame_shown(page) == frame, key
    page.keyboard.press(" ")
    assert page.evaluate("model.get('playing')") is True
    page.keyboard.press(" ")
    page.wait_for_timeout(600)
    assert page.locator("[aria-live]").inner_text().startswith("frame")


def test_orbit_zoom_and_reset(open_page):
    page = open_page()
    mount(page, Viewer(walking(), playing=False))
    start = picture(page)
    box = page.locator("canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 120, y + 20, steps=4)
    page.mouse.up()
    page.wait_for_timeout(60)
    turned = picture(page)
    assert changed(start, turned) > 200
    camera = page.evaluate("model.get('camera')")
    assert camera["yaw"] == pytest.approx(0.6 - 120 * 0.008)
    page.mouse.wheel(0, -400)
    page.wait_for_timeout(400)
    assert page.evaluate("model.get('camera').distance") < camera["distance"]
    page.mouse.dblclick(x, y)
    page.wait_for_timeout(100)
    assert page.evaluate("model.get('camera')") == {}
    assert changed(start, picture(page)) < 20


def test_a_page_that_scrolls_under_the_pointer_goes_on_scrolling(open_page):
    page = open_page(height=300)
    mount(page, Viewer(walking(), playing=False))
    page.evaluate("document.body.style.height = '2000px'")
    page.evaluate("document.body.style.paddingTop = '100px'")
    page.mouse.move(300, 50)
    page.mouse.wheel(0, 100)  # moves the viewer under the resting pointer
    page.wait_for_timeout(200)
    page.mouse.wheel(0, 100)
    page.wait_for_timeout(300)
    assert page.evaluate("scrollY") == 200
    assert page.evaluate("model.get('camera')") == {}


def test_a_marker_turns_from_missed_to_met(open_page):
    page = open_page()
    missed = Viewer(wished(walking(), off=0.3), playing=False, frame=10)
    mount(page, missed)
    root = page.locator(".pf-viewer")
    assert root.get_attribute("data-met") == "0"
    assert count_colour(page, MISSED) > 60
    assert "0 of 60 markers met" in root.inner_text()
    assert "max |A x − y| = 0.300 m" in root.inner_text()

    met = wished(walking(), off=3.1e-8)
    missed.motion = met
    update(page, missed, "markers", "residual", "data", "shape", "names")
    assert root.get_attribute("data-met") == "60"
    assert count_colour(page, MISSED) == 0
    assert count_colour(page, MET) > 100
    assert "✓ 60 of 60 markers met" in root.inner_text()
    assert "max |A x − y| = 3.1e-08 m" in root.inner_text()


def test_a_new_motion_keeps_camera_and_play_state_and_never_blanks(open_page):
    page = open_page()
    viewer = Viewer(walking(), camera={"yaw": 1.0, "distance": 6.0, "target": [0, 1, 1]})
    mount(page, viewer)
    page.evaluate(
        """() => { window.blank = 0; const check = () => {
          const canvas = document.querySelector("canvas");
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          if (data.every((value, i) => value === data[i % 4])) window.blank += 1;
          requestAnimationFrame(check); }; check(); }"""
    )
    clock = frame_shown(page)
    viewer.show(walking(60, 0.3), walking(60, 0.6))
    update(page, viewer, "data", "shape", "names")
    page.wait_for_timeout(200)
    assert page.evaluate("window.blank") == 0
    assert frame_shown(page) > clock
    assert page.get_by_label("Pause").count() == 1
    assert page.evaluate("model.get('camera')") == {"yaw": 1, "distance": 6, "target": [0, 1, 1]}


def test_follow_keeps_the_pelvis_in_the_middle(open_page):
    page = open_page()
    mount(page, Viewer(walking(100, 3.0), playing=False, follow=True))
    centre = """() => { const canvas = document.querySelector("canvas");
      const { width, height } = canvas;
      const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
      let [sum, count] = [0, 0];
      for (let i = 0; i < data.length; i += 4) {
        if (data[i] > 180 && data[i + 2] < 80) { sum += (i / 4) % width; count += 1; }
      }
      return sum / count / width; }"""
    places = []
    for frame in (0, 40, 99):
        page.get_by_role("slider", name="Frame").fill(str(frame))
        page.wait_for_timeout(60)
        places.append(page.evaluate(centre))
    assert max(places) - min(places) < 0.03
    assert places[0] == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("ratio", [1, 2])
def test_frame_rate_with_196_frames_and_three_ghosts(open_page, ratio, record_property):
    page = open_page(ratio=ratio)
    ghosts = [walking(196, speed) for speed in (0.4, 0.6, 0.8)]
    mount(page, Viewer(wished(walking(196, 1.0)), *ghosts, trail="left_wrist"))
    page.wait_for_timeout(2600)
    rate = float(page.locator(".pf-viewer").get_attribute("data-fps"))
    record_property("frames per second", rate)
    print(f"\nviewer, 196 frames, 3 ghosts, pixel ratio {ratio}: {rate:.1f} pictures a second")
    assert rate > 5, "not a benchmark: only that it plays at all on a busy machine"


def test_readable_in_the_dark(open_page, artefacts):
    page = open_page(ratio=2)
    viewer = Viewer(wished(walking(), frames=range(60)), playing=False, frame=33)
    mount(page, viewer, dark=True)
    assert page.locator(".pf-viewer").get_attribute("data-theme") == "dark"
    for selector in (".pf-readout", ".pf-note", "button:has-text('Follow')", ".pf-met"):
        assert contrast(page, selector) >= 4.5, selector
    assert count_colour(page, (17, 17, 17)) > 10_000, "the picture has the paper of the theme"
    page.screenshot(path=artefacts / "viewer_page_dark.png")
    update_theme = "document.body.style.setProperty('--jp-layout-color0', '#ffffff')"
    page.evaluate(update_theme)
    page.wait_for_timeout(100)
    assert page.locator(".pf-viewer").get_attribute("data-theme") == "light"


def test_readable_in_the_light(open_page, artefacts):
    page = open_page(ratio=2)
    viewer = Viewer(walking(), walking(60, 0.8), names=["walk", "slower"], trail="left_wrist")
    mount(page, viewer)
    for selector in (".pf-readout", ".pf-note", "button:has-text('Follow')"):
        assert contrast(page, selector) >= 4.5, selector
    page.screenshot(path=artefacts / "viewer_page_light.png")


def test_a_front_end_that_cannot_start_says_so(open_page):
    page = open_page()
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto("about:blank")
    mount(page, Viewer(walking(3)))
    message = page.get_by_role("alert").inner_text()
    assert "The motion viewer could not start in this browser" in message
    assert "Reload the page" in message


def test_no_motion_and_unmounting_are_harmless(open_page):
    page = open_page()
    mount(page, Viewer())
    assert "no motion to show" in page.locator(".pf-viewer").inner_text()
    page.evaluate("unmount()")


def words_of(page):
    """What the next picture writes on its canvas."""
    return page.evaluate(
        """async () => {
        const words = [], prototype = CanvasRenderingContext2D.prototype, write = prototype.fillText;
        prototype.fillText = function (text, ...place) { words.push(text); write.call(this, text, ...place); };
        window.model.set("camera", { ...window.model.get("camera"), yaw: 0.5 });
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
        prototype.fillText = write;
        return words;
        }"""
    )


@pytest.mark.parametrize("apart", [0.1, 2.0])
def test_thin_bodies_are_named_above_their_heads_only_where_they_stand_apart(
    open_page, artefacts, apart
):
    page = open_page(width=460, height=520)
    other = walking()
    other.positions[..., 0] += apart
    viewer = Viewer(walking(), other, names=["ddnm", "the clip"], playing=False)
    mount(page, viewer)
    assert page.locator(".pf-note").inner_text() == "ddnm\nthin: the clip"
    assert ("the clip" in words_of(page)) is (apart > 1)
    page.screenshot(path=artefacts / f"viewer_page_{'apart' if apart > 1 else 'together'}.png")
