#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Meshes the paper's six models and shapes of a known block structure in all variants, and keeps what comes of it.

    run.py PROGRAM [--sizes small full shapes] [--only MODEL...] [--variants NAME...] [--ablation] [--again]
           [--models FOLDER] [--results FILE.json] [--meshes FOLDER]
    run.py PROGRAM --quick
    run.py --steps PAPER_STEPS [--only MODEL...] [--again]

PROGRAM is `framehex`, PAPER_STEPS what the target of that name builds: the small models with steps switched off that the
program has no option for. Each run is added to the results (results.json beside this file) as soon as it ends, so that the
command can be interrupted and goes on where it stopped; --again measures what is there anew. tables.py makes the tables.

--quick meshes a few small models and compares them with the stored results: exit status 1 when a share of hexahedra has
fallen by more than half a point, a cell is invalid or an interface open. It writes nothing.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import shapes

HERE = pathlib.Path(__file__).resolve().parent
MODELS = HERE.parents[1] / "tests" / "data"
SMALL = {"dome": 0.156, "bunny": 0.26, "blade": 0.026, "piece": 0.108, "fuselage": 0.156, "naca": 0.038}
SIZES = {"small": SMALL, "full": {model: size / 2 for model, size in SMALL.items()}, "shapes": shapes.SIZES}

PAPERS_TERMS = ["--floor", "0.25", "--interfaces", "open", "--no-improvement"]
FIELDS = {"NN": "nearest", "Sm": "smoothed"}
ORDERS = {"Fr": "fifo", "FB": "smoothness"}
PAPERS_VARIANTS = {f"{f}-{o}": ["--field", FIELDS[f], "--order", ORDERS[o], *PAPERS_TERMS] for f in FIELDS for o in ORDERS}
# The program's defaults, but for the placement of points, of which one is the default; the results say which.
PLACEMENTS = {"fronts": "smoothness", "lattice": "lattice"}
OUR_VARIANTS = {
    **{f"{name}, paper's terms": ["--order", order, *PAPERS_TERMS] for name, order in PLACEMENTS.items()},
    **{name: ["--order", order] for name, order in PLACEMENTS.items()},
}
ABLATION = {
    **{name: OUR_VARIANTS[name] for name in PLACEMENTS},
    "fronts, fifo": ["--order", "fifo"],
    "lattice, smoothed field": ["--order", "lattice", "--field", "smoothed"],
    "lattice, greedy": ["--order", "lattice", "--select", "greedy"],
    "lattice, open": ["--order", "lattice", "--interfaces", "open"],
    "lattice, no improvement": ["--order", "lattice", "--no-improvement"],
    "fronts, smoothed field": ["--order", "smoothness", "--field", "smoothed"],
    "fronts, greedy": ["--order", "smoothness", "--select", "greedy"],
    "fronts, open": ["--order", "smoothness", "--interfaces", "open"],
    "fronts, no improvement": ["--order", "smoothness", "--no-improvement"],
}
VARIANTS = {**PAPERS_VARIANTS, **OUR_VARIANTS, **ABLATION}

QUICK = [("naca", "NN-Fr"), ("naca", "Sm-FB"), ("naca", "fronts"), ("dome", "Sm-FB"), ("dome", "lattice")]
MOST_LOST = 0.5  # points by which a share may fall


def surface_file(models, model, folder):
    if model in shapes.SIZES:
        path = folder / f"{model}.off"
        shapes.write(model, path)
        return path
    for path in sorted(models.glob(f"{model}.*")):
        if path.suffix in (".stl", ".ply", ".off", ".obj"):
            return path
    raise SystemExit(f"run.py: {models} has no surface {model}")


def run_program(arguments):
    """Exit status, CPU seconds and peak memory in MB of a program and of what it starts.

    The memory of this script counts as theirs where it is more, so that it keeps to the standard library."""
    process = os.posix_spawn(arguments[0], arguments, os.environ)
    try:
        _, status, usage = os.wait4(process, 0)
    except KeyboardInterrupt:
        os.wait4(process, 0)  # it heard the interrupt too, and cleans up
        raise
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def measure(program, surface, size, options, mesh):
    report = mesh.with_suffix(".json")
    status, cpu, peak = run_program([str(program), "mesh", str(surface), "-o", str(mesh), "--report", str(report), "--size",
                                     str(size), "--threads", "1", "--quiet", *options])
    if status != 0:
        raise RuntimeError(f"exit status {status}")
    full = json.loads(report.read_text())
    counts, quality = full["counts"], full["quality"]
    return {
        "size": size,
        "options": {key: full["options"][key] for key in ("field", "order", "floor", "select", "interfaces", "improvement")},
        "cells": counts["cells"],
        **{kind: counts[kind] for kind in ("tetrahedra", "prisms", "pyramids", "hexahedra")},
        "hex_number": round(100 * full["hex_ratio"]["number"], 2),
        "hex_volume": round(100 * full["hex_ratio"]["volume"], 2),
        "least": round(quality["least"], 4),
        "mean": round(quality["mean"], 4),
        "least_hexahedron": round(quality.get("hexahedra", {}).get("least", 1), 4),
        "invalid": len(quality["invalid_cells"]) + len(quality["inverted_cells"]),
        "open": full["conformity"]["open_quads"],
        "bad_faces": full["conformity"]["other_bad_faces"] + full["conformity"]["open_boundary_edges"],
        "volume": quality["volume"],
        "second_tetrahedra": full["points"]["tetrahedra"],
        "seconds": {key: round(s, 2) for key, s in full["seconds"].items()},
        "cpu": round(cpu, 1),
        "megabytes": round(peak),
        "version": full["version"],
    }


