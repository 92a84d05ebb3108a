"""Symplectic Euler in NumPy, held against the others by springcheck:

springcheck run scenes/pa1/scene04.yml \\
    --external numpy='python3 examples/external.py {scene_json} {output}'

Reads the scene as flat arrays (SI units) and saves every state: t (T), x and v (T, N, 3).
"""

import json
import sys

import numpy as np

scene_json, output = sys.argv[1:]
with open(scene_json) as file:
    scene = json.load(file)

# What this program does not compute, it must not pretend to.
missing = set(scene["effects"]) - {"gravity", "springs"}
if missing or scene["damping_model"] != "axial":
    sys.exit(f"external.py: cannot compute {sorted(missing) or 'isotropic damping'}")

h, steps = scene["timestep"], scene["steps"]  # s, 1
x = np.array(scene["positions"]).reshape(-1, 3)  # m
v = np.array(scene["velocities"]).reshape(-1, 3)  # m/s
mass = np.array(scene["masses"])[:, None]  # kg
fixed = np.array(scene["fixed"])
gravity = np.array(scene["gravity"])  # m/s^2
springs = scene["springs"]
i, j = np.array(springs["ids"], dtype=int).reshape(-1, 2).T  # the ends of each spring
k = np.array(springs["stiffness"])  # N/m
c = np.array(springs["damping"])  # N s/m
rest = np.array(springs["rest_lengths"])  # m


def forces(x, v):
    """Forces on all particles (N, 3), in newtons."""
    f = mass * gravity
    d = x[j] - x[i]  # from the first end to the second, m
    length = np.linalg.norm(d, axis=1)
    rate = np.sum((v[j] - v[i]) * d, axis=1) / length  # how fast it grows, m/s
    pull = ((k * (length - rest) + c * rate) / length)[:, None] * d
    # Not f[i] += pull, which adds only once where a particle holds several springs.
    np.add.at(f, i, pull)
    np.subtract.at(f, j, pull)
    return f


xs, vs = [x], [v]
for _ in range(steps):
    v = np.where(fixed[:, None], 0.0, v + h * forces(x, v) / mass)  # kick
    x = x + h * v  # drift, with the new velocity
    xs.append(x)
    vs.append(v)
np.savez(output, t=h * np.arange(steps + 1), x=xs, v=vs)
