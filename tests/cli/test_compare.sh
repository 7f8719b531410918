#!/usr/bin/env bash
# `odpd compare`: every backend solves the same frozen step to the tolerance asked for.
source "$(dirname "$0")/lib.sh" "$@"

write_walled channel
solvers=pcg,eigen-cg,cholmod,picard,picard-deflated
expect_exit 0 "$odpd" info
expect_text "$out_text" odpd picard picard-deflated pcg eigen-cg cholmod trapezoidal euler processors
grep -q '^ *solvers .*petsc' "$out_text" && solvers=$solvers,petsc
compare() { "$odpd" compare "$@"; }

expect_exit 0 compare channel --solvers "$solvers" --tolerance 1e-6,1e-3 --steps 10 --out all
expect_text "$out_text" 'a small channel' '96 unknowns' 'in all' ${solvers//,/ }
for name in ${solvers//,/ }; do
  expect test "$(grep -c "^$name,1e-06,1," all/compare.csv)" -eq 1
  expect test "$(grep -c "^$name,0.001,1," all/compare.csv)" -eq 1
done
expect test "$(wc -l <all/compare.csv)" -eq $((1 + 2 * $(tr , '\n' <<<"$solvers" | wc -l)))
expect test -s all/case.toml
if command -v gnuplot >/dev/null; then
  for kind in svg png gp; do expect test -s "all/compare.$kind"; done
fi
cat >table.py <<'PYTHON'
import csv, sys
for row in csv.DictReader(open(sys.argv[1])):
    tolerance, residual = float(row["tolerance"]), float(row["residual"])
    assert row["converged"] == "1" and 0.0 <= residual <= tolerance, row
    # The error in v is the residual times at most the condition of R, which a gap of factors 1e4 more than covers.
    assert 0.0 <= float(row["velocity_error"]) <= 1e4 * tolerance, row
    assert int(row["iterations"]) >= 1 and int(row["memory_bytes"]) > 0, row
    assert float(row["setup_seconds"]) >= 0.0 and float(row["solve_seconds"]) > 0.0, row
    held = row["solver"] == "picard-deflated"
    assert row["problem"] == ("centre of mass held still" if held else "R v = f"), row
PYTHON
if have_python; then
  expect "$python" table.py all/compare.csv
else
  skip 'the numbers of compare.csv: there is no Python'
fi

# A repetition is the same problem: iterations, residuals and errors, and moves the first table aside.
numbers() { cut -d, -f1-6 "$1"; }
expect_exit 0 compare channel --solvers pcg,eigen-cg --tolerance 1e-6 --steps 10 --threads 2 --out all
expect test -s all.1/compare.csv
expect diff <(numbers all/compare.csv) <(numbers all.1/compare.csv | grep -E '^(solver|pcg,1e-06|eigen-cg,1e-06)')

# Without --solvers all of the build, without --tolerance a sweep; the own directory is runs/<case>-compare.
expect_exit 0 compare channel --steps 0 --tolerance 1e-4 --set output.pictures=false
expect test "$(wc -l <runs/channel-compare/compare.csv)" -eq $((1 + $(tr , '\n' <<<"$solvers" | wc -l)))
expect test ! -e runs/channel-compare/compare.svg
expect_exit 0 compare channel --steps 0 --solvers cholmod --set output.pictures=false
expect test "$(wc -l <runs/channel-compare/compare.csv)" -eq 10

# The case's own solver settings stay out of the way, a periodic box works as well.
write_periodic box
expect_exit 0 compare box --solvers pcg,cholmod,picard-deflated --tolerance 1e-6 --steps 3 --out box_table \
  --set solver.name=picard --set solver.stopping=increment --set output.pictures=false
expect test "$(grep -c ',1e-06,1,' box_table/compare.csv)" -eq 3

# Nothing moves an ideal gas at rest without noise: errors of a zero answer are absolute.
expect_exit 0 compare box --solvers pcg,cholmod --tolerance 1e-6 --steps 1 --out rest --set fluid.a=0.0 \
  --set fluid.kT=0.0 --set output.pictures=false
expect test "$(grep -Ec '^[a-z]+,1e-06,1,0,0,0,' rest/compare.csv)" -eq 2
expect test "$(grep -ci nan "$out_text")" -eq 0

# --- what goes wrong ---
expect_error 1 compare channel --solvers pgc --out wrong -- pgc "\"pcg\"" cholmod
expect_error 1 compare channel --solvers pcg --tolerance 2 --out wrong -- --tolerance 2
expect_error 1 compare channel --steps -1 --out wrong -- --steps
expect_error 1 compare missing --out wrong -- missing
expect_error 1 compare channel --set fluid.gamma=-1.0 --out wrong -- '--set fluid.gamma' positive
expect_error 1 compare channel --set fluid.what=1 --out wrong -- '--set fluid.what'
expect_error 1 compare -- case 'compare --help'
expect test ! -e wrong
mkdir -p foreign && printf 'mine\n' >foreign/file
expect_error 3 compare channel --steps 0 --solvers pcg --tolerance 1e-3 --out foreign -- foreign --out
# A backend that does not get there is a row of the table and an exit code.
expect_exit 2 compare channel --solvers pcg,cholmod --tolerance 1e-6 --steps 0 --out short \
  --set solver.max_iterations=3 --set output.pictures=false
expect_text "$out_text" 'NOT CONVERGED' solver.max_iterations
expect test "$(grep -c '^pcg,1e-06,0,3,' short/compare.csv)" -eq 1
expect test "$(grep -c '^cholmod,1e-06,1,' short/compare.csv)" -eq 1
finish
