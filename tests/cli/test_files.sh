#!/usr/bin/env bash
# The files of a run: complete, readable by others, and never lost or half written when something is in the way.
source "$(dirname "$0")/lib.sh" "$@"

write_periodic box
write_walled channel
cat >>box/case.toml <<'CASE'

[output]
checkpoint_every = 16
trajectory_every = 4
vtk_every = 20

[[observe]]
kind = "thermo"
every = 2
series = true

[[observe]]
kind = "msd"
window = 0.02
every = 1

[[observe]]
kind = "rdf"

[[observe]]
kind = "profile"
fit = "linear"

[[check]]
observable = "pressure"
expected = 40.0
tolerance = 1000.0
source = "nobody"
CASE
run() { "$odpd" run "$@"; }

# --- what a run writes ---
expect_exit 0 run box --out out
for file in case.toml summary.json checkpoint.h5 thermo_series.csv rdf.csv profile.csv msd.csv particles.pvd \
  frames/0000000020.vtp frames/0000000040.vtp trajectory.0000.h5 trajectory.0001.h5 trajectory.0002.h5; do
  expect test -s "out/$file"
done
expect test ! -e out/trajectory.0003.h5
expect test -z "$(find out -name '.tmp-*')"
expect_exit 0 head -n 1 out/thermo_series.csv
expect_text "$out_text" time energy pressure
# 30 measured steps, every second one sampled.
expect test "$(wc -l <out/thermo_series.csv)" -eq 16
if command -v gnuplot >/dev/null; then
  for name in rdf msd profile_velocity profile_density particles; do
    for kind in svg png gp; do expect test -s "out/$name.$kind"; done
  done
  expect_exit 0 head -c 8 out/rdf.png
  expect_text "$out_text" PNG
  # The script draws the picture again by itself.
  rm -f out/rdf.svg
  expect_exit 0 bash -c 'cd out && gnuplot rdf.gp'
  expect test -s out/rdf.svg
  # Without gnuplot the numbers are there all the same.
  mkdir -p tools && ln -sf "$(command -v bash)" tools/bash
  expect_exit 0 env PATH="$work/tools" "$odpd" run box --out plain
  expect test -s plain/summary.json
  expect test ! -e plain/rdf.svg
else
  skip 'pictures: there is no gnuplot'
fi

cat >read_run.py <<'PYTHON'
import csv, glob, json, sys
import xml.etree.ElementTree as tree

def refuse(text):
    raise ValueError(f"{text} is not JSON")

run = sys.argv[1]
summary = json.load(open(f"{run}/summary.json"), parse_constant=refuse)
for key in ("case", "version", "seed", "particles", "steps", "wall_seconds", "phase_seconds", "solver",
            "observables", "checks"):
    assert key in summary, f"summary.json has no '{key}'"
assert summary["case"] == "box" and summary["seed"] == 7 and summary["particles"] == 64
assert summary["steps"] == 40 and summary["finished"] and not summary["interrupted"]
for name in ("energy_per_particle", "pressure", "config_temperature", "diffusion"):
    assert set(summary["observables"][name]) == {"mean", "stderr"}, name
for name in ("energy_per_particle", "pressure", "config_temperature", "diffusion", "profile.slope"):
    assert isinstance(summary["observables"][name]["mean"], float), name
phases = summary["phase_seconds"]
assert set(phases) == {"neighbours", "edges", "noise", "assembly", "solve", "sweep", "measure", "write"}, phases
assert all(seconds >= 0.0 for seconds in phases.values()) and phases["solve"] > 0.0
assert summary["solver"]["name"] == "pcg" and summary["solver"]["solves"] == 80
assert summary["solver"]["worst_residual"] <= summary["solver"]["tolerance"]
assert len(summary["checks"]) == 1 and summary["checks"][0]["passed"] is True

for name in ("thermo_series", "rdf", "profile", "msd"):
    rows = list(csv.reader(line for line in open(f"{run}/{name}.csv") if not line.startswith("#")))
    assert len(rows) > 1 and len(rows[0]) > 1, name
    for row in rows[1:]:
        assert len(row) == len(rows[0]), f"{name}: {row}"
        [float(value) for value in row]

