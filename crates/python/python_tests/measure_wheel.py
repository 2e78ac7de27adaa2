"""Prints the size of a wheel and what a call from Python costs beside the work itself.

    python measure_wheel.py WHEEL

Exit status 1 where the wheel has 25 MB or more, or a call of `simulate` costs 1 % of the work or more.
"""

import pathlib
import statistics
import sys
import time

import crosshead as ch

MACHINE = pathlib.Path(__file__).parents[3] / "data" / "machines" / "single-stage.yaml"


# Calls that are measured; the median counts.
CALLS = 41


def main():
    megabytes = pathlib.Path(sys.argv[1]).stat().st_size / 1e6
    print(f"wheel: {megabytes:.1f} MB")
    machine = ch.Machine(MACHINE).replace(**{"joints.small_end.clearance": "0.2 mm"})
    work, call = [], []
    for _ in range(CALLS):
        started = time.perf_counter()
        run = ch.simulate(machine, progress=False)
        whole = time.perf_counter() - started
        # Simulating and measuring by its own clock, on the thread that does it; all else is the call.
        work.append(run._rust.seconds)
        call.append(whole - run._rust.seconds)
    share = statistics.median(call) / statistics.median(work)
    print(f"simulate, one case of 20 revolutions: {1e3 * statistics.median(work):.2f} ms in Rust")
    print(f"the call from Python: {1e3 * statistics.median(call):.3f} ms, {100 * share:.2f} %")
    if megabytes >= 25 or share >= 0.01:
        sys.exit(1)


if __name__ == "__main__":
    main()
