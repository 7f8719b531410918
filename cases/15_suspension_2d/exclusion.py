# g(q) of the solvent around the centres of the spring colloids (Phan-Thien et al. 2016, eq. 48), from a run of rest.toml
# with a trajectory. Usage: python3 exclusion.py RUN   (needs h5py and numpy)
import glob
import sys

import h5py
import numpy as np

bin_width, bins, threshold = 0.01, 200, 1e-3
count, frames, colloids = np.zeros(bins), 0, 0
for file in sorted(glob.glob(f"{sys.argv[1]}/trajectory.*.h5")):
    with h5py.File(file) as f:
        p = f["particles/all"]
        box = p["box/edges/value"][0]
        position, image = p["position/value"], p["image/value"]
        names = [x.decode() for x in f["parameters/odpd"].attrs["species_names"]]
        colloid = p["species"][:] == names.index("colloid")
        for k in range(position.shape[0]):
            r = position[k] + image[k] * box
            beads = r[colloid].reshape(-1, 3, 2)
            arms = beads - beads[:, :1]
            centre = beads[:, 0] + (arms - box * np.round(arms / box)).mean(axis=1)
            apart = r[~colloid][None] - centre[:, None]
            apart -= box * np.round(apart / box)
            q = np.sqrt((apart**2).sum(axis=2)).ravel()
            count += np.histogram(q, bins, (0.0, bins * bin_width))[0]
            frames += 1
            colloids = len(beads)
            density = (~colloid).sum() / box.prod()
edge = bin_width * np.arange(bins + 1)
g = count / (frames * colloids * density * np.pi * np.diff(edge**2))
wide = g.reshape(-1, 5).mean(axis=1)  # rings of 0.05: one visit in a ring of 0.01 near the centre is already above 0.001
print(f"frames {frames}; g first exceeds {threshold} at {edge[np.argmax(g > threshold)]:.2f} in rings of 0.01")
for k, value in enumerate(wide):
    print(f"{5 * bin_width * (k + 0.5):.3f} {value:.4f}")
