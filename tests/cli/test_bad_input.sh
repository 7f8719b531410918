#!/usr/bin/env bash
# Wrong cases, options and inputs: one message that tells what, where and the remedy, and the right exit code.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
write_walled channel

# bad NAME: a copy of the periodic case under a name of its own, to be spoilt by the caller.
bad() {
  rm -rf "$1"
  cp -r box "$1"
}
# replace DIRECTORY OLD NEW: in its case file.
replace() { sed -i "s|$2|$3|" "$1/case.toml"; }
line_of() { grep -n -- "$2" "$1/case.toml" | cut -d: -f1; }
run() { "$odpd" run "$@"; }

# --- the command line ---
expect_exit 0 "$odpd" --help
expect_text "$out_text" run compare info 'Exit codes'
expect_exit 0 "$odpd" run --help
expect_text "$out_text" --set --out --threads --restart --dry-run
expect_exit 0 "$odpd" --version
expect_text "$out_text" odpd
expect_exit 0 "$odpd" info
expect_text "$out_text" solvers pcg integrators trapezoidal
expect_exit 0 "$odpd" run box --quiet --out quiet
expect test -z "$(grep -v '^step' "$err_text")"
expect_exit 0 "$odpd" --quiet run box --out quiet
expect test -z "$(grep info "$err_text")"
expect_error 1 "$odpd" -- --help
expect_error 1 "$odpd" simulate box -- simulate 'run, compare, study, calibrate, info'
expect_error 1 run -- case
expect_error 1 run box --thread 2 -- --thread
expect_error 1 run box --threads many -- --threads many
expect_error 1 run box --threads -1 -- --threads
expect_error 1 run missing -- missing
expect_error 1 run missing.toml -- missing.toml
mkdir -p empty
expect_error 1 run empty -- case.toml

# --- keys and values, each with its file, line and key ---
bad misspelt
replace misspelt 'gamma = 4.5' 'gama = 4.5'
expect_error 1 run misspelt -- 'fluid.gamma' "'gama' (misspelt/case.toml:$(line_of misspelt gama))"
bad extra
replace extra 'a = 18.5' 'a = 18.5\ngama_perp = 1.0'
expect_error 1 run extra -- "extra/case.toml:$(line_of extra gama_perp)" fluid.gama_perp "'gamma_perp'"
bad table
printf '\n[solvers]\nname = "pcg"\n' >>table/case.toml
expect_error 1 run table -- 'table/case.toml:' solvers "'solver'"
bad type
replace type 'a = 18.5' 'a = "strong"'
expect_error 1 run type -- "type/case.toml:$(line_of type strong)" fluid.a number
bad negative
replace negative 'dt = 0.005' 'dt = -0.005'
expect_error 1 run negative -- "negative/case.toml:$(line_of negative -0.005)" integrator.dt positive
bad nan
replace nan 'kT = 1.0' 'kT = nan'
expect_error 1 run nan -- "nan/case.toml:$(line_of nan nan)" fluid.kT finite
bad syntax
replace syntax 'kT = 1.0' 'kT = '
expect_error 1 run syntax -- "syntax/case.toml:$(line_of syntax 'kT')"
bad twice
replace twice 'a = 18.5' 'a = 18.5\na = 3.0'
expect_error 1 run twice -- 'twice/case.toml:'
bad both
replace both 'gamma = 4.5' 'gamma = 4.5\nsigma = 3.0'
expect_error 1 run both -- "both/case.toml:$(line_of both sigma)" fluid.sigma gamma
expect_error 1 run box --set fluid.mass=1.0 --set integrator.name=euler -- '--set integrator.name' 'mass 0 only' trapezoidal
expect_error 1 run box --set integrator.name=shardlow -- '--set integrator.name' fluid.mass trapezoidal
expect_error 1 run box --set integrator.name=velocity-verlet --set integrator.lambda=2 --set fluid.mass=1 -- integrator.lambda
expect_error 1 run box --set integrator.lambda=0.5 -- integrator.lambda
# monte-carlo takes a case as it was written for another scheme.
expect_exit 0 run box --set integrator.lambda=0.5 --set integrator.order=2 --set integrator.name=monte-carlo --out sampled
expect_error 1 run channel --set fluid.zeta_0=0.1 --set 'wall.0.velocity=[1.0, 0.0]' -- fluid.zeta_0 zeta_0_under_flow rattler_friction
# Shear.
sheared=(--set shear.rate=1.0)
expect_exit 0 run box "${sheared[@]}" --set run.duration=0.02 --out sheared
expect_error 1 run box --set shear.flow=x -- shear.rate
expect_error 1 run box "${sheared[@]}" --set shear.flow=z -- '--set shear.flow' x y
expect_error 1 run box "${sheared[@]}" --set shear.flow=y -- shear.gradient 'another direction'
expect_error 1 run box "${sheared[@]}" --set shear.frequency=-1.0 -- shear.frequency
expect_error 1 run box "${sheared[@]}" --set shear.frequency=1.0 --set fluid.mass=1.0 -- shear.frequency 'fluid.mass = 0.0'
expect_error 1 run box "${sheared[@]}" --set shear.gama=1.0 -- shear.gama
expect_error 1 run box "${sheared[@]}" --set fluid.zeta_0=0.1 --set fluid.zeta_0_under_flow=true -- fluid.zeta_0 rattler_friction
expect_error 1 run box "${sheared[@]}" --set integrator.name=monte-carlo -- '--set integrator.name' shear trapezoidal
expect_error 1 run box "${sheared[@]}" --set 'body_force.force=[1.0, 0.0]' \
  --set 'body_force.wave={ along = "y", number = 1 }' -- body_force.force '[shear]'
