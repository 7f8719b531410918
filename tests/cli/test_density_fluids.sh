#!/usr/bin/env bash
# model = "sdpd" and "mdpd": wrong cases, each with one message that tells what, where and the remedy; restarts; densities in files.
source "$(dirname "$0")/lib.sh" "$@"

mkdir sdpd mdpd
cat >sdpd/case.toml <<'CASE'
dimension = 2
seed = 7

[box]
size = [25.0, 25.0]
periodic = [true, true]

[fluid]
model = "sdpd"
density = 1.0
kT = 0.01
eta = 1.0
bulk_modulus = 1.0

[integrator]
dt = 0.2

[run]
duration = 4.0

[output]
checkpoint_every = 8
trajectory_every = 5
vtk_every = 10
pictures = false
CASE
sed -e 's/^size = .*/size = [12.0, 12.0]/' -e 's/"sdpd"/"mdpd"/' -e 's/^density = .*/density = 4.2\nmass = 0.1/' \
  -e 's/^kT = .*/kT = 1.0\nA = -40.0\nB = 25.0\nr_d = 0.75\ngamma = 4.5/' -e '/^eta/d' -e '/^bulk_modulus/d' \
  -e 's/^dt = .*/dt = 0.005/' -e 's/^duration = .*/duration = 0.1/' sdpd/case.toml >mdpd/case.toml
run() { "$odpd" run "$@"; }
line_of() { grep -n -- "$2" "$1/case.toml" | cut -d: -f1; }
# wrong MODEL SED-EXPRESSION -- TEXT...: that case with this change is refused.
wrong() {
  rm -rf changed
  mkdir changed
  sed -e "$2" "$1/case.toml" >changed/case.toml
  expect_error 1 run changed -- "${@:4}"
}
# after MODEL KEY LINE -- TEXT...: refused with this line after that of the key.
after() { wrong "$1" "s/^$2 = .*/&\n$3/" "${@:4}"; }

# --- sdpd ---
eta=$(line_of sdpd '^eta')
after sdpd eta 'kernel = "gauss"' -- "changed/case.toml:$((eta + 1))" fluid.kernel wendland-c2, quintic gauss
after sdpd eta 'kernel = "cubic-spline"' -- "changed/case.toml:$((eta + 1))" fluid.kernel pair wendland-c2
after sdpd eta 'support = 0.9' -- "changed/case.toml:$((eta + 1))" fluid.support spacings '3 is usual'
after sdpd eta 'a = 18.5' -- "changed/case.toml:$((eta + 1))" fluid.a DPD bulk_modulus support
after sdpd eta 'alpha = 2.0' -- fluid.alpha DPD
after sdpd eta 'form = "central"\nzeta_b = 1.0' -- "changed/case.toml:$((eta + 2))" fluid.zeta_b form never
after sdpd eta 'zeta_b = 2.5' -- fluid.zeta_b '(1 + 2/d) eta = 2'
after sdpd eta 'sound_speed = 2.0' -- "changed/case.toml:$((eta + 2))" fluid.bulk_modulus sound_speed 'one of the two'
wrong sdpd '/^bulk_modulus/d' -- changed/case.toml fluid.bulk_modulus sound_speed
wrong sdpd 's/^bulk_modulus.*/sound_speed = 2.0/' -- "changed/case.toml:$((eta + 1))" fluid.sound_speed mass bulk_modulus
wrong sdpd '/^eta/d' -- changed/case.toml fluid.eta missing
after sdpd eta 'tait_exponent = 7.0' -- "changed/case.toml:$((eta + 1))" fluid.tait_exponent equation_of_state '"tait"'
wrong sdpd 's/^size = .*/size = [25.0, 5.9]/' -- "changed/case.toml:$(line_of sdpd '^size')" box.size 'direction y' 'two cutoffs (6)' fluid.support
wrong sdpd 's/^dt = .*/dt = 6.0/; s/^duration = .*/duration = 60.0/' -- "changed/case.toml:$(line_of sdpd '^dt')" integrator.dt unstable 0.4
after sdpd dt 'name = "implicit"' -- integrator.name stiffness trapezoidal
# Names of this model alone are suggested.
after sdpd eta 'suport = 3.0' -- fluid.suport "'support'"
after sdpd eta 'viscosity = 3.0' -- fluid.viscosity
expect test "$(grep -c -w -e gamma -e s_bar -e cutoff "$err_text")" -eq 0

