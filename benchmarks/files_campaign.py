#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Gives the program every surface file of two packages of test data, whole or broken as they are, and tells what became of each.

    files_campaign.py --program FRAMEHEX --results FOLDER [--cells 1000] [--limit SECONDS] [--memory GIGABYTES]
                      [--judge SCRIPT] [--also FOLDER] [FILE_OR_FOLDER...]

Without files, those of Debian's assimp-testmodels and libcgal-demo, some two hundred: fetched by `apt-get download` and unpacked in
FOLDER, nothing is installed. --also names a folder of more, as make_surfaces.py makes. Files of one content are run once. Each run leaves a line in FOLDER/runs.jsonl; files that have
one are not run again, so that a campaign that was stopped goes on where it was.

Each file must be meshed, without a fault by the program's own report and by --judge (run as `SCRIPT MESH --json`, of whose
answer "valid" is believed), or be refused in one line that names the file, by exit status 2. A crash, a hang (processor seconds), or more
memory than allowed is a failure, and exit status 1. The table that is printed gives the reason for each refusal.
"""
import argparse
import collections
import hashlib
import json
import pathlib
import subprocess
import sys
import tarfile
import tempfile

from limited_run import limited_run

PACKAGES = ("assimp-testmodels", "libcgal-demo")
SURFACES = (".stl", ".obj", ".off", ".ply", ".vtu", ".vtk", ".msh", ".mesh", ".meshb")
# What a refusal says, and what that means. The first that is found counts.
REASONS = (
    ("overlapping bodies", "crosses itself"), ("triangles meet", "crosses itself"), ("triangles cross", "crosses itself"),
    ("pair of triangles", "crosses itself"), ("pairs of triangles", "crosses itself"), ("is open along", "open"),
    ("stands twice", "a triangle stands twice"), ("stand more than once", "a triangle stands twice"),
    ("an edge has", "an edge of more than two triangles"), ("edges have", "an edge of more than two triangles"),
    ("touches itself at", "touches itself"), ("encloses no volume", "encloses no volume"),
)


def fetch(folder):
    """The files of the packages, unpacked once."""
    unpacked = folder / "unpacked"
    if not unpacked.exists():
        packages = folder / "packages"
        packages.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", *PACKAGES], cwd=packages, check=True, stdout=subprocess.DEVNULL)
        partial = folder / "unpacking"
        for package in packages.glob("*.deb"):
            subprocess.run(["dpkg", "-x", package, partial], check=True)
        with tarfile.open(partial / "usr/share/doc/libcgal-dev/data.tar.gz") as tar:
            tar.extractall(partial / "cgal", [m for m in tar.getmembers() if m.isfile()])
        partial.rename(unpacked)
    return [unpacked]


def files_of(names):
    for name in map(pathlib.Path, names):
        if name.is_dir():
            yield from sorted(p for p in name.rglob("*") if p.suffix.lower() in SURFACES and p.is_file())
        else:
            yield name


def verdict(status, lines, name, report, valid):
    """What became of a file, and why: in capitals what must not be."""
    if status is None:
        return "HANGS", ""
    message = lines[-1] if lines else ""
    if status == 2 and name in message:
        return "refused", next((why for words, why in REASONS if words in message), "") or message.partition(name + ": ")[2]
    if status != 0:
        return "FAILS", f"exit status {status}: {message}"
    quality, conformity = report["quality"], report["conformity"]
    if quality["invalid_cells"] or any(conformity[f] for f in ("open_quads", "other_bad_faces", "open_boundary_edges")) or not valid:
        return "INVALID", ""
    return "meshed", f"{report['counts']['cells']} cells, least scaled Jacobian {quality['least']:.3f}"


def campaign(file, options, folder):
    mesh, report = folder / "mesh.vtu", folder / "report.json"
    command = [options.program, "mesh", str(file), "-o", str(mesh), "--cells", str(options.cells), "--report", str(report), "--quiet"]
    status, lines, seconds, megabytes = limited_run(command, options.limit, options.memory)
    found, valid = {}, True
    if status == 0:
        found = json.loads(report.read_text())
        if options.judge:
            judged = subprocess.run([sys.executable, options.judge, mesh, "--json"], capture_output=True, text=True)
            valid = bool(json.loads(judged.stdout or "{}").get("valid"))
    what, why = verdict(status, lines, file.name, found, valid)
    return {"verdict": what, "why": why, "seconds": round(seconds, 2), "megabytes": round(megabytes)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--results", required=True, type=pathlib.Path)
    parser.add_argument("--cells", type=int, default=1000)
    parser.add_argument("--limit", type=int, default=300, help="processor seconds")
    parser.add_argument("--memory", type=float, default=4, help="gigabytes of address space")
    parser.add_argument("--judge")
    parser.add_argument("--also", action="append", default=[])
    parser.add_argument("file", nargs="*")
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    record = options.results / "runs.jsonl"
    done = {r["content"]: r for r in map(json.loads, record.read_text().splitlines())} if record.exists() else {}
    seen, results = set(), []
    for file in files_of([*(options.file or fetch(options.results)), *options.also]):
        content = hashlib.sha256(file.read_bytes()).hexdigest()
        if content in seen:
            continue
        seen.add(content)
        if content not in done:
            with tempfile.TemporaryDirectory() as folder:
                done[content] = {"content": content, "file": file.name, **campaign(file, options, pathlib.Path(folder))}
            with record.open("a") as lines:
                lines.write(json.dumps(done[content]) + "\n")
        r = done[content]
        results.append(r)
        print(f"{r['verdict']:8} {r['file']:40} {r['seconds']:7.1f} s {r['megabytes']:6} MB  {r['why']}", flush=True)
    counts = collections.Counter((r["verdict"], "" if r["verdict"] == "meshed" else r["why"]) for r in results)
    for (what, why), n in sorted(counts.items()):
        print(f"{n:5} {what} {why}")
    return 1 if any(r["verdict"].isupper() for r in results) else 0


if __name__ == "__main__":
    sys.exit(main())
