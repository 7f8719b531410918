#!/usr/bin/env bash
# model = "table": bad tables are refused by file and line, a run names its table absolutely and a restart needs only the checkpoint;
# with a hard core the reports say what is undefined, and what blows up is caught all the same.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
sed -i -e 's/^a = 18.5/model = "table"\nforce_file = "force.csv"/' box/case.toml
printf 'r,f\n0.0,18.5\n1.0,0.0\n' >box/force.csv
run() { "$odpd" run "$@" --threads 1 --set output.pictures=false; }
# value FILE KEY...: of a summary.
value() { "$python" -c 'import json, sys; v = json.load(open(sys.argv[1]))
for key in sys.argv[2:]: v = v[key]
print(v)' "$@"; }
# table TEXT: the table of the next runs.
table() { printf "$1" >box/force.csv; }

# --- the linear force of DPD: the same run as with model = "dpd", to rounding ---
expect_exit 0 run box --out first
expect_text "$out_text" 'rows = 2' 'pressure = 42.74'
expect_exit 0 run box --dry-run
expect_text "$out_text" 'model table' 'pressure = 42.74' 'step_limit = 0.0486'
write_periodic dpd
expect_exit 0 run dpd --out second
if have_python; then
  expect "$python" -c 'import json
for name in "energy_per_particle", "pressure", "config_temperature":
    a, b = (json.load(open(f"{run}/summary.json"))["observables"][name]["mean"] for run in ("first", "second"))
    assert abs(a - b) < 1e-6 * abs(b), (name, a, b)'
fi

# --- its text is in the checkpoint ---
expect_text first/case.toml "force_file = \"$PWD/box/force.csv\""
expect_exit 0 run box --set run.duration=0.3 --out whole
mv box/force.csv hidden.csv
expect_error 1 run box -- case.toml fluid.force_file force.csv
expect_exit 0 run first/case.toml --set run.duration=0.3 --restart first/checkpoint.h5
if have_python; then
  for key in observables solver; do
    expect "$python" -c 'import json, sys
assert json.load(open("whole/summary.json"))[sys.argv[1]] == json.load(open("first/summary.json"))[sys.argv[1]]' $key
  done
fi
mv hidden.csv box/force.csv

# --- bad keys and tables ---
expect_error 1 run box --set fluid.a=1 -- fluid.a 'nothing in this case reads'
expect test "$(grep -c -w eta "$err_text")" -eq 0 # no other model's keys are suggested
expect_error 1 run box --set fluid.eta=1 -- fluid.eta 'model = "dpd"' table
expect_error 1 run box --set fluid.force_below=zero -- fluid.force_below 'error, constant'
expect_error 1 run dpd --set fluid.force_file=force.csv -- fluid.force_file
expect_error 1 "$odpd" calibrate box --eta 3 -- fluid.model 'model = "dpd"' '"table"'
sed '/^force_file/d' box/case.toml >box/without.toml
expect_error 1 run box/without.toml -- fluid.force_file missing
table 'r,f\n0.0,1.0\n0.4,1.0\n0.3,1.0\n1.0,0.0\n'
expect_error 1 run box -- box/force.csv:4 ascending
table 'r,f\n0.0,1.0\n0.4,1.0\n0.4,1.0\n1.0,0.0\n'
expect_error 1 run box -- box/force.csv:4 'each once'
table 'r,f\n0.0,1.0\n0.1,1.0\n0.5,1.0\n0.6,1.0\n1.0,0.0\n'
expect_error 1 run box -- box/force.csv:4 'rows are missing'
table '# of mine\nr,f\n0.0,1.0\n0.4,inf\n1.0,0.0\n'
expect_error 1 run box -- box/force.csv:4 "'f'" finite
table 'r,f\n0.0,1.0\n0.4\n1.0,0.0\n'
expect_error 3 run box -- box/force.csv:3 '1 values'
table 'r,f\n0.0,1.0\n0.9,0.0\n'
expect_error 1 run box -- box/force.csv:3 'ends at r = 0.9' cutoff
expect_exit 0 run box --set fluid.cutoff=0.9 --out shorter
table 'r,f,u\n0.0,1.0,1.0\n1.0,0.0,0.0\n'
expect_error 1 run box -- box/force.csv 'keep one'
table 'r,force\n0.0,1.0\n1.0,0.0\n'
expect_error 1 run box -- box/force.csv "'f'" "'force'"

# --- a table of its own for a pair of species ---
table 'r,f\n0.0,18.5\n1.0,0.0\n'
printf 'r,u\n0.0,18.0\n0.25,10.125\n0.5,4.5\n0.75,1.125\n1.0,0.0\n' >box/other.csv
species=(--set 'species=[{name="A", fraction=0.5}, {name="B", fraction=0.5}]')
pair() { run box "${species[@]}" --set "pair=[{species=[\"A\", \"B\"], $1}]" "${@:2}"; }
expect_exit 0 pair 'force_file="other.csv", gamma=9.0' --out two
expect_text two/case.toml "force_file = \"$PWD/box/other.csv\""
# 4 + pi/24 (18.5 + 36)/2 16, the mean of two repulsions.
expect_text "$out_text" 'pressure = 61.07'
expect_error 1 pair 'cutoff=1.5' -- box/force.csv:3 'before the cutoff 1.5'
expect_error 1 pair 'force_file="none.csv"' -- pair.0.force_file none.csv

# --- a Lennard-Jones core: epsilon = kT, sigma = 0.4 ---
awk 'BEGIN { print "r,f"; for (k = 0; k <= 140; ++k) { r = 0.3 + 0.005 * k; x = (0.4 / r)^6
  printf "%.6g,%.12g\n", r, 4 * (12 * x * x - 6 * x) / r } }' >box/force.csv
