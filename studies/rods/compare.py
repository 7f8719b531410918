#!/usr/bin/python3
"""Mobilities of the study's bodies against theory, with one radius fitted.

Usage: compare.py STUDY_OUT FLUID FLUID      two runs of fluid.toml, at two densities
Writes STUDY_OUT/rods.csv (bodies) and STUDY_OUT/theory.csv (curves), and prints a table for the README.

mu, what the observer gives in a cubic box of edge L, becomes that of one body in an endless fluid of the same density:

    translation   mu (N/(n V))^2 + 2.837297/(6 pi eta L) - c_i/(eta V)      c_i = (4 sum_k M_k - 2 M_i)/15
    rotation      mu + c/(eta V)                                            c = 1/6 about the axis, 1/6 + b^2/10 across

Its first factor: the observer spreads the force that balances the load over all N particles, of which a filled body has more than its
volume of fluid would. n, the density of the fluid beside the body, is the one at which the fluid alone has the pressure of the run; its
viscosity eta is taken there. Then Hasimoto's images (1959), with the next order in 1/L, the mean over orientations: M are the second
moments of the traction over the surface, a_i^2/3 of an ellipsoid, and b = (p^2 - 1)/(p^2 + 1) is what the images' strain adds to their
vorticity (Jeffery). Terms that are cubic in orientation vanish along [1.618, 1, 0], the corner of an icosahedron; the next are of order L^-6.

The body's surface is `delta` outside of its outermost particles: R + delta, length + 2 delta, R = 0 for a line. `delta` is fitted to the four
mobilities of each body, all with the same weight; that of the sphere is then used for all.
"""
import csv
import json
import math
import pathlib
import sys
import tomllib

import numpy as np

import theory

NAMES = ("D along", "D across", "D_r about", "D_r across")


def observed(run):
    summary = json.loads((run / "summary.json").read_text())
    return summary, {name: o["mean"] for name, o in summary["observables"].items()}


class Fluid:
    """Pressure and viscosity between two runs, as powers of the density."""

    def __init__(self, runs):
        self.n, self.pressure, self.eta = [], [], []
        for run in runs:
            summary, values = observed(run)
            self.n.append(summary["fluid"]["state"]["density"])
            self.pressure.append(values["pressure"])
            self.eta.append(values["high-frequency-viscosity.eta"])
        if self.n[0] == self.n[1]:
            sys.exit("compare.py: the two runs of the fluid have the same density: make them at two")

    def at_pressure(self, pressure):
        """Density and viscosity."""
        power = lambda y: math.log(y[1] / y[0]) / math.log(self.n[1] / self.n[0])
        n = self.n[0] * (pressure / self.pressure[0]) ** (1 / power(self.pressure))
        return n, self.eta[0] * (n / self.n[0]) ** power(self.eta)


class Body:
    """One run: sizes of the body, and its mobilities in an endless fluid of viscosity 1."""

    def __init__(self, run, fluid):
        case = tomllib.loads((run / "case.toml").read_text())
        summary, values = observed(run)
        keys = case["body"][0]
        self.shape = keys["shape"]
        self.R = keys.get("radius", 0.0)  # 0: a line of particles, which has no rotation about itself
        self.half_length = {"rod": keys.get("length", 0) / 2, "ellipsoid": self.R * keys.get("aspect", 1)}.get(self.shape, self.R)
        self.L = case["box"]["size"][0]
        n, self.eta = fluid.at_pressure(values["pressure"])
        mu = lambda kind, c: self.eta * (values[f"mobility.body.{kind}.{c}"] or math.nan)
        # Where the body's volume is given, the observer spreads the force by volume itself.
        self.frame = 1.0 if "excluded_volume" in keys else (summary["particles"] / (n * self.L**3)) ** 2
        across = lambda kind: 0.5 * (mu(kind, "y") + mu(kind, "z"))
        self.mu = np.array([mu("translation", "x"), across("translation"), mu("rotation", "x"), across("rotation")])

    def aspect(self, delta):
        return (self.half_length + delta) / (self.R + delta)

    def alone(self, delta):
        """The four mobilities times eta without images."""
        a, b, p = self.half_length + delta, self.R + delta, self.aspect(delta)
        moment = np.array([a**2 / 3, b**2 / 3, b**2 / 3])
        c = (4 * moment.sum() - 2 * moment[:2]) / 15
        turned = np.array([1 / 6, 1 / 6 + ((p * p - 1) / (p * p + 1)) ** 2 / 10])
        V = self.L**3
        translation = self.mu[:2] * self.frame + 2.837297 / (6 * math.pi * self.L) - c / V
        return np.concatenate([translation, self.mu[2:] + turned / V])

    def by_theory(self, delta):
        b, p = self.R + delta, self.aspect(delta)
        resistance = theory.rod(p) if self.shape == "rod" else theory.perrin(p)
        return 1 / resistance / (math.pi * np.array([6 * b, 6 * b, 8 * b**3, 8 * b**3]))

    def over_theory(self, delta):
        return self.alone(delta) / self.by_theory(delta)

    def fitted(self):
        deltas = np.arange(max(-0.2, 0.2 - self.R), 0.8, 0.001)
        return min(deltas, key=lambda d: np.nansum(np.log(self.over_theory(d)) ** 2))


