#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Prints how the time of `plane` or `shell` grows: planar_speed.py PROGRAM [--surface FILE AREA] [--triangles N N ...]

Of the plate with three holes, or a surface of that area, in as many triangles: CPU seconds and peak memory of the process, wall
seconds of the stages, and the exponent of each from one size to the next. Memory is told as
no less than this script's own, about 65 MB. Needs what planar_pictures.py does.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import tempfile

from planar_pictures import plate

AREA_OF_PLATE = 6.8


def run(command, report):
    """CPU seconds of a command, and its report."""
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{command} failed")
    return usage.ru_utime + usage.ru_stime, json.loads(report.read_text())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--surface", nargs=2, metavar=("FILE", "AREA"))
    parser.add_argument("--triangles", nargs="+", type=float, default=[1e4, 10**4.5, 1e5, 10**5.5, 1e6])
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        outline, report = folder / "outline.txt", folder / "report.json"
        outline.write_text("\n\n".join("\n".join(f"{x} {y}" for x, y in loop) for loop in plate()) + "\n")
        command, source = ("shell", arguments.surface[0]) if arguments.surface else ("plane", outline)
        area = float(arguments.surface[1]) if arguments.surface else AREA_OF_PLATE
        before = None
        for wished in arguments.triangles:
            size = math.sqrt(2 * area / wished)
            seconds, told = run([arguments.program, command, source, "-o", folder / "mesh.vtu", "--size", str(size),
                                 "--report", report, "--quiet"], report)
            n = told["points"]["triangles"]
            times = {"CPU": seconds, **told["seconds"]}
            print(f"{n:,} triangles, {told['peak_memory_bytes'] / n / 1000:.2f} kB each: " +
                  ", ".join(f"{k} {v:.2f}" for k, v in times.items()), flush=True)
            if before:
                growth = math.log(n / before[0])
                print("  exponents: " + ", ".join(f"{k} {math.log(v / before[1][k]) / growth:.2f}"
                                                  for k, v in times.items() if v > 0 and before[1][k] > 0), flush=True)
            before = n, times


if __name__ == "__main__":
    main()
