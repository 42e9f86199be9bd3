"""Shared by all tests: a headless browser that reaches nothing outside this machine."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlparse

import pytest
from browser.install import ADVICE, find_browser
from hypothesis import settings

# Property tests draw the same cases in every run and are never failed for being slow.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")

ARTEFACTS = Path(__file__).parents[1] / "artefacts"
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
LOOPBACK = {"127.0.0.1", "localhost", "::1"}


def pytest_collection_modifyitems(items) -> None:
    """A browser on a machine that does something else drops a frame now and then: one more try.

    The summary names every test that needed it; what fails twice is a failure.
    """
    for item in items:
        if item.get_closest_marker("browser"):
            item.add_marker(pytest.mark.flaky(reruns=1))


def browser_path() -> str:
    """Path of the browser to drive. Without one the tests fail: skipping would prove nothing."""
    path = find_browser()
    if path is None:
        pytest.fail(f"no browser found. {ADVICE}", pytrace=False)
    return path


@dataclass
class Watch:
    """What a page did that it should not: requests that tried to leave, errors in its console."""

    left: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def install(self, page) -> None:
        page.route("**/*", self.gate)
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on(
            "console",
            lambda message: self.errors.append(message.text) if message.type == "error" else None,
        )

    def gate(self, route) -> None:
        address = urlparse(route.request.url)
        if address.scheme in {"data", "blob"} or address.hostname in LOOPBACK:
            route.continue_()
        else:
            self.left.append(route.request.url)
            route.abort()

    def check(self) -> None:
        assert not self.left, f"requests tried to leave this machine: {self.left}"
        assert not self.errors, f"errors in the browser's console: {self.errors}"


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium for one file of tests.

    Not for the whole run: as long as playwright is open there is a running event loop in this
    thread, and tests that start one of their own (asyncio, notebooks) would fail.
    """
    from playwright.sync_api import sync_playwright

    path = browser_path()
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def open_page(browser):
    """Function that opens a page of a given size; at the end checks what the page did.

    ``page.watch`` holds what it saw; a test that provokes an error on purpose clears it.
    """
    contexts = []

    def open_(width=900, height=700, ratio=1.0, **options):
        context = browser.new_context(
            viewport={"width": width, "height": height}, device_scale_factor=ratio, **options
        )
        page = context.new_page()
        page.watch = Watch()
        page.watch.install(page)
        contexts.append((context, page))
        return page

    yield open_
    for context, page in contexts:
        context.close()
        page.watch.check()


@pytest.fixture(scope="session")
def artefacts() -> Path:
    """Folder for screenshots, not part of the repository."""
    ARTEFACTS.mkdir(exist_ok=True)
    return ARTEFACTS
