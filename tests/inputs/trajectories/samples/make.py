"""Writes the samples beside it: python3 make.py, here with NumPy 2.4."""

import numpy as np

t = 0.25 * np.arange(5)
x = np.arange(5 * 2 * 3).reshape(5, 2, 3) / 8 - 1
v = -x[::-1]

np.savez("savez.npz", t=t, x=x, v=v)
np.savez_compressed("compressed.npz", t=t, x=x, v=v)
np.savez("single_fortran.npz", t=t.astype("f4"), x=np.asfortranarray(x, dtype="f4"))
np.savez("big_endian.npz", t=t.astype(">f8"), x=np.asfortranarray(x).astype(">f8", order="K"), v=v.astype(">f4"))
np.savez("whole.npz", t=np.arange(5), x=(8 * x).astype(np.int16), v=(8 * x + 8).astype(np.uint8))
np.savez("free_only.npz", t=t, x=x[:, 1:], v=v[:, 1:])
np.save("positions.npy", x)
np.save("one_particle.npy", x[:, 1])
rows = [[t[k], i, *x[k, i], *v[k, i]] for k in range(5) for i in range(2)]
np.savetxt("savetxt.csv", rows, delimiter=",", header="t,id,x,y,z,vx,vy,vz")
with open("print.csv", "w") as out:
    print("t,id,x,y,z,vx,vy,vz", file=out)
    for t_k, *row in rows:
        print(t_k, *row, sep=",", file=out)
