#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Tries the script that compares results of the microbenchmark on files of known content: check_compare.py COMPARE"""
import json
import pathlib
import subprocess
import sys
import tempfile


def results(folder, name, times, count=7):
    """A file as Google Benchmark writes it; stage/host -> times of its repetitions in ms."""
    runs = [{"name": f"{key}/min_time:0.100", "run_type": "iteration", "cpu_time": t, "count": count if key != "field/odd" else 8}
            for key, repetitions in times.items() for t in repetitions]
    runs.append({"name": "validate/arrays_mean", "run_type": "aggregate", "cpu_time": 1e9, "count": 0})
    path = pathlib.Path(folder, name)
    path.write_text(json.dumps({"context": {}, "benchmarks": runs}))
    return path


def compare(*arguments):
    run = subprocess.run([sys.executable, sys.argv[1], *map(str, arguments)], capture_output=True, text=True)
    rows = [line.strip("| ").split(" | ") for line in run.stdout.splitlines()[2:]]
    return run.returncode, rows, run.stderr


with tempfile.TemporaryDirectory() as folder:
    new = results(folder, "new.json", {"validate/arrays": [4, 2, 3], "validate/pointers": [2.5, 2.1]})
    old = results(folder, "old.json", {"validate/arrays": [4]})
    # The least of the repetitions, and means left out: 2.1 / 2 and, to the older file, 2 / 4.
    assert compare(new) == (0, [["validate", "arrays", "2.00", "1.00"], ["validate", "pointers", "2.10", "1.05"]], "")
    assert [row[4] for row in compare(new, old)[1]] == ["0.50", "new"]
    assert compare(new, "--limit", "1.06")[0] == 0
    assert compare(new, "--limit", "1.04")[0] == 1
    odd = results(folder, "odd.json", {"field/arrays": [1], "field/odd": [1]})
    status, _, message = compare(odd)
    assert status == 1 and "8 in odd, 7 in arrays" in message
print("penalties, comparison and limits are those of the files")
