#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Reads results of the microbenchmark: compare.py NEW.json [OLD.json] [--limit RATIO]

One file: CPU time of each stage in each host, and its abstraction penalty, the ratio to flat arrays. Two: the ratio to the
older as well. Of repetitions the least counts. Exit status 1 when a penalty exceeds the limit, or a count differs between hosts.

    microbenchmark --benchmark_repetitions=5 --benchmark_format=json > new.json
"""
import argparse
import json
import sys


def read(path):
    """(stage, host) -> least CPU milliseconds, count."""
    with open(path, encoding="utf-8") as file:
        runs = json.load(file)["benchmarks"]
    results = {}
    for run in runs:
        if run.get("run_type") == "aggregate":
            continue
        stage, host = run["name"].split("/")[:2]
        key = (stage, host)
        results[key] = (min(run["cpu_time"], results.get(key, (float("inf"),))[0]), int(run["count"]))
    return results


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("new")
    parser.add_argument("old", nargs="?")
    parser.add_argument("--limit", type=float, default=float("inf"), help="greatest penalty allowed")
    options = parser.parse_args()
    new, old = read(options.new), read(options.old) if options.old else {}
    failed = False
    print(f"| stage | host | ms | penalty |{' to old |' if old else ''}")
    print(f"| --- | --- | ---: | ---: |{' ---: |' if old else ''}")
    for (stage, host), (time, count) in new.items():
        base, expected = new[(stage, "arrays")]
        penalty = time / base
        row = f"| {stage} | {host} | {time:.2f} | {penalty:.2f} |"
        if old:
            row += f" {time / old[(stage, host)][0]:.2f} |" if (stage, host) in old else " new |"
        print(row)
        if count != expected:
            print(f"{stage}: {count} in {host}, {expected} in arrays", file=sys.stderr)
        failed |= count != expected or penalty > options.limit
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
