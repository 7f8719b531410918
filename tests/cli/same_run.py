"""Are two runs the same? With "files" also the files they were cut into; with "anew" their series and trajectories may
begin at different times. Usage: same_run.py A B [files] [anew]"""
import filecmp, glob, json, os, sys

a, b = sys.argv[1:3]
with_files = "files" in sys.argv[3:]

def summary(run):
    values = json.load(open(f"{run}/summary.json"))
    for key in ("wall_seconds", "phase_seconds", "threads", "checks", "case"):
        del values[key]
    return values

assert summary(a) == summary(b), "summary.json"
names = sorted(os.path.basename(name) for name in glob.glob(f"{a}/*.csv"))
assert names == sorted(os.path.basename(name) for name in glob.glob(f"{b}/*.csv")), names
for name in names:
    if "anew" in sys.argv[3:] and name.endswith("_series.csv"):
        continue
    assert filecmp.cmp(f"{a}/{name}", f"{b}/{name}", shallow=False), name
try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(0)

def arrays(file):
    found = {}
    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
    with h5py.File(file) as f:
        f.visititems(visit)
    return found

def same(one, other, name):
    one, other = np.asarray(one), np.asarray(other)
    assert one.shape == other.shape and one.dtype == other.dtype, f"{name}: {one.shape} {other.shape}"
    assert one.tobytes() == other.tobytes(), name

def compare_checkpoints():
    one, other = arrays(f"{a}/checkpoint.h5"), arrays(f"{b}/checkpoint.h5")
    assert one.keys() == other.keys(), one.keys() ^ other.keys()
    for name in one:
        # Seconds differ; the case names the options of its own part.
        if name in ("components/run/phase_seconds", "components/run/wall_seconds", "components/run/case"):
            continue
        if not with_files and name.startswith("components/output/"):
            continue
        if one[name].dtype.kind == "O":
            assert one[name] == other[name], name
        else:
            same(one[name], other[name], name)
    assert any(name == "components/particles/position" for name in one)

def trajectory(run):
    frames = {}
    for file in sorted(glob.glob(f"{run}/trajectory.*.h5")):
        with h5py.File(file) as f:
            p = f["particles/all"]
            for k, step in enumerate(p["position/step"][:]):
                assert step not in frames, f"{run}: step {step} twice"
                frames[int(step)] = [p[f"{name}/value"][k] for name in ("position", "image", "velocity")]
    return frames

compare_checkpoints()
one, other = trajectory(a), trajectory(b)
if "anew" not in sys.argv[3:]:
    assert one.keys() == other.keys(), sorted(one.keys() ^ other.keys())
for step in one.keys() & other.keys():
    for k in range(3):
        same(one[step][k], other[step][k], f"trajectory at step {step}")
