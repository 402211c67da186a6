#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""benchmarks/files_campaign.py, with the program and with stand-ins for programs that go wrong."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.environ["FRAMEHEX"]
CAMPAIGN = pathlib.Path(__file__).resolve().parents[2] / "benchmarks" / "files_campaign.py"
CUBE = """OFF
8 6 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
4 3 2 1 0
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
"""


class TestFilesCampaign(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="framehex_test_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.files = self.folder / "files"
        self.files.mkdir()

    def run_campaign(self, program, *more):
        return subprocess.run([sys.executable, CAMPAIGN, "--program", program, "--results", self.folder / "results", "--cells", "30",
                               *more, self.files], capture_output=True, text=True)

    def stand_in(self, *lines):
        program = self.folder / "program"
        program.write_text("\n".join(("#!/usr/bin/env python3", "import os, sys", *lines)) + "\n")
        program.chmod(0o755)
        return program

    def test_files_as_they_are(self):
        (self.files / "cube.off").write_text(CUBE)
        (self.files / "again.OFF").write_text(CUBE)  # of the same content
        (self.files / "open.off").write_text(CUBE.replace("8 6 0", "8 5 0"))
        (self.files / "short.off").write_text(CUBE.replace("8 6 0", "9 6 0"))
        (self.files / "other.txt").write_text("not a surface")
        first = self.run_campaign(PROGRAM)
        self.assertEqual(first.returncode, 0, first.stdout + first.stderr)
        verdicts = [line.split()[:2] for line in first.stdout.splitlines()[:3]]
        self.assertEqual(verdicts, [["meshed", "again.OFF"], ["refused", "open.off"], ["refused", "short.off"]])
        self.assertIn("    1 refused open\n", first.stdout)
        again = self.run_campaign(self.stand_in("sys.exit('is not run')"))
        self.assertEqual(again.stdout, first.stdout)

    def test_folders_of_more_files(self):
        more = self.folder / "more"
        more.mkdir()
        (self.files / "cube.off").write_text(CUBE)
        (more / "open.off").write_text(CUBE.replace("8 6 0", "8 5 0"))
        result = self.run_campaign(PROGRAM, "--also", more)
        verdicts = [line.split()[:2] for line in result.stdout.splitlines()[:2]]
        self.assertEqual(verdicts, [["meshed", "cube.off"], ["refused", "open.off"]])

    def test_what_goes_wrong_is_told(self):
        (self.files / "cube.off").write_text(CUBE)
        report = {"quality": {"invalid_cells": [], "least": 1}, "counts": {"cells": 1},
                  "conformity": {"open_quads": 0, "other_bad_faces": 0, "open_boundary_edges": 2}}
        for name, lines in {
            "FAILS": ["os.kill(os.getpid(), 11)"],
            "HANGS": ["while True: pass"],
            "INVALID": [f"open(sys.argv[sys.argv.index('--report') + 1], 'w').write('''{report}'''.replace(\"'\", '\"'))"],
        }.items():
            with self.subTest(name):
                (self.folder / "results" / "runs.jsonl").unlink(missing_ok=True)
                result = self.run_campaign(self.stand_in(*lines), "--limit", "1")
                self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
                self.assertEqual(result.stdout.split()[:2], [name, "cube.off"])
        (self.folder / "results" / "runs.jsonl").unlink()
        result = self.run_campaign(self.stand_in("print('program: error: out of memory', file=sys.stderr)", "sys.exit(2)"))
        self.assertEqual(result.stdout.split()[0], "FAILS")  # the message does not name the file


if __name__ == "__main__":
    unittest.main()
