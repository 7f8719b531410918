#!/usr/bin/env bash
# What observers say where there is little to measure, whose energy is divided by whom, and at which time a row stands.
source "$(dirname "$0")/lib.sh" "$@"

run() { "$odpd" run "$@" --set output.pictures=false; }
# mean FILE NAME: of an observable in a summary.json.
mean() { "$python" -c 'import json, sys; print(json.load(open(sys.argv[1]))["observables"][sys.argv[2]]["mean"])' "$@"; }

# --- a profile without a fit in a channel two cutoffs wide ---
write_walled thin
sed -i 's/^size.*/size = [4.0, 4.0]/; s/^density.*/count = 32/' thin/case.toml
printf '\n[[observe]]\nkind = "profile"\n' >>thin/case.toml
expect_exit 0 run thin --out thin_run
expect_text "$out_text" 'note: profile: the surfaces are at most two cutoffs apart'
expect test "$(grep -vc '^#' thin_run/profile.csv)" -eq 21
line=$(wc -l <thin/case.toml)
expect_error 1 run thin --set observe.0.fit=linear -- observe.0.fit 'give fit_from and fit_to'
sed 's/^kind = "profile"/&\nfit_from = 2.5/' thin/case.toml >thin/wrong.toml
expect_error 1 run thin/wrong.toml -- "thin/wrong.toml:$((line + 1))" observe.0.fit_from 'fit_to = 2 (the default)'
expect_exit 0 run thin --set observe.0.fit=linear --set observe.0.fit_from=1.2 --set observe.0.fit_to=2.8 --out thin_run

# --- an observer that samples nothing ---
write_periodic box
cat >>box/case.toml <<'CASE'

[output]
trajectory_every = 1

[[observe]]
kind = "thermo"
every = 1
series = true

[[observe]]
kind = "profile"
series = true

[[observe]]
kind = "msd"
every = 2
window = 0.05
series = true

[[observe]]
kind = "rdf"
every = 1000
CASE
expect_exit 0 run box --out box_run
expect_text "$out_text" 'note: rdf: nothing was sampled' 'every = 1000, and 30 step(s) were measured'
expect test "$(grep -c 'nothing was sampled' "$out_text")" -eq 1
expect_text box_run/summary.json 'rdf: nothing was sampled'
expect test ! -e box_run/rdf.csv
expect_exit 0 run box --set observe.3.every=30 --out sampled
expect test "$(grep -c 'nothing was sampled' "$out_text")" -eq 0
expect test -s sampled/rdf.csv

# --- species that nobody belongs to ---
write_periodic species
cat >>species/case.toml <<'CASE'

[[species]]
name = "a"
fraction = 1.0

[[species]]
name = "b"
count = 0

[[observe]]
kind = "rdf"
every = 1

[[observe]]
kind = "msd"
window = 0.05
CASE
expect_exit 0 run species --out species_run
expect_text "$out_text" 'note: rdf: g of a_b is undefined' 'note: rdf: g of b_b is undefined' \
  "note: msd: displacements and diffusion of 'b' are undefined" 'diffusion.b                        undefined'
expect test "$(grep -v '^#' species_run/rdf.csv | tail -n 1 | cut -d, -f4-)" = nan,nan,nan,nan
expect_exit 0 run thin --set 'observe=[{kind="rdf", every=1}]' --out walls
expect_text walls/rdf.csv '# walls: g counts on full shells'
expect test "$(grep -c walls species_run/rdf.csv)" -eq 0

if ! have_h5py; then
  skip 'energies and times of rows: there is no h5py'
  finish
fi
expect test "$(mean species_run/summary.json diffusion.b)" = None
expect test "$(mean species_run/summary.json diffusion)" = "$(mean species_run/summary.json diffusion.a)"
expect test "$(mean box_run/summary.json energy_per_particle)" != None

# --- the energy of bodies is that of all that move ---
cat >few.toml <<'CASE'
title = "rigid squares, almost no fluid"
dimension = 2
seed = 5
[box]
size = [8.0, 8.0]
periodic = [true, true]
[fluid]
count = 1
kT = 1.0
a = 18.5
gamma = 4.5
zeta_0 = 1.0
[[body]]
shape = "square"
side = 0.4
per_side = 2
count = 60
clearance = 0.05
[integrator]
dt = 0.002
[run]
duration = 0.1
[output]
trajectory_every = 1
[[observe]]
kind = "thermo"
every = 1
series = true
CASE
expect_exit 0 run few.toml --out few

# --- one pressure, between walls too; euler has one stage, so that both look at the same forces ---
expect_exit 0 run thin --set 'observe=[{kind="thermo", every=1}, {kind="stress"}]' --set integrator.name=euler --out pressure

cat >rows.py <<'PYTHON'
import csv, glob, json, sys
import h5py
import numpy as np

def frames(run):
    """time -> positions"""
    found = {}
    for file in sorted(glob.glob(f"{run}/trajectory.*.h5")):
        with h5py.File(file) as f:
            p = f["particles/all"]
            found.update(zip(p["position/time"][:], p["position/value"][:]))
    return found

def rows(file):
    return list(csv.DictReader(line for line in open(file) if not line.startswith("#")))

def energy(r, size, bodies=()):
    """Sum of a/2 (1 - r)^2 over pairs, without those inside a body."""
    d = r[:, None, :] - r[None, :, :]
    d -= size * np.round(d / size)
    u = 9.25 * np.maximum(1.0 - np.sqrt((d**2).sum(axis=-1)), 0.0) ** 2
    body = np.array(bodies) if len(bodies) else np.arange(len(r))
    return 0.5 * u[body[:, None] != body[None, :]].sum()

# A row of thermo stands at the time of the frame whose energy it tells, to the last bit of the time.
at = frames("box_run")
table = rows("box_run/thermo_series.csv")
assert len(table) == 30 and float(table[0]["time"]) == 10 * 0.005, table[0]
for row in table:
    assert abs(float(row["energy_per_particle"]) - energy(at[float(row["time"])], 4.0) / 64) < 1e-9, row["time"]
# A profile tells of the middle of a step, an msd of the end of its window.
times = [float(row["time"]) for row in rows("box_run/profile_series.csv")]
assert np.allclose(times, 0.005 * (10.5 + np.arange(30)), atol=1e-12), times
times = [float(row["time"]) for row in rows("box_run/msd_series.csv")]
assert np.allclose(times, [0.005 * (12 + 10), 0.005 * (12 + 20)], atol=1e-12), times

with h5py.File(sorted(glob.glob("few/trajectory.*.h5"))[0]) as f:
    group = f["particles/all/group"][:]
body = np.where(group == 0, 1, group)
at = frames("few")
for row in rows("few/thermo_series.csv"):
    expected = energy(at[float(row["time"])], 8.0, body) / len(body)
    assert 0.5 < expected < 10.0 and abs(float(row["energy_per_particle"]) - expected) < 1e-9, row["time"]

seen = json.load(open("pressure/summary.json"))["observables"]
one = seen["pressure"]["mean"]
other = seen["stress.pressure.kinetic"]["mean"] + seen["stress.pressure.conservative"]["mean"]
assert abs(one - other) < 1e-9 * one, (one, other)
PYTHON
expect "$python" rows.py
# Sweeps begin with the configuration that they tell of.
expect_exit 0 run box --set integrator.name=monte-carlo --set 'observe=[{kind="profile", series=true}]' --out sweeps
expect test "$(sed -n 2p sweeps/profile_series.csv | cut -d, -f1)" = 0.05
finish
