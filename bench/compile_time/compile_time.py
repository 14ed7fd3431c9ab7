#!/usr/bin/env python3
"""Times the compiler on what users compile: an empty program with the libraries alone, one with all of cdem, the program of
the README, a bond law of one's own.

    compile_time.py [--compiler g++] [--flags=-O2] [--repetitions 3] [--include DIR ...]

Processor seconds, median and least of the repetitions, which are run in turn: compare the lines of one run. `ratio` is to
the libraries alone.
"""

import argparse
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LIBRARIES = "#include <Eigen/Core>\n#include <Eigen/Geometry>\n#include <nanoflann.hpp>\n"


def units():
    readme = (ROOT / "README.md").read_text("utf-8")
    program = re.search(r"```cpp\n(.*?)```", readme, re.DOTALL).group(1)
    empty = "int main() {}\n"
    return {
        "Eigen and nanoflann alone": LIBRARIES + empty,
        "cdem/cdem.hpp, empty program": "#include <cdem/cdem.hpp>\n" + empty,
        "cdem/bond/bond_forces.hpp, empty": "#include <cdem/bond/bond_forces.hpp>\n" + empty,
        "cdem/packing/lubachevsky_stillinger.hpp, empty": "#include <cdem/packing/lubachevsky_stillinger.hpp>\n" + empty,
        "the program of the README": program,
    }


def seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"compile_time: {' '.join(command)} failed:\n{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--flags", default="-O2")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--include", nargs="*", default=["/usr/include/eigen3"])
    options = parser.parse_args()
    if options.repetitions < 1:
        parser.error(f"--repetitions {options.repetitions} is not accepted: 1 or more is expected")
    print(f"{options.compiler} {options.flags}: processor seconds of a translation unit\n", flush=True)
    times = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in units().items():
            times[name] = []
            (pathlib.Path(folder) / f"{len(times)}.cpp").write_text(text, "utf-8")
        for _ in range(options.repetitions):
            for number, name in enumerate(times, 1):
                times[name].append(seconds(
                    [options.compiler, "-std=c++20", *options.flags.split(), f"-I{ROOT / 'include'}",
                     *(f"-I{path}" for path in options.include), "-c", f"{folder}/{number}.cpp", "-o", f"{folder}/o"]))
    base = statistics.median(next(iter(times.values())))
    print(f"{'unit':48} {'median':>7} {'least':>7} {'ratio':>6}")
    for name, values in times.items():
        print(f"{name:48} {statistics.median(values):7.2f} {min(values):7.2f} {statistics.median(values) / base:6.2f}")


if __name__ == "__main__":
    main()
