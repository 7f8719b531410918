#!/usr/bin/env bash
# `odpd calibrate`: finds a friction, which measured again gives the viscosity; goes on where it stopped; its file sets the
# friction of a case, and of no other fluid.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
small=(--particles 64 --threads 1)
quick=(--relative-error 0.1 "${small[@]}")

# number FILE PATH...: a number of a JSON file.
number() { "$python" -c 'import json, sys
value = json.load(open(sys.argv[1]))
for key in sys.argv[2:]: value = value[int(key) if isinstance(value, list) else key]
print(value)' "$@"; }
# true_of EXPRESSION NAME=VALUE...
true_of() { "$python" -c 'import sys
for pair in sys.argv[2:]:
    name, value = pair.split("=")
    globals()[name] = float(value)
sys.exit(0 if eval(sys.argv[1]) else sys.argv[1:])' "$@"; }

expect_exit 0 "$odpd" calibrate box --eta 5.0 "${quick[@]}" --out found
expect_text "$out_text" 'gives eta = 5' '[fluid]' 'gamma = ' '# measured: eta = 5' 'twice that of the measurements'
expect_text found/calibration.json '"measurements"' '"shear_rate"' '"result"' '"gamma_stderr"'
cp "$out_text" first.txt

# The same friction again, by other random numbers.
have_python || { skip "the numbers need $python"; finish; }
gamma=$(number found/calibration.json result gamma)
error=$(number found/calibration.json result eta_stderr)
expect true_of '0 < error <= 0.5' error="$error"
expect_exit 0 "$odpd" calibrate box --measure-only "${small[@]}" --set fluid.gamma="$gamma" --set seed=99 \
  --relative-error 0.05 --out again
expect_text "$out_text" ': eta = '
again=$(number again/calibration.json measurements 0 eta)
again_error=$(number again/calibration.json measurements 0 eta_stderr)
expect true_of 'abs(again - 5) < 3.5 * (error**2 + again_error**2)**0.5' again="$again" error="$error" \
  again_error="$again_error"
# Kinetic theory's friction would not pass: it is off by more than that.
expect true_of 'abs(gamma - affine) > 0.01 * affine' gamma="$gamma" affine="$("$python" -c 'print(4.5 * 5 / 2.87231)')"

# Nothing is measured twice, and a smaller error goes on from what is there.
expect_exit 0 "$odpd" calibrate box --eta 5.0 "${quick[@]}" --out found
expect true_of 'gamma == before' gamma="$(number found/calibration.json result gamma)" before="$gamma"
expect test -z "$(ls -d found.1 2>/dev/null)"
before=$("$python" -c 'import json; print(len(json.load(open("found/calibration.json"))["measurements"]))')
# Out of time: what is there stays, and the same command goes on to the end.
expect_exit 4 "$odpd" calibrate box --eta 5.0 --particles 64 --relative-error 0.015 --limit-seconds 0.001 --out found
expect_text "$err_text" 'odpd: error: --limit-seconds' 'goes on from there'
expect_exit 0 "$odpd" calibrate box --eta 5.0 --particles 64 --relative-error 0.015 --out found
after=$("$python" -c 'import json; print(len(json.load(open("found/calibration.json"))["measurements"]))')
expect true_of 'after > before' after="$after" before="$before"
expect true_of 'error <= 0.015 * 5' error="$(number found/calibration.json result eta_stderr)"
gamma=$(number found/calibration.json result gamma)

# Another fluid does not mix with it.
expect_exit 4 "$odpd" calibrate box --eta 6.0 "${quick[@]}" --limit-seconds 0.001 --out found
expect_text "$err_text" 'another calibration: eta was 5 and is 6'
expect test -f found.1/calibration.json

# A case by its viscosity takes the friction from the file, also where it is read from the directory of a run.
write_periodic asked
sed -i '/^gamma/d; s/^density.*/density = 4.0\neta = 5.0\ncalibration = "..\/found.1\/calibration.json"/' asked/case.toml
expect_exit 0 "$odpd" run asked --dry-run
expect_text "$out_text" "gamma = $("$python" -c "print('%.6g' % $gamma)")" 'calibrated' 'measured to give eta = 5.0'
expect_exit 0 "$odpd" run asked --quiet --out run
expect_text run/summary.json '"calibration"' '"gamma_stderr"'
expect_exit 0 "$odpd" run run/case.toml --dry-run
expect_exit 0 "$odpd" run asked --restart run/checkpoint.h5 --set run.duration=0.2 --quiet
sed 's/"gamma": [0-9.]*,/"gamma": 7.0,/' found.1/calibration.json >found.1/other.json
# A restart keeps the friction of its checkpoint, whatever became of the file.
friction() { "$python" -c 'import json, sys; print(json.load(open(sys.argv[1]))["fluid"])' "$1/summary.json"; }
expect_exit 0 "$odpd" run asked --restart run/checkpoint.h5 --set run.duration=0.3 --quiet \
  --set 'fluid.calibration="../found.1/other.json"' --out other_file
expect test "$(friction run | grep -c "$gamma")" -eq 1 -a "$(friction run | sed 's/other.json/calibration.json/')" = \
  "$(friction other_file | sed 's/other.json/calibration.json/')"
expect_exit 0 "$odpd" run asked --restart run/checkpoint.h5 --set run.duration=0.3 --quiet \
  --set 'fluid.calibration="nowhere.json"' --out no_file

for change in density=4.1 kT=1.1 a=19.0 s_bar=1.1 s=0.6 cutoff=1.1 mass=0.1 eta=5.1; do
  expect_error 1 "$odpd" run asked --dry-run --set fluid.$change -- "fluid.${change%%=*}" 'was measured for' 'odpd calibrate'
done
expect_error 1 "$odpd" run asked --dry-run --set 'fluid.rattler_friction={gamma=0.1,cutoff=2.0}' -- rattler_friction 'was measured for'
expect_error 1 "$odpd" run asked --dry-run --set 'fluid.calibration="nowhere.json"' -- fluid.calibration nowhere.json 'odpd calibrate'
expect_error 1 "$odpd" run asked --dry-run --set 'fluid.calibration="../again/calibration.json"' -- fluid.calibration 'holds no friction'
expect_error 1 "$odpd" run box --dry-run --set 'fluid.calibration="../found.1/calibration.json"' -- fluid.calibration 'give eta'
# Such a case can be calibrated itself.
expect_exit 4 "$odpd" calibrate asked "${quick[@]}" --limit-seconds 0.001 --out itself
expect_text itself/calibration.json '"eta": 5.0'

# An SDPD fluid: the eta to ask for, so that what is measured is the one wanted.
mkdir -p sdpd
cat >sdpd/case.toml <<'END'
dimension = 2
[box]
size = [12.0, 12.0]
periodic = [true, true]
[fluid]
model = "sdpd"
density = 1.0
kT = 0.01
eta = 1.0
bulk_modulus = 1.0
background_pressure = 0.0
[integrator]
dt = 0.2
[run]
duration = 1.0
END
expect_exit 0 "$odpd" calibrate sdpd --relative-error 0.08 --particles 144 --threads 1 --out sdpd_found
expect_text "$out_text" 'gives eta = 1.0' 'model = "sdpd"' 'background_pressure = 0' 'eta = 1.'
found=$(number sdpd_found/calibration.json result fluid.eta)
# Without background pressure this fluid has 0.82 of what it is asked for (docs/density-fluids.md).
expect true_of 'abs(found * 0.82 - 1) < 0.28' found="$found"
expect true_of 'found > 1' found="$found"
expect_exit 4 "$odpd" calibrate sdpd --relative-error 0.08 --particles 144 --threads 1 --limit-seconds 0.001 --out sdpd_found \
  --set fluid.support=3.5
expect_text "$err_text" 'another calibration: the fluid was' 'support = 3.5'
expect_error 1 "$odpd" run sdpd --dry-run --set 'fluid.calibration="../found.1/calibration.json"' -- fluid.calibration 'odpd calibrate'
expect_error 1 "$odpd" calibrate sdpd --set fluid.zeta_b=1.0 -- fluid.zeta_b fluid.form

# Bad input.
expect_error 1 "$odpd" calibrate box -- fluid.eta --eta --measure-only
expect_error 1 "$odpd" calibrate box --eta 5.0 --measure-only -- --measure-only 'calibrate --help'
expect_error 1 "$odpd" calibrate box --eta -1 -- --eta
expect_error 1 "$odpd" calibrate box --eta 5 --relative-error 0 -- --relative-error
expect_error 1 "$odpd" calibrate box --eta 5 --particles 16 -- --particles 'three cutoffs'
expect_error 1 "$odpd" calibrate box --eta 5 --set fluid.kT=0.0 -- fluid.kT
expect_error 1 "$odpd" calibrate box --eta 5 --set fluid.gamma_perp=1.0 -- fluid.gamma_perp
expect_error 1 "$odpd" calibrate box --eta 5 --set fluid.b=1.0 -- fluid.b
expect_exit 0 "$odpd" calibrate --help
expect_text "$out_text" --eta --relative-error --shear-rate --limit-seconds --measure-only
finish
