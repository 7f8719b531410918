#!/usr/bin/env bash
# Restarts and the files that are there: refused with nothing touched; continued, with the files of a run that was never
# stopped; and from the checkpoint alone, without the files that the case was made from.
source "$(dirname "$0")/lib.sh" "$@"
source "$source_root/tests/cli/restart.sh"
run() { "$odpd" run "$@" --threads 1; }

write_periodic box
cat >>box/case.toml <<'CASE'

[output]
checkpoint_every = 8
trajectory_every = 3
vtk_every = 16
pictures = false

[[observe]]
kind = "thermo"
every = 2
series = true

[[observe]]
kind = "rdf"
every = 4
CASE
sed -i 's/^duration = .*/duration = 0.45/' box/case.toml # 100 steps
expect_exit 0 run box --out whole

# --- a finished run is as it was after every refusal ---
# refused DIRECTORY ARGUMENTS... -- TEXT...: a restart in a copy of the finished run, changed by `spoil`.
refused() {
  rm -rf spoilt && cp -r whole spoilt
  (cd spoilt && eval "$1")
  rm -rf before && cp -r spoilt before
  shift
  expect_error "$@"
  expect diff -r before spoilt
}
longer=(run box --restart spoilt/checkpoint.h5 --set run.duration=0.5)
refused 'rm thermo_series.csv' 3 "${longer[@]}" -- spoilt/thermo_series.csv 'is missing' --out
refused 'head -n 3 ../whole/thermo_series.csv >thermo_series.csv' 3 "${longer[@]}" -- thermo_series.csv 'was cut' --out
refused 'rm thermo_series.csv && mkdir thermo_series.csv' 3 "${longer[@]}" -- thermo_series.csv
refused 'rm .odpd-run thermo_series.csv' 3 "${longer[@]}" -- 'is missing' --out
refused : 1 run box --restart spoilt/checkpoint.h5 --set run.duration=0.4 -- run.duration
refused : 1 run box --restart spoilt/checkpoint.h5 --set fluid.a=10.0 -- fluid.a
# The checkpoint alone, away from its run: only into a new directory.
mkdir alone && cp whole/checkpoint.h5 alone
expect_error 3 run box --restart alone/checkpoint.h5 --set run.duration=0.5 -- alone/thermo_series.csv --out
expect test "$(ls -A alone)" = checkpoint.h5
expect_exit 0 run box --restart alone/checkpoint.h5 --set run.duration=0.5 --out from_alone

# --- continued: the summary of the part before is gone once there is a new one ---
cp -r whole goes_on
expect_exit 0 run box --restart goes_on/checkpoint.h5 --set run.duration=0.5
expect test -s goes_on/summary.json -a ! -e goes_on/summary.previous.json

# --- stopped anywhere and continued: every file is that of the run that was not ---
# names DIRECTORY: of all its files.
names() { (cd "$1" && find . -type f | sort); }
# same_files DIRECTORY: it has the files of the whole run.
same_files() {
  same_run whole "$1" files
  expect diff <(names whole) <(names "$1")
  expect cmp whole/particles.pvd "$1/particles.pvd"
  expect diff -r whole/frames "$1/frames"
}
# at SIGNAL STEPS DIRECTORY: stopped by a signal after about so many steps.
at() {
  local signal=$1 steps=$2 directory=$3 tries=0
  "$odpd" run box --threads 1 --out "$directory" >/dev/null 2>"$err_text" &
  local pid=$!
  until [ "$(cat "$directory/frames/"*.vtp 2>/dev/null | grep -c TimeValue)" -ge "$steps" ] || [ $((tries += 1)) -gt 2000 ]; do
    sleep 0.002
  done
  kill "-$signal" $pid 2>/dev/null
  wait $pid 2>/dev/null
}
for steps in 1 3; do
  for signal in KILL INT; do
    at $signal $steps "$signal$steps" 2>/dev/null
    expect_exit 0 run box --restart "$signal$steps/checkpoint.h5"
    same_files "$signal$steps"
  done
done
# At chosen steps, between two frames, two checkpoints and on one of either: by its length, which leaves what Ctrl-C leaves.
for duration in 0.005 0.11 0.27 0.405; do
  expect_exit 0 run box --set run.duration=$duration --out "part$duration"
  expect_exit 0 run box --restart "part$duration/checkpoint.h5"
  same_files "part$duration"
done
# From an older checkpoint in the same directory.
expect_exit 0 run box --set run.duration=0.11 --out early
cp -r whole rewound && cp early/checkpoint.h5 rewound/early.h5
expect_exit 0 run box --restart rewound/early.h5
rm rewound/early.h5
same_files rewound

