#!/usr/bin/env bash
# A study runs its points once, survives those that blow up, tells what is wrong at once, and writes all its files.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
mkdir small
cat >small/study.toml <<'STUDY'
title = "A <small> study"
case = "../box"

[budget]
equilibrate = 0.05
duration = 1.0

[[axis]]
name = "method"
values = [
  { label = "trapezoidal", integrator.name = "trapezoidal" },
  { label = "euler", integrator.name = "euler" },
]

[[axis]]
key = "integrator.dt"
values = [0.005, 0.01, 0.02]
quick = [0.01, 0.02]

[[axis]]
key = "fluid.a"
values = [10.0, 1e5]

[[skip]]
method = "euler"
a = 1e5

[[observable]]
name = "energy_per_particle"
reference = { method = "trapezoidal", dt = 0.01 }

[[observable]]
name = "pressure"
reference = 20.0
tolerance = 0.1
STUDY
study() { "$odpd" study "$@"; }
# replaced OLD NEW: the study with one text replaced, as directory `bad`.
replaced() {
  rm -rf bad
  cp -r small bad
  sed -i "s|$1|$2|" bad/study.toml
}

expect_exit 0 study --help
expect_text "$out_text" --quick --dry-run --out --threads
expect_exit 0 study small --dry-run
expect_text "$out_text" 'trapezoidal, dt=0.005, a=10.0' '9 points'
expect test ! -e runs

# --- it runs, and what blows up does not end it ---
expect_exit 0 study small --quick
expect_text "$out_text" '[  1/6] trapezoidal, dt=0.01, a=10.0, seed 1: energy_per_particle' 'BLEW UP: step' study.html
out=runs/study-small-quick
for file in study.csv runs.csv study.html; do expect test -s $out/$file; done
expect test "$(grep -c ',blew up,' $out/study.csv)" -eq 4
expect test "$(wc -l <$out/study.csv)" -eq 13
expect test "$(ls $out/points | wc -l)" -eq 6
expect_text $out/study.csv 'method,dt,a,observable,verdict' 'euler,0.02,10.0,pressure'
expect_text $out/study.html 'A &lt;small&gt; study' 'odpd study small --quick' '--set fluid.a=10.0 --set run.duration=1' '[[skip]]'
if command -v gnuplot >/dev/null; then
  for name in accuracy_energy_per_particle_a=10-0 stability_pressure; do
    for kind in svg png gp; do expect test -s "$out/$name.$kind"; done
  done
  expect test "$(grep -c '<svg' $out/study.html)" -eq 6
fi
# Nothing in the page comes from elsewhere.
expect test -z "$(grep -E '<script|<link|<img|@import|src=' $out/study.html)"
cat >read_study.py <<'PYTHON'
import csv, sys
from html.parser import HTMLParser

rows = list(csv.DictReader(open(sys.argv[1] + "/study.csv")))
for row in rows:
    good = row["verdict"] != "blew up"
    assert good == (row["a"] == "10.0"), row
    assert good or float(row["blew_up_at"]) >= 0.0, row
    if not good:
        continue
    mean, reference, bias = (float(row[k]) for k in ("mean", "reference", "bias"))
    assert abs(bias - (mean - reference) / abs(reference)) < 1e-12, row
    assert float(row["seconds_per_time"]) > 0.0
assert any(row["pareto"] == "1" for row in rows)

class Balanced(HTMLParser):
    stack = []
    def handle_starttag(self, tag, attributes):
        if tag not in ("meta", "br"):
            self.stack.append(tag)
    def handle_endtag(self, tag):
        assert self.stack.pop() == tag, tag
page = Balanced()
page.feed(open(sys.argv[1] + "/study.html").read())
assert page.stack == [], page.stack
PYTHON
if have_python; then expect "$python" read_study.py $out; else skip 'the contents of study.csv: there is no Python'; fi