core=(--set fluid.density=3.0 --set 'fluid.rattler_friction={gamma=0.1, cutoff=2.0}' --set output.trajectory_every=0 --set run.equilibrate=0)
expect_exit 0 run box "${core[@]}" --dry-run
expect_text "$out_text" 'pressure = undefined' 'energy_per_particle = undefined' 'step_limit = 5.6'
expect_exit 0 run box "${core[@]}" --set integrator.dt=5e-5 --set run.duration=0.05 --out cored
expect_text "$out_text" 'pressure = undefined'
# Trial moves do not go where the table does not reach.
expect_exit 0 run box "${core[@]}" --set integrator.name=monte-carlo --set integrator.dt=1 --set run.duration=400 --out sampled
# Nor does that keep a bond from holding a pair there which it excludes.
sampling=(--set integrator.name=monte-carlo --set integrator.dt=1 --set run.duration=400)
dimers='shape="chain", spacing=0.25, species="fluid", H=400.0, count=5, exclude="repulsion"'
expect_exit 0 run box "${core[@]}" "${sampling[@]}" --set "molecule=[{$dimers}]" --set 'observe=[{kind="molecules"}]' --out bonded
if have_python; then
  expect "$python" -c "assert 0.2 < $(value bonded/summary.json observables molecules.molecule.bond_length mean) < 0.28"
fi
# Far too large a step. Pairs come nearer than the table begins, or the watch sees what came of it first.
wild=("${core[@]}" --set integrator.dt=0.005 --set run.duration=4)
expect_error 2 run box "${wild[@]}" --set integrator.name=euler --out blown -- 'step ' 'particles ' ' apart, and ' \
  'box/force.csv begins at r = 0.3' force_below 'blown up' 'Likely cause: integrator.dt = 0.005 is beyond' 'Remedy: integrator.dt = 5.6e-05' last_good.h5
for name in trapezoidal extrapolated implicit; do
  expect_error 2 run box "${wild[@]}" --set integrator.name=$name --out blown -- 'step ' 'blown up' 'Remedy: integrator.dt = '
done
expect_error 2 run box "${core[@]}" --set start.relax_sweeps=0 --out blown -- 'step 0 ' 'begins at r = 0.3' force_below
# With a constant force there it is the watch that catches it.
for name in euler trapezoidal extrapolated implicit; do
  expect_error 2 run box "${wild[@]}" --set fluid.force_below=constant --set integrator.name=$name --out blown -- 'step ' 'blown up' \
    'configurational temperature' 'Remedy: integrator.dt = '
done
expect test -s blown/last_good.h5
expect_exit 0 run box "${core[@]}" --set fluid.force_below=constant --set integrator.dt=5e-5 --set run.duration=0.05 --out cored
# Where the force rises with r the stiffness is negative: implicit steps leave it out and say how often.
expect_exit 0 run box "${core[@]}" --set integrator.name=implicit --set integrator.dt=5e-5 --set run.duration=0.005 --out implicit
expect_text "$out_text" 'negative stiffnesses were left out of the implicit repulsion'
expect_text implicit/summary.json '"stiffnesses_left_out"'
expect test "$(grep -c stiffnesses_left_out cored/summary.json)" -eq 0
finish
