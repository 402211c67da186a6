#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Which lines of include/ the tests run: coverage.py BUILD_DIR [--least PERCENT] [--missing PATTERN]

Reads what the programs in BUILD_DIR/bin left in BUILD_DIR/profiles, built by clang with -fprofile-instr-generate and
-fcoverage-mapping, and prints a table by folder. A line counts as run when any instantiation in any program ran it.
Templates that nothing instantiates leave no lines for the compiler to count: what lies inside of functions that no program contains is counted as not run, line for line, unless it is constexpr, which the compiler may
have run itself. Exit status 1 when less than --least percent are run. --missing lists lines and functions of headers whose
path contains PATTERN.
"""
import argparse
import collections
import pathlib
import re
import subprocess
import sys

from inventory import functions

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADERS = ROOT / "include" / "framehex"


def lines_run(build):
    """Header -> line -> how often it was run, in all programs together."""
    profiles = sorted((build / "profiles").glob("*.profraw"))
    programs = [path for path in sorted((build / "bin").iterdir()) if path.read_bytes()[:4] == b"\x7fELF"]
    if not profiles or not programs:
        sys.exit(f"{build}: no program was built with the preset coverage and run there")
    merged = build / "all.profdata"
    # Processes that were killed while they wrote leave files that cannot be read: those are left out.
    subprocess.run(["llvm-profdata-16", "merge", "--sparse", "--failure-mode=all", "-o", merged, *profiles], check=True,
                   stderr=subprocess.DEVNULL)
    objects = [f"--object={path}" for path in programs]
    listed = subprocess.run(["llvm-cov-16", "export", "--format=lcov", f"--instr-profile={merged}", *objects],
                            check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    counts = collections.defaultdict(collections.Counter)
    lines = None
    for record in listed.stdout.splitlines():
        if record.startswith("SF:"):
            path = pathlib.Path(record[3:])
            lines = counts[path.relative_to(HEADERS).as_posix()] if path.is_relative_to(HEADERS) else None
        elif record.startswith("DA:") and lines is not None:
            number, count = record[3:].split(",")[:2]
            lines[int(number)] += int(count)
    return counts


def is_statement(line):
    """Whether a line of a function's body is likely to be one that the compiler would count."""
    line = line.strip()
    return bool(line) and not line.startswith("//") and line not in ("}", "};", "{", "});", "else", "} else {", "public:", "private:")


def never_compiled(text, counted):
    """Name, first line and statements of functions of which the compiler counted no line."""
    lines = text.splitlines()
    for name, first, length in functions(text):
        head_and_body = range(first, first + length)
        if name == "requires" or any(n in counted for n in head_and_body) or "constexpr" in lines[first - 1]:
            continue
        opening = next(n for n in head_and_body if lines[n - 1].rstrip().endswith("{"))
        yield name, first, [n for n in range(opening + 1, first + length) if is_statement(lines[n - 1])]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--least", type=float, default=0)
    parser.add_argument("--missing", metavar="PATTERN")
    options = parser.parse_args()
    counts = lines_run(options.build.resolve())

    folders = collections.defaultdict(lambda: [0, 0, 0])  # lines, of them run, of them never compiled
    for path in sorted(HEADERS.rglob("*.hpp")):
        header = path.relative_to(HEADERS).as_posix()
        unseen = list(never_compiled(path.read_text(), counts[header]))
        n_unseen = sum(len(lines) for _, _, lines in unseen)
        missed = sorted(line for line, n in counts[header].items() if n == 0)
        total = folders[header.split("/")[0] if "/" in header else "(top)"]
        total[0] += len(counts[header]) + n_unseen
        total[1] += len(counts[header]) - len(missed)
        total[2] += n_unseen
        if options.missing is not None and options.missing in header and (missed or n_unseen):
            print(f"{header}: lines {missed}" + "".join(f"\n  never compiled: {name}, line {first}" for name, first, _ in unseen))

    print("| folder | lines | run | % | in no program |\n| --- | ---: | ---: | ---: | ---: |")
    everything = [sum(total[i] for total in folders.values()) for i in range(3)]
    for folder, (n, n_run, n_unseen) in [*sorted(folders.items()), ("all", everything)]:
        print(f"| {folder} | {n} | {n_run} | {100 * n_run / max(n, 1):.1f} | {n_unseen} |")
    percent = 100 * everything[1] / everything[0]
    if percent < options.least:
        print(f"{percent:.2f} % of the lines are run, less than {options.least} %", file=sys.stderr)
    return 1 if percent < options.least else 0


if __name__ == "__main__":
    sys.exit(main())
