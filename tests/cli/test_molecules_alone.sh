#!/usr/bin/env bash
# Molecules without a solvent, bonds that outgrow the box, and molecules of start files that no step could begin with.
source "$(dirname "$0")/lib.sh" "$@"

# --- a melt: the beads are the fluid ---
write_periodic melt
sed -i 's/^density.*/count = 0/' melt/case.toml
run() { "$odpd" run "$@"; }
expect_error 1 run melt -- "melt/case.toml:$(grep -n '^count' melt/case.toml | cut -d: -f1)" fluid.count '[[molecule]]'
expect_error 1 run melt --set 'body=[{shape="square", side=0.4, count=2}]' -- fluid.count 'bodies alone'
expect_error 1 run melt --set fluid.count=-1 -- fluid.count 'zero or positive'
cat >>melt/case.toml <<'CASE'

[output]
pictures = false
trajectory_every = 10

[[molecule]]
shape = "walk"
species = "fluid"
beads = 8
spacing = 0.4
H = 100.0
count = 8
CASE
expect_exit 0 run melt --out melt_run
expect_text "$out_text" '64 free particles' 'density = 4 '
expect_text melt_run/summary.json '"pressure"' '"finished": true'
expect_exit 0 run melt --dry-run
expect_text "$out_text" '64 free particles' MiB
for more in 'start.from=lattice' 'integrator.name=monte-carlo' 'fluid.mass=1.0' 'shear.rate=0.5' \
  'observe=[{kind="molecules"}, {kind="rdf"}, {kind="stress"}]' 'body=[{shape="square", side=0.2, count=2}]'; do
  expect_exit 0 run melt --set "$more" --out more
done
# A melt from its own last frame, and by physical inputs.
own=$PWD/$(find melt_run -name 'trajectory.*.h5' | sort | tail -n 1)
expect_exit 0 run melt --set start.from=file --set "start.file=\"$own\"" --out continued
expect_error 1 run melt --set start.from=file --set "start.file=\"$own\"" --set molecule.0.count=7 -- trajectory '8 fluid particles' 'fluid.count asks for 0'
sed '/^gamma/d' melt/case.toml >melt/eta.toml
expect_exit 0 run melt/eta.toml --set fluid.eta=3.0 --dry-run
expect_text "$out_text" 'eta = 3 ' 'density = 4 '
# A restart gives the same bits.
series=(--set 'observe=[{kind="thermo", every=1, series=true}]')
expect_exit 0 run melt "${series[@]}" --out whole
expect_exit 0 run melt "${series[@]}" --set run.duration=0.075 --out part
expect_exit 0 run melt "${series[@]}" --restart part/checkpoint.h5
expect cmp whole/thermo_series.csv part/thermo_series.csv
expect test "$(wc -l <whole/thermo_series.csv)" -eq 31

# --- a harmonic bond that grows past half the box: no smaller step would cure it ---
write_periodic soft
cat >>soft/case.toml <<'CASE'

[[molecule]]
shape = "chain"
species = "fluid"
spacing = 0.5
H = 0.2
count = 4
CASE
soft() { run soft --set run.duration=50.0 --set output.trajectory_every=0 --out soft_run "$@"; }
expect_error 2 soft -- step 'bond of particles' 'half the shortest periodic edge (2) or more' 'a larger box, a larger H or a smaller r_0'
expect test -z "$(grep -E 'Remedy|--set integrator.dt|Likely cause' "$err_text")"
expect_text soft_run/summary.json '"blew_up"'
# Where bonds are explicit it might, so the step is named, too.
expect_error 2 soft --set integrator.name=extrapolated -- 'a larger box' 'integrator.dt ='

# --- bonds of a start file ---
sed '/^density/d' melt/case.toml >melt/file.toml
sed -i '/^count = 0/d; /^\[\[molecule/,$d' melt/file.toml
printf '[start]\nfrom = "file"\nfile = "start.csv"\n[bonds]\nfile = "bonds.csv"\nH = 10.0\n' >>melt/file.toml
{
  printf 'x,y\n'
  for x in 0.3 1.1 1.7 2.3 3.1 3.7; do for y in 0.2 0.7 1.5 2.2 3.0 3.6; do printf '%s,%s\n' $x $y; done; done
} >melt/start.csv
printf 'i,j\n0,1\n' >melt/bonds.csv
expect_exit 0 run melt/file.toml --out joined
printf 'i,j\n0,1\n0,20\n' >melt/bonds.csv
expect_error 1 run melt/file.toml -- start.csv 'bond of its particles 0 and 20' 'half the shortest periodic edge' 'a larger box'
printf 'i,j\n0,1\n7,20\n' >melt/bonds.csv
expect_error 1 run melt/file.toml --set bonds.law=fene --set bonds.r_max=1.0 -- start.csv 'particles 7 and 20' 'from -1 to 1' r_max

# --- a simplex on sites, with its corners in the other order ---
# simplex DIMENSION ORDER...: particles of a fluid, then those of a simplex of edge 0.25, in that order.
simplex() {
  awk -v d="$1" -v order="${*:2}" 'BEGIN {
    print (d == 2) ? "x,y" : "x,y,z"
    for (x = 0.25; x < 3; x += 0.5) for (y = 0.25; y < 3; y += 0.5)
      if (d == 2) print x "," y
      else for (z = 0.25; z < 3; z += 0.5) print x "," y "," z
    split("0 0 0;0.25 0 0;0.125 0.216506351 0;0.125 0.072168784 0.204124145", corner, ";")
    n = split(order, at, " ")
    for (k = 1; k <= n; k++) {
      split(corner[at[k]], r, " ")
      print 1.4 + r[1] "," 1.4 + r[2] (d == 2 ? "" : "," 1.4 + r[3])
    }
  }'
}
for d in 2 3; do
  mkdir -p mirror$d
  size='3.0, 3.0' periodic='true, true'
  [ $d -eq 3 ] && size="$size, 3.0" periodic="$periodic, true"
  cat >mirror$d/case.toml <<CASE
dimension = $d
[box]
size = [$size]
periodic = [$periodic]
[fluid]
kT = 1.0
a = 18.5
gamma = 4.5
[start]
from = "file"
file = "start.csv"
[integrator]
dt = 0.005
[run]
duration = 0.02
[output]
pictures = false
[[molecule]]
name = "colloid"
shape = "simplex"
species = "fluid"
spacing = 0.25
bonds = "sites"
H = 1000.0
CASE
  fluid=$((d == 2 ? 36 : 216))
  all=(1 2 3 4)
  simplex $d "${all[@]:0:d+1}" >mirror$d/start.csv
  expect_exit 0 run mirror$d --out right$d
  simplex $d 2 1 "${all[@]:2:d-1}" >mirror$d/start.csv
  expect_error 1 run mirror$d -- start.csv "particles $fluid to $((fluid + d))" "'colloid'" 'mirror image of its shape' 'exchange any two'
  # Which bonds between the particles do not see.
  expect_exit 0 run mirror$d --set molecule.0.bonds=all --out all$d
done
finish
