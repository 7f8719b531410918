#!/usr/bin/env bash
# Runs that blow up: when, why and what to do is told, the last sound state is left, and it can be continued from. Sound
# runs never trip. And runs that end at a standard error.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
write_walled channel
run() { "$odpd" run "$@" --threads 1 --set output.pictures=false; }
# value FILE KEY...: of a summary.
value() { "$python" -c 'import json, sys; v = json.load(open(sys.argv[1]))
for key in sys.argv[2:]: v = v[key]
print(v)' "$@"; }

# blown DIRECTORY TEXT...: after expect_error 2: what the run left.
blown() {
  local directory=$1
  expect test -s "$directory/checkpoint.h5" -a -s "$directory/last_good.h5" -a -s "$directory/trajectory.0000.h5"
  have_python || return
  expect test "$(value "$directory/summary.json" finished)" = False
  expect test "$(value "$directory/summary.json" interrupted)" = False
  expect test -n "$(value "$directory/summary.json" blew_up step)"
  expect test -n "$(value "$directory/summary.json" blew_up time)"
  expect test -n "$(value "$directory/summary.json" blew_up reason)"
}

# --- repulsion far too strong for the step: gamma/a = 0.0045 ---
stiff=(--set fluid.a=1000 --set integrator.dt=0.02 --set run.duration=2)
for name in euler trapezoidal extrapolated; do
  expect_error 2 run box "${stiff[@]}" --set integrator.name=$name --out $name -- 'step ' 'blown up' 'particle ' \
    'Likely cause: integrator.dt = 0.02 is beyond 0.0009' 'Remedy: integrator.dt = 0.0009' last_good.h5 'odpd run'
  blown $name
done
# The command that the message gives runs.
go_on=$(sed -n "s|.*go on from it with: odpd \(run .*\)|\1|p" "$scratch/message")
expect test -n "$go_on"
eval "set -- $go_on"
expect_exit 0 "$odpd" "$@" --set run.duration=0.02 --set run.equilibrate=0.01
expect_text "$out_text" '64 free particles'
expect test -s extrapolated-smaller-step/summary.json

# --- without noise or at strong repulsion in a channel ---
expect_error 2 run box "${stiff[@]}" --set fluid.kT=0 --out cold -- 'blown up' 'beyond 0.0009'
blown cold
expect_error 2 run channel "${stiff[@]}" --out channel_stiff -- 'blown up' 'beyond 0.0009'
blown channel_stiff

# --- mass too small for an explicit scheme (Nguyen 2021, chapter 3's state, where m/friction is 1.2e-4) ---
light=(--set fluid.density=10 --set fluid.mass=0.01 --set fluid.cutoff=1.6 --set fluid.a=234.1 --set fluid.s_bar=13.92
  --set fluid.gamma=3.825 --set integrator.dt=2.5e-4 --set run.equilibrate=0 --set run.duration=0.05)
expect_error 2 run box "${light[@]}" --set integrator.name=velocity-verlet --out light -- 'blown up' \
  'm/(friction of a particle)' "'velocity-verlet'" 'Remedy: integrator.dt = 0.0001'
blown light
expect_exit 0 run box "${light[@]}" --set run.blow_up=3 --out implicit_friction

expect_error 1 run box --set run.blow_up=1 -- run.blow_up 'above 1'

# --- a solver that does not converge has not blown up, and can be continued with another one, from the step that failed ---
expect_exit 0 run box --set run.duration=0.2 --out whole
expect_exit 0 run box --out part
expect_error 2 run box --set run.duration=0.2 --restart part/checkpoint.h5 --set solver.max_iterations=2 -- \
  'step 40' solver.max_iterations
if have_python; then expect test "$(value part/summary.json failed step)" = 40; fi
expect_exit 0 run box --set run.duration=0.2 --restart part/checkpoint.h5
if have_python; then
  expect test "$(value whole/summary.json observables)" = "$(value part/summary.json observables)"
  expect test "$(value whole/summary.json solver)" = "$(value part/summary.json solver)"
fi

# --- sound runs pass, with a multiple far below the default ---
quick=(--set run.blow_up=3 --set output.trajectory_every=0 --set run.equilibrate=0)
expect_exit 0 run box "${quick[@]}" --set 'box.size=[2.0,2.0]' --set run.duration=20 --out small
expect_exit 0 run box "${quick[@]}" --set run.duration=50 --set integrator.dt=0.09 --out coarse
expect_exit 0 run box "${quick[@]}" --set run.duration=5 --set start.relax_sweeps=0 --set fluid.kT=0.01 --out unrelaxed
expect_exit 0 run box "${quick[@]}" --set run.duration=5 --set start.relax_sweeps=0 --set fluid.kT=0.01 \
  --set fluid.mass=1 --set integrator.name=velocity-verlet --out released
expect_exit 0 run box "${quick[@]}" --set run.duration=5 --set fluid.kT=0 --set fluid.mass=1 --out still
expect_exit 0 run channel "${quick[@]}" --set run.duration=5 --set fluid.kT=0.001 --out sheared
expect_exit 0 run channel "${quick[@]}" --set run.duration=5 --set fluid.kT=0.01 --set fluid.mass=0.1 \
  --set 'wall.1.velocity=[10.0,0.0]' --set integrator.dt=0.002 --out fast
expect_exit 0 run channel "${quick[@]}" --set run.duration=5 --set fluid.kT=0.01 --set 'body_force.force=[0.0,20.0]' --out heavy
# Friction alone between moving walls: no energy to judge, and a wall's potential is felt all the same.
expect_exit 0 run channel "${quick[@]}" --set run.duration=5 --set fluid.kT=0 --set fluid.a=0 --set fluid.zeta_0=0.1 \
  --set fluid.zeta_0_under_flow=true --out friction
# A long step is nothing to warn of where the repulsion is implicit.
expect_exit 0 run box "${quick[@]}" --set run.duration=5 --set integrator.dt=0.15 --set integrator.name=implicit --out long
expect test "$(grep -c 'limit of explicit repulsion' "$err_text")" -eq 0
expect_exit 0 run box "${quick[@]}" --set run.duration=1 --set integrator.dt=0.15 --set run.blow_up=1e6 --out warned
expect_text "$err_text" 'twice the limit of explicit repulsion'

# --- small systems that begin at random are sound, whether or not their first state looks ordered by chance ---
unrelaxed=(--set 'box.size=[5.0,4.0]' --set fluid.count=80 --set start.relax_sweeps=0 --set run.equilibrate=0
  --set output.trajectory_every=0)
sed '/^density/d' box/case.toml >unrelaxed.toml
for seed in 2 14 16 17; do
  expect_exit 0 run unrelaxed.toml "${unrelaxed[@]}" --set seed=$seed --set fluid.mass=1 --set integrator.dt=2e-4 \
    --set run.duration=0.2 --out start
  expect_exit 0 run unrelaxed.toml "${unrelaxed[@]}" --set seed=$seed --set integrator.dt=2e-5 --set run.duration=0.02 --out start
done

# --- the start file and what the case says of its contents ---
file=(--set start.from=file --set "start.file=\"$PWD/extrapolated/last_good.h5\"")
expect_exit 0 run box "${file[@]}" --out from_file
expect_error 1 run box "${file[@]}" --set fluid.density=1 -- last_good.h5 '64 fluid particles' fluid.density 16

# A body pulled or turned hard in cold fluid presses it without harm.
cold=(--set fluid.kT=0.01 --set 'box.size=[6.0,6.0]' --set integrator.dt=0.002 --set run.equilibrate=0
  --set run.duration=1.2 --set output.trajectory_every=0)
for load in 'force=[3000.0,0.0]' torque=3000.0; do
  expect_exit 0 run box "${cold[@]}" --set "body=[{shape=\"disk\",radius=0.6,count=1,$load}]" --out driven
done

# --- run.until ---
until=(--set 'run.until={observable="pressure",standard_error=0.05}' --set output.trajectory_every=0
  --set output.checkpoint_every=100)
expect_error 1 run box --set 'run.until={observable="presure",standard_error=0.05}' -- run.until.observable "'pressure'"
expect_error 1 run box --set 'run.until={observable="kinetic_temperature",standard_error=0.05}' -- run.until.observable pressure
expect_error 1 run box --set 'run.until={observable="pressure",standard_error=0}' -- run.until.standard_error
expect_error 1 run box --set 'run.until={observable="pressure"}' -- run.until.standard_error
expect_exit 0 run box "${until[@]}" --set run.duration=100 --out target
expect_text "$out_text" 'stopped early' pressure
expect_exit 0 run box "${until[@]}" --set run.duration=2 --out missed
expect_text "$out_text" 'was not reached'
# Continued with the same target it is done; with a smaller one it goes on as a run that had it from the start.
if have_python; then
  expect test "$(value target/summary.json finished)" = True -a "$(value target/summary.json stopped_at_target)" = True
  expect test "$(value missed/summary.json finished)" = True -a "$(value missed/summary.json stopped_at_target)" = False
  steps=$(value target/summary.json steps)
  expect test "$steps" -gt 400 -a "$steps" -lt 20000
  expect "$python" -c "assert $(value target/summary.json observables pressure stderr) <= 0.05"
  expect_exit 0 run box "${until[@]}" --set run.duration=100 --restart target/checkpoint.h5
  expect test "$(value target/summary.json steps)" = "$steps"
  expect_exit 0 run box "${until[@]}" --set run.duration=100 --restart missed/checkpoint.h5
  expect test "$(value missed/summary.json observables)" = "$(value target/summary.json observables)"
  expect_exit 0 run box "${until[@]}" --set run.until.standard_error=0.04 --set run.duration=100 --restart target/checkpoint.h5
  expect_exit 0 run box "${until[@]}" --set run.until.standard_error=0.04 --set run.duration=100 --out smaller
  expect test "$(value target/summary.json observables)" = "$(value smaller/summary.json observables)"
fi
finish
