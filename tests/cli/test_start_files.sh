#!/usr/bin/env bash
# Start files as other programs write them: separators, quotes, upper case, numbers of species. What is clear is taken as
# it is meant, the rest is asked for by one message that says what was found.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
sed -i '/^density/d; s/^equilibrate.*//; s/^duration.*/duration = 0.02/' box/case.toml
cat >>box/case.toml <<'CASE'

[start]
from = "file"
file = "start.csv"

[output]
pictures = false

[[observe]]
kind = "thermo"
every = 1
series = true
CASE
run() { "$odpd" run box "$@"; }
# start FILE ARGUMENTS...: a run that starts from it.
start() { run --set "start.file=\"$1\"" "${@:2}"; }
{
  printf 'x,y\n'
  for x in 0.3 1.1 1.7 2.3 3.1 3.7; do for y in 0.2 0.7 1.5 2.2 3.0 3.6; do printf '%s,%s\n' $x $y; done; done
} >box/start.csv
expect_exit 0 run --out plain

# --- separators, quotes, case: the same particles, so the same bits ---
tr ',' ';' <box/start.csv >box/semicolons.csv
tr ',' '\t' <box/start.csv >box/tabs.csv
sed 's/x,y/"x","y"/' box/start.csv >box/quoted.csv
sed 's/\([^,]*\),\(.*\)/"\1";"\2"/' box/start.csv >box/all_quoted.csv
sed 's/x,y/X,Y/; s/$/\r/' box/start.csv >box/upper.csv
for name in semicolons tabs quoted all_quoted upper; do
  expect_exit 0 start $name.csv --out $name
  expect cmp plain/thermo_series.csv $name/thermo_series.csv
done
expect test "$(wc -l <plain/thermo_series.csv)" -eq 5

# --- what cannot be taken: the message tells what was found, and where ---
tr ',' ' ' <box/start.csv >box/spaces.csv
sed '1d' box/start.csv >box/headless.csv
sed '1s/^/# /' box/start.csv >box/comment.csv
sed 's/x,y/x (nm),y (nm)/' box/start.csv >box/units.csv
sed 's/,/;/; s/\./,/g' box/start.csv >box/decimals.csv
sed '1s/,/;/' box/start.csv >box/mixed.csv
sed 's/^0.3/"0.3/' box/start.csv >box/open.csv
expect_error 1 start spaces.csv -- spaces.csv "'x y'" 'not by spaces'
expect_error 3 start headless.csv -- headless.csv:1 '0.3, 0.2' 'a line of names'
expect_error 3 start comment.csv -- comment.csv:2 '0.3, 0.2' 'without a #'
expect_error 1 start units.csv -- units.csv "'x'" "'x (nm)', 'y (nm)'" 'a start file needs x, y'
expect_error 1 start decimals.csv -- decimals.csv:2 "'0,3'" 'with a point'
expect_error 3 start mixed.csv -- mixed.csv:2 'separated by semicolons'
expect_error 3 start open.csv -- open.csv:2 quote

# --- the file of bonds is read by the same rules ---
printf '"I"\t"J"\t"H"\n0\t1\t10.0\n' >box/tabs_bonds.csv
printf 'first,second\n0,1\n' >box/named_bonds.csv
expect_exit 0 run --set bonds.file=tabs_bonds.csv --out bonded
expect_error 1 run --set bonds.file=named_bonds.csv -- named_bonds.csv "'i'" "'first', 'second'" 'H, r_0, r_max'

# --- numbers of species ---
two='species=[{name="A", fraction=0.5}, {name="B", fraction=0.5}]'
three='species=[{name="A", fraction=0.5}, {name="B", fraction=0.5}, {name="C", count=0}]'
numbered() { awk -F, -v from="$1" 'NR == 1 { print $0 ",Species" } NR > 1 { print $0 "," from + NR % 2 }' box/start.csv; }
numbered 0 >box/from_0.csv
numbered 1 >box/from_1.csv
numbered 0 | awk -F, 'NR > 1 { $3 = $3 == 0 ? "A" : "B" } { print $1 "," $2 "," $3 }' >box/named.csv
awk 'NR == 1 { print $0 ",species" } NR > 1 { print $0 ",1" }' box/start.csv >box/all_1.csv
strong='pair=[{species=["A", "B"], a=60.0}]'
expect_exit 0 start named.csv --set "$two" --set "$strong" --out species
expect_exit 0 start from_0.csv --set "$two" --set "$strong" --out species_from_0
expect cmp species/thermo_series.csv species_from_0/thermo_series.csv
# Of two species or of three: none is taken in silence.
for case in "$two" "$three"; do
  expect_error 1 start from_1.csv --set "$case" --set "$strong" -- from_1.csv 'numbers from 1 on' LAMMPS \
    "start.first_species = 1 (then 1 is 'A')"
done
expect_exit 0 start from_1.csv --set "$two" --set "$strong" --set start.first_species=1 --out species_from_1
expect cmp species/thermo_series.csv species_from_1/thermo_series.csv
expect_exit 0 start from_1.csv --set "$three" --set 'pair=[{species=["B", "C"], a=60.0}]' --set start.first_species=0 --out species_of_3
expect cmp species/thermo_series.csv species_of_3/thermo_series.csv
expect_error 1 start from_1.csv --set "$two" --set start.first_species=0 -- from_1.csv:3 "'2'" 'numbered from 0'
expect_error 1 start from_0.csv --set "$two" --set start.first_species=1 -- from_0.csv:2 "'0'" 'numbered from 1'
expect_error 1 start from_1.csv --set start.first_species=1 -- from_1.csv:3 "'2'"
# One species and one number leave no choice.
expect_exit 0 start all_1.csv --out only
expect cmp plain/thermo_series.csv only/thermo_series.csv

# --- the same of H5MD, as LAMMPS dumps it: types from 1, no names ---
if have_h5py; then
  "$python" - <<'SCRIPT'
import h5py, numpy as np
rows = np.loadtxt('box/from_1.csv', delimiter=',', skiprows=1)
with h5py.File('box/lammps.h5', 'w') as f:
    f.create_group('h5md').attrs['version'] = [1, 0]
    all = f.create_group('particles/all')
    box = all.create_group('box')
    box.attrs['boundary'] = [b'periodic', b'periodic']
    box['edges/value'] = [[4.0, 4.0]]
    all['position/value'] = [rows[:, :2]]
    all['species/value'] = [rows[:, 2].astype(int)]
SCRIPT
  expect_error 1 start lammps.h5 --set "$two" --set "$strong" -- lammps.h5 'numbers from 1 on' start.first_species
  expect_exit 0 start lammps.h5 --set "$two" --set "$strong" --set start.first_species=1 --out dumped
  expect cmp species/thermo_series.csv dumped/thermo_series.csv
  # odpd's own files name their species.
  own=$(find species -name 'trajectory.*.h5' | tail -n 1)
  expect_exit 0 start "$PWD/$own" --set "$two" --set "$strong" --out own
else
  skip 'H5MD species: there is no h5py'
fi
finish