# --- mdpd ---
mass=$(line_of mdpd '^mass')
wrong mdpd 's/^mass = .*/mass = 0.0/' -- "changed/case.toml:$mass" fluid.mass turning 'filled = true' '1.11e+03 dt^2'
wrong mdpd '/^mass/d' -- changed/case.toml fluid.mass 'filled = true'
after mdpd gamma 'a = 18.5' -- fluid.a A B
after mdpd gamma 'eta = 18.5' -- fluid.eta mdpd
for key in A B r_d; do wrong mdpd "/^$key = /d" -- changed/case.toml "fluid.$key" missing; done
wrong mdpd 's/^size = .*/size = [1.9, 12.0]/' -- box.size 'direction x' 'two cutoffs (2)'
after mdpd dt 'name = "implicit"' -- integrator.name trapezoidal

# --- pairs of species ---
for model in sdpd mdpd; do
  sed -e 's/^\[integrator\]/[[species]]\nname = "A"\nfraction = 0.5\n\n[[species]]\nname = "B"\nfraction = 0.5\n\n&/' \
    -e '$a\\n[[pair]]\nspecies = ["A", "B"]' "$model/case.toml" >$model.toml
  mkdir $model-pair
  cp $model.toml $model-pair/case.toml
  after $model-pair species 'gama = 1.0' -- pair.0.gama
done
after sdpd-pair species 'support = 4.0' -- pair.0.support 'eta, species, zeta_b'
after sdpd-pair species 'gamma = 4.0' -- pair.0.gamma DPD
for key in B r_d; do after mdpd-pair species "$key = 1.0" -- "pair.0.$key" 'whole fluid' 'Give b'; done
wrong sdpd-pair 's/^species = .*/species = ["A"]/' -- pair.0.species 'two names'
wrong mdpd-pair 's/^species = .*/species = ["A", "C"]/' -- pair.0.species "'C'" 'A, B'

# --- restarts, with a change of threads ---
export OMP_WAIT_POLICY=passive
source "$source_root/tests/cli/restart.sh"
for case in sdpd sdpd:form=classical mdpd; do
  model=${case%%:*}
  settings=()
  [[ $case == *:* ]] && settings=(--set "fluid.${case#*:}")
  name=${case/:*=/_}
  expect_exit 0 run $model --threads 1 "${settings[@]}" --out $name-whole
  expect_exit 0 run $model --threads 2 "${settings[@]}" --set run.duration="$([ $model = sdpd ] && echo 2.4 || echo 0.06)" --out $name-parts
  expect_exit 0 run $model --threads 1 "${settings[@]}" --restart $name-parts/checkpoint.h5
  same_run $name-whole $name-parts files
done

# --- densities in trajectories and frames for ParaView, by their definition from the positions there; none for other models ---
write_periodic dpd
expect_exit 0 run dpd --out dpd-run --set output.vtk_every=10 --set output.trajectory_every=10
expect test -z "$(grep -l density dpd-run/frames/*.vtp)"
cat >densities.py <<'PYTHON'
import glob, sys, xml.etree.ElementTree as tree
import h5py
import numpy as np

def separations(r, edge):
    d = r[:, None, :] - r[None, :, :]
    d -= edge * np.round(d / edge)
    return np.sqrt((d**2).sum(axis=2))

def sdpd(r):
    q = separations(r, 25.0) / 3.0
    return np.where(q < 1.0, 7.0 / (np.pi * 9.0) * (1.0 - q)**4 * (1.0 + 4.0 * q), 0.0).sum(axis=1)

def mdpd(r):
    w = np.maximum(1.0 - separations(r, 12.0) / 0.75, 0.0)**2
    return 6.0 / (np.pi * 0.75**2) * (w.sum(axis=1) - 1.0)

for run, density in (("sdpd-whole", sdpd), ("mdpd-whole", mdpd)):
    frames = 0
    for file in sorted(glob.glob(run + "/trajectory.*.h5")):
        with h5py.File(file) as f:
            p = f["particles/all"]
            assert p["density/step"] == p["position/step"]
            for r, d in zip(p["position/value"], p["density/value"]):
                assert d.std() > 0.0 and np.abs(d - density(r)).max() < 1e-11, run
                frames += 1
    assert frames == 5, frames
    for file in sorted(glob.glob(run + "/frames/*.vtp")):
        piece = tree.parse(file).getroot().find("PolyData/Piece")
        numbers = lambda e: np.array([float(word) for word in e.text.split()])
        data = {e.get("Name"): numbers(e) for e in piece.findall("PointData/DataArray")}
        r = numbers(piece.find("Points/DataArray")).reshape(-1, 3)[:, :2]
        assert np.abs(data["density"] - density(r)).max() < 1e-11, file
with h5py.File(sorted(glob.glob("dpd-run/trajectory.*.h5"))[0]) as f:
    assert "density" not in f["particles/all"]
PYTHON
have_h5py && expect "$python" densities.py
finish