expect_error 1 run box "${sheared[@]}" --set 'observe=[{kind="msd", directions=["x"]}]' -- directions flow
expect_error 1 run box --set 'body=[{shape="ring", radius=0.2}]' --set 'observe=[{kind="bodies", directions=["w"]}]' -- directions "'w'"
expect_error 1 run box --set 'body=[{shape="ring", radius=[0.5, 1e-12]}]' -- shape "two points"
expect_error 1 run box --set 'body=[{shape="ring", radius=[0.5, -0.1]}]' -- radius "positive"
expect_error 1 run channel "${sheared[@]}" -- shear.gradient bounded velocity
# Spins: what nothing takes up, what nothing turns, numbers and schemes.
spinning=(--set fluid.gamma_perp=2.0 --set fluid.lever_radius=0.5)
expect_error 1 run box --set fluid.gamma_perp=2.0 -- '--set fluid.gamma_perp' lever_radius 'antisymmetric_stress = true'
expect_error 1 run box --set fluid.lever_radius=0.5 -- '--set fluid.lever_radius' 'across lines of centres' gamma_perp
expect_error 1 run box "${spinning[@]}" --set fluid.mass=1.0 --set fluid.moment=-0.1 -- '--set fluid.moment'
expect_error 1 run box "${spinning[@]}" --set fluid.moment=0.1 -- '--set fluid.moment' fluid.mass
expect_error 1 run box "${spinning[@]}" --set fluid.mass=1.0 --set integrator.name=setd -- '--set integrator.name' lever_radius trapezoidal
expect_error 1 run box "${spinning[@]}" --set fluid.mass=1.0 --set fluid.moment=0.0 --set integrator.name=shardlow -- '--set integrator.name' moment
expect_exit 0 run box "${spinning[@]}" --out spinning
expect_text "$out_text" eta_rotational spin_relaxation

