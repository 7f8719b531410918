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
finish
