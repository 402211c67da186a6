#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Meshes many surfaces at several sizes with the program and tabulates what came out.

    campaign.py --program FRAMEHEX [--results FOLDER] [--cells 300 1000 ...] [--jobs N] [--limit SECONDS]
                [--as-given] [--sound PROGRAM] [--judge SCRIPT] [--also FOLDER] [SURFACE...]

SURFACE: files, or folders whose .off, .stl, .obj and .ply are taken; without any, those of Debian's package libcgal-demo
(apt-get install libcgal-demo), some hundred, most of them closed. --also names a folder of more, as make_surfaces.py makes. Each surface is turned at
random first, by its name, so that no axis is favoured and every campaign meshes the same; with --as-given none is. Each run leaves one file in FOLDER;
runs that have one are not repeated, so that a campaign that was stopped goes on where it was. Of the meshes only those with a
fault are kept.

A run must give a mesh: conforming, every cell valid, none below the least scaled Jacobian but for places that the report lists
as forced by the surface's own angles ("listed"), in less than 20 times the median processor time of its size. Refused may be
(told apart as "refused") what is open or crosses itself: by `PROGRAM SURFACE` of --sound, which exits with 0 when a surface
bounds a body (closed_surface.cpp asks CGAL); without it, by the words of the refusal. --judge names a second opinion on each
mesh, run as `SCRIPT MESH --surface SURFACE --json`, of whose answer "valid" is believed. Exit status 1 when a run breaks this.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tarfile
import tempfile
import threading

import meshio
import numpy

from limited_run import limited_run

# What the program says of surfaces that are no boundary of a body, before it meshes anything.
RIGHTLY_REFUSED = ("triangles meet", "pair of triangles", "is open along", "stands twice", "stand more than once", "an edge has",
                   "edges have", "touches itself at", "encloses no volume")
LEAST_QUALITY = 0.05
SLOWEST = 20  # times the median of a size


def read_off(path):
    lines = (line.split("#")[0].split() for line in path.read_text().splitlines())
    lines = [line for line in lines if line]
    if lines[0][0].endswith("OFF"):
        lines = ([lines[0][1:]] if lines[0][1:] else []) + lines[1:]
    n_points, n_faces = map(int, lines[0][:2])
    faces = [[int(v) for v in line[1 : 1 + int(line[0])]] for line in lines[1 + n_points : 1 + n_points + n_faces]]
    return numpy.array([line[:3] for line in lines[1 : 1 + n_points]], float), \
        [[face[0], a, b] for face in faces for a, b in zip(face[1:], face[2:])]


def read_surface(path):
    if path.suffix.lower() == ".off":
        return read_off(path)
    mesh = meshio.read(path)
    return mesh.points.astype(float), mesh.cells_dict["triangle"]


def turn_of(name):
    """A turn that is as likely as any other, and the same for the same name."""
    generator = random.Random(name)
    w, x, y, z = (generator.gauss(0, 1) for _ in range(4))
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def name_of(surface):
    return surface.name.removesuffix(".off")


def turned(surface, folder):
    """Turned, in a form that everyone reads; as it is where it cannot be read."""
    path = folder / f"{name_of(surface)}.off"
    if path.exists():
        return path
    try:
        points, triangles = read_surface(surface)
    except (Exception, SystemExit):  # meshio exits
        return surface
    part = path.with_suffix(".part")
    with part.open("w") as out:
        print(f"OFF\n{len(points)} {len(triangles)} 0", file=out)
        # Point by point: the same point must be the same wherever it stands.
        out.writelines("{!r} {!r} {!r}\n".format(*map(float, turn_of(name_of(surface)) @ p)) for p in points)
        out.writelines("3 {} {} {}\n".format(*t) for t in triangles)
    part.rename(path)
    return path


def run(options, surface, cells):
    mesh = options.results / f"{name_of(surface)}-{cells}.vtu"
    report = mesh.with_suffix(".report.json")
    command = [options.program, "mesh", str(surface), "-o", str(mesh), "--cells", str(cells), "--report", str(report), "--quiet"]
    status, lines, seconds, megabytes = limited_run(command, options.limit)
    message = lines[-1:] if status is not None else ["not done in the time limit"]
    result = {"surface": name_of(surface), "asked": cells, "status": status, "message": " ".join(message),
              "seconds": round(seconds, 2), "megabytes": round(megabytes)}
    if status == 0:
        result |= findings(json.loads(report.read_text()))
        if options.judge:
            of_surface = ["--surface", surface] if surface.parent.name == "turned" else []
            told = subprocess.run([*options.judge.split(), mesh, *of_surface, "--json"], capture_output=True, text=True)
            result["judged"] = json.loads(told.stdout) if told.returncode == 0 else {"valid": False, "error": told.stderr}
    elif status == 2:
        result["sound"] = subprocess.run([options.sound, surface], capture_output=True).returncode == 0 if options.sound else \
            not any(words in result["message"] for words in RIGHTLY_REFUSED)
    report.unlink(missing_ok=True)
    if verdict_of(result) == "ok":
        mesh.unlink(missing_ok=True)
    return result


