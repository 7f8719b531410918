#!/usr/bin/env bash
# The Python of docs/files.md reads what a run writes: in 2D and 3D, between walls and sheared.
source "$(dirname "$0")/lib.sh" "$@"
have_h5py || { skip 'there is no Python with h5py to read with'; finish; }
run() { "$odpd" run "$@" --threads 1; }

# block K: the K-th piece of Python in docs/files.md, which begins with its imports.
block() {
  awk -v wanted="$1" '/^    import glob/ { ++k; on = 1 } !/^    / && !/^$/ { on = 0 } on && k == wanted { sub(/^    /, ""); print }' \
    "$source_root/docs/files.md"
}
block 1 >read.py
block 2 >mdanalysis.py
expect test "$(grep -c . read.py)" -gt 20 -a "$(grep -c . mdanalysis.py)" -gt 20

write_periodic flat
cat >>flat/case.toml <<'CASE'

[[species]]
name = "water"
fraction = 0.5

[[species]]
name = "oil"
fraction = 0.5

[output]
checkpoint_every = 8
trajectory_every = 3
pictures = false
CASE
write_walled channel
printf '\n[output]\ncheckpoint_every = 8\ntrajectory_every = 3\npictures = false\n' >>channel/case.toml
sed 's/^dimension = .*/dimension = 3/; s/^size = .*/size = [3.0, 3.5, 4.0]/; s/^periodic = .*/periodic = [true, true, true]/' \
  flat/case.toml >deep.toml
shear=(--set shear.rate=30.0)
expect_exit 0 run flat --out flat_run
expect_exit 0 run flat "${shear[@]}" --out flat_sheared
expect_exit 0 run channel --out channel_run
expect_exit 0 run deep.toml --out deep_run
expect_exit 0 run deep.toml "${shear[@]}" --out deep_sheared
runs='flat_run flat_sheared channel_run deep_run deep_sheared'

# Unwrapped, a particle never moves by half a box between frames, but along a sheared flow.
cat >>read.py <<'PYTHON'
assert len(time) == 14 and np.allclose(np.diff(time), 0.015), time
sheared = run.endswith("sheared")
steps = np.abs(np.diff(r, axis=0))[:, :, 1 if sheared else 0 :]
assert 0.0 < steps.max() < 1.4, steps.max()
assert len(ids) == positions.shape[0] and "dimension" in case and step == 40 and species.max() < len(names)
PYTHON
for name in $runs; do expect "$python" read.py $name; done

if "$python" -W ignore -c 'import MDAnalysis' 2>/dev/null; then
  cat >>mdanalysis.py <<'PYTHON'

run = sys.argv[1]
frame = 0
for file in files:
    with h5py.File(file) as f:
        p = f["particles/all"]
        for k, time in enumerate(p["position/time"][:]):
            ts = universe.trajectory[frame]
            frame += 1
            assert abs(ts.time - time) < 1e-6, (ts.time, time)
            assert np.abs(ts.positions[:, :dimension] - p["position/value"][k]).max() < 1e-5
            edges = np.eye(3)
            edges[:dimension, :dimension] = p["box/edges/value"][k]
            # MDAnalysis keeps lengths and angles in single precision.
            lengths = np.linalg.norm(edges, axis=1)
            cosines = [edges[i] @ edges[j] / (lengths[i] * lengths[j]) for i, j in ((1, 2), (0, 2), (0, 1))]
            assert np.allclose(ts.dimensions[:3], lengths, atol=1e-5), ts.dimensions
            assert np.allclose(np.cos(np.radians(ts.dimensions[3:])), cosines, atol=1e-5), ts.dimensions
assert frame == len(universe.trajectory) == 14, frame
assert set(types) == ({"fluid"} if run == "channel_run" else {"water", "oil"}), types
PYTHON
  for name in $runs; do expect "$python" -W ignore mdanalysis.py $name; done
else
  skip 'there is no MDAnalysis (Debian: python3-mdanalysis)'
fi
finish