def with_error(values):
    """Mean and standard error over seeds."""
    values = np.array(values)
    few = len(values) < 2
    return values.mean(0), np.full_like(values.mean(0), np.nan) if few else values.std(0, ddof=1) / math.sqrt(len(values))


def printed(mean, error):
    if math.isnan(mean):
        return "-"
    return f"{mean:.3f}" if math.isnan(error) else f"{mean:.3f}({max(round(1000 * error), 1):.0f})"


def print_table(columns, rows):
    for row in (columns, ["---"] * len(columns), *rows):
        print("| " + " | ".join(row) + " |")


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    out, fluid = pathlib.Path(sys.argv[1]), Fluid([pathlib.Path(p) for p in sys.argv[2:]])
    bodies = {}
    for row in csv.DictReader((out / "runs.csv").open()):
        if row["observable"] == "pressure" and row["status"] == "done":
            label = row["point"].removeprefix("body=")
            bodies.setdefault(label, []).append(Body(out / "points" / row["directory"] / "run", fluid))
    if "sphere" not in bodies:
        sys.exit(f"compare.py: {out}/runs.csv has no run of the sphere, whose delta all bodies are given")
    of_sphere, error = with_error([b.fitted() for b in bodies["sphere"]])
    one_each, of_all = [], []
    with (out / "rods.csv").open("w") as file:
        rows = csv.writer(file)
        rows.writerow(["body", "shape", "p", "F_par", "F_par_error", "F_perp", "F_perp_error", "T_perp", "T_perp_error", "ratio", "ratio_error"])
        for label, runs in bodies.items():
            one = runs[0]
            delta = with_error([b.fitted() for b in runs])
            ratio = with_error([(lambda m: m[0] / m[1])(b.alone(delta[0])) for b in runs])
            t = one.by_theory(delta[0])
            over = [[printed(m, e) for m, e in zip(*with_error([b.over_theory(d) for b in runs]))] for d in (delta[0], of_sphere)]
            one_each.append([label, printed(*delta), f"{one.aspect(delta[0]):.2f}", *over[0], printed(*ratio), f"{t[0] / t[1]:.3f}"])
            # Resistances over those of a ball as wide.
            b = one.R + of_sphere
            unit = math.pi * np.array([6 * b, 6 * b, 8 * b**3, 8 * b**3])
            resistances = with_error([1 / (x.alone(of_sphere) * unit) for x in runs])
            of_all.append([label, f"{one.aspect(of_sphere):.2f}", *[printed(m, e) for m, e in zip(*resistances)], *over[1]])
            values = [v for k in (0, 1, 3) for v in (resistances[0][k], resistances[1][k])]
            rows.writerow([label, one.shape, one.aspect(of_sphere), *values, *ratio])
    print("Over theory, each body with a delta of its own:\n")
    print_table(["body", "delta", "p", *NAMES, "D along/D across", "theory"], one_each)
    print(f"\nResistances over 6 pi eta (R + delta) and 8 pi eta (R + delta)^3, and mobilities over theory, all with delta = {printed(of_sphere, error)}:\n")
    print_table(["body", "p", "F along", "F across", "T about", "T across", *NAMES], of_all)
    with (out / "theory.csv").open("w") as file:
        rows = csv.writer(file)
        rows.writerow(["p"] + [f"{shape}_{k}" for shape in ("rod", "spheroid") for k in ("F_par", "F_perp", "T_perp")])
        for p in np.geomspace(1, 12, 97):
            rows.writerow([p] + [f[k] for f in (theory.rod(p), theory.perrin(p)) for k in (0, 1, 3)])


if __name__ == "__main__":
    main()
