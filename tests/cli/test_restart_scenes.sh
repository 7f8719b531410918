#!/usr/bin/env bash
# Threads, solvers, integrators, molecules, bodies and shear: a run cut in two, on other threads, ends with the same bits.
source "$(dirname "$0")/lib.sh" "$@"
source "$source_root/tests/cli/restart.sh"

# --- threads: enough particles that they share the work ---
# Waiting threads must not spin on a machine with other work.
export OMP_WAIT_POLICY=passive
write_periodic many
sed -i -e 's/^size = .*/size = [12.0, 12.0]/' -e 's/^duration = .*/duration = 0.1/' many/case.toml
cat >>many/case.toml <<'CASE'

[output]
checkpoint_every = 10
trajectory_every = 7
vtk_every = 100
pictures = false

CASE
expect_exit 0 run many --threads 1 --out one
expect_exit 0 run many --threads 2 --out two
same_run one two files
expect_exit 0 run many --threads 1 --set seed=8 --out differs
expect_exit 1 "$python" "$source_root/tests/cli/same_run.py" one differs
for threads in '1 2' '2 1'; do
  read -r before after <<<"$threads"
  expect_exit 0 run many --threads "$before" --set run.duration=0.05 --out "threads$before$after"
  expect_exit 0 run many --threads "$after" --restart "threads$before$after/checkpoint.h5"
  same_run one "threads$before$after"
done
for solver in eigen-cg picard; do
  expect_exit 0 run many --threads 1 --set run.duration=0.02 --set solver.name=$solver --out "$solver-1"
  expect_exit 0 run many --threads 2 --set run.duration=0.02 --set solver.name=$solver --out "$solver-2"
  same_run "$solver-1" "$solver-2" files
done

# --- the grid operator that pcg keeps from step to step survives a restart and a change of threads ---
grid=(--set solver.preconditioner=multilevel --set run.duration=0.2)
expect_exit 0 run many --threads 1 "${grid[@]}" --out grid
expect_exit 0 run many --threads 2 "${grid[@]}" --set run.duration=0.05 --out grid-parts
expect_exit 0 run many --threads 1 "${grid[@]}" --restart grid-parts/checkpoint.h5
same_run grid grid-parts
if "$odpd" info | grep -q 'kernels portable'; then
  skip 'this processor has one instruction path only'
else
  expect_exit 0 env ODPD_ISA=portable "$odpd" run many --threads 1 "${grid[@]}" --restart grid-parts/checkpoint.h5 --set run.duration=0.21
  expect_text "$err_text" 'instruction path'
fi

# --- every integrator: its arrays survive a restart and a change of threads ---
for scheme in midpoint extrapolated implicit euler monte-carlo mass:trapezoidal mass:extrapolated mass:setd mass:velocity-verlet \
  mass:shardlow; do
  settings=(--set "integrator.name=${scheme#mass:}" --set fluid.zeta_0=0.1)
  [[ $scheme == mass:* ]] && settings+=(--set fluid.mass=0.2)
  [[ $scheme == mass:setd ]] && settings+=(--set integrator.order=2)
  name=${scheme/:/_}
  expect_exit 0 run many --threads 1 "${settings[@]}" --out "$name"
  expect_exit 0 run many --threads 2 "${settings[@]}" --set run.duration=0.05 --out "$name-parts"
  expect_exit 0 run many --threads 1 "${settings[@]}" --restart "$name-parts/checkpoint.h5"
  same_run "$name" "$name-parts"
done

# --- particles that spin: angular velocities, those at the end of a step and those that a scheme keeps ---
for scheme in trapezoidal extrapolated mass:trapezoidal mass:extrapolated mass:velocity-verlet mass:shardlow; do
  settings=(--set "integrator.name=${scheme#mass:}" --set fluid.gamma_perp=2.0 --set fluid.lever_radius=0.4)
  [[ $scheme == mass:* ]] && settings+=(--set fluid.mass=0.2)
  name=spins_${scheme/:/_}
  expect_exit 0 run many --threads 1 "${settings[@]}" --out "$name"
  expect_exit 0 run many --threads 2 "${settings[@]}" --set run.duration=0.05 --out "$name-parts"
  expect_exit 0 run many --threads 1 "${settings[@]}" --restart "$name-parts/checkpoint.h5"
  same_run "$name" "$name-parts"
done

# --- molecules: their bonds follow the identities, through a reordering, a restart and a change of threads ---
cp -r many bonded
cat >>bonded/case.toml <<'CASE'

