"""The same mechanisms in MuJoCo. Reads a list of jobs from standard input and writes what each took.

A job: [scene, time step (s), seconds]. The answer: {"seconds": time of the processor (s), "q": positions at the end, "drift": m}, where drift is how far
the first body moved along x between a fifth of the motion and its end.
"""

import json
import sys
import time

import mujoco

HEAD = """<mujoco>
  <compiler angle="radian"/>
  <option timestep="{step}" gravity="{gravity}" cone="elliptic" {more}/>
  <default><geom condim="3" friction="{mu} 0 0"/></default>
  <worldbody>
    <geom type="plane" size="50 50 1" pos="0 0 {floor}"/>
"""

# Uniform box of 2 kg, half sides 0.3, 0.2, 0.15 m.
BOX = HEAD + """
    <body pos="0 0 0.8" quat="0.8 0.2 -0.4 0.4">
      <freejoint/>
      <geom type="box" size="0.3 0.2 0.15" mass="2"/>
    </body>
  </worldbody>
</mujoco>"""

# Hip, leg and foot as in simulation/models/hopper.mech. The foot is a ball of 1 mm, and the floor 1 mm lower.
HOPPER = HEAD + """
    <body pos="0 0 1">
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="z" type="slide" axis="0 0 1"/>
      <joint name="qb" type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="8" diaginertia="0.6 0.6 0.6"/>
      <body>
        <joint name="ql" type="hinge" axis="0 -1 0"/>
        <inertial pos="0 0 -0.2" mass="0.5" diaginertia="0.02 0.02 1e-6"/>
        <body pos="0 0 -0.6">
          <joint name="w" type="slide" axis="0 0 -1" stiffness="4000" damping="20"/>
          <inertial pos="0 0 0" mass="0.3" diaginertia="1e-9 1e-9 1e-9"/>
          <geom type="sphere" size="0.001"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"""

# A particle on an incline of 0.05 rad: gravity is turned instead of the plane.
PUCK = HEAD + """
    <body pos="0 0 0">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1e-3 1e-3 1e-3"/>
      <geom type="sphere" size="0.001"/>
    </body>
  </worldbody>
</mujoco>"""

DOWN = "0 0 -9.81"
INCLINE = "-0.49029563103881 0 -9.79774005108347"
SCENES = {
    "box": (BOX, dict(gravity=DOWN, mu=0.4, floor=0, more="")),
    "hopper": (HOPPER, dict(gravity=DOWN, mu=0.9, floor=-0.001, more="")),
    "puck": (PUCK, dict(gravity=INCLINE, mu=1.0, floor=-0.001, more="")),
    "puck, impratio 100": (PUCK, dict(gravity=INCLINE, mu=1.0, floor=-0.001, more='impratio="100"')),
}


def run(scene, step, seconds):
    text, options = SCENES[scene]
    model = mujoco.MjModel.from_xml_string(text.format(step=step, **options))
    data = mujoco.MjData(model)
    if scene == "box":
        # Along N, and about the axes of the box.
        data.qvel[:] = [0.5, 0, 0, 3, -2, 1]
    fifth = round(seconds / step / 5)
    begun = time.thread_time()
    mujoco.mj_step(model, data, nstep=fifth)
    place = float(data.qpos[0])
    mujoco.mj_step(model, data, nstep=4 * fifth)
    spent = time.thread_time() - begun
    return {"seconds": spent, "q": [float(q) for q in data.qpos], "drift": float(data.qpos[0]) - place}


print(json.dumps({"version": mujoco.__version__, "answers": [run(*job) for job in json.load(sys.stdin)]}))