# Physical inputs: both sets at once, and what the formulas cannot give.
physical=(--set fluid.eta=3.0)
expect_error 1 run box "${physical[@]}" -- "box/case.toml:$(line_of box 'gamma = 4.5')" fluid.gamma eta
bad physical
sed -i '/^gamma/d; /^a = /d' physical/case.toml
expect_error 1 run physical --set fluid.eta=3.0 -- fluid.a
expect_error 1 run physical "${physical[@]}" --set fluid.a=1.0 --set fluid.sigma=3.0 -- '--set fluid.sigma' eta
expect_error 1 run physical "${physical[@]}" --set fluid.a=1.0 --set fluid.gamma_perp=1.0 -- '--set fluid.gamma_perp'
expect_error 1 run physical --set fluid.kappa_inverse=20.0 --set fluid.a=9.0 -- fluid.eta viscosity
expect_error 1 run physical "${physical[@]}" --set fluid.alpha=1.0 -- '--set fluid.alpha' 'mass = 0'
expect_error 1 run physical "${physical[@]}" --set fluid.a=9.0 --set fluid.Sc=1e5 -- '--set fluid.Sc' 'mass = 0'
expect_error 1 run physical "${physical[@]}" --set fluid.a=9.0 --set fluid.Sc=1e5 --set fluid.s=1.0 -- '--set fluid.s' Sc
expect_error 1 run physical "${physical[@]}" --set fluid.alpha=1.0 --set fluid.a=9.0 -- '--set fluid.a' alpha
expect_error 1 run physical "${physical[@]}" --set fluid.kappa_inverse=20.0 -- '--set fluid.kappa_inverse' s_bar alpha
expect_error 1 run physical "${physical[@]}" --set fluid.kappa_inverse=0.9 --set fluid.s_bar=1.0 -- '--set fluid.kappa_inverse' 'larger than 1'
expect_error 1 run physical "${physical[@]}" --set fluid.kappa_inverse=20.0 --set fluid.a=1.0 -- '--set fluid.kappa_inverse' 'too stiff' 6
expect_error 1 run physical "${physical[@]}" --set fluid.kappa_inverse=20.0 --set fluid.s_bar=1.0 --set fluid.kT=0.0 -- '--set fluid.kappa_inverse' kT
expect_error 1 run box --set fluid.rho=4.0 --set fluid.mass=1.0 -- '--set fluid.rho' density mass
expect_exit 0 run physical "${physical[@]}" --set fluid.kappa_inverse=20.0 --set fluid.s_bar=1.0 --out physical_run
expect_text "$out_text" 'asked for' 'kappa_inverse = 20' 'eta = 3 ' 'Kinetic theory is a guide'
expect_text physical_run/summary.json '"viscosity_measured": null' '"asked_for"' '"kinetic_theory"'
# The resolved case holds what was given, not what followed from it: it runs again.
expect_exit 0 run physical_run --out again
expect cmp physical_run/case.toml again/case.toml
expect_error 1 run box --set dimension=4 -- '--set dimension' '2 or 3'
expect_error 1 run box --set seed=-3 -- '--set seed'
expect_error 1 run box --set run.duration=0.001 -- '--set run.duration' integrator.dt
expect_error 1 run box --set run.duration=1e30 -- '--set run.duration'
expect_error 1 run box --set fluid.count=0 -- '--set fluid.count'
expect_error 1 run box --set output.trajectory_every=-1 -- '--set output.trajectory_every'

# --- overrides ---
expect_error 1 run box --set fluid.b=1.0 -- '--set fluid.b'
expect_error 1 run box --set fluid.a -- '--set fluid.a'
expect_error 1 run box --set fluid.a=strong -- '--set fluid.a' number
expect_error 1 run box --set fluid.a.b=1 -- '--set fluid.a.b'
expect_error 1 run channel --set wall.5.thickness=1.0 -- '--set wall.5.thickness'

# --- names ---
expect_error 1 run box --set solver.name=gmres -- '--set solver.name' picard-deflated pcg eigen-cg cholmod
expect_error 1 run box --set solver.name=pgc -- "'pcg'"
expect_error 1 run box --set integrator.name=verlet -- '--set integrator.name' trapezoidal euler
expect_error 1 run box --set 'observe=[{kind="profil"}]' -- kind "'profile'"
expect_error 1 run box --set 'observe=[{kind="rdf"}, {kind="rdf"}]' -- rdf name
expect_error 1 run box --set 'observe=[{kind="stress", bins=-1}]' -- bins
expect_error 1 run box --set 'observe=[{kind="viscosity", every=2}]' -- every 'every step'
expect_error 1 run channel --set 'observe=[{kind="viscosity", window=1.0}]' -- window
expect_error 1 run box --set fluid.mass=1.0 --set 'observe=[{kind="heat"}]' -- heat fluid.mass
expect_error 1 run box --set 'observe=[{kind="velocities"}]' -- kind 'mass = 0' fluid.mass
expect_error 1 run box --set fluid.mass=1.0 --set 'observe=[{kind="velocities", directions=["z"]}]' -- directions "'z'"
expect_error 1 run box --set 'observe=[{kind="divergence", bins=[2.0, 4.0]}]' -- bins 3
expect_error 1 run box --set 'shear={rate=1.0}' --set 'observe=[{kind="divergence", bins=[4.0, 4.0]}]' -- kind shear
expect_error 1 run box --set 'observe=[{kind="profile", fit="sine"}]' -- fit body_force.wave
expect_error 1 run box --set 'observe=[{kind="rdf", from=1e6}]' -- from 'no step of the run'
expect_error 1 run box --set 'observe=[{kind="rdf", until=0.0}]' -- until positive
expect_error 1 run box --set 'observe=[{kind="density-residual", clear_of_bodies=1.0}]' -- clear_of_bodies '[[body]]'
expect_error 1 run box --set 'body=[{name="b", shape="square", side=0.1}]' --set 'observe=[{kind="density-residual", clear_of_bodies=1.0}]' -- clear_of_bodies "'b' moves"

