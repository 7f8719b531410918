#!/usr/bin/env bash
# A run that was killed, interrupted, lengthened or given other threads ends with the same bits as one that was not.
source "$(dirname "$0")/lib.sh" "$@"

have_python || { skip 'there is no Python to compare runs with'; finish; }
have_h5py || skip 'checkpoints and trajectories are not compared: there is no h5py'

cat >same_run.py <<'PYTHON'
# same_run.py A B [files]: are two runs the same? With "files" also the files they were cut into.
import filecmp, glob, json, os, sys

a, b = sys.argv[1:3]
with_files = "files" in sys.argv[3:]

def summary(run):
    values = json.load(open(f"{run}/summary.json"))
    for key in ("wall_seconds", "phase_seconds", "threads", "checks", "case"):
        del values[key]
    return values

assert summary(a) == summary(b), "summary.json"
names = sorted(os.path.basename(name) for name in glob.glob(f"{a}/*.csv"))
assert names == sorted(os.path.basename(name) for name in glob.glob(f"{b}/*.csv")), names
for name in names:
    if "anew" in sys.argv[3:] and name.endswith("_series.csv"):
        continue
    assert filecmp.cmp(f"{a}/{name}", f"{b}/{name}", shallow=False), name
try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(0)

def arrays(file):
    found = {}
    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
    with h5py.File(file) as f:
        f.visititems(visit)
    return found

def same(one, other, name):
    one, other = np.asarray(one), np.asarray(other)
    assert one.shape == other.shape and one.dtype == other.dtype, f"{name}: {one.shape} {other.shape}"
    assert one.tobytes() == other.tobytes(), name

def compare_checkpoints():
    one, other = arrays(f"{a}/checkpoint.h5"), arrays(f"{b}/checkpoint.h5")
    assert one.keys() == other.keys(), one.keys() ^ other.keys()
    for name in one:
        # Seconds differ; the case names the options of its own part.
        if name in ("components/run/phase_seconds", "components/run/wall_seconds", "components/run/case"):
            continue
        if not with_files and name.startswith("components/output/"):
            continue
        if one[name].dtype.kind == "O":
            assert one[name] == other[name], name
        else:
            same(one[name], other[name], name)
    assert any(name == "components/particles/position" for name in one)

def trajectory(run):
    frames = {}
    for file in sorted(glob.glob(f"{run}/trajectory.*.h5")):
        with h5py.File(file) as f:
            p = f["particles/all"]
            for k, step in enumerate(p["position/step"][:]):
                assert step not in frames, f"{run}: step {step} twice"
                frames[int(step)] = [p[f"{name}/value"][k] for name in ("position", "image", "velocity")]
    return frames

compare_checkpoints()
one, other = trajectory(a), trajectory(b)
if "anew" not in sys.argv[3:]:
    assert one.keys() == other.keys(), sorted(one.keys() ^ other.keys())
for step in one.keys() & other.keys():
    for k in range(3):
        same(one[step][k], other[step][k], f"trajectory at step {step}")
PYTHON
same_run() { expect "$python" same_run.py "$@"; }

write_walled channel
cat >>channel/case.toml <<'CASE'

[output]
checkpoint_every = 10
trajectory_every = 7
vtk_every = 100
pictures = false

[neighbours]
reorder_every = 15

[[observe]]
kind = "thermo"
every = 3
series = true

[[observe]]
kind = "msd"
window = 0.2
every = 1

[[observe]]
kind = "rdf"

[[observe]]
kind = "profile"
fit = "linear"
series = true

[[observe]]
kind = "density-residual"
CASE
sed -i 's/^duration = .*/duration = 1.45/' channel/case.toml # 300 steps
run() { "$odpd" run "$@"; }

expect_exit 0 run channel --out whole
expect_exit 0 run channel --out twin
same_run whole twin files

# signalled SIGNAL DELAY DIRECTORY: a run that gets the signal so many seconds after its first checkpoint; leaves its
# exit code in $code.
signalled() {
  "$odpd" run channel --out "$3" >"$out_text" 2>"$err_text" &
  local pid=$! tries=0
  until [ -e "$3/checkpoint.h5" ] || [ $((tries += 1)) -gt 3000 ]; do sleep 0.01; done
  sleep "$2"
  kill "-$1" "$pid" 2>/dev/null
  wait "$pid" 2>/dev/null
  code=$?
}