collection = tree.parse(f"{run}/particles.pvd").getroot()
frames = [entry.get("file") for entry in collection.iter("DataSet")]
assert frames == ["frames/0000000020.vtp", "frames/0000000040.vtp"], frames
for frame in frames:
    piece = tree.parse(f"{run}/{frame}").getroot().find("PolyData/Piece")
    assert piece.get("NumberOfPoints") == "64"
PYTHON
if have_python; then
  expect "$python" read_run.py out
  if command -v gnuplot >/dev/null; then
    for picture in out/*.svg; do
      expect "$python" -c 'import sys, xml.etree.ElementTree as t; t.parse(sys.argv[1])' "$picture"
    done
  fi
else
  skip 'the contents of summary.json, CSV and VTK files: there is no Python'
fi

cat >read_h5.py <<'PYTHON'
import glob, sys
import h5py
import numpy as np

run = sys.argv[1]
steps = []
for name in sorted(glob.glob(f"{run}/trajectory.*.h5")):
    with h5py.File(name) as f:
        assert list(f["h5md"].attrs["version"]) == [1, 1]
        creator = f["h5md/creator"].attrs["name"]
        assert (creator.decode() if isinstance(creator, bytes) else creator) == "odpd"
        p = f["particles/all"]
        frames = len(p["position/step"])
        assert p["position/value"].shape == (frames, 64, 2), p["position/value"].shape
        assert p["velocity/value"].shape == (frames, 64, 2) and p["image/value"].shape == (frames, 64, 2)
        assert p["box"].attrs["dimension"] == 2
        assert (p["box/edges/value"][:] == np.diag([4.0, 4.0])).all() and p["box/edges/value"].shape == (frames, 2, 2)
        assert np.array_equal(p["id"][:], np.arange(64))
        r = p["position/value"][:]
        assert np.isfinite(r).all() and (r >= 0.0).all() and (r < 4.0).all()
        assert np.allclose(p["position/time"][:], 0.005 * p["position/step"][:])
        steps += list(p["position/step"][:])
assert steps == list(range(0, 41, 4)), steps
with h5py.File(f"{run}/checkpoint.h5") as f:
    c = f["components"]
    assert c["run/counts"][0] == 40
    ids = c["particles/id"][:]
    last = c["particles/position"][:].reshape(64, 2)[np.argsort(ids)]
    assert np.array_equal(last, r[-1]), "the checkpoint and the last frame differ"
PYTHON
if have_h5py; then
  expect "$python" read_h5.py out
else
  skip 'the contents of HDF5 files: there is no h5py'
fi

# --- the resolved case runs again, to the same numbers ---
observables() { "$python" -c 'import json, sys; print(json.load(open(sys.argv[1]))["observables"])' "$1/summary.json"; }
if have_python; then
  expect_exit 0 run out --out again
  expect test "$(observables out)" = "$(observables again)"
  expect cmp out/thermo_series.csv again/thermo_series.csv
  expect_exit 0 run out/case.toml --set seed=8 --out other
  expect test "$(observables out)" != "$(observables other)"
  # Also when it starts from a file, which it names relative to its own directory.
  mkdir seeded
  sed '/^density/d' box/case.toml >seeded/case.toml
  printf 'x,y\n' >seeded/start.csv
  for x in 0.2 0.7 1.2 1.7 2.2 2.7 3.2 3.7; do
    for y in 0.1 0.6 1.1 1.6 2.1 2.6 3.1 3.6; do printf '%s,%s\n' $x $y; done
  done >>seeded/start.csv
  expect_exit 0 run seeded --set start.from=file --set 'start.file="start.csv"' --out from_file
  expect_exit 0 run from_file --out from_file_again
  expect cmp from_file/thermo_series.csv from_file_again/thermo_series.csv
  expect_exit 0 run seeded --set start.from=file --set 'start.file="start.csv"' --set run.duration=0.2 \
    --restart from_file/checkpoint.h5
  # A frame of another run is a start as well.
  expect_exit 0 run seeded --set start.from=file --set 'start.file="../out/trajectory.0002.h5"' --out from_frame
fi

# --- what is in the way ---
cp -r out saved
expect_exit 0 run box --out out --set seed=9
expect_text "$err_text" out.1
expect diff -r saved out.1
expect_exit 0 run box --out out/ --set output.pictures=false
expect test -s out.2/summary.json
expect diff -r saved out.1
expect_exit 0 bash -c "cd box && '$odpd' run . --set output.pictures=false"
expect test -s box/runs/box/summary.json

printf 'a file\n' >occupied
expect_error 3 run box --out occupied -- occupied --out
expect grep -q 'a file' occupied
expect_error 3 run box --out occupied/below -- occupied
mkdir -p foreign
printf 'thesis\n' >foreign/chapter1
expect_error 3 run box --out foreign -- foreign --out
expect test "$(ls foreign)" = chapter1
expect test ! -e foreign.1
mkdir -p vacant
expect_exit 0 run box --out vacant --set output.pictures=false
expect test ! -e vacant.1
expect_error 3 run box --out "$(printf 'x%.0s' {1..300})" -- xxx --out
if [ -w /dev/full ]; then
  full() { "$@" >/dev/full; }
  expect_error 3 full "$odpd" info -- 'standard output'
  expect_error 3 full "$odpd" run box --out unseen -- 'standard output'
  expect test -s unseen/summary.json
fi
if [ "$(id -u)" -ne 0 ]; then
  mkdir -p locked && chmod a-w locked
  expect_error 3 run box --out locked/run -- locked/run permission
  chmod a-rx locked
  expect_error 3 run box --out locked/run -- locked/run Permission
  expect_error 3 run box --out locked -- locked Permission
  chmod a+rwx locked
else
  skip 'a directory without permission: root may write everywhere'
fi

# --- no room ---
# limited KIB COMMAND...: files may not grow beyond it.
limited() { (ulimit -f "$1" && shift && exec "$@"); }
expect_error 3 limited 1 "$odpd" run box --out full -- full --out
expect_error 3 limited 8 "$odpd" run box --out small -- small 'ulimit -f' --out
expect test -z "$(find small -name '.tmp-*')"
# With a long window the checkpoint grows while the run goes on, so that a later one fails.
sed -e 's/^duration = .*/duration = 1.0/' -e 's/^checkpoint_every = .*/checkpoint_every = 20/' \
  -e 's/^trajectory_every = .*/trajectory_every = 0/' -e 's/^window = .*/window = 0.9/' \
  -e 's/^\[output\]/[output]\npictures = false/' box/case.toml >grow.toml
