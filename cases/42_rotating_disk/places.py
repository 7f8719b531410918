#!/usr/bin/env python3
"""Places of the fluid between two radii about the centre of the box, 4 per area: places.py INNER OUTER CENTRE > places.csv"""
import math
import sys

inner, outer, centre = map(float, sys.argv[1:])
density = 4.0
print("x,y")
for k in range(round(density * math.pi * (outer**2 - inner**2))):
    r = math.sqrt(inner**2 + (k + 0.5) / (density * math.pi))
    angle = k * math.pi * (3.0 - math.sqrt(5.0))  # the golden one
    print(f"{centre + r * math.cos(angle):.4f},{centre + r * math.sin(angle):.4f}")
