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


def measured(of):
    """Median time of a call, s."""
    times = []
    for _ in range(41):
        started = time.perf_counter()
        of()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def main():
    megabytes = pathlib.Path(sys.argv[1]).stat().st_size / 1e6
    print(f"wheel: {megabytes:.1f} MB")
    machine = ch.Machine(MACHINE).replace(**{"joints.small_end.clearance": "0.2 mm"})
    # The work by its own clock, on the thread that does it; everything else is the call.
    whole = measured(lambda: ch.simulate(machine, progress=False))
    work = statistics.median(ch.simulate(machine, progress=False)._rust.seconds for _ in range(41))
    share = whole / work - 1
    print(f"simulate, one case of 20 revolutions: {1e3 * whole:.2f} ms, of which Rust {1e3 * work:.2f} ms: {100 * share:.2f} % more")
    if megabytes >= 25 or share >= 0.01:
        sys.exit(1)


if __name__ == "__main__":
    main()
