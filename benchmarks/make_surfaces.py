#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Makes closed surfaces for campaign.py: plates, springs, gears, text, gyroids.

    make_surfaces.py FOLDER

By Gmsh's OpenCASCADE (`gmsh`), by OpenSCAD (`openscad`) and by marching tetrahedra; what is there already is not made anew.
"""
import itertools
import pathlib
import subprocess
import sys

import numpy

GMSH = {  # programs of Gmsh with its OpenCASCADE kernel; elements no longer than L
    "plate_10": "Box(1) = {0,0,0, 10,6,1}; L = 3;",
    "plate_100": "Box(1) = {0,0,0, 10,6,0.1}; L = 3;",
    "plate_1000": "Box(1) = {0,0,0, 10,6,0.01}; L = 3;",
    "plate_holes": """Box(1) = {0,0,0, 10,6,0.3};
        For i In {0:7}
          Cylinder(10+i) = {1.2+1.1*i,2+2*(i%2),-1, 0,0,3, 0.2+0.1*i};
        EndFor
        BooleanDifference{ Volume{1}; Delete; }{ Volume{10:17}; Delete; } L = 1;""",
    "plate_bent": """Rectangle(1) = {3,0,0, 0.1,4};
        Extrude{ {0,1,0}, {0,0,0}, 3*Pi/2 }{ Surface{1}; } L = 0.7;""",
    "spring": """
        For i In {0:120}
          Point(i+1) = {Cos(i*Pi/10), Sin(i*Pi/10), 0.035*i};
        EndFor
        Spline(1) = {1:121}; Wire(1) = {1}; Disk(1) = {1,0,0, 0.2,0.2}; Rotate{ {1,0,0}, {1,0,0}, Pi/2 }{ Surface{1}; }
        Extrude{ Surface{1}; } Using Wire{1} Delete{ Surface{1}; } L = 0.15;""",
    "bracket": """Box(1) = {0,0,0, 4,3,0.4}; Box(2) = {0,0,0, 0.4,3,3}; BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
        Cylinder(4) = {2.5,1.5,-1, 0,0,3, 0.7}; BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; }; L = 0.5;""",
    "elbow": """Torus(1) = {0,0,0, 3,1, Pi/2}; Torus(2) = {0,0,0, 3,0.9, Pi/2};
        BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; } L = 0.4;""",
    "nozzle": "Cone(1) = {0,0,0, 0,0,4, 2,0.05}; Cylinder(2) = {0,0,-1, 0,0,6, 0.03}; "
              "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; } L = 0.5;",
    "lens": "Sphere(1) = {0,0,-2, 2.5}; Sphere(2) = {0,0,2, 2.5}; BooleanIntersection{ Volume{1}; Delete; }{ Volume{2}; Delete; } L = 0.3;",
    "ledges": """Cylinder(1) = {0,0,0, 0,0,1, 2}; Cylinder(2) = {0,0,1, 0,0,1, 1.98}; Cylinder(3) = {0,0,2, 0,0,1, 1.9};
        BooleanUnion{ Volume{1}; Delete; }{ Volume{2,3}; Delete; } L = 0.4;""",
    "crossed_pipes": """Cylinder(1) = {-3,0,0, 6,0,0, 1}; Cylinder(2) = {0,-3,0.3, 0,6,0, 0.8}; Cylinder(3) = {0,0,-3, 0,0,6, 0.5};
        BooleanUnion{ Volume{1}; Delete; }{ Volume{2,3}; Delete; } L = 0.3;""",
    "shell_box": """Box(1) = {0,0,0, 4,3,2}; Box(2) = {0.05,0.05,0.05, 3.9,2.9,3};
        BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; } L = 1;""",
    "fins": """Box(1) = {0,0,0, 5,3,0.3};
        For i In {0:8}
          Box(10+i) = {0.1+0.55*i,0,0.3, 0.05,3,1.5};
        EndFor
        BooleanUnion{ Volume{1}; Delete; }{ Volume{10:18}; Delete; } L = 0.8;""",
    "rounded": "Box(1) = {0,0,0, 3,2,1}; Fillet{1}{1:12}{0.2} L = 0.2;",
    "chamfered": "Box(1) = {0,0,0, 3,2,1}; Chamfer{1}{1:12}{3,3,3,3,1,1,1,1,1,1,1,1}{0.15} L = 0.4;",
    "fillet_boss": """Box(1) = {-3,-2,0, 6,4,0.5}; Cylinder(2) = {0,0,0.5, 0,0,1.5, 0.9}; BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
        e() = Curve In BoundingBox {-1,-1,0.4, 1,1,0.6}; v() = Fillet{3}{e()}{0.3};
        Cylinder(50) = {0,0,-1, 0,0,4, 0.4}; BooleanDifference{ Volume{v()}; Delete; }{ Volume{50}; Delete; } L = 0.3;""",
    "flange": """Cylinder(1) = {0,0,0, 0,0,0.4, 3}; Cylinder(2) = {0,0,0.4, 0,0,2, 1.2}; BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
        Cylinder(4) = {0,0,-1, 0,0,5, 1};
        For i In {0:7}
          Cylinder(10+i) = {2.3*Cos(i*Pi/4),2.3*Sin(i*Pi/4),-1, 0,0,3, 0.3};
        EndFor
        BooleanDifference{ Volume{3}; Delete; }{ Volume{4,10:17}; Delete; } L = 0.4;""",
    "cup": "Sphere(1) = {0,0,0, 2, -Pi/2, 0}; Sphere(2) = {0,0,0, 1.95, -Pi/2, 0}; BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; } L = 0.3;",
    "tee": """Cylinder(1) = {-3,0,0, 6,0,0, 1}; Cylinder(2) = {0,0,0, 0,0,3, 0.7}; BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
        Cylinder(4) = {-4,0,0, 8,0,0, 0.9}; Cylinder(5) = {0,0,0, 0,0,4, 0.6}; BooleanDifference{ Volume{3}; Delete; }{ Volume{4,5}; Delete; } L = 0.3;""",
    "bottle": """Point(1) = {1,0,0}; Point(2) = {1.2,0,1}; Point(3) = {0.8,0,2.2}; Point(4) = {0.3,0,3}; Point(5) = {0.35,0,3.6};
        Point(6) = {0.95,0,0}; Point(7) = {1.15,0,1}; Point(8) = {0.75,0,2.2}; Point(9) = {0.25,0,3}; Point(10) = {0.3,0,3.6};
        Spline(1) = {1:5}; Line(2) = {5,10}; Spline(3) = {10,9,8,7,6}; Line(4) = {6,1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
        Extrude{ {0,0,1}, {0,0,0}, 2*Pi }{ Surface{1}; } Delete{ Surface{1}; } L = 0.3;""",
    "duct": """Rectangle(1) = {-1,-1,0, 2,2, 0.3}; Rectangle(2) = {-0.6,-0.6,3, 1.2,1.2, 0.5}; Wire(30) = {1:8}; Wire(31) = {9:16};
        ThruSections(1) = {30,31}; Physical Surface(1) = Boundary{ Volume{1}; }; L = 0.3;""",
    "wavy_sheet": """For i In {0:24}
          Point(i+1) = {0.25*i, 0, 0.5*Sin(0.25*i*2)}; Point(i+101) = {0.25*i, 0, 0.5*Sin(0.25*i*2)+0.08};
        EndFor
        Spline(1) = {1:25}; Line(2) = {25,125}; Spline(3) = {125:101:-1}; Line(4) = {101,1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
        Extrude{ 0,3,0 }{ Surface{1}; } L = 0.4;""",
}

GEAR = """module gear(teeth, bore) { difference() { union() { circle(teeth / 2 - 1, $fn = 5 * teeth);
    for (i = [0 : teeth - 1]) rotate(360 * i / teeth) translate([teeth / 2 - 1.5, 0]) polygon([[0, -0.9], [2.2, -0.35], [2.2, 0.35], [0, 0.9]]); }
    circle(bore, $fn = 40); } }"""
OPENSCAD = {
    "gear_spur": GEAR + "linear_extrude(3) gear(18, 3);",
    "gear_helical": GEAR + "linear_extrude(4, twist = 30, slices = 12) gear(14, 2);",
    "gear_worn": GEAR + "linear_extrude(0.4) gear(40, 17);",
    "text_hex": 'linear_extrude(2) text("hex", 10, font = "DejaVu Sans");',
    "text_plaque": 'difference() { translate([-2, -4, 0]) cube([34, 17, 2]); translate([0, 0, 1.5]) linear_extrude(1) text("Mesh", 9, font = "DejaVu Serif"); }',
    "threaded_rod": "linear_extrude(10, twist = 1800, slices = 150) translate([0.3, 0]) circle(2, $fn = 40);",
    "sponge": """difference() { cube(9, center = true); for (a = [[0, 0, 0], [90, 0, 0], [0, 90, 0]]) rotate(a) { cube([3, 3, 10], center = true);
        for (i = [-3, 0, 3], j = [-3, 0, 3]) translate([i, j, 0]) cube([1, 1, 10], center = true); } }""",
    "gear_bevel": GEAR + "linear_extrude(4, scale = 0.6) gear(16, 2);",
    "gear_herringbone": GEAR + "for (side = [0, 1]) mirror([0, 0, side]) linear_extrude(2, twist = 15, slices = 8) gear(12, 2);",
    "spring_flat": "linear_extrude(12, twist = 1440, slices = 160) translate([3, 0]) square([0.5, 1.2], center = true);",
    "text_round": 'rotate_extrude($fn = 60) translate([6, 0]) square([0.5, 4]); for (i = [0 : 3]) rotate(90 * i) '
                  'translate([6.3, 0, 2]) rotate([90, 0, 90]) linear_extrude(0.8) text("abc"[i % 3], 2, font = "DejaVu Sans", halign = "center", valign = "center");',
    "vase": "difference() { linear_extrude(6, twist = 60, slices = 30, scale = 1.4) circle(2, $fn = 6); "
            "translate([0, 0, 0.2]) linear_extrude(6, twist = 60, slices = 30, scale = 1.4) circle(1.85, $fn = 6); }",
    "pill": "minkowski() { cube([4, 2, 0.3], center = true); sphere(0.4, $fn = 20); }",
    "lattice_bars": "for (i = [0 : 2], j = [0 : 2]) { translate([2 * i, 2 * j, -1]) cylinder(6, 0.4, 0.4, $fn = 16); "
                    "translate([2 * i, -1, 2 * j]) rotate([-90, 0, 0]) cylinder(6, 0.4, 0.4, $fn = 16); "
                    "translate([-1, 2 * i, 2 * j]) rotate([0, 90, 0]) cylinder(6, 0.4, 0.4, $fn = 16); }",
}


def gyroid(p):
    return numpy.sin(p[0]) * numpy.cos(p[1]) + numpy.sin(p[1]) * numpy.cos(p[2]) + numpy.sin(p[2]) * numpy.cos(p[0])


def box(p, half):
    return numpy.abs(p).max(axis=0) - half


FUNCTIONS = {  # negative inside, with the half length of the box that is searched and the number of its cells
    "gyroid_solid": (lambda p: numpy.maximum(gyroid(p), box(p, 4)), 4.3, 18),
    "gyroid_sheet": (lambda p: numpy.maximum(numpy.abs(gyroid(p)) - 0.4, box(p, 3.5)), 3.8, 24),
    "gyroid_ball": (lambda p: numpy.maximum(gyroid(p) - 0.3, numpy.sqrt((p * p).sum(axis=0)) - 5), 5.3, 20),
    "schwarz": (lambda p: numpy.maximum(numpy.cos(p).sum(axis=0) - 0.2, box(p, 5)), 5.3, 18),
}


def marching_tetrahedra(f, half, n):
    """The surface where f is zero, of six tetrahedra in each cell; triangles look to where f is positive."""
    axis = numpy.linspace(-half, half, n + 1)
    p = numpy.stack(numpy.meshgrid(axis, axis, axis, indexing="ij")).reshape(3, -1)
    values = f(p)
    index = numpy.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    number, points, triangles = {}, [], []

    def crossing(a, b):
        a, b = min(a, b), max(a, b)
        if (a, b) not in number:
            number[a, b] = len(points)
            t = min(max(values[a] / (values[a] - values[b]), 0.05), 0.95)
            points.append((1 - t) * p[:, a] + t * p[:, b])
        return number[a, b]

    for order in itertools.permutations(range(3)):
        corners = [numpy.zeros(3, int)]
        for along in order:
            corners.append(corners[-1] + numpy.eye(3, dtype=int)[along])
        tets = numpy.stack([index[c[0] : c[0] + n, c[1] : c[1] + n, c[2] : c[2] + n].ravel() for c in corners], axis=1)
        inside = values[tets] < 0
        cut = inside.any(axis=1) & ~inside.all(axis=1)
        for tet, of in zip(tets[cut], inside[cut]):
            loop = [crossing(i, o) for i in tet[of] for o in tet[~of]]
            if len(loop) == 4:
                loop = [loop[0], loop[1], loop[3], loop[2]]
            at = [points[corner] for corner in loop[:3]]
            outward = p[:, tet[~of]].mean(axis=1) - p[:, tet[of]].mean(axis=1)
            if numpy.cross(at[1] - at[0], at[2] - at[0]) @ outward < 0:
                loop.reverse()
            triangles += [(loop[0], a, b) for a, b in zip(loop[1:], loop[2:])]
    return points, triangles


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in GMSH.items():
        stl = folder / f"{name}.stl"
        if not stl.exists():
            stl.with_suffix(".geo").write_text(
                f'SetFactory("OpenCASCADE");\n{text}\nMesh.CharacteristicLengthMax = L; Mesh.CharacteristicLengthFromCurvature = 1; '
                "Mesh.MinimumElementsPerTwoPi = 20; Mesh.Binary = 1;\n")
            subprocess.run(["gmsh", "-2", "-v", "1", stl.with_suffix(".geo"), "-o", folder / "partial.stl"], check=True)
            (folder / "partial.stl").rename(stl)  # Gmsh writes one when it fails, too
    for name, text in OPENSCAD.items():
        off = folder / f"{name}.off"
        if not off.exists():
            off.with_suffix(".scad").write_text(text)
            subprocess.run(["openscad", "-q", "-o", off, off.with_suffix(".scad")], check=True)
    for name, (f, half, n) in FUNCTIONS.items():
        off = folder / f"{name}.off"
        if not off.exists():
            points, triangles = marching_tetrahedra(f, half, n)
            with off.open("w") as out:
                print(f"OFF\n{len(points)} {len(triangles)} 0", file=out)
                out.writelines("{!r} {!r} {!r}\n".format(*map(float, p)) for p in points)
                out.writelines("3 {} {} {}\n".format(*t) for t in triangles)


if __name__ == "__main__":
    main()
