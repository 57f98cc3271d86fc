"""Arms of five joints on a grid, far apart: `python3 benches/grid.py 300 > grid.toml`, then `mechanim check grid.toml`."""

import random
import sys

count = int(sys.argv[1])
random.seed(1)
row = int(count**0.5) + 1
print('duration = 2\nunits = { length = "mm", angle = "rad" }\n[view]\nfps = 20\n[inputs]')
for k in range(5):
    print(f'u{k} = "{0.3 + 0.1 * k:.1f}*sin({1 + k}*t + {k})"')
for body in range(count):
    x, y = 200 * (body % row), 200 * (body // row)
    a, b, c, d, e = (f"{random.uniform(0.5, 1.5):.3f}*u{k}" for k in range(5))
    print(f'[[bodies]]\nname = "b{body}"')
    print(f'frame = "Tx({x}) Ty({y}) Rz({a}) Tx(10) Ry({b}) Tx(10) Rx({c}) Tz(10) Rz({d}) Tx(10) Ry({e})"')
    print("shapes = [{ capsule = { from = [0, 0, 0], to = [20, 0, 0], radius = 2 } }]")
print("[clearance]\nminimum = 0.5")
