"""Make sure that there is a browser for the tests: find one, install Debian's, or say what to do."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
ADVICE = (
    "The tests need Chromium or Google Chrome, and none was found.\n"
    "  Debian, Ubuntu:  sudo apt-get install chromium\n"
    "  Fedora:          sudo dnf install chromium\n"
    "  macOS:           brew install --cask chromium\n"
    "or set CHROMIUM to the path of one that you have."
)


def find_browser() -> str | None:
    """Path of a Chromium-like browser: the variable CHROMIUM, or the first known name on PATH."""
    chosen = os.environ.get("CHROMIUM")
    if chosen:
        return chosen if os.access(chosen, os.X_OK) else None
    mac = "/Applications/{0}.app/Contents/MacOS/{0}"
    places = [shutil.which(name) for name in NAMES]
    places += [mac.format(name) for name in ("Chromium", "Google Chrome")]
    return next((place for place in places if place and os.access(place, os.X_OK)), None)


def install_on_debian() -> bool:
    """Install Debian's Chromium where that is possible without asking for a password."""
    if not shutil.which("apt-get") or os.environ.get("CHROMIUM"):
        return False
    prefix = [] if os.geteuid() == 0 else ["sudo", "-n"]
    if prefix and not shutil.which("sudo"):
        return False
    print("Installing Chromium for the browser tests (once) ...", flush=True)
    quiet = {
        "stdout": subprocess.DEVNULL,
        "env": {**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
    }
    for command in (["apt-get", "update"], ["apt-get", "install", "--yes", "chromium"]):
        if subprocess.run(prefix + command, **quiet, check=False).returncode:
            return False
    return True


def main() -> int:
    """Return 0 when a browser is there, 1 with advice when none is."""
    if find_browser() or (install_on_debian() and find_browser()):
        return 0
    print(ADVICE, file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