# --- killed ---
hits=0
for delay in 0.0 0.03 0.09 0.17; do
  signalled KILL "$delay" "killed$delay" 2>/dev/null
  # A fast machine may be through before.
  [ "$code" -eq 0 ] && continue
  expect test "$code" -eq 137 -a ! -e "killed$delay/summary.json"
  hits=$((hits + 1))
  expect_exit 0 run channel --restart "killed$delay/checkpoint.h5"
  same_run whole "killed$delay" files
  expect test -z "$(find "killed$delay" -name '.tmp-*')"
done
expect test "$hits" -ge 2

# Killed twice, continued from the resolved case.
signalled KILL 0.02 twice
"$odpd" run twice --restart twice/checkpoint.h5 >/dev/null 2>&1 &
pid=$!
sleep 0.1
kill -KILL $pid 2>/dev/null
wait $pid 2>/dev/null
expect_exit 0 run twice --restart twice/checkpoint.h5
same_run whole twice files

# --- interrupted ---
for name in INT TERM; do
  signalled $name 0.05 "stopped$name"
  [ "$code" -eq 0 ] && { skip "SIG$name: the run was through before"; continue; }
  expect test "$code" -eq 130
  expect_text "$out_text" interrupted
  expect_exit 0 "$python" -c "
import json
s = json.load(open('stopped$name/summary.json'))
assert s['interrupted'] and not s['finished'] and s['checks'] == [], s"
  for file in case.toml checkpoint.h5 thermo_series.csv; do
    expect test -s "stopped$name/$file"
  done
  expect_exit 0 run channel --restart "stopped$name/checkpoint.h5"
  same_run whole "stopped$name"
done

# --- lengthened, into the same and into a new directory ---
expect_exit 0 run channel --set run.duration=0.6 --out part
cp -r part part_copy
expect_exit 0 run channel --restart part/checkpoint.h5
same_run whole part
expect_exit 0 run channel --restart part_copy/checkpoint.h5 --out moved
same_run whole moved anew
expect diff -q part_copy/thermo_series.csv <(head -n "$(wc -l <part_copy/thermo_series.csv)" part/thermo_series.csv)
expect test "$(wc -l <moved/thermo_series.csv)" -lt "$(wc -l <part/thermo_series.csv)"
# A finished run has nothing left to do, and says the same again.
cp -r whole finished
expect_exit 0 run channel --restart finished/checkpoint.h5
same_run whole finished files
# Other solvers, output and checks may follow.
expect_exit 0 run channel --restart part_copy/checkpoint.h5 --out solved --set solver.name=cholmod \
  --set output.checkpoint_every=0 --set 'check=[{observable="pressure", expected=50.0, tolerance=100.0}]'

# --- refused, with nothing touched ---
expect_error 1 run channel --restart part_copy/checkpoint.h5 --set run.duration=0.5 -- run.duration
cp -r part_copy refused
write_periodic box
expect_error 1 run channel --restart refused/checkpoint.h5 --set fluid.a=10.0 -- fluid.a 18.5 10
expect_error 1 run channel --restart refused/checkpoint.h5 --set integrator.dt=0.01 -- integrator.dt
expect_error 1 run channel --restart refused/checkpoint.h5 --set seed=3 -- seed
expect_error 1 run channel --restart refused/checkpoint.h5 --set run.equilibrate=1.0 -- run.equilibrate
expect_error 1 run channel --restart refused/checkpoint.h5 --set wall.1.thickness=0.9 -- wall.1.thickness 0.9
expect_error 1 run box --restart refused/checkpoint.h5 -- 'another case'
expect_error 3 run channel --restart refused/trajectory.0000.h5 -- trajectory.0000.h5 checkpoint
expect_error 3 run channel --restart refused/missing.h5 -- missing.h5
expect_error 3 run channel --restart refused/case.toml -- case.toml HDF5
expect_error 3 run channel --restart refused -- refused
expect diff -r part_copy refused
size=$(stat -c %s refused/checkpoint.h5)
for part in 0 100 $((size / 2)) $((size - 1)); do
  head -c "$part" part_copy/checkpoint.h5 >refused/checkpoint.h5
  expect_error 3 run channel --restart refused/checkpoint.h5 -- checkpoint.h5
done
cp part_copy/checkpoint.h5 refused/checkpoint.h5
expect diff -r part_copy refused
head -n 3 part_copy/thermo_series.csv >refused/thermo_series.csv
expect_error 3 run channel --restart refused/checkpoint.h5 -- thermo_series.csv