def findings(report):
    conformity, quality = report["conformity"], report["quality"]
    return {
        "cells": report["counts"]["cells"],
        "hexahedra": report["hex_ratio"]["number"],
        "hexahedra_volume": report["hex_ratio"]["volume"],
        "least": quality["least"],
        "faults": len(quality["invalid_cells"]) + conformity["open_quads"] + conformity["other_bad_faces"] +
                  conformity["open_boundary_edges"],
        "poor": quality.get("poor_cells", []),
        "lattice": report.get("lattice", {}).get("volume", 0),
        "size_limits": report.get("sizes", {}).get("limited_places", 0),
        "given_up": report["assembly"]["given_up"],
    }


def verdict_of(result, slowest=math.inf):
    if result["status"] is None or result["seconds"] > slowest:
        return "HANGS"
    if result["status"] == 2 and not result["sound"]:
        return "refused"
    if result["status"] != 0:
        return "FAILS"
    if result["faults"] > 0 or not result.get("judged", {"valid": True})["valid"]:
        return "INVALID"
    if result["least"] < LEAST_QUALITY:
        return "POOR" if any(not poor["input_angle"] for poor in result["poor"]) else "listed"
    return "ok"


def print_row(result, verdict):
    head = f"{verdict:8} {result['surface']:28} {result['asked']:6} {result['seconds']:8.1f}"
    if result["status"] == 0:
        print(f"{head} {result['cells']:8} {100 * result['hexahedra']:5.1f} {100 * result['hexahedra_volume']:5.1f} "
              f"{result['least']:6.3f} {result['size_limits']:6}", flush=True)
    else:
        print(f"{head}  {result['message'].split('.off: ')[-1][:160]}", flush=True)


def print_summary(results):
    """What came out for each size; then, with their places, the runs that need looking at. Returns whether all is as promised."""
    all_well = True
    for size in sorted({r["asked"] for r in results}):
        of_size = [r for r in results if r["asked"] == size]
        seconds = [r["seconds"] for r in of_size if r["status"] == 0]
        slowest = SLOWEST * statistics.median(seconds) if len(seconds) > 9 else math.inf
        verdicts = [verdict_of(r, slowest) for r in of_size]
        all_well = all_well and not any(v.isupper() for v in verdicts)
        print(f"\n{size} cells, {len(of_size)} surfaces: " + ", ".join(f"{verdicts.count(v)} {v}" for v in sorted(set(verdicts))) +
              (f"; processor seconds: median {statistics.median(seconds):.1f}, most {max(seconds):.1f}" if seconds else ""))
        for result, verdict in zip(of_size, verdicts):
            if verdict.isupper() or verdict == "listed":
                print_row(result, verdict)
                for poor in result.get("poor", []):
                    print(f"{'':17} {poor['scaled_jacobian']:.4f} near {poor['place']}{' at an angle of the input' * poor['input_angle']}")
    return all_well


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


def run_all(options):
    names = options.surface or surfaces_of_debian(options.results)
    surfaces = list(surfaces_of(names + [options.also] * bool(options.also)))
    if len({name_of(s) for s in surfaces}) < len(surfaces):
        sys.exit("campaign.py: two surfaces have the same name")
    (options.results / "turned").mkdir(parents=True, exist_ok=True)
    lock, results = threading.Lock(), []
    print(f"{'':8} {'surface':28} {'asked':>6} {'seconds':>8} {'cells':>8} {'hex %':>5} {'vol %':>5} {'least':>6} {'limits':>6}")

    def one(surface, cells):
        known = options.results / f"{name_of(surface)}-{cells}.json"
        if not known.exists():
            known.write_text(json.dumps(run(options, surface if options.as_given else turned(surface, options.results / "turned"), cells)))
        result = json.loads(known.read_text())
        with lock:
            results.append(result)
            print_row(result, verdict_of(result))

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for task in [pool.submit(one, surface, cells) for cells in options.cells for surface in surfaces]:
            task.result()
    return print_summary(results)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--results", type=pathlib.Path)
    parser.add_argument("--cells", nargs="+", type=int, default=[300, 1000, 3000, 10000, 30000])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--limit", type=int, default=600, help="processor seconds")
    parser.add_argument("--as-given", action="store_true", help="turn no surface")
    parser.add_argument("--sound", help="program that exits with 0 for a surface that bounds a body")
    parser.add_argument("--judge", help="script that looks at a mesh and answers in JSON")
    parser.add_argument("--also", help="a folder of more surfaces")
    parser.add_argument("surface", nargs="*")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        options.results = options.results or pathlib.Path(folder)
        return 0 if run_all(options) else 1


if __name__ == "__main__":
    sys.exit(main())
