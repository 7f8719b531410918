#!/usr/bin/env bash
# A run that was killed, interrupted, lengthened or started from another one's frames ends with the same bits as one that was not.
source "$(dirname "$0")/lib.sh" "$@"
source "$source_root/tests/cli/restart.sh"

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
  # A fast machine may be through before, or have nothing left to do but to end.
  [ "$code" -eq 0 ] && continue
  grep -qs '"finished": true' "killed$delay/summary.json" && continue
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
finish
