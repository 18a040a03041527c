"""Five lines to a motion, and what it tells."""

import sys
from pathlib import Path

import hodograph

MODELS = Path(__file__).resolve().parents[3] / "models"

pendulum = hodograph.load(MODELS / "planar_double_pendulum.mech")
motion = pendulum.simulate(2.0, mu=0.3, e=0.5, law="stronge")
for event in motion.events:
    print(f"{event.time:.6f} s: {event.kind} at {event.contact}, {event.energy_change or 0.0:+.4f} J")
print(f"at the end q = {motion.q[-1]}, and {motion.account['impacts']:.4f} J were lost in impacts")
if len(sys.argv) > 1:
    motion.html(sys.argv[1])