# --- another start file: the particles of the checkpoint go on, and what is measured is theirs ---
write_periodic mixed
sed -i '/^density/d' mixed/case.toml
cat >>mixed/case.toml <<'CASE'

[[species]]
name = "a"
fraction = 0.75

[[species]]
name = "b"
fraction = 0.25

[start]
from = "file"
file = "few.csv"

[[observe]]
kind = "rdf"
every = 5

[[observe]]
kind = "msd"
window = 0.05
every = 1
CASE
# start_csv EVERY: 64 particles on a grid, one of so many of species b.
start_csv() {
  printf 'x,y,species\n'
  local k species
  for ((k = 0; k < 64; k++)); do
    species=a
    [ $((k % $1)) -eq 0 ] && species=b
    printf '%d.%d,%d.%d,%s\n' $((k / 16)) $((k / 8 % 2 * 5)) $((k % 8 / 2)) $((k % 2 * 5)) $species
  done
}
start_csv 4 >mixed/few.csv
start_csv 3 >mixed/many.csv
expect_exit 0 run mixed --out mixed_whole
expect_exit 0 run mixed --set run.duration=0.07 --out mixed_part
expect_exit 0 run mixed --set 'start.file="many.csv"' --restart mixed_part/checkpoint.h5
same_run mixed_whole mixed_part

# --- a walled trajectory starts a walled case, also with particles behind a soft wall's surface ---
expect_exit 0 run channel --set wall.0.stiffness=5.0 --set wall.1.stiffness=5.0 --set run.duration=0.6 --out soft
frames=$(find soft -name 'trajectory.*.h5' | sort | tail -n 1)
if have_h5py; then
  expect "$python" -c "
import h5py
p = h5py.File('$frames')['particles/all']
y = p['position/value'][-1][p['group'][()] == 0][:, 1]
assert len(y) == 48 and ((y < 1.0) | (y > 4.0)).any(), y"
fi
cp -r channel seeded
sed -i '/^density/d' seeded/case.toml
seeded() { run seeded --set start.from=file --set "start.file=\"../$frames\"" --set run.duration=0.05 "$@"; }
expect_exit 0 seeded --out seeded_run
expect_text "$out_text" '48 free particles'
expect_error 1 seeded --set 'box.size=[4.0, 5.5]' --out other_box -- "$frames" 'direction y' 5.5 box.size
expect test ! -e other_box

# --- threads: enough particles that they share the work ---
# Waiting threads must not spin on a machine with other work.
export OMP_WAIT_POLICY=passive
write_periodic many
sed -i -e 's/^size = .*/size = [12.0, 12.0]/' -e 's/^duration = .*/duration = 0.1/' many/case.toml
sed -n '/^\[output\]/,/^$/p' channel/case.toml >>many/case.toml
expect_exit 0 run many --threads 1 --out one
expect_exit 0 run many --threads 2 --out two
same_run one two files
expect_exit 0 run many --threads 1 --set seed=8 --out differs
expect_exit 1 "$python" same_run.py one differs
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
if have_h5py; then
  expect "$python" -c "
import h5py
f = h5py.File('bonded-trapezoidal/trajectory.0000.h5')
b = f['connectivity/bonds']
assert b.shape == (36, 2) and f[b.attrs['particles_group']].name == '/particles/all', b"
fi
# A trajectory starts the same molecules; bonds may also come from a file, from anywhere.
last=$(find bonded-trapezoidal -name 'trajectory.*.h5' | sort | tail -n 1)
expect_exit 0 run bonded --set start.from=file --set "start.file=\"../$last\"" --set run.duration=0.02 --out bonded-again
cp -r mixed joined
printf 'i,j,r_0\n0,1,0.5\n1,17,0.7\n' >joined/bonds.csv
printf '\n[bonds]\nfile = "bonds.csv"\nH = 50.0\n' >>joined/case.toml
expect_exit 0 run joined --out joined_whole
expect_exit 0 run joined --set run.duration=0.07 --out joined_part
expect_exit 0 run joined_part --restart joined_part/checkpoint.h5
expect_exit 0 run joined --restart joined_part/checkpoint.h5
same_run joined_whole joined_part
printf 'i,j,r_0\n0,1,0.5\n1,18,0.7\n' >joined/bonds.csv
expect_error 1 run joined --restart joined_part/checkpoint.h5 -- 'other bonds'

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
expect_error 1 again "$still" --set shear.rate=30.0 --restart again_part/checkpoint.h5 -- start.file offset
finish