def line(key, row):
    return (f"{key}: {row['cells']:,} cells, {row['hex_number']:.1f} / {row['hex_volume']:.1f} % hexahedra, least "
            f"{row['least']:.2f}, {row['invalid']} invalid, {row['open']} open, {row['cpu']:.0f} s, {row['megabytes']} MB")


def load(path):
    return json.loads(path.read_text()) if path.exists() else {"program": {}, "runs": {}}


def about_program(program, folder):
    """Its version and which placement it takes when not told."""
    row = measure(program, surface_file(MODELS, "L", folder), 0.5, [], folder / "L.vtu")
    return {"version": row["version"], "default": next(n for n, o in PLACEMENTS.items() if o == row["options"]["order"])}


def save(results, path):
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n")
    partial.replace(path)


def wanted(options):
    variants = options.variants or [*PAPERS_VARIANTS, *OUR_VARIANTS]
    for size in options.sizes:
        for model, edge in sorted(SIZES[size].items(), key=lambda item: item[0]):
            if options.only and model not in options.only:
                continue
            names = [v for v in variants if size != "shapes" or v in OUR_VARIANTS]
            if options.ablation and size == "small":
                names = [*ABLATION]
            for variant in names:
                yield size, model, edge, variant


def run_all(options, folder):
    done, jobs = load(options.results)["runs"], list(wanted(options))
    program = about_program(options.program, folder)
    for number, (size, model, edge, variant) in enumerate(jobs, 1):
        key = f"{model} | {size} | {variant}"
        if key in done and not options.again:
            continue
        mesh = (options.meshes or folder) / f"{model}-{size}-{variant.replace(', ', '-').replace(' ', '-')}.vtu"
        surface = surface_file(options.models, model, folder)
        started = time.monotonic()
        try:
            row = measure(options.program, surface, edge, VARIANTS[variant], mesh)
        except RuntimeError as failure:
            print(f"{number}/{len(jobs)} {key}: {failure}", flush=True)
            continue
        results = load(options.results)  # again, as others may have added to it
        results["program"], results["runs"][key] = program, row
        save(results, options.results)
        print(f"{number}/{len(jobs)} {line(key, row)} ({time.monotonic() - started:.0f} s)", flush=True)
        if not options.meshes:
            mesh.unlink()


def run_steps(options, folder):
    for model, size in SMALL.items():
        results = load(options.results)
        steps = results.setdefault("steps", {})
        if (options.only and model not in options.only) or (model in steps and not options.again):
            continue
        command = [options.steps, surface_file(options.models, model, folder), str(size)]
        steps[model] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        save(results, options.results)
        shares = (f"{name} {row['hex_volume']:.1f} %" for name, row in steps[model].items())
        print(f"{model}: {', '.join(shares)}", flush=True)


def quick(options, folder):
    stored, failures = load(options.results)["runs"], []
    for model, variant in QUICK:
        key = f"{model} | small | {variant}"
        row = measure(options.program, surface_file(options.models, model, folder), SMALL[model], VARIANTS[variant],
                      folder / "mesh.vtu")
        print(line(key, row), flush=True)
        for share in ("hex_number", "hex_volume"):
            if row[share] < stored[key][share] - MOST_LOST:
                failures.append(f"{key}: {share} is {row[share]}, was {stored[key][share]}")
        if row["invalid"] or row["bad_faces"]:
            failures.append(f"{key}: {row['invalid']} invalid cells, {row['bad_faces']} bad faces")
        if row["open"] and variant in PLACEMENTS:
            failures.append(f"{key}: {row['open']} open interfaces")
    print("\n".join(failures) if failures else "no share of hexahedra has fallen")
    return 1 if failures else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, nargs="?")
    parser.add_argument("--steps", type=pathlib.Path, metavar="PAPER_STEPS")
    parser.add_argument("--sizes", nargs="+", choices=SIZES, default=["small", "shapes", "full"])
    parser.add_argument("--only", nargs="+", metavar="MODEL")
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, metavar="NAME")
    parser.add_argument("--ablation", action="store_true", help="the small models with each step switched off in turn")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--models", type=pathlib.Path, default=MODELS)
    parser.add_argument("--results", type=pathlib.Path, default=HERE / "results.json")
    parser.add_argument("--meshes", type=pathlib.Path, help="keep the meshes here")
    options = parser.parse_args()
    if not options.program and not options.steps:
        parser.error("PROGRAM or --steps is needed")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if options.steps:
            run_steps(options, folder)
        if options.program:
            options.program = options.program.resolve()
            return quick(options, folder) if options.quick else run_all(options, folder)


if __name__ == "__main__":
    sys.exit(main())
