"""Writes a file of data/results from the cases of `crosshead hidden-effects`.

    python3 tests/nightly/hidden_effects.py NAME.csv FOLDER COMMAND...

FOLDER is its `--out`, COMMAND the command that made it.
"""

import json
import shlex
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import results  # noqa: E402


def row(case):
    """The line of one case."""
    found = case["found"] or {"verdict": "failed", "named": [], "gap": {}}
    gap, first = found["gap"], next(iter(found["named"]), {})
    return {
        "case": case["case"],
        "compressor": case["machine"],
        "noise": case["noise"],
        "size": case["size"],
        "hidden": " + ".join(h["effect"] for h in case["hidden"]) or case.get("outside") or "nothing",
        "named": " + ".join(n["effect"] for n in found["named"]) or "nothing",
        "probability_of_the_first": first.get("probability"),
        "rivals_of_the_first": " + ".join(first.get("rivals", [])),
        "verdict": found["verdict"],
        "gap_before": gap.get("before"),
        "gap_after": gap.get("after"),
        "heldout_before": gap.get("heldout_before"),
        "heldout_after": gap.get("heldout_after"),
        "cpu_s": case["cpu_seconds"] and round(case["cpu_seconds"]),
    }


def main():
    name, folder, command = sys.argv[1], Path(sys.argv[2]), shlex.join(sys.argv[3:])
    lines = (folder / "cases.jsonl").read_text().splitlines()
    cases = sorted(map(json.loads, lines), key=lambda case: case["case"])
    print(results.write(name, [row(case) for case in cases], command))


if __name__ == "__main__":
    main()
