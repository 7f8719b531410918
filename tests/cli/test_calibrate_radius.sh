#!/usr/bin/env bash
# `odpd calibrate --radius`: how large a body is, of a small disk; goes on where it stopped; what it prints is read by [[body]].
source "$(dirname "$0")/lib.sh" "$@"

write_periodic disks
cat >>disks/case.toml <<'CASE'

[[body]]
name = "disk"
shape = "disk"
radius = 0.5
rings = 1

[[body]]
name = "post"
shape = "square"
side = 0.2
motion = "fixed"
CASE
sed -i 's/^size = .*/size = [5.0, 5.0]/' disks/case.toml
quick=(--radius --boxes 4.5,6 --relative-error 0.05 --threads 1)

expect_exit 0 "$odpd" calibrate disks "${quick[@]}" --out found
expect_text "$out_text" 'fluid alone at density 4: eta = ' 'Hydrodynamic radius of disk: ' 'by torque: ' 'Excluded volume: ' '[[body]]' \
  'hydrodynamic_radius = 0.' 'excluded_volume = '
expect_text found/radius.json '"pure_fluid"' '"boxes"' '"result"' '"extrapolated"' '"torque_radius"'
expect test "$(wc -l <found/radius.csv)" -eq 3

# The lines it prints are keys of a case.
lines=()
for key in hydrodynamic_radius excluded_volume; do
  lines+=(--set "body.0.$key=$(sed -n "s/^$key = \([0-9.]*\) .*/\1/p" "$out_text")")
done
# Seven particles of the fluid would take 1.75.
expect awk "BEGIN { v = ${lines[3]##*=}; exit !(0.5 < v && v < 3.0) }"
expect_exit 0 "$odpd" run disks --dry-run "${lines[@]}"
expect_text "$out_text" 'Suspension' 'disk            1 bodies: number fraction = 0.06' 'hydrodynamic fraction = 0.0'
expect_exit 0 "$odpd" run disks --dry-run
expect test -z "$(grep Suspension "$out_text")"

# The same command measures nothing again; a smaller error does; another fluid starts anew.
cp found/radius.json first.json
expect_exit 0 "$odpd" calibrate disks "${quick[@]}" --out found
expect cmp found/radius.json first.json
expect_exit 4 "$odpd" calibrate disks --radius --boxes 4.5,6 --relative-error 0.002 --limit-seconds 0.001 --threads 1 --out found
expect_text "$err_text" 'odpd: error: --limit-seconds' 'goes on from there'
# What was there stays, also where other boxes are asked for.
expect cmp found/radius.json first.json
expect_exit 4 "$odpd" calibrate disks --radius --boxes 7.5,9 --relative-error 0.01 --limit-seconds 0.001 --threads 1 --out found
expect cmp found/radius.json first.json
expect_exit 0 "$odpd" calibrate disks --radius --boxes 6,7.5 --relative-error 0.05 --threads 1 --out found
expect_text found/radius.json '"edge": 4.5' '"edge": 6.0' '"edge": 7.5' '"result"'
expect test -z "$(ls -d found.1 2>/dev/null)"
expect_exit 4 "$odpd" calibrate disks "${quick[@]}" --limit-seconds 0.001 --set fluid.gamma=5.0 --out found
expect_text "$err_text" 'of another fluid or body'
expect test -f found.1/radius.json

# Bad input.
expect_error 1 "$odpd" calibrate disks --radius plate -- "key 'body'" '--radius plate' 'but disk'
expect_error 1 "$odpd" calibrate disks --radius --set body.0.motion=fixed -- 'there is none here'
expect_error 1 "$odpd" calibrate disks --radius --set body.1.motion=free -- 'say which one' '--radius disk' 'disk, post are free'
expect_error 1 "$odpd" calibrate disks --radius --boxes 2.5 -- --boxes 'an edge of 2.5' 'longer than 3'
expect_exit 4 "$odpd" calibrate disks --radius --boxes 4.5,5 --limit-seconds 0.001 --out odd
expect_text "$err_text" 'warning: --boxes: 5 is no whole multiple of 1.5' '6 is'
expect_error 1 "$odpd" calibrate disks --radius --set fluid.mass=1.0 -- fluid.mass '--set fluid.mass=0.0'
expect_error 1 "$odpd" calibrate disks --radius --set body.0.count=2 --set body.0.radius='[0.4, 0.5]' -- body.0.radius 'several radii'
expect_error 1 "$odpd" calibrate disks --radius --eta 5.0 -- --radius --eta
expect_error 1 "$odpd" calibrate disks --boxes 4 -- --boxes --radius
expect_error 1 "$odpd" calibrate disks --radius --find cutoff -- --find --wanted
expect_error 1 "$odpd" calibrate disks --radius --find cutoff --wanted 0.5 -- "key 'pair'" "there is no [[pair]] of 'fluid' with the fluid"
# Two kinds of colloids: a [[pair]] of the two is none with the fluid.
sed -e '/^\[\[body\]\]/,$d' disks/case.toml >two.toml
cat >>two.toml <<'CASE'
[[species]]
name = "solvent"
[[species]]
name = "small"
count = 0
[[species]]
name = "large"
count = 0
[[pair]]
species = ["large", "small"]
cutoff = 0.8
[[molecule]]
name = "ball"
species = "small"
shape = "particle"
count = 1
clearance = 1.0
CASE
expect_error 1 "$odpd" calibrate two.toml --radius --find cutoff --wanted 0.5 -- "key 'pair'" "there is no [[pair]] of 'small' with the fluid"
expect_error 1 "$odpd" run disks --dry-run --set body.0.hydrodynamic_radius=-1.0 -- body.0.hydrodynamic_radius positive
expect_error 1 "$odpd" run disks --dry-run --set body.0.hydrodynamic_radius=3.0 -- body.0.hydrodynamic_radius 28.2743 'odpd calibrate --radius'
expect_error 1 "$odpd" run disks --dry-run --set body.0.excluded_volume=25.0 -- body.0.excluded_volume 'of the 25 of space'
expect_error 1 "$odpd" run disks --dry-run --set body.0.fraction=0.1 --set body.0.fraction_of=hydrodynamic -- fraction hydrodynamic_radius
expect_exit 0 "$odpd" calibrate --help
expect_text "$out_text" --radius --boxes
finish