# --- contradictions in the scene ---
expect_error 1 run box --set 'box.size=[1.5, 4.0]' -- cutoff 1.5
expect_error 1 run box --set 'box.size=[4.0]' -- '--set box.size' 2
expect_error 1 run box --set 'box.periodic=[true, false]' -- '--set box.periodic' '[[wall]]'
expect_error 1 run channel --set 'box.periodic=[true, true]' -- side periodic
bad two_walls
cp channel/case.toml two_walls/case.toml
replace two_walls 'side = "y+"' 'side = "y-"'
expect_error 1 run two_walls -- "two_walls/case.toml:$(line_of two_walls 'side = "y-"' | tail -n 1)" 'two walls' 'y-'
expect_error 1 run channel --set wall.0.thickness=3.0 -- '--set wall.0.thickness'
expect_error 1 run channel --set 'wall.0.velocity=[0.0, 1.0]' -- '--set wall.0.velocity'
expect_error 1 run channel --set 'wall.0.layers=[]' -- '--set wall.0.layers'
expect_error 1 run box --set 'body_force.force=[1.0, 0.0]' -- '--set body_force.force' periodic walls
expect_error 1 run box --set 'body_force.wave={along="y"}' -- '--set body_force.wave' amplitude
expect_error 1 run box --set 'body_force.force=[1.0, 0.0]' --set 'body_force.wave={along="x"}' -- body_force.force 'along the wave'
expect_error 1 run channel --set 'body_force.force=[1.0, 0.0]' --set 'body_force.wave={along="y"}' -- body_force.wave.along bounded
expect_error 1 run box --set 'body_force.region=[{axis="y", from=0.0, to=2.0, force=[1.0, 0.0]}]' -- body_force.region 'net force'
expect_error 1 run box --set 'body_force.region=[{axis="y", from=0.0, to=9.0, force=[1.0, 0.0]}]' -- to 'outside the box'
expect_error 1 run box --set 'body_force.force=[1.0, 0.0]' --set 'body_force.wave={along="y"}' --set integrator.name=monte-carlo -- monte-carlo body_force.wave
expect_error 1 run box --set 'species=[{name="A", fraction=0.5}]' -- fraction

# --- solvers ---
if "$odpd" info | grep -q '^ *solvers .*petsc'; then
  expect_error 1 run box --set solver.name=petsc --set 'solver.petsc_options="-pc_nonsense 3"' --out late -- pc_nonsense
  expect_error 1 run box --set solver.name=petsc --set 'solver.petsc_options="-pc_type nonsense"' --out late -- nonsense
  expect_error 1 run box --set solver.name=petsc --set 'solver.petsc_options="-ksp_rtol 1e-3"' -- solver.tolerance
else
  skip 'PETSc options: this build has no PETSc'
  expect_error 1 run box --set solver.name=petsc -- PETSc