expect_exit 0 run grow.toml --out roomy
first=$("$odpd" run grow.toml --set run.duration=0.05 --out first >/dev/null 2>&1 && stat -c %s first/checkpoint.h5)
last=$(stat -c %s roomy/checkpoint.h5)
kib=$(((first + last) / 2048))
expect test "$first" -lt $((kib * 1024)) -a "$last" -gt $((kib * 1024))
expect_error 3 limited "$kib" "$odpd" run grow.toml --out cramped -- cramped/checkpoint.h5 'ulimit -f'
expect test -s cramped/checkpoint.h5 -a ! -e cramped/summary.json
expect test -z "$(find cramped -name '.tmp-*')"
expect_exit 0 run grow.toml --restart cramped/checkpoint.h5
expect cmp roomy/thermo_series.csv cramped/thermo_series.csv

mkdir -p tiny
if mount -t tmpfs -o size=64k none tiny 2>/dev/null; then
  expect_error 3 run grow.toml --set output.trajectory_every=1 --out tiny/run -- tiny/run 'free some space'
  [ -e tiny/run/checkpoint.h5 ] && expect_exit 0 run grow.toml --set output.trajectory_every=1 --restart \
    tiny/run/checkpoint.h5 --out moved
  umount tiny
else
  skip 'a full disk: no permission to mount one'
fi
finish
