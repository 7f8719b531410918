#!/usr/bin/env bash
# Bodies in each other or in a wall: refused by name, with the key, before anything is written.
source "$(dirname "$0")/lib.sh" "$@"

write_walled channel
sed -i 's/velocity.*//' channel/case.toml
# disks AT...: the channel (surfaces at y = 1 and 4) with disks there.
disks() {
  mkdir -p bodies
  {
    cat channel/case.toml
    printf '[[body]]\nname = "disk"\nshape = "disk"\nradius = 0.5\npositions = [%s]\n' "$*"
  } >bodies/case.toml
  line=bodies/case.toml:$(grep -n '^positions' bodies/case.toml | cut -d: -f1)
}
run() { "$odpd" run bodies "$@"; }

disks '{ at = [2.0, 2.5] }, { at = [2.0, 2.5] }'
expect_error 1 run -- "$line" body.0.positions "body 1 of [[body]] 'disk' at (2, 2.5)" \
  "body 2 of [[body]] 'disk' at (2, 2.5)" 'lie in each other' 'further apart'
expect_error 1 run --set body.0.motion=fixed -- "$line" 'lie in each other'
disks '{ at = [2.0, 2.5] }, { at = [2.3, 2.5] }'
expect_error 1 run -- "$line" 'at (2.3, 2.5)' 'lie in each other'
disks '{ at = [1.0, 0.5] }'
expect_error 1 run -- "$line" "body 1 of [[body]] 'disk' at (1, 0.5)" 'in the wall at y-' '1 behind its surface' 'y = 1.5 or more'
disks '{ at = [1.0, 3.9] }'
expect_error 1 run -- "$line" 'in the wall at y+' '0.4 behind its surface' 'y = 3.5 or less'
expect test ! -e runs
# Touching bodies and walls, and a bump on a wall, are in order.
disks '{ at = [1.0, 2.5] }, { at = [2.0, 2.5] }'
expect_exit 0 run --set run.duration=0.02 --out touching
disks '{ at = [1.0, 1.5] }'
expect_exit 0 run --set run.duration=0.02 --out at_wall
disks '{ at = [1.0, 1.0] }'
expect_exit 0 run --set run.duration=0.02 --set body.0.motion=fixed --out bump

# --- random places ---
# crowd COUNT: so many disks of radius 0.5, each with a clearance of 0.2, in a periodic box of 20 x 20; a fluid beside them.
crowd() {
  mkdir -p crowd
  cat >crowd/case.toml <<CASE
dimension = 2
[box]
size = [20.0, 20.0]
periodic = [true, true]
[fluid]
count = 800
a = 18.75
gamma = 4.5
kT = 1.0
[[body]]
name = "disk"
shape = "disk"
radius = 0.5
count = $1
clearance = 0.2
[integrator]
name = "trapezoidal"
dt = 0.01
[run]
duration = 0.02
CASE
}
# .6 of the area, more than one after the other finds: the same places each time.
crowd 212
expect_exit 0 "$odpd" run crowd --threads 1 --out crowd-1
expect_exit 0 "$odpd" run crowd --threads 2 --out crowd-2
have_python && expect "$python" "$source_root/tests/cli/same_run.py" crowd-1 crowd-2
# .95 and more than all there is.
crowd 336
expect_error 1 "$odpd" run crowd -- "[[body]] 'disk'" 'all 336 bodies' '0.95 of the area' 'and 0.8' 'was reached' 'about 2' 'lower count, fraction or clearance'
crowd 1000
expect_error 1 "$odpd" run crowd -- "[[body]] 'disk'" '2.83 of the area, more than there is' 'larger box'

# --- the poses of a start file ---
disks '{ at = [1.0, 2.5] }, { at = [2.5, 2.5] }'
expect_exit 0 run --set run.duration=0.02 --out before
own=$PWD/$(find before -name 'trajectory.*.h5' | sort | tail -n 1)
start=(--set start.from=file --set run.duration=0.02)
expect_exit 0 run "${start[@]}" --set "start.file=\"$own\"" --out after
if have_h5py; then
  # move SHIFT: of the second body onto the first, moved by SHIFT along y.
  move() {
    cp "$own" moved.h5
    "$python" - "$1" "$2" <<'SCRIPT'
import sys
import h5py, numpy as np
with h5py.File('moved.h5', 'r+') as f:
    all = f['particles/all']
    group = all['group'][...]
    frame = all['position/value'][-1]
    first, second = group == -1, group == -2
    assert first.sum() == second.sum() == 19
    if sys.argv[1] == 'onto':
        frame[second] = frame[first]
    else:
        frame[second, 1] += float(sys.argv[2]) - frame[second, 1].mean()
    all['position/value'][-1] = frame
SCRIPT
  }
  moved=(--set "start.file=\"$PWD/moved.h5\"")
  move onto 0
  expect_error 1 run "${start[@]}" "${moved[@]}" -- moved.h5 "body 1 of [[body]] 'disk'" "body 2 of [[body]] 'disk'" 'at one place'
  move to 0.4
  expect_error 1 run "${start[@]}" "${moved[@]}" -- moved.h5 "body 2 of [[body]] 'disk'" 'in the wall at y-'
  move to 1.4
  expect_exit 0 run "${start[@]}" "${moved[@]}" --out pressed
else
  skip 'poses of start files: there is no h5py'
fi
finish