fi
expect_error 1 run box --set 'solver.petsc_options="-pc_type jacobi"' -- solver.petsc_options
expect_error 1 run box --set solver.preconditioner=ilu -- '--set solver.preconditioner' multilevel block-jacobi
expect_error 1 run box --set solver.name=cholmod --set solver.preconditioner=multilevel -- '--set solver.preconditioner' pcg
expect_error 1 env ODPD_ISA=mmx "$odpd" run box -- ODPD_ISA avx512 avx2 portable
expect_error 1 run box --set solver.stopping=increment -- solver.stopping pcg
expect_error 1 run box --set solver.tolerance=2.0 -- '--set solver.tolerance'
expect_error 1 run box --set solver.max_iterations=0 -- '--set solver.max_iterations'
expect_error 2 run box --set solver.max_iterations=2 --out stuck -- 'step 0' pcg solver.max_iterations
# Particles without neighbours: both cures are named, and each of them works.
sparse=(--set fluid.density=0.8 --set fluid.a=0.0 --set 'box.size=[10.0, 10.0]')
expect_error 2 run box "${sparse[@]}" --out rattlers -- neighbour rattler_friction
expect_exit 0 run box "${sparse[@]}" --set 'fluid.rattler_friction={gamma=0.1, cutoff=2.5}' --out cured

# --- a failure in the middle of a run leaves what was written before ---
cat >>channel/case.toml <<'CASE'
[[observe]]
kind = "thermo"
series = true
every = 1
[output]
checkpoint_every = 5
trajectory_every = 5
pictures = false
CASE
# A repulsion far too strong for the step throws particles about until the run stops.
expect_exit 2 run channel --set integrator.dt=0.5 --set run.equilibrate=0.0 --set run.duration=500.0 --out blown
expect_one_error
expect test -s blown/case.toml
expect_exit 0 run channel --out short
expect_error 2 run channel --set run.duration=1.0 --restart short/checkpoint.h5 --set solver.max_iterations=2 \
  -- solver.max_iterations
expect_exit 0 run channel --set run.duration=0.3 --restart short/checkpoint.h5

# --- start files: they say how many particles there are ---
sed -i '/^density/d' box/case.toml channel/case.toml
expect_error 1 run box -- fluid.density missing
start() { run "$1" --set start.from=file --set "start.file=\"$2\"" "${@:3}"; }
printf 'x,y\n0.5,0.5\n1.0,1.0\n1.5,0.8\n1.0,0.5\n' >box/good.csv
printf 'x,y\n0.5,0.5\n1.0,1.0,3\n' >box/ragged.csv
printf 'x,y\n0.5,0.5\n1.0,here\n' >box/word.csv
printf 'x,y\n0.5,0.5\n1.0,nan\n' >box/nan.csv
printf 'x,z\n0.5,0.5\n' >box/columns.csv
printf 'x,y\n' >box/none.csv
: >box/empty.csv
printf 'x,y,species\n0.5,0.5,fluid\n1.0,1.0,polymer\n' >box/species.csv
printf 'not HDF5\n' >box/broken.h5
expect_error 1 start box good.csv --set fluid.density=4.0 -- good.csv '4 fluid particles' fluid.density 64
expect_error 1 start box good.csv --set fluid.count=5 -- good.csv '4 fluid particles' fluid.count 5
expect_error 3 start box missing.csv -- missing.csv
expect_error 3 start box ragged.csv -- ragged.csv:3
expect_error 1 start box word.csv -- word.csv:3 "'y'" here
expect_error 1 start box nan.csv -- nan.csv:3 "'y'" nan
expect_error 1 start box columns.csv -- columns.csv "'y'"
expect_error 1 start box none.csv -- none.csv
expect_error 3 start box empty.csv -- empty.csv
expect_error 1 start box species.csv -- species.csv:3 polymer
expect_error 3 start box broken.h5 -- broken.h5 HDF5
expect_error 1 start box case.toml -- case.toml CSV
printf 'x,y\n1.0,-0.2\n' >channel/good.csv
expect_error 1 start channel good.csv -- good.csv 'particle 0' y
printf 'x,y\n' >box/grid.csv
for x in 0.5 1.5 2.5 3.5; do for y in 0.2 0.9 1.6 2.3 3.0 3.7; do printf '%s,%s\n' $x $y; done; done >>box/grid.csv
expect_exit 0 start box grid.csv --set 'fluid.rattler_friction={gamma=0.1, cutoff=2.0}' --out started
expect_text "$out_text" '24 free particles'

