#!/usr/bin/env bash
# One cluster of touching particles that floats free in a periodic box: every solver runs it without its rotation. What has no
# answer is refused by name, and each cure that a message names is one.
source "$(dirname "$0")/lib.sh" "$@"

mkdir drop
cat >drop/case.toml <<'CASE'
title = "one droplet of touching particles"
dimension = 2
seed = 4
[box]
size = [20.0, 20.0]
periodic = [true, true]
[fluid]
kT = 1.0
a = 0.0
gamma = 4.5
[start]
from = "file"
file = "cluster.csv"
[integrator]
dt = 0.0001
[run]
duration = 0.001
[output]
pictures = false
trajectory_every = 1
CASE
cat >drop/cluster.csv <<'CSV'
x,y
5.1643540247857453,4.7237440565166446
4.4491682287234333,4.4198331626342346
5.375924287040327,5.4953066927332657
5.1279629309206154,5.2753958731807984
5.0523499897585076,5.5220869085453215
5.3790242649458389,4.4032862002041782
5.4288851319050835,4.4403026903665577
5.2755865357159326,4.6107867447230708
5.4358147068198637,5.0497534642989104
4.7596542686448622,4.90722466543719
4.4339836053745554,4.549139931799477
5.2047492976323566,5.1766274138890997
5.1384621337775043,4.8604130651142601
5.5966519229470535,5.5770024065314763
5.2226503813768339,5.1805511315213799
5.2261360766851279,4.8667057087749246
4.5621158060268936,5.2657860082328982
5.0304251869708709,4.7722902506707472
4.9830024305981464,5.4673854012188006
5.5208522191474998,4.8293542360508841
CSV
run() { expect_exit 0 "$odpd" run "$@" --threads 1; }
across='fluid.gamma_perp=0.5 --set fluid.antisymmetric_stress=true'
cures=(fluid.zeta_0=0.1 fluid.mass=0.01 "$across")
drag_under_flow='(fluid.zeta_0, with fluid.zeta_0_under_flow = true)'

# --- every solver ---
solvers=$("$odpd" info | sed -n 's/.*solvers[: ]*//p' | tr -d ,)
expect test -n "$solvers"
for name in $solvers; do
  run drop --set solver.name=$name --out "$name"
  expect_text "$out_text" "solver $name to 1e-05"
  expect_text "$err_text" '20 particles' 'can turn as one (1 null motion(s) of R)' fluid.zeta_0 fluid.mass fluid.gamma_perp fluid.antisymmetric_stress
done
# --- what makes it turn, as the warning says ---
for cure in "${cures[@]}"; do
  # shellcheck disable=SC2086
  run drop --set $cure --out cured
  expect test "$(grep -c 'null motion' "$err_text")" -eq 0
done

# --- a torque from outside ---
wave=(--set 'body_force.force=[1.0, 0.0]' --set 'body_force.wave={along = "y"}')
expect_error 2 "$odpd" run drop "${wave[@]}" --out torque -- '20 particles' 'can turn as one' 'no answer' \
  "$drag_under_flow" fluid.mass fluid.gamma_perp
run drop "${wave[@]}" --set fluid.zeta_0=0.1 --set fluid.zeta_0_under_flow=true --out cured
for cure in fluid.mass=0.01 "$across"; do
  # shellcheck disable=SC2086
  run drop "${wave[@]}" --set $cure --out cured
done

# --- under shear ---
expect_error 2 "$odpd" run drop --set shear.rate=0.1 --out sheared -- 'under shear' fluid.mass fluid.gamma_perp
for cure in fluid.mass=0.01 "$across"; do
  # shellcheck disable=SC2086
  run drop --set shear.rate=0.1 --set $cure --out cured
done

# --- two of them ---
cp -r drop two
awk -F, 'NR > 1 { printf "%.16g,%.16g\n", $1 + 1.5, $2 }' drop/cluster.csv >>two/cluster.csv
run two --out close # touching: one cluster
awk -F, 'NR == 1 { print } NR > 1 { print; printf "%.16g,%.16g\n", $1 + 2.5, $2 }' drop/cluster.csv >two/cluster.csv
expect_error 2 "$odpd" run two --out apart -- '20 particle(s)' 'out of reach of all others' fluid.zeta_0 fluid.mass \
  fluid.rattler_friction
for cure in fluid.zeta_0=0.1 fluid.mass=0.01 'fluid.rattler_friction={gamma = 0.1, cutoff = 3.0}'; do
  run two --set "$cure" --out cured
done

# --- five of them, each pinned by an obstacle: three are named; of a force on one of them the error names that one ---
{
  cat drop/case.toml
  echo '[[body]]'
  echo 'shape = "points"'
  echo 'points = [{ at = [0.0, 0.0] }]'
  echo 'motion = "fixed"'
  echo 'positions = [{ at = [2.0, 5.0] }, { at = [5.0, 5.0] }, { at = [8.0, 5.0] }, { at = [11.0, 5.0] }, { at = [14.0, 5.0] }]'
} >two/case.toml
awk -F, 'NR == 1 { print } NR > 1 { for (k = -1; k <= 3; ++k) printf "%.16g,%.16g\n", $1 + 3 * k, $2 }' drop/cluster.csv >two/cluster.csv
run two --out pinned
expect_text "$err_text" 'turn about it' '; and 2 more,' 'where walls move or forces drive, with fluid.zeta_0_under_flow = true'
expect test "$(grep -o '20 particles, among them' "$err_text" | wc -l)" -eq 3
fourth=(--set 'body_force.region=[{axis = "x", from = 9.5, to = 12.5, force = [0.0, 1.0]}]')
expect_error 2 "$odpd" run two "${fourth[@]}" --out driven -- '20 particles' 'no answer' "$drag_under_flow"
particle=$(sed -n 's/.*among them particle \([0-9]*\),.*/\1/p' "$err_text")
expect test "$((${particle:-0} % 5))" -eq 3 # the file has one of each in turn

finish
