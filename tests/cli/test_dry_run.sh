#!/usr/bin/env bash
# `odpd run --dry-run`: what would be modelled, how large it is and how long it takes; nothing is written.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
write_walled channel
listing() { find . -printf '%p %s %T@\n' | sort; }
before=$(listing)

expect_exit 0 "$odpd" run box --dry-run
expect_text "$out_text" 'a small periodic box' '64 free particles' '0 of known velocity' edges '40 steps' \
  '10 of them equilibration' 'dt = 0.005' 'solver pcg' MiB 'ms per stage' \
  '+ conservative force' '+ random force' '- inertia' '- walls' '+ solves per step' '2, integrator trapezoidal' '- assembled matrix'
expect test ! -s "$err_text"
# About 9 to 14 neighbours within the cutoff at this density, two ends to an edge.
edges=$(grep -o '[0-9]* edges' "$out_text" | cut -d' ' -f1)
expect test "$edges" -gt $((64 * 3)) -a "$edges" -lt $((64 * 14))

expect_exit 0 "$odpd" run channel --dry-run --set fluid.kT=0.0 --set fluid.a=0.0 --set solver.name=cholmod \
  --set integrator.name=euler --set 'body_force.force=[0.5, 0.0]'
expect_text "$out_text" '48 free particles' '36 of known velocity' '- conservative force' '- random force' '+ walls' \
  '2 [[wall]]' '+ body force' '+ solves per step' '1, integrator euler' '+ assembled matrix'

# The fluid in both languages. By hand at n = 4, s = 1/2: eta = 4.5 16 (64 pi/315)/16, p = 4 + 18.5 16 pi/24.
expect_exit 0 "$odpd" run box --dry-run
expect_text "$out_text" 'a = 18.5 s_bar = 1' 'gamma = 4.5 sigma = 3' 'eta_friction = 2.87231' 'pressure = 42.7463' \
  'Sc = infinite' 'eta: not in this run'
expect test -z "$(grep 'asked for' "$out_text")"

# Three coarse-graining levels of one fluid with mass by its properties (Nguyen 2021, section 4.1): viscosity and
# compressibility stay, the DPD parameters do not. gamma = 315 eta/(4 pi n^2 r_c^4), a = gamma^2 r_c/m.
write_periodic level
sed -i '/^a = /d; /^gamma/d; s/^density.*/eta = 30.0\nalpha = 1.0\nkappa_inverse = 15.98\nrho = 8.0/' level/case.toml
before=$(listing)
for level in '8.0 1.0 11.7501 138.065' '6.0 1.3333333333333333 6.60944 43.6847' '4.0 2.0 2.93753 8.62907'; do
  read -r density cutoff gamma a <<<"$level"
  expect_exit 0 "$odpd" run level --dry-run --set fluid.density="$density" --set fluid.cutoff="$cutoff" \
    --set integrator.dt=0.001
  expect_text "$out_text" "gamma = $gamma" "a = $a" 'rho = 8 ' 'eta_friction = 30 ' 'kappa_inverse = 15.98' 'alpha = 1'
done
expect_exit 0 "$odpd" run level --dry-run --set fluid.mass=2.0 --set fluid.cutoff=2.0
expect_text "$out_text" 'density = 4 mass = 2' 'gamma = 2.93753'
expect_error 1 "$odpd" run level --dry-run --set fluid.mass=2.0 --set fluid.cutoff=2.0 --set fluid.Sc=100.0 -- \
  '--set fluid.Sc' 'too small' '3.20'

# Every case that comes with the program is in order.
for case in "$source_root"/cases/*/case.toml; do
  checks=$((checks + 1))
  timeout 60 "$odpd" run "$case" --dry-run >"$out_text" 2>"$err_text" && continue
  fail "--dry-run of $case"
  show_texts
done

# A case that does not fit into the memory there is: size and memory are told without building it, by the run as well. (With
# sanitizers the program itself needs more than any such limit.)
limited() { (ulimit -v "$1" && shift && "$odpd" "$@"); }
if limited 8000000 --version >"$out_text" 2>&1; then
  huge=(--set fluid.count=1000000000 --set 'box.size=[15811.0, 15811.0]')
  sed '/^density/d' box/case.toml >box/counted.toml
  for how in --dry-run ''; do
    expect_error 2 limited 8000000 run box/counted.toml $how "${huge[@]}" -- 'not enough memory' '1e+09 particles' edges TiB \
      '7.63 GiB (ulimit -v)' 'lower fluid.count'
  done
  expect_error 2 limited 8000000 run box --dry-run --set 'box.size=[15811.0, 15811.0]' -- 'lower fluid.density or box.size'
  expect_error 2 limited 8000000 run channel --dry-run --set 'wall.0.layers=[{depth=0.0, spacing=1e-9}]' -- wall.layers
  expect_error 2 limited 8000000 run box --dry-run --set fluid.density=1e30 -- 'not enough memory' EiB fluid.density
  # The particles fit, what lies between them does not.
  expect_error 2 limited 400000 run box --dry-run --set 'box.size=[500.0, 500.0]' --set start.relax_sweeps=0 -- \
    'not enough memory' '1e+06 particles' GiB 'fluid.density'
  expect test ! -e runs
else
  skip 'too little memory: this build does not start under a limit'
fi
before=$(listing)

# Errors come as they would in the run, and --out and --threads change nothing.
expect_error 1 "$odpd" run box --dry-run --set fluid.b=1.0 -- '--set fluid.b'
expect_error 2 "$odpd" run box --dry-run --set solver.max_iterations=1 -- solver.max_iterations
expect_exit 0 "$odpd" run box --dry-run --out somewhere --threads 2
expect_text "$out_text" '64 free particles' '2 thread(s)'
expect test "$before" = "$(listing)"
finish
