#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Pages and pictures are those of the stored results; the tables say what the rows say."""
import hashlib
import json
import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAPER, IMAGES = ROOT / "benchmarks" / "paper", ROOT / "docs" / "images"
sys.path.insert(0, str(PAPER))
import run  # noqa: E402
import surfaces  # noqa: E402
import tables  # noqa: E402

RESULTS = json.loads((PAPER / "results.json").read_text())
PICTURES = json.loads((PAPER / "pictures.json").read_text())


class TestPages(unittest.TestCase):
    def test_tables_are_those_of_the_results(self):
        done = subprocess.run([sys.executable, PAPER / "tables.py", "--check"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_results_are_of_the_surfaces_beside_the_tests(self):
        told = {key.split(" | ")[0]: row["surface"] for key, row in RESULTS["runs"].items() if "surface" in row}
        for model in run.SMALL:
            path = run.surface_file(run.MODELS, model, None)
            self.assertEqual(told[model], {"sha256": run.fingerprint(path), **surfaces.describe(path)})

    def test_readme_has_the_cells_that_the_rows_have(self):
        lines = (ROOT / "README.md").read_text().splitlines()
        for model, size in run.SMALL.items():
            line = next(x for x in lines if x.startswith(f"| {model} {size:g} |"))
            cells = [cell.strip() for cell in line.split("|")]
            for place, variant in ((2, "fronts"), (6, "lattice")):
                row = RESULTS["runs"][f"{model} | small | {variant}"]
                self.assertEqual(cells[place], f"{row['cells']:,}")
                self.assertEqual(cells[place + 1], f"{row['hex_number']:.1f} / {row['hex_volume']:.1f}")


class TestPictures(unittest.TestCase):
    def test_all_are_noted(self):
        made = [path.stem for pattern in ("results-*.png", "viewer-*.png") for path in IMAGES.glob(pattern)]
        self.assertEqual(sorted([*made, "bunny"]), sorted(PICTURES))

    def test_they_are_the_files_that_were_noted(self):
        for name, picture in PICTURES.items():
            self.assertEqual(hashlib.sha256((IMAGES / f"{name}.png").read_bytes()).hexdigest(), picture["sha256"], name)

    def test_they_show_what_the_tables_say(self):
        n = 0
        for name, picture in PICTURES.items():
            for panel in picture["panels"]:
                if "row" not in panel:
                    continue
                row = RESULTS["runs"][panel["row"]]
                n += 1
                self.assertEqual(panel["cells"], row["cells"], f"{name}: {panel['row']}")
                for share in ("number", "volume"):  # the page adds volumes in single precision
                    self.assertAlmostEqual(float(panel[share]), row[f"hex_{share}"], delta=0.0501, msg=f"{name}: {panel['row']}")
        self.assertGreaterEqual(n, 23)


class TestTables(unittest.TestCase):
    def test_shares_are_rounded_once(self):
        self.assertEqual(tables.shares({"hex_number": 12.3456, "hex_volume": 99.0502}), "12.3 / 99.1")

    def test_volume_is_that_of_the_row(self):
        row = {"volume": 0.99, "surface": {"volume": 2.0}}
        self.assertAlmostEqual(tables.volume_off({}, "dome", row), 50.5)

    def test_sentences_follow_the_rows(self):
        row = lambda number, volume: {"hex_number": number, "hex_volume": volume}  # noqa: E731
        results = {"runs": {"dome | full | NN-Fr": row(50, 70), "dome | full | Sm-FB": row(48, 71),
                            "blade | full | NN-Fr": row(50, 70), "blade | full | Sm-FB": row(51.26, 69)}}
        paper = {model: {"NN-Fr": [1, 0, 0, 0, 0, 40, 60], "Sm-FB": [1, 0, 0, 0, 0, 45.5, 62]} for model in tables.NAMES}
        [text] = tables.say_claim(results, paper)
        self.assertIn("Ours at full size by volume dome +1.0, blade -1.0; by number blade +1.3, dome -2.0", text)
        self.assertIn("Paper by volume dome +2.0, bunny +2.0", text)
        self.assertIn("on dome, and it is a fraction", text)
        self.assertIn("NN-Fr itself is +10.0 points", text)

    def test_edges_go_by_the_volume_of_a_hexahedron(self):
        # Eight times as many in twice the volume: a quarter of the volume each.
        self.assertAlmostEqual(tables.mean_edge(80, 800) / tables.mean_edge(40, 100), 0.25 ** (1 / 3))


if __name__ == "__main__":
    unittest.main()
