# Shared by the tests of the program. Each test begins with
#     source "$(dirname "$0")/lib.sh" "$@"
# where the arguments are the program and the root of the sources, and ends with `finish`.
# It works in a directory of its own, which is removed at the end.

set -u
export LC_ALL=C
odpd=$(realpath "$1")
source_root=$(realpath "$2")
test_name=$(basename "$0" .sh)
checks=0
failures=0
scratch=$(mktemp -d)
trap 'cd /; rm -rf "$scratch"' EXIT
work=$scratch/work
mkdir "$work" && cd "$work" || exit 1
# Standard output and standard error of the last expect_exit.
out_text=$scratch/stdout
err_text=$scratch/stderr

python=/usr/bin/python3
have_python() { [ -x "$python" ]; }
have_h5py() { have_python && "$python" -c 'import h5py' 2>/dev/null; }

fail() {
  failures=$((failures + 1))
  printf '%s: FAILED: %s\n' "$test_name" "$*"
}

skip() { printf '%s: skipped: %s\n' "$test_name" "$*"; }

# Ends the test: non-zero when anything failed.
finish() {
  printf '%s: %d checks, %d failed\n' "$test_name" "$checks" "$failures"
  [ "$failures" -eq 0 ]
  exit
}

show_texts() {
  sed 's/^/    stdout: /' "$out_text" | tail -n 5
  sed 's/^/    stderr: /' "$err_text" | tail -n 5
}

# expect_exit CODE COMMAND...: runs it; its output goes to $out_text and $err_text.
expect_exit() {
  local wanted=$1 code
  shift
  "$@" >"$out_text" 2>"$err_text"
  code=$?
  checks=$((checks + 1))
  [ "$code" -eq "$wanted" ] && return
  fail "exit code $code instead of $wanted: $*"
  show_texts
}

# expect_text FILE TEXT...: the file holds every one of the texts, literally.
expect_text() {
  local file=$1 text
  shift
  for text in "$@"; do
    checks=$((checks + 1))
    grep -qF -- "$text" "$file" && continue
    fail "'$text' is not in ${file##*/}, which reads"
    head -n 8 "$file" | sed 's/^/    /'
  done
}

# expect CONDITION-COMMAND...: it succeeds. The last failure is described by the command itself.
expect() {
  checks=$((checks + 1))
  "$@" >"$scratch/expect" 2>&1 && return
  fail "not true: $*"
  head -n 8 "$scratch/expect" | sed 's/^/    /'
}

# The last expect_exit wrote one line "odpd: error: ..." and nothing else: no line on standard output,
# beside it at most information and warnings.
expect_one_error() {
  checks=$((checks + 1))
  local errors others
  errors=$(grep -c '^odpd: error: ' "$err_text")
  others=$(grep -cvE '^odpd: (error|warning|info): |^step [0-9]+/' "$err_text")
  [ "$errors" -eq 1 ] && [ "$others" -eq 0 ] && [ ! -s "$out_text" ] && return
  fail "one line 'odpd: error: ...' on stderr and nothing on stdout was expected"
  show_texts
}

# expect_error CODE COMMAND... -- TEXT...: it fails with one message that holds all the texts.
expect_error() {
  local wanted=$1 command=()
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    command+=("$1")
    shift
  done
  shift
  expect_exit "$wanted" "${command[@]}"
  expect_one_error
  grep '^odpd: error: ' "$err_text" >"$scratch/message"
  expect_text "$scratch/message" "$@"
}

# write_periodic DIRECTORY: a case of 64 particles in a periodic box, 40 steps.
write_periodic() {
  mkdir -p "$1"
  cat >"$1/case.toml" <<'CASE'
title = "a small periodic box"
dimension = 2
seed = 7

[box]
size = [4.0, 4.0]
periodic = [true, true]

[fluid]
density = 4.0
kT = 1.0
a = 18.5
gamma = 4.5

[integrator]
dt = 0.005

[run]
equilibrate = 0.05
duration = 0.15
CASE
}

# write_walled DIRECTORY: a case of 48 fluid and 36 wall particles, 40 steps.
write_walled() {
  mkdir -p "$1"
  cat >"$1/case.toml" <<'CASE'
title = "a small channel"
dimension = 2
seed = 7

[box]
size = [4.0, 5.0]
periodic = [true, false]

[fluid]
density = 4.0
kT = 1.0
a = 18.5
gamma = 4.5

[[wall]]
side = "y-"
velocity = [-1.0, 0.0]
layers = [{ depth = 0.0, count = 12 }, { depth = 0.5, count = 6 }]

[[wall]]
side = "y+"
velocity = [1.0, 0.0]
layers = [{ depth = 0.0, count = 12 }, { depth = 0.5, count = 6 }]

[integrator]
dt = 0.005

[run]
equilibrate = 0.05
duration = 0.15
CASE
}
