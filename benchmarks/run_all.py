"""Run every benchmark and write its results into README.md: nothing there was typed by hand.

python benchmarks/run_all.py              some fifteen minutes on an idle machine
python benchmarks/run_all.py --quick      a minute, leaves README.md alone
python benchmarks/run_all.py --only sampling one_step
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import measuring

HERE = Path(__file__).parent
NAMES = ("projection", "memory_pass", "sampling", "one_step", "scaling", "memory", "latency")
BEGIN = "<!-- results, written by run_all.py -->"


def page(results: dict[str, dict[str, Any]]) -> str:
    """Results as Markdown: for each benchmark its question, the verdicts, the table."""
    parts = []
    for name, result in results.items():
        bars = [
            measuring.Bar(**{key: bar[key] for key in measuring.Bar._fields})
            for bar in result["bars"]
        ]
        parts += [f"### {name}.py", result["question"]]
        parts += ["\n".join(f"- {bar}" for bar in bars)] if bars else []
        parts += [measuring.table(result["rows"]), f"On: {result['machine']}."]
        parts += [f"![{result['question']}](results/{name}.png)"]
    return "\n\n".join(parts) + "\n"


def main(arguments: list[str] | None = None) -> None:
    """Run them one after the other, each in a process of its own."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="only see that all of them run")
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, help="these alone")
    options = parser.parse_args(arguments)
    folder = HERE / "results"
    folder.mkdir(exist_ok=True)
    for name in options.only:
        command = [sys.executable, str(HERE / f"{name}.py")]
        if options.quick:
            command += ["--quick"]
        else:
            command += [
                "--json",
                str(folder / f"{name}.json"),
                "--plot",
                str(folder / f"{name}.png"),
            ]
        print(f"== {name}", flush=True)
        subprocess.run(command, check=True)
    if not options.quick:
        write_page(folder, HERE / "README.md")


def write_page(folder: Path, readme: Path) -> None:
    """Replace what follows the mark in a README by the results in a folder."""
    files = [folder / f"{name}.json" for name in NAMES]
    results = {file.stem: json.loads(file.read_text()) for file in files if file.exists()}
    introduction = readme.read_text().split(BEGIN)[0]
    readme.write_text(f"{introduction}{BEGIN}\n\n{page(results)}")


if __name__ == "__main__":
    main()
