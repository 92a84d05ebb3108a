"""Symplectic Euler on a scene's flat arrays (SI units). Put your own solver in its place."""
import json, sys

scene = json.load(open(sys.argv[1]))
unknown = set(scene["effects"]) - {"gravity", "springs"}
if unknown or scene["damping_model"] != "axial":
    sys.exit(f"solver.py: cannot compute {sorted(unknown) or 'isotropic damping'}")
h, x, v, springs = scene["timestep"], scene["positions"], scene["velocities"], scene["springs"]


def forces():
    f = [m * g for m in scene["masses"] for g in scene["gravity"]]
    ends = zip(springs["ids"][::2], springs["ids"][1::2])
    for (i, j), k, c, rest in zip(ends, springs["stiffness"], springs["damping"], springs["rest_lengths"]):
        d = [x[3 * j + a] - x[3 * i + a] for a in range(3)]  # from the first end to the second
        length = sum(d[a] ** 2 for a in range(3)) ** 0.5
        rate = sum((v[3 * j + a] - v[3 * i + a]) * d[a] for a in range(3)) / length
        for a in range(3):
            pull = (k * (length - rest) + c * rate) * d[a] / length
            f[3 * i + a] += pull
            f[3 * j + a] -= pull
    return f


print("t,id,x,y,z,vx,vy,vz")
for n in range(scene["steps"] + 1):
    for p in range(scene["particles"]):
        print(n * h, p, *x[3 * p : 3 * p + 3], *v[3 * p : 3 * p + 3], sep=",")
    f = forces()
    for a in range(len(x)):
        if not scene["fixed"][a // 3]:
            v[a] += h * f[a] / scene["masses"][a // 3]  # kick
            x[a] += h * v[a]  # drift, with the new velocity