# --- checks ---
cat >box/checked.toml <<'CASE'
include = "case.toml"
[fluid]
density = 4.0
[output]
pictures = false
[[check]]
observable = "presure"
expected = 1.0
tolerance = 100.0
CASE
expect_error 1 run box/checked.toml --out checked -- check.0.observable presure "'pressure'" energy_per_particle
expect_exit 4 run box/checked.toml --set check.0.observable=pressure --set check.0.tolerance=0.1 --out checked
expect_text "$out_text" FAILED 'outside the tolerance'
expect_exit 0 run box/checked.toml --set check.0.observable=pressure --out checked
expect_error 1 run box/checked.toml --set check.0.relative_tolerance=0.1 -- check tolerance

# Nothing that stands in the case file itself was found out only after something was written.
expect test ! -e runs
# --- obstacles and bodies ---
write_periodic box
cp -r box obstacle
cat >>obstacle/case.toml <<'CASE'

[[body]]
shape = "square"
side = 0.2
positions = [{ at = [1.0, 1.0] }]
CASE
body() { run obstacle --set "body.0.$1" "${@:2}"; }
expect_exit 0 body motion=fixed --out obstructed
expect_error 1 body shape=sphere -- body shape 'points, square, ring, disk'
expect_error 1 body side=0.0 -- body side positive
expect_error 1 body side=5.0 -- body shape 'across'
expect_error 1 body shape=points -- body points
expect_error 1 body per_side=1 -- body shape 'turns'
expect_error 1 body motion=stuck -- body motion 'free, fixed, given'
expect_error 1 body velocity='[1.0, 0.0]' -- velocity
expect_error 1 body count=3 -- body count positions
expect_error 1 body 'positions=[{at=[-1.0, 1.0]}]' -- positions 'outside the box'
expect_error 1 body name='a b' -- body name
expect_error 1 body species=stone -- species "'stone'"
expect_error 1 body motion=free --set fluid.mass=1.0 --set integrator.name=shardlow -- integrator.name '[[body]]'
expect_error 1 body force='[1.0, 0.0]' --set integrator.name=monte-carlo -- 'pushed'
expect_exit 0 body motion=free --set shear.rate=1.0 --set run.duration=0.02 --out sheared_body
expect_error 1 body motion=given --set 'body.0.velocity=[0.0, 1.0]' --set shear.rate=1.0 -- body velocity gradient '[shear]'
expect_error 1 body motion=fixed --set fluid.mass=1.0 --set shear.rate=1.0 -- body motion 'fluid.mass = 0.0'
expect_error 1 body motion=fixed --set shear.rate=1.0 --set 'observe=[{kind="density-residual", clear_of_bodies=1.0}]' -- clear_of_bodies '[shear]'
expect_error 1 run box --set 'observe=[{kind="bodies"}]' -- kind '[[body]]'
# --- molecules and bonds ---
write_periodic box
cp -r box chain
cat >>chain/case.toml <<'CASE'

