# SPDX-License-Identifier: BSL-1.0
"""Surfaces of shapes that have an all-hexahedral mesh of few blocks, as OFF files."""
import math

SIZES = {"cylinder": 0.05, "tube": 0.05, "torus": 0.07, "ball": 0.1, "prism": 0.05, "tetrahedron": 0.05, "L": 0.1}


def extruded(outline, height, holes=()):
    """A polygon, star-shaped from its first corner or (with a hole of as many corners) ring-shaped, raised to a height."""
    points, faces, n = [], [], len(outline)
    for ring in (outline, *holes):
        points += [(x, y, z) for z in (0, height) for x, y in ring]

    def wall(first, outward):
        for i in range(n):
            a, b, c, d = first + i, first + (i + 1) % n, first + n + (i + 1) % n, first + n + i
            faces.append((a, b, c, d) if outward else (d, c, b, a))

    wall(0, True)
    if holes:
        wall(2 * n, False)
        for i in range(n):
            j = (i + 1) % n
            faces.append((j, i, 2 * n + i, 2 * n + j))
            faces.append((n + i, n + j, 3 * n + j, 3 * n + i))
    else:
        faces.append(tuple(reversed(range(n))))
        faces.append(tuple(range(n, 2 * n)))
    return points, faces


def circle(radius, n):
    return [(radius * math.cos(2 * math.pi * i / n), radius * math.sin(2 * math.pi * i / n)) for i in range(n)]


def fan(points, faces):
    """Polygons of more than four corners as triangles round their centre."""
    out = []
    points = list(points)
    for face in faces:
        if len(face) <= 4:
            out.append(face)
            continue
        points.append(tuple(sum(points[v][k] for v in face) / len(face) for k in range(3)))
        out += [(face[i - 1], face[i], len(points) - 1) for i in range(len(face))]
    return points, out


def torus(major, minor, n, m):
    points, faces = [], []
    for i in range(n):
        for j in range(m):
            u, v = 2 * math.pi * i / n, 2 * math.pi * j / m
            r = major + minor * math.cos(v)
            points.append((r * math.cos(u), r * math.sin(u), minor * math.sin(v)))
            a, b = (i + 1) % n, (j + 1) % m
            faces.append((i * m + j, a * m + j, a * m + b, i * m + b))
    return points, faces


def icosphere(n_splits):
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1),
              (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7),
             (9, 8, 1)]
    for _ in range(n_splits):
        middle, split = {}, []

        def half(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(points)
                points.append(tuple((x + y) / 2 for x, y in zip(points[a], points[b])))
            return middle[key]

        for a, b, c in faces:
            ab, bc, ca = half(a, b), half(b, c), half(c, a)
            split += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = split
    return [tuple(x / math.hypot(*p) for x in p) for p in points], faces


def make(name):
    if name == "cylinder":
        return fan(*extruded(circle(0.5, 96), 2))
    if name == "tube":
        return extruded(circle(0.5, 96), 1, [circle(0.25, 96)])
    if name == "torus":
        return torus(1, 0.35, 120, 60)
    if name == "ball":
        return icosphere(4)
    if name == "prism":
        return extruded([(0, 0), (1, 0), (0.5, math.sqrt(3) / 2)], 1)
    if name == "tetrahedron":
        s = math.sqrt(1 / 8)
        return [(s, s, s), (s, -s, -s), (-s, s, -s), (-s, -s, s)], [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
    if name == "L":
        points, faces = extruded([(0, 0), (2, 0), (3, 0), (3, 1), (2, 1), (2, 2), (0, 2), (0, 1)], 1)
        n = 8
        # Six unit squares less one: a row of three and two above it. The polygon is not convex, so its lids are cut.
        lids = [(0, 1, 4, 7), (1, 2, 3, 4), (7, 4, 5, 6)]
        return points, faces[:n] + [tuple(reversed(lid)) for lid in lids] + [tuple(n + v for v in lid) for lid in lids]
    raise ValueError(f"no shape is called {name}")


def write(name, path):
    points, polygons = make(name)
    faces = [(face[0], face[i - 1], face[i]) for face in polygons for i in range(2, len(face))]  # all are convex
    with open(path, "w") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        for point in points:
            file.write(" ".join(repr(x) for x in point) + "\n")
        for face in faces:
            file.write(" ".join(map(str, (len(face), *face))) + "\n")
