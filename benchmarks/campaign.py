#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Meshes many surfaces at several sizes with the program and tabulates what came out.

    campaign.py --program FRAMEHEX --results FOLDER [--cells 300 800 ...] [--jobs N] [--limit SECONDS] [SURFACE...]

SURFACE: files, or folders whose .off, .stl, .obj and .ply are taken; without any, those of Debian's package libcgal-demo
(apt-get install libcgal-demo), some hundred, most of them closed. Each run leaves one file in FOLDER; runs that have one
are not repeated, so that a campaign that was stopped goes on where it was. Of the meshes only those with a fault are kept.

A surface that is open, or that crosses itself as it stands, is refused by the program before it meshes anything: that is right
and is told apart ("refused"). All else must give a mesh: conforming, every cell valid, none below the least scaled Jacobian but for
places that the report lists as forced by the surface's own angles ("listed"). Exit status 1 when a run breaks that.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tarfile
import tempfile
import threading

# What the program says of surfaces that are no boundary of a body, before it meshes anything.
RIGHTLY_REFUSED = ("triangles meet", "pair of triangles", "is open along", "stands twice", "stand more than once", "an edge has",
                   "edges have", "touches itself at", "encloses no volume")
LEAST_QUALITY = 0.05


def run(program, surface, cells, folder, limit):
    mesh = folder / f"{surface.stem}-{cells}.vtu"
    report = folder / f"{surface.stem}-{cells}.report.json"
    command = [program, "mesh", str(surface), "-o", str(mesh), "--cells", str(cells), "--report", str(report), "--quiet"]
    with tempfile.TemporaryFile("w+") as told:
        # Processor time: a busy machine makes no surface hang.
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=told,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5)))
        _, code, usage = os.wait4(child.pid, 0)
        told.seek(0)
        message = told.read().strip().splitlines()[-1:]
    status = os.waitstatus_to_exitcode(code)
    if status in (-signal.SIGXCPU, -signal.SIGKILL):
        status, message = None, ["not done in the time limit"]
    result = {"surface": surface.name, "asked": cells, "status": status, "message": " ".join(message),
              "seconds": round(usage.ru_utime + usage.ru_stime, 2)}
    if status == 0:
        found = json.loads(report.read_text())
        conformity, quality = found["conformity"], found["quality"]
        result |= {
            "cells": found["counts"]["cells"],
            "hexahedra": found["hex_ratio"]["number"],
            "hexahedra_volume": found["hex_ratio"]["volume"],
            "least": quality["least"],
            "faults": len(quality["invalid_cells"]) + conformity["open_quads"] + conformity["other_bad_faces"] +
                      conformity["open_boundary_edges"],
            "unexplained": sum(not poor["input_angle"] for poor in quality.get("poor_cells", [])),
            "lattice": found.get("lattice", {}).get("volume", 0),
            "size_limits": found.get("sizes", {}).get("limited_places", 0),
        }
    report.unlink(missing_ok=True)
    if judge(result) == "ok":
        mesh.unlink(missing_ok=True)
    (folder / f"{surface.stem}-{cells}.json").write_text(json.dumps(result))
    return result


def judge(result):
    if result["status"] is None:
        return "HANGS"
    if result["status"] == 2 and any(words in result["message"] for words in RIGHTLY_REFUSED):
        return "refused"
    if result["status"] != 0:
        return "FAILS"
    if result["faults"] > 0:
        return "INVALID"
    if result["least"] < LEAST_QUALITY:
        return "POOR" if result["unexplained"] > 0 else "listed"
    return "ok"


def print_row(result):
    head = f"{judge(result):8} {result['surface']:28} {result['asked']:6} {result['seconds']:8.1f}"
    if result["status"] == 0:
        print(f"{head} {result['cells']:8} {100 * result['hexahedra']:5.1f} {100 * result['hexahedra_volume']:5.1f} "
              f"{result['least']:6.3f} {result['size_limits']:6}", flush=True)
    else:
        print(f"{head}  {result['message'].split('.off: ')[-1]}", flush=True)


def surfaces_of_debian(folder):
    if not (folder / "data" / "meshes").exists():
        archive = pathlib.Path("/usr/share/doc/libcgal-dev/data.tar.gz")
        if not archive.exists():
            sys.exit("campaign.py: no surfaces given; apt-get install libcgal-demo has some")
        with tarfile.open(archive) as tar:
            tar.extractall(folder, [m for m in tar.getmembers() if m.name.startswith("data/meshes/") and m.name.endswith(".off")])
    return [folder / "data" / "meshes"]


def surfaces_of(names):
    for name in map(pathlib.Path, names):
        if name.is_dir():
            yield from sorted(p for p in name.rglob("*") if p.suffix.lower() in (".off", ".stl", ".obj", ".ply"))
        else:
            yield name


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--results", required=True, type=pathlib.Path)
    parser.add_argument("--cells", nargs="+", type=int, default=[300, 800, 1500, 3000])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--limit", type=int, default=600, help="processor seconds")
    parser.add_argument("surface", nargs="*")
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    lock, results = threading.Lock(), []
    print(f"{'':8} {'surface':28} {'asked':>6} {'seconds':>8} {'cells':>8} {'hex %':>5} {'vol %':>5} {'least':>6} {'limits':>6}")

    def one(surface, cells):
        known = options.results / f"{surface.stem}-{cells}.json"
        result = json.loads(known.read_text()) if known.exists() else run(
            options.program, surface, cells, options.results, options.limit)
        with lock:
            results.append(result)
            print_row(result)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        tasks = [pool.submit(one, surface, cells) for surface in surfaces_of(options.surface or surfaces_of_debian(options.results)) for cells in options.cells]
        for task in tasks:
            task.result()
    verdicts = [judge(r) for r in results]
    print(", ".join(f"{verdicts.count(v)} {v}" for v in sorted(set(verdicts))))
    return 1 if any(v.isupper() for v in verdicts) else 0


if __name__ == "__main__":
    sys.exit(main())