[[species]]
name = "fluid"

[[species]]
name = "bead"
count = 0

[[molecule]]
shape = "walk"
beads = 6
spacing = 0.5
species = "bead"
law = "fene"
H = 30.0
r_max = 1.5
count = 3

[[molecule]]
name = "colloid"
shape = "simplex"
spacing = 0.25
species = "bead"
H = 1000.0
exclude = "repulsion"
count = 5

[[molecule]]
name = "tied"
shape = "simplex"
spacing = 0.25
species = "bead"
bonds = "sites"
H = 1000.0
count = 2

[[observe]]
kind = "molecules"
window = 0.02
every = 1
series = true
CASE
for scheme in trapezoidal implicit monte-carlo; do
  settings=(--set "integrator.name=$scheme" --set neighbours.reorder_every=4)
  expect_exit 0 run bonded --threads 1 "${settings[@]}" --out "bonded-$scheme"
  expect_exit 0 run bonded --threads 2 "${settings[@]}" --set run.duration=0.05 --out "bonded-$scheme-parts"
  expect_exit 0 run bonded --threads 1 "${settings[@]}" --restart "bonded-$scheme-parts/checkpoint.h5"
  same_run "bonded-$scheme" "bonded-$scheme-parts"
done
# What fluctuates at rest, with solves of its own, of molecules and bodies.
cp -r bonded controlled
cat >>controlled/case.toml <<'CASE'

[[body]]
shape = "ring"
radius = 0.3
points_on_ring = 4
count = 3

[[observe]]
kind = "modes"
numbers = [1, 3]
window = 0.04
control = true
control_every = 2
series = true

[[observe]]
kind = "viscosity"
window = 0.04
control = true
CASE
settings=(--set neighbours.reorder_every=4 --set solver.preconditioner=multilevel)
expect_exit 0 run controlled --threads 1 "${settings[@]}" --out controlled-whole
expect_exit 0 run controlled --threads 2 "${settings[@]}" --set run.duration=0.05 --out controlled-parts
expect_exit 0 run controlled --threads 1 "${settings[@]}" --restart controlled-parts/checkpoint.h5
same_run controlled-whole controlled-parts
if have_h5py; then
  expect "$python" -c "
import h5py
f = h5py.File('bonded-trapezoidal/trajectory.0000.h5')
b = f['connectivity/bonds']
assert b.shape == (36, 2) and f[b.attrs['particles_group']].name == '/particles/all', b"
fi
# A trajectory starts the same molecules.
last=$(find bonded-trapezoidal -name 'trajectory.*.h5' | sort | tail -n 1)
expect_exit 0 run bonded --set start.from=file --set "start.file=\"../$last\"" --set run.duration=0.02 --out bonded-again

# --- bodies: poses and what they carry are state; free, turned by hand and fixed ones ---
cp -r many bodies
cat >>bodies/case.toml <<'CASE'

[[body]]
shape = "ring"
radius = 0.3
points_on_ring = 4
torque = 1.0
count = 3

[[body]]
name = "rotor"
shape = "square"
side = 0.3
motion = "given"
velocity = [1.0, 0.0]
angular_velocity = 20.0
positions = [{ at = [2.5, 3.0] }]

[[observe]]
kind = "bodies"
window = 0.02
every = 1
series = true
CASE
for scheme in trapezoidal extrapolated implicit mass:trapezoidal monte-carlo; do
  settings=(--set "integrator.name=${scheme#mass:}" --set neighbours.reorder_every=4)
  [[ $scheme == mass:* ]] && settings+=(--set fluid.mass=0.2)
  [[ $scheme == monte-carlo ]] && settings+=(--set 'body.1.motion="fixed"' --set body.0.torque=0.0)
  name=bodies-${scheme/:/_}
  [[ $scheme == monte-carlo ]] && sed '/^velocity = \[1/d; /^angular_velocity/d' -i bodies/case.toml
  expect_exit 0 run bodies --threads 1 "${settings[@]}" --out "$name"
  expect_exit 0 run bodies --threads 2 "${settings[@]}" --set run.duration=0.05 --out "$name-parts"
  expect_exit 0 run bodies --threads 1 "${settings[@]}" --restart "$name-parts/checkpoint.h5"
  same_run "$name" "$name-parts"