# --- what is done is not run again; what is lost is, and only that ---
stamps() { (cd $out/points && find . -type f -printf '%p %T@\n' | sort); }
stamps >before
expect_exit 0 study small --quick
expect_text "$out_text" '6 of 6 runs are done already'
stamps >after
expect cmp before after
lost=$(ls -d $out/points/euler,dt=0.02*)
rm "$lost/outcome.json"
expect_exit 0 study small --quick
expect_text "$out_text" '5 of 6 runs are done already' '[  6/6] euler, dt=0.02'
# Another duration is another case; the old points stay.
replaced 'duration = 1.0' 'duration = 0.5'
expect_exit 0 study bad --quick --out $out
expect_text "$out_text" '[  1/6]'
expect test "$(ls $out/points | wc -l)" -eq 12
# A command of the page gives the same numbers.
command=$(grep -o 'odpd run [^<]*dt=0.02[^<]*' $out/study.html | grep -v last_good | head -n 1 | sed 's/^odpd //; s/&gt;/>/g')
expect_exit 0 bash -c "'$odpd' $command --out again"
if have_python; then
  # shellcheck disable=SC2016
  expect "$python" -c 'import glob, json, sys
mean = lambda run: json.load(open(run + "/summary.json"))["observables"]["pressure"]["mean"]
assert mean("again") in [mean(run) for run in glob.glob(sys.argv[1] + "/points/*dt=0.02,a=10.0,*/run")]' $out
fi

# --- a run that takes too long is kept with what it has ---
replaced 'duration = 1.0' 'duration = 1e6\nseconds = 1'
sed -i 's/^quick = .*/quick = [0.01]/' bad/study.toml
expect_exit 0 study bad --quick --out limited
expect_text "$out_text" '(out of seconds)'
expect grep -q 'trapezoidal,0.01,10.0,pressure,[a-z]*,1,.*,1,nan,$' limited/study.csv

# --- Ctrl-C ends it cleanly; the same command goes on from the checkpoint ---
replaced 'duration = 1.0' 'duration = 40.0'
sed -i 's/^quick = .*/quick = [0.01]/' bad/study.toml
"$odpd" study bad --quick --out stopped >first 2>&1 &
child=$!
for _ in $(seq 100); do
  compgen -G 'stopped/points/*/run/case.toml' >/dev/null && break
  sleep 0.05
done
sleep 0.3
kill -INT $child
wait $child
expect test $? -eq 130
expect_text first interrupted
expect_exit 0 study bad --quick --out stopped
expect_text "$out_text" '[  3/3]'

# --- what ended is told by its name; another program has results of its own ---
mkdir ends
cat >ends/study.toml <<'STUDY'
case = "../box"

[budget]
equilibrate = 0.05
duration = 0.3

[[axis]]
name = "ends"
values = [
  { label = "well", seed = 1 },
  { label = "unsolved", solver.max_iterations = 1 },
  { label = "thin", fluid.density = 0.2 },
  { label = "hot", fluid.a = 1e5 },
]

[[observable]]
name = "divergence.rms"
reference = { ends = "well" }
STUDY
cp -r box flowing
printf '\n[[observe]]\nkind = "divergence"\nbins = [3, 3]\nevery = 1\n' >>flowing/case.toml
sed -i 's|"../box"|"../flowing"|' ends/study.toml
expect_exit 0 study ends --out ended
expect_text "$out_text" 'ends=well, seed 1: divergence.rms' 'NOT CONVERGED: step' 'SINGULAR: step' 'BLEW UP: step'
expect_text ended/study.csv 'well,divergence.rms,' 'unsolved,divergence.rms,not converged,' 'thin,divergence.rms,singular,' \
  'hot,divergence.rms,blew up,'
expect_exit 0 study ends --out ended
expect_text "$out_text" '4 of 4 runs are done already'
cp "$odpd" changed && printf x >>changed
expect_exit 0 ./changed study ends --out ended
expect_text "$out_text" '[  1/4]'
expect_exit 0 study ends --out ended
expect_text "$out_text" '4 of 4 runs are done already'

# --- what is wrong is told before anything runs ---
expect_error 1 study -- study
expect_error 1 study nowhere -- nowhere
replaced 'key = "integrator.dt"' 'name = "dt"\nkey = "integrator.dtt"'
expect_error 1 study bad --out never -- dt=0.005 integrator.dtt "did you mean 'dt'"
replaced 'name = "pressure"' 'name = "presure"'
expect_error 1 study bad --out never -- "measures 'presure'" "did you mean 'pressure'"
replaced 'method = "euler"' 'metod = "euler"'
expect_error 1 study bad --out never -- skip
replaced 'values = \[10.0, 1e5\]' 'values = []'
expect_error 1 study bad --out never -- axis values
expect test ! -e never
mkdir -p foreign && printf 'x\n' >foreign/file
expect_error 3 study small --out foreign -- foreign --out
finish