# --- from the checkpoint alone ---
write_periodic mixed
sed -i '/^density/d' mixed/case.toml
cat >>mixed/case.toml <<'CASE'

[[species]]
name = "a"
fraction = 0.75

[[species]]
name = "b"
fraction = 0.25

[start]
from = "file"
file = "few.csv"

[[observe]]
kind = "rdf"
every = 5

[[observe]]
kind = "msd"
window = 0.05
every = 1
CASE
# start_csv EVERY: 64 particles on a grid, one of so many of species b.
start_csv() {
  printf 'x,y,species\n'
  local k species
  for ((k = 0; k < 64; k++)); do
    species=a
    [ $((k % $1)) -eq 0 ] && species=b
    printf '%d.%d,%d.%d,%s\n' $((k / 16)) $((k / 8 % 2 * 5)) $((k % 8 / 2)) $((k % 2 * 5)) $species
  done
}
start_csv 4 >mixed/few.csv
start_csv 3 >mixed/many.csv
expect_exit 0 run mixed --out mixed_whole
expect_exit 0 run mixed --set run.duration=0.07 --out mixed_part
cp mixed_part/checkpoint.h5 mixed_checkpoint.h5
expect_exit 0 run mixed --set title=renamed --restart mixed_checkpoint.h5 --out renamed
expect_exit 0 run mixed --set 'start.file="many.csv"' --restart mixed_part/checkpoint.h5
same_run mixed_whole mixed_part
# Without the file, and without the case: what it was is in the checkpoint.
mv mixed/few.csv hidden.csv
expect_exit 0 run mixed --restart mixed_checkpoint.h5 --out mixed_again
same_run mixed_whole mixed_again anew
expect_exit 0 run mixed_again --restart mixed_again/checkpoint.h5 --set run.duration=0.2
expect_error 3 run mixed -- few.csv
expect_error 1 run mixed --restart mixed_checkpoint.h5 --set start.from=random --set fluid.count=64 --out never -- start.from
expect_error 1 run mixed --restart mixed_checkpoint.h5 --set 'box.size=[3.0, 4.0]' --out never -- box.size '[4.0, 4.0]'
expect test ! -e never
mv hidden.csv mixed/few.csv
# Bonds from a file, restarted from anywhere.
cp -r mixed joined
printf 'i,j,r_0\n0,1,0.5\n1,17,0.7\n' >joined/bonds.csv
printf '\n[bonds]\nfile = "bonds.csv"\nH = 50.0\n' >>joined/case.toml
expect_exit 0 run joined --out joined_whole
expect_exit 0 run joined --set run.duration=0.07 --out joined_part
cp joined_part/checkpoint.h5 joined.h5
expect_exit 0 run joined_part --restart joined_part/checkpoint.h5
expect_exit 0 run joined --restart joined_part/checkpoint.h5
same_run joined_whole joined_part
# The bonds of the checkpoint go on, whatever became of their file.
printf 'i,j,r_0\n0,1,0.5\n1,18,0.7\n' >joined/bonds.csv
expect_exit 0 run joined --restart joined.h5 --out joined_changed
same_run joined_whole joined_changed anew
rm joined/bonds.csv joined/few.csv
expect_exit 0 run joined --restart joined.h5 --out joined_gone
same_run joined_whole joined_gone anew
expect_error 1 run joined --restart joined.h5 --set bonds.H=60.0 --out never -- bonds.H
expect_error 1 run mixed --restart joined.h5 --out never -- "'bonds." absent
# Bodies, whose places the file has, in a sheared cell whose images it has displaced.
cp -r box sheared
cat >>sheared/case.toml <<'CASE'

[shear]
rate = 5.0

[[body]]
shape = "ring"
radius = 0.3
points_on_ring = 4
count = 3
CASE
sed -i '/^series/d; s/^duration = .*/duration = 0.1/' sheared/case.toml
expect_exit 0 run sheared --out stretched
cp "$(find stretched -name 'trajectory.*.h5' | sort | tail -n 1)" frames.h5
sed -i '/^density/d' sheared/case.toml
start=(--set start.from=file --set "start.file=\"$work/frames.h5\"")
expect_exit 0 run sheared "${start[@]}" --out sheared_whole
expect_exit 0 run sheared "${start[@]}" --set run.duration=0.03 --out sheared_part
rm frames.h5
expect_exit 0 run sheared "${start[@]}" --restart sheared_part/checkpoint.h5
same_run sheared_whole sheared_part files
finish
