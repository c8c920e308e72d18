"""A rod of ten particles, built as a dict: its buckling load by statics, and its motion until it has turned by a radian.

    PYTHONPATH=build/release/python python3 examples/python/rod.py
"""

import numpy as np

import vbond

keys = {
    "title": "Rod of ten particles",
    "specimen": [{"kind": "rod", "particles": 10, "radius": 0.4, "mass": 1.0}],
    "bonds": [{"distance": 1.1, "theory": "bernoulli-euler", "E": 31.830988618379067, "nu": 0.2,
               "section": {"shape": "circle", "diameter": 0.2}}],  # c_A = 1, c_B = 0.0025
    "velocities": [{"kind": "rigid", "angular_velocity": [0, 0, 1e-3]}],
    "stage": [{"name": "turn", "duration": "1000 T0"}],
}
case = vbond.Case.from_dict(keys)

clamp = {"group": "first", "fix": ["x", "y", "z", "rx", "ry", "rz"]}
column = vbond.buckling(case, supports=[clamp], loads=[{"group": "last", "force": [-1, 0, 0]}], count=1)
print(f"critical force {column.critical_loads[0].force:.6g}, Euler's {np.pi**2 * 0.0025 / (4 * 9**2):.6g}")


def angle(state: vbond.State) -> float:
    along = state.positions[-1] - state.positions[0]
    return float(np.arctan2(along[1], along[0]))


run = vbond.Run(case)
run.on_step(10, lambda now: angle(now.state) >= 1.0)
run.run()
print(f"it has turned by {angle(run.state):.4f} rad at time {run.time:.6g}, after {run.steps} steps")
