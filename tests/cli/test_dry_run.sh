#!/usr/bin/env bash
# `odpd run --dry-run`: what would be modelled, how large it is and how long it takes; nothing is written.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
write_walled channel
listing() { find . -printf '%p %s %T@\n' | sort; }
before=$(listing)

expect_exit 0 "$odpd" run box --dry-run
expect_text "$out_text" 'a small periodic box' '64 free particles' '0 of known velocity' edges '40 steps' \
  '10 of them equilibration' 'dt = 0.005' 'solver pcg' MiB 'ms per step' \
  '+ conservative force' '+ random force' '- inertia' '- walls' '+ solves per step' '2, integrator trapezoidal' '- assembled matrix'
expect test ! -s "$err_text"
# About 9 to 14 neighbours within the cutoff at this density, two ends to an edge.
edges=$(grep -o '[0-9]* edges' "$out_text" | cut -d' ' -f1)
expect test "$edges" -gt $((64 * 3)) -a "$edges" -lt $((64 * 14))

expect_exit 0 "$odpd" run channel --dry-run --set fluid.kT=0.0 --set fluid.a=0.0 --set solver.name=cholmod \
  --set integrator.name=euler --set 'body_force.force=[0.5, 0.0]'
expect_text "$out_text" '48 free particles' '36 of known velocity' '- conservative force' '- random force' '+ walls' \
  '2 [[wall]]' '+ body force' '+ solves per step' '1, integrator euler' '+ assembled matrix'

# Solves of observers, in the part that they measure: of two components, and of four modes in every other step.
expect_exit 0 "$odpd" run box --dry-run --set \
  'observe=[{kind="viscosity",control=true},{kind="modes",numbers=[1],control=true,control_every=2}]'
expect_text "$out_text" '2, integrator trapezoidal, and 4 of observers while they measure'

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
expect_error 1 "$odpd" run level --dry-run --set fluid.mass=2.0 --set fluid.tau_P=1.0 -- '--set fluid.tau_P' '3D only'

# Every case that comes with the program is in order.
for case in "$source_root"/cases/*/*.toml; do
  checks=$((checks + 1))
  timeout 60 "$odpd" run "$case" --dry-run >"$out_text" 2>"$err_text" && continue
  fail "--dry-run of $case"
  show_texts
done

# Memory: what --dry-run says is within a fifth of the largest resident memory of a run, with free bodies as without. (With
# sanitizers a program needs several times as much.)
limited() { (ulimit -v "$1" && shift && "$odpd" "$@"); }
crowd() { # directory, dimension, edge of the box, particles of the fluid, lines of the body
  mkdir "$1"
  local size=$3 periodic=true
  for ((c = 1; c < $2; ++c)); do size+=", $3" periodic+=", true"; done
  printf 'title = "a crowd"\ndimension = %s\n[box]\nsize = [%s]\nperiodic = [%s]\n' "$2" "$size" "$periodic" >"$1/case.toml"
  printf '[fluid]\ncount = %s\nkT = 1.0\ncutoff = 1.0\na = 18.5\ngamma = 4.5\ns = 0.5\nzeta_0 = 0.05\n%s\n' "$4" "$5" >>"$1/case.toml"
  printf '[start]\nrelax_sweeps = 5\n[integrator]\nname = "trapezoidal"\ndt = 0.001\n[solver]\nname = "pcg"\n' >>"$1/case.toml"
  printf '[run]\nduration = 0.002\n[output]\npictures = false\n' >>"$1/case.toml"
}
largest_resident='import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)'
crowd disks 2 70.7 10500 '[[body]]
shape = "disk"
radius = 0.8
count = 500
clearance = 0.3'
crowd spheres 3 17.1 10000 '[[body]]
shape = "sphere"
radius = 0.8
points_on_sphere = 30
count = 333
clearance = 0.3'
crowd fluid 3 17.1 20000 ''
if have_python && limited 8000000 --version >"$out_text" 2>&1; then
  for name in disks spheres fluid; do
    expect_exit 0 "$odpd" run $name --dry-run --threads 1
    estimate=$(sed -n 's/.*about \([0-9.]*\) MiB.*/\1/p' "$out_text")
    kibibytes=$("$python" -c "$largest_resident" "$odpd" run $name --threads 1 --out $name/run)
    expect "$python" -c "assert abs($estimate / ($kibibytes / 1024) - 1) < 0.2, '$name: $estimate MiB, and it took $kibibytes KiB'"
    rm -r $name/run
  done
else
  skip 'memory of a run: no python3, or this build does not start under a limit'
fi

# A case that does not fit into the memory there is: size and memory are told without building it, by the run as well. (With
# sanitizers the program itself needs more than any such limit.)
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
  expect_error 2 limited 350000 run box --dry-run --set 'box.size=[500.0, 500.0]' --set start.relax_sweeps=0 -- \
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