[[molecule]]
shape = "chain"
spacing = 0.4
beads = 3
species = "fluid"
H = 100.0
CASE
molecule() { run chain --set "molecule.0.$1" "${@:2}"; }
expect_exit 0 molecule count=2 --out chained
expect_error 1 molecule shape=ring -- molecule shape 'chain, walk, simplex, points'
expect_error 1 molecule shape=octahedron -- molecule shape 'chain, walk, simplex, points'
expect_error 1 molecule shape=simplex --set molecule.0.radius=0.2 -- molecule radius spacing
expect_error 1 molecule shape=points -- molecule points
expect_error 1 molecule species=tail -- species "'tail'"
expect_error 1 molecule H=0.0 -- molecule H positive
expect_error 1 molecule r_0=-1.0 -- molecule r_0
expect_error 1 molecule r_max=2.0 -- r_max
expect_error 1 molecule law=fene -- molecule r_max
expect_error 1 molecule law=fene --set molecule.0.r_max=0.3 -- r_max 'out of its reach'
expect_error 1 molecule law=morse -- law 'harmonic, fene'
expect_error 1 molecule exclude=some -- exclude
expect_error 1 molecule spacing=50.0 -- 'half the box'
expect_error 1 molecule 'bond=[{between=[0, 3]}]' -- between 'from 0 to 2'
expect_error 1 molecule 'bond=[{between=[0, 1]}]' -- 'beads 0 and 2'
# What every bond gives itself, the molecule need not.
sed -i '/^H = /d' chain/case.toml
series=(--set 'observe=[{kind="thermo", every=1, series=true}]')
expect_exit 0 molecule 'bond=[{between=[0, 1], H=50.0}, {between=[1, 2], H=20.0}]' "${series[@]}" --out own
expect_exit 0 molecule 'bond=[{between=[0, 1]}, {between=[1, 2], H=20.0}]' --set molecule.0.H=50.0 "${series[@]}" --out common
expect cmp own/thermo_series.csv common/thermo_series.csv
expect_exit 0 molecule 'bond=[{between=[0, 1]}, {between=[1, 2], H=20.0}]' --set molecule.0.H=20.0 "${series[@]}" --out other
expect test -n "$(cmp own/thermo_series.csv other/thermo_series.csv)"
expect_exit 0 molecule law=fene --set 'molecule.0.bond=[{between=[0, 1], H=50.0, r_max=1.0}, {between=[1, 2], H=20.0, r_max=1.0}]' --out fene
expect_error 1 molecule 'bond=[{between=[0, 1], H=50.0}, {between=[1, 2]}]' -- molecule.0.bond.1.H missing
expect_error 1 molecule law=fene --set 'molecule.0.bond=[{between=[0, 1], H=50.0, r_max=1.0}, {between=[1, 2], H=20.0}]' -- bond.1.r_max missing
expect_error 1 molecule 'bond=[{between=[0, 1], H=-50.0}, {between=[1, 2], H=20.0}]' -- bond.0.H positive
expect_error 1 molecule count=2 -- H missing
printf 'H = 100.0\n' >>chain/case.toml
expect_exit 0 molecule bonds=sites --out tied
expect_error 1 molecule bonds=sites --set molecule.0.law=harmonic -- law sites
expect_error 1 molecule bonds=sites --set molecule.0.r_0=0.1 -- r_0 sites
expect_error 1 molecule bonds=sites --set molecule.0.shape=walk -- bonds 'a walk has no shape'
expect_error 1 molecule bonds=sites --set molecule.0.H=-1.0 -- H positive
expect_error 1 molecule bonds=sites --set molecule.0.shape=points --set 'molecule.0.points=[{at=[0.0, 0.0]}, {at=[0.0, 0.0]}]' -- shape 'turn freely'
expect_error 1 molecule bonds=frame -- bonds 'chain, all, sites'
expect_error 1 molecule 'positions=[{at=[1.0, 1.0]}]' --set molecule.0.count=2 -- count positions
expect_error 1 run box --set 'observe=[{kind="molecules"}]' -- kind '[[molecule]]'
expect_error 1 molecule count=2 --set 'observe=[{kind="molecules", bin=9.0}]' -- bin r_max
expect_error 1 molecule count=2 --set 'observe=[{kind="molecules", empty=1.0}]' -- empty 'below 1'
expect_error 1 run box --set bonds.file=bonds.csv -- bonds.file start.from
cp -r box joined
sed -i '/^density/d' joined/case.toml
printf 'x,y\n1.0,1.0\n1.5,1.0\n1.0,1.5\n' >joined/start.csv
joined() { run joined --set start.from=file --set start.file=start.csv --set bonds.file=bonds.csv "$@"; }
printf 'i,k\n0,1\n' >joined/bonds.csv
expect_error 1 joined -- bonds.csv "column 'j'"
printf 'i,j\n0,3\n' >joined/bonds.csv
expect_error 1 joined --set bonds.H=1.0 -- bonds.csv:2 'j = 3'
printf 'i,j\n0,1\n' >joined/bonds.csv
expect_error 1 joined -- bonds.csv:2 'particles 0 and 1' 'H = 0' bonds.H
expect_error 1 joined --set bonds.H=1.0 --set bonds.law=fene -- bonds.csv:2 'r_max = 0' bonds.r_max
printf 'i,j\n0,1\n1,0\n' >joined/bonds.csv
expect_error 1 joined --set bonds.H=1.0 -- 'bonded twice'
finish
