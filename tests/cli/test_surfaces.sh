#!/usr/bin/env bash
# Many-body DPD with free surfaces: what is refused, what is warned of, and what only the run can tell.
source "$(dirname "$0")/lib.sh" "$@"

mkdir drop
cat >drop/case.toml <<'CASE'
dimension = 2
[box]
size = [8.0, 8.0]
periodic = [true, true]
[fluid]
model = "mdpd"
density = 4.142
mass = 0.05
A = -40.0
B = 25.0
r_d = 0.75
gamma = 4.5
kT = 1.0
[start]
region = { centre = [4.0, 4.0], radius = 2.0 }
[integrator]
dt = 0.005
[run]
duration = 0.05
[output]
pictures = false
[[observe]]
kind = "drop"
core = 0.8
CASE
run() { "$odpd" run drop "$@"; }

expect_exit 0 run --out drop_run
expect_text "$out_text" '52 free particles' drop.laplace
expect test "$(grep -c 'thermal speed' "$err_text")" -eq 0
expect_exit 0 run --set integrator.dt=0.01 --out long_step
expect_text "$err_text" 'integrator.dt = 0.01' 'moves by 0.0447 in a step' 'dt = 0.0067 or less' 'mass of 0.11 or more'
expect_exit 0 run --set integrator.dt=0.01 --set fluid.filled=true --out filled
expect test "$(grep -c 'thermal speed' "$err_text")" -eq 0
expect_exit 0 run --set integrator.name=monte-carlo --set integrator.dt=0.01 --out sampled
expect test "$(grep -c 'thermal speed' "$err_text")" -eq 0
expect_error 1 run --set fluid.mass=0.0 -- fluid.mass 'filled = true'

# A massless drop that is said to fill the box: what it has lost resists nothing.
{ echo x,y; for x in 3.5 4.0 4.5; do for y in 3.5 4.0 4.5; do echo "$x,$y"; done; done; echo 7.5,7.5; } >drop/start.csv
sed '/^density/d' drop/case.toml >drop/lost.toml
expect_error 2 "$odpd" run drop/lost.toml --set fluid.mass=0.0 --set fluid.filled=true --set start.from=file \
  --set start.file=start.csv -- 'particle 9 is a rattler' 'its 0 neighbour(s)' fluid.rattler_friction

# --- regions ---
region() { expect_error 1 run --set "start.region=$1" -- "${@:2}"; }
region '{ centre = [4.0, 4.0], radius = 5.0 }' start.region.radius 'from -1 to 9 along x'
region '{ centre = [4.0, 4.0], radius = 2.0, form = 1 }' start.region.form
region '{ from = [0.0, 0.0], to = [2.0, 2.0, 2.0] }' start.region.to 'components'
region '{ from = [0.0, 3.0], to = [8.0, 2.0] }' start.region.to 'along y'
region '{ radius = 2.0 }' start.region.centre
finish
