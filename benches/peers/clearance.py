"""Times of coal on the pairs and poses of `cargo bench --bench clearance`, in microseconds a query.

`pip install coal numpy`, then `python3 benches/peers/clearance.py` right after the bench. Every time holds a call from
Python, about 0.5 us. The mean distance of each row is printed, so that the two can be compared.
"""

import math
import time

import coal
import numpy as np

QUERIES = {"solid": 2000, "mesh": 500}
ROUNDS = 7


def turn(axis, angle):
    s, c = math.sin(angle), math.cos(angle)
    rows = {0: [[1, 0, 0], [0, c, -s], [0, s, c]], 2: [[c, -s, 0], [s, c, 0], [0, 0, 1]]}
    return np.array(rows[axis], dtype=float)


def pose(k):
    t = k * 0.377
    place = np.array([3 * math.sin(t), 2 * math.cos(1.3 * t), 2.6])
    return coal.Transform3s(turn(0, t) @ turn(2, 1.7 * t), place)


def sphere_mesh(rings):
    around = 2 * rings
    vertices = [[0, 0, 1], [0, 0, -1]]
    for i in range(1, rings):
        polar = math.pi * i / rings
        for j in range(around):
            angle = math.tau * j / around
            flat = math.sin(polar)
            vertices.append([flat * math.cos(angle), flat * math.sin(angle), math.cos(polar)])

    def at(i, j):
        return 0 if i == 0 else 1 if i == rings else 2 + (i - 1) * around + j % around

    triangles = []
    for i in range(rings):
        for j in range(around):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            if i + 1 < rings:
                triangles.append([a, b, c])
            if i > 0:
                triangles.append([a, c, d])
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(triangles), len(vertices))
    for t in triangles:
        model.addTriangle(*(np.array(vertices[k], dtype=float) for k in t))
    model.endModel()
    return model, len(triangles)


def micros(a, b, queries):
    here = coal.Transform3s()
    poses = [pose(k) for k in range(queries)]
    request = coal.DistanceRequest()
    best, total = math.inf, 0.0
    for _ in range(ROUNDS):
        total, start = 0.0, time.perf_counter()
        for there in poses:
            result = coal.DistanceResult()
            total += coal.distance(a, here, b, there, request, result)
        best = min(best, time.perf_counter() - start)
    return best * 1e6 / queries, total / queries


def row(name, a, b, queries):
    time_of, mean = micros(a, b, queries)
    print(f"{name:<20} {time_of:>8.3f} us a query, mean distance {mean:.12f}", flush=True)


def main():
    capsule, cylinder, box = coal.Capsule(0.3, 2.0), coal.Cylinder(0.3, 2.0), coal.Box(1.0, 0.7, 0.5)
    for name, a, b in [
        ("capsule-capsule", capsule, capsule),
        ("capsule-box", capsule, box),
        ("box-cylinder", box, cylinder),
        ("box-box", box, box),
        ("cylinder-cylinder", cylinder, cylinder),
    ]:
        row(name, a, b, QUERIES["solid"])
    for rings in [16, 50, 158]:
        mesh, count = sphere_mesh(rings)
        for name, solid in [("capsule", capsule), ("box", box), ("cylinder", cylinder), ("mesh", mesh)]:
            row(f"{name}-mesh {count}", solid, mesh, QUERIES["mesh"])


if __name__ == "__main__":
    main()
