# SPDX-License-Identifier: BSL-1.0
"""The file of results: what it has to hold, one writer at a time, whole or not at all."""
import contextlib
import fcntl
import json
import os
import tempfile

# What the tables need of a run. Rows have more; which program and which surface they are of is not known of early ones.
ROW = {"size", "cells", "tetrahedra", "prisms", "pyramids", "hexahedra", "hex_number", "hex_volume", "least", "mean",
       "least_hexahedron", "invalid", "open", "volume", "seconds", "cpu"}


class Failure(Exception):
    """Something that the user has to know and can do something about."""


def read_json(path):
    try:
        return json.loads(path.read_text())
    except OSError as error:
        raise Failure(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:  # of the text's coding too
        raise Failure(f"{path} is no whole JSON file: {error}") from None


def load(path, must_exist=True):
    """Results, checked. Without a file and without need of one: empty ones."""
    if not path.exists() and not must_exist:
        return {"program": {}, "programs": {}, "runs": {}}
    results = read_json(path)
    if not isinstance(results, dict) or not isinstance(results.get("runs"), dict):
        raise Failure(f'{path} is no file of results: it has no "runs"')
    for key, row in results["runs"].items():
        missing = ROW - set(row) if isinstance(row, dict) else ROW
        if missing:
            raise Failure(f'{path}: the run "{key}" has no {", ".join(sorted(missing))}')
    steps = results.get("steps", {})
    for name, row in steps.items() if isinstance(steps, dict) else [("", None)]:
        if not isinstance(row, dict) or not isinstance(row.get("variants"), dict):
            raise Failure(f'{path}: the steps "{name}" have no variants')
    return results


def save(results, path):
    partial = path.with_name(path.name + ".partial")
    try:
        partial.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n")
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def writing_to(path):
    """Holds off other writers, and finds out whether the file can be written before anything is measured."""
    if path.is_dir():
        raise Failure(f"{path} is a folder, no file of results")
    lock = path.with_name(f".{path.name}.lock")
    try:
        with tempfile.TemporaryFile(dir=path.parent) as attempt:
            attempt.write(b"\n")
            attempt.flush()  # a full disk says so here
        descriptor = os.open(lock, os.O_CREAT | os.O_RDWR, 0o644)
    except OSError as error:
        raise Failure(f"results cannot be written to {path}: {error.strerror}") from None
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            ours = os.path.exists(lock) and os.path.samestat(os.fstat(descriptor), os.stat(lock))
        except OSError:
            ours = False
        if not ours:
            raise Failure(f"another run adds to {path}; wait for it, or name another file with --results")
        try:
            yield
        finally:
            os.unlink(lock)  # while it is held: whoever opened it before sees that it is no longer there
    finally:
        os.close(descriptor)