done
# --- sheared: the images slide by the time alone, so a run continues amidst it; without a rate it is the periodic box ---
for scheme in trapezoidal midpoint extrapolated implicit euler mass:trapezoidal mass:extrapolated mass:setd \
  mass:velocity-verlet mass:shardlow; do
  settings=(--set "integrator.name=${scheme#mass:}" --set shear.rate=30.0 --set solver.preconditioner=multilevel)
  [[ $scheme == mass:* ]] && settings+=(--set fluid.mass=0.2)
  [[ $scheme == trapezoidal ]] && settings+=(--set shear.frequency=40.0)
  [[ $scheme == mass:setd ]] && settings+=(--set integrator.order=2)
  name=sheared-${scheme/:/_}
  expect_exit 0 run many --threads 1 "${settings[@]}" --out "$name"
  expect_exit 0 run many --threads 2 "${settings[@]}" --set run.duration=0.055 --out "$name-parts"
  expect_exit 0 run many --threads 1 "${settings[@]}" --restart "$name-parts/checkpoint.h5"
  same_run "$name" "$name-parts"
done
sheared=(--set shear.rate=30.0 --set neighbours.reorder_every=4)
expect_exit 0 run bodies --threads 1 "${sheared[@]}" --out sheared-bodies
expect_exit 0 run bodies --threads 2 "${sheared[@]}" --set run.duration=0.05 --out sheared-bodies-parts
expect_exit 0 run bodies --threads 1 "${sheared[@]}" --restart sheared-bodies-parts/checkpoint.h5
same_run sheared-bodies sheared-bodies-parts
# A frame has their poses.
frames=$(find sheared-bodies -name 'trajectory.*.h5' | sort | tail -n 1)
placed() { run bodies --threads 1 --set shear.rate=30.0 --set start.from=file --set "start.file=\"../$frames\"" "$@"; }
expect_exit 0 placed --out placed
expect_error 1 placed --set body.0.count=2 --out other_bodies -- "$frames" '4 bodies, the case 3' '[[body]]'
expect_error 1 placed --set body.0.radius=0.4 --out other_shape -- "$frames" 'another shape'
expect_error 1 placed --set 'body=[]' --out no_bodies -- "$frames" '[[body]]'
# Random places are not sought for bodies that have theirs in the file.
expect_exit 0 placed --set body.0.clearance=100.0 --out tight
if have_h5py; then
  expect "$python" -c "
import glob, h5py, numpy as np
first, last = (h5py.File(f)['particles/all/position/value'] for f in (sorted(glob.glob('placed/trajectory.*.h5'))[0], '$frames'))
assert np.abs(first[0] - last[-1]).max() < 1e-12
"
fi
still=(--set output.checkpoint_every=5)
expect_exit 0 run many --threads 1 "${still[@]}" --out unsheared
expect_exit 0 run many --threads 1 "${still[@]}" --set shear.rate=0.0 --out still
if have_h5py; then
  expect "$python" -c "
import glob, h5py, numpy as np
def last(run):
    with h5py.File(sorted(glob.glob(run + '/trajectory.*.h5'))[-1]) as f:
        p = f['particles/all']
        return [p[name + '/value'][()] for name in ('position', 'velocity', 'image')], p['box/edges/value'][-1], p['position/time'][-1]
(a, _, _), (b, edges, _) = last('unsheared'), last('still')
assert all(x.tobytes() == y.tobytes() for x, y in zip(a, b))
assert (edges == np.diag([12.0, 12.0])).all(), edges
_, edges, time = last('sheared-midpoint')
assert abs(edges[1, 0] - np.remainder(30.0 * 12.0 * time + 6.0, 12.0) + 6.0) < 1e-9, edges
assert edges[0, 1] == 0.0 and time > 0.0
"
fi
# Its last frame starts a run with the images where they were, and no other.
frames=$(find sheared-midpoint -name 'trajectory.*.h5' | sort | tail -n 1)
cp -r many again
sed -i '/^density/d' again/case.toml
again() { run again --threads 1 --set start.from=file --set "start.file=\"../$1\"" "${@:2}"; }
expect_exit 0 again "$frames" --set shear.rate=30.0 --set run.duration=0.05 --out again_part
expect_exit 0 again "$frames" --set shear.rate=30.0 --out again_whole
expect_exit 0 again "$frames" --set shear.rate=30.0 --restart again_part/checkpoint.h5
same_run again_whole again_part
expect_error 1 again "$frames" --out unsheared_again -- "$frames" tilted '[shear]'
still=$(find still -name 'trajectory.*.h5' | sort | tail -n 1)
# A restart has its own images, whatever file is named.
expect_exit 0 again "$still" --set shear.rate=30.0 --restart again_part/checkpoint.h5
same_run again_whole again_part
finish
