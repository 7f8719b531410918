#!/usr/bin/python3
"""Stokes drag of spheroids and of rods with round ends (spherocylinders).

Usage: theory.py [ASPECT ...]      a table for these aspects p, length over all by width; without any, 2 3 5 10

Spheroids in closed form (Perrin 1934, 1936; here as Kim & Karrila 1991, table 3.4). Of rods no paper at hand has round ends:
their drag is computed, by

    int G(x - y) f(y) dS(y) = U + w x x   on the surface,   G(r) = (1 + r r/r^2)/(8 pi eta r)

with the unknown f constant on N patches of equal area A/N around the sites that odpd puts on such a body
(include/odpd/scene/body_shapes.h). The patch around a site itself counts as a disk of radius rho = sqrt(A/(pi N)): 3 pi rho along its
plane and 2 pi rho across, over 8 pi eta. The error is linear in N^-1/2, and a straight line through N = 400, 800, 1600
ends within 2e-3 of the closed forms for spheroids up to p = 14, which `--check` shows.

Resistances are given over 6 pi eta R (forces) and 8 pi eta R^3 (torques), R half the width: F_par, F_perp, T_par, T_perp,
along the axis and across it.
"""
import functools
import math
import sys

import numpy as np


def perrin(p):
    """The four resistances of a prolate spheroid of aspect p > 1; of a ball at p = 1."""
    if p < 1 + 1e-4:
        return np.ones(4)
    e = math.sqrt(1 - 1 / p**2)
    log = math.log((1 + e) / (1 - e))
    return np.array(
        [
            p * 8 / 3 * e**3 / (-2 * e + (1 + e**2) * log),
            p * 16 / 3 * e**3 / (2 * e + (3 * e**2 - 1) * log),
            p**3 * 4 / 3 * e**3 * (1 - e**2) / (2 * e - (1 - e**2) * log),
            p**3 * 4 / 3 * e**3 * (2 - e**2) / (-2 * e + (1 + e**2) * log),
        ]
    )


def sites(shape, p, n):
    """n sites on the surface (half width 1), their normals, the area of a patch."""
    k = np.arange(n)
    share = (k + 0.5) / n
    if shape == "rod":
        area = 4 * math.pi * p
        x = p * (2 * share - 1)
        beyond = np.sign(x) * np.maximum(np.abs(x) - (p - 1), 0.0)
        s = np.sqrt(1 - beyond**2)
        normal = np.stack([beyond, s], 1)
    else:
        t = np.linspace(-1, 1, 200001)
        f = np.sqrt(1 - (1 - 1 / p**2) * t**2)
        below = np.concatenate([[0], np.cumsum(0.5 * (f[1:] + f[:-1])) * (t[1] - t[0])])
        area = 2 * math.pi * p * below[-1]
        x = p * np.interp(share * below[-1], below, t)
        s = np.sqrt(1 - (x / p) ** 2)
        normal = np.stack([x / p**2, s], 1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    angle = math.pi * (3 - math.sqrt(5)) * k
    around = lambda a, b: np.stack([a, b * np.cos(angle), b * np.sin(angle)], 1)
    return around(x, s), around(normal[:, 0], normal[:, 1]), area / n


def by_sites(shape, p, n):
    """The four resistances from n patches."""
    r, normal, patch = sites(shape, p, n)
    d = r[:, None] - r[None]
    distance = np.linalg.norm(d, axis=2)
    np.fill_diagonal(distance, 1.0)
    one = np.eye(3)
    g = patch * (one / distance[..., None, None] + d[..., :, None] * d[..., None, :] / distance[..., None, None] ** 3)
    rho = math.sqrt(patch / math.pi)
    here = np.arange(n)
    g[here, here] = math.pi * rho * (3 * one - normal[:, :, None] * normal[:, None, :])
    g = g.transpose(0, 2, 1, 3).reshape(3 * n, 3 * n) / (8 * math.pi)
    moved = np.zeros((3 * n, 4))
    moved[0::3, 0] = moved[1::3, 1] = 1.0
    moved[:, 2] = np.cross([1.0, 0.0, 0.0], r).ravel()
    moved[:, 3] = np.cross([0.0, 0.0, 1.0], r).ravel()
    traction = patch * np.linalg.solve(g, moved)
    unit = np.array([6, 6, 8, 8]) * math.pi
    return np.einsum("ij,ij->j", traction, moved) / unit


@functools.lru_cache(maxsize=None)
def extrapolated(shape, p, counts=(400, 800, 1600)):
    values = np.array([by_sites(shape, p, n) for n in counts])
    return np.polyfit([n**-0.5 for n in counts], values, 1)[-1]


# Where `rod` interpolates; the values are its table, made by this program (theory.py 1 1.5 2 ...).
TABLE = {
    1.0: (1.0, 1.0, 1.0, 1.0),
    1.5: (1.1682, 1.2571, 1.5374, 2.0963),
    2.0: (1.3154, 1.4852, 2.0554, 3.7798),
    2.5: (1.4508, 1.6964, 2.5665, 6.1490),
    3.0: (1.5784, 1.8962, 3.0737, 9.2916),
    4.0: (1.8168, 2.2715, 4.0825, 18.2224),
    5.0: (2.0392, 2.6245, 5.0896, 31.1921),
    7.0: (2.4528, 3.2857, 7.0996, 71.5434),
    10.0: (3.0234, 4.2052, 10.1070, 176.0871),
    14.0: (3.7254, 5.3483, 14.1203, 418.5426),
}


def rod(p):
    """The four resistances of a rod of aspect p, from the table, a cubic in ln p through the four nearest."""
    known = np.array(sorted(TABLE))
    near = known[np.argsort(np.abs(np.log(known / p)))[:4]]
    # Over those of a spheroid they are nearly straight.
    ratio = np.array([np.array(TABLE[q]) / perrin(q) for q in near])
    x = np.log(near / p)
    weights = [np.prod([x[j] / (x[j] - x[i]) for j in range(4) if j != i]) for i in range(4)]
    return perrin(p) * (np.array(weights) @ ratio)


def main():
    aspects = [float(a) for a in sys.argv[1:] if a != "--check"] or [2.0, 3.0, 5.0, 10.0]
    if min(aspects) < 1:
        sys.exit("theory.py: an aspect below 1 was asked for: rods and prolate spheroids have 1 or more")
    print("       p   F_par/6 pi eta R  F_perp  T_par/8 pi eta R^3  T_perp   D_par/D_perp")
    for p in aspects:
        rows = [("rod", extrapolated("rod", p)), ("spheroid", perrin(p))]
        if "--check" in sys.argv:
            rows.append(("spheroid by sites", extrapolated("spheroid", p)))
        for name, f in rows:
            print(f"{p:8g}  " + "  ".join(f"{v:9.4f}" for v in f) + f"  {f[1] / f[0]:8.4f}   {name}")


if __name__ == "__main__":
    main()
