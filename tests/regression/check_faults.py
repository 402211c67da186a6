#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Compares README.md beside it with the tests that carry the tag [regression]: check_faults.py

Each row names a test that exists and has the tag, and each test with the tag is in a row. Tests in Python are classes and have
no tag.
"""
import pathlib
import re
import sys

TESTS = pathlib.Path(__file__).resolve().parent.parent
ROW = re.compile(r"^\| .* \| (\w+): (.*) \|$", re.M)
CASE = re.compile(r'TEST_CASE\(\s*"((?:[^"\\]|\\.)*)"(?:,\s*"([^"]*)")?')


def tagged():
    """The tests in C++ that have the tag, and the classes of tests in Python."""
    cases, classes = set(), set()
    for path in TESTS.glob("*/*.cpp"):
        cases |= {(path.parent.name, name) for name, tags in CASE.findall(path.read_text()) if "[regression]" in tags}
    for path in TESTS.glob("*/test_*.py"):
        classes |= {(path.parent.name, name) for name in re.findall(r"^class (Test\w+)", path.read_text(), re.M)}
    return cases, classes


def main():
    rows = ROW.findall((TESTS / "regression" / "README.md").read_text())
    cases, classes = tagged()
    errors = [f"{folder}: {name}: there is no such test, or it has no tag [regression]"
              for folder, name in rows if (folder, name) not in cases | classes]
    errors += [f"{folder}: {name}: has the tag [regression] but no row in README.md" for folder, name in sorted(cases - set(rows))]
    print("\n".join(errors) if errors else f"{len(rows)} faults, each with its test")
    return 1 if errors or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
