"""The same mechanisms in MuJoCo. Reads a list of jobs from standard input and writes what each took.

A job: [scene, time step (s), seconds]. The answer: {"seconds": time of the processor (s), "q": positions at the end, "drift": m}, where drift is how far
the first body moved along x between a fifth of the motion and its end.
"""

import json
import math
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

# Hub and eight spokes as in models/rimless_wheel.mech, on a slope of 0.08 rad.
WHEEL = HEAD + """
    <body pos="0 0 0.9238795325112867">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 0 1"/>
      <joint type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.2 0.2 0.2"/>
""" + "".join(
    f'<geom type="sphere" size="0.001" pos="{math.cos(angle)} 0 {math.sin(angle)}"/>'
    for angle in (math.pi / 8 + math.pi / 4 * spoke for spoke in range(8))
) + """
    </body>
  </worldbody>
</mujoco>"""


def cubes(count):
    """Boxes on each other, as in models/two_cubes.mech."""
    bodies = "".join(
        f"""
    <body pos="0 0 {0.1 + 0.2 * place}" quat="{math.cos(0.1 * place)} 0 0 {math.sin(0.1 * place)}">
      <freejoint/>
      <geom type="box" size="0.2 0.15 0.1" mass="1"/>
    </body>"""
        for place in range(count)
    )
    return HEAD + bodies + "\n  </worldbody>\n</mujoco>"


def leg(name, x, y):
    """A leg of models/quadruped.mech; its joints have actuators that hold a posture."""
    return f"""
      <body pos="{0.25 * x} {0.1 * y} 0">
        <joint name="a_{name}" type="hinge" axis="1 0 0" damping="1.5"/>
        <inertial pos="0 {0.06 * y} 0" mass="0.8" diaginertia="0.001 0.001 0.001"/>
        <body pos="0 {0.06 * y} 0">
          <joint name="h_{name}" type="hinge" axis="0 1 0" damping="1.5"/>
          <inertial pos="0 0 -0.125" mass="1" diaginertia="0.006 0.006 0.0006"/>
          <body pos="0 0 -0.25">
            <joint name="k_{name}" type="hinge" axis="0 1 0" damping="1.5"/>
            <inertial pos="0 0 -0.125" mass="0.3" diaginertia="0.004 0.004 0.0004"/>
            <geom type="sphere" size="0.001" pos="0 0 -0.25"/>
          </body>
        </body>
      </body>"""


LEGS = [("fl", 1, 1), ("fr", 1, -1), ("hl", -1, 1), ("hr", -1, -1)]
QUADRUPED = HEAD + """
    <body pos="0 0 0.3825">
      <freejoint/>
      <inertial pos="0 0 0" mass="12" diaginertia="0.15 0.4 0.45"/>
""" + "".join(leg(*which) for which in LEGS) + """
    </body>
  </worldbody>
  <actuator>""" + "".join(
    f'<position joint="{joint}_{name}" kp="120"/>' for name, _, _ in LEGS for joint in "ahk"
) + """</actuator>
</mujoco>"""


def posture(time, lift):
    """What the joints are held at: diagonal legs bend in turns."""
    wave = math.sin(12 * time)
    bends = [lift * (1 + (wave if name in ("fl", "hr") else -wave)) / 2 for name, _, _ in LEGS]
    return [angle for bend in bends for angle in (0, 0.7 + bend, -1.4 - 2 * bend)]


DOWN = "0 0 -9.81"
SLOPE = "0.7839536535 0 -9.7786264573"
INCLINE = "-0.49029563103881 0 -9.79774005108347"
SCENES = {
    "box": (BOX, dict(gravity=DOWN, mu=0.4, floor=0, more="")),
    "hopper": (HOPPER, dict(gravity=DOWN, mu=0.9, floor=-0.001, more="")),
    "wheel": (WHEEL, dict(gravity=SLOPE, mu=0.6, floor=-0.001, more="")),
    "two cubes": (cubes(2), dict(gravity=DOWN, mu=0.5, floor=0, more="")),
    "three cubes": (cubes(3), dict(gravity=DOWN, mu=0.5, floor=0, more="")),
    "quadruped stands": (QUADRUPED, dict(gravity=DOWN, mu=0.7, floor=-0.001, more="")),
    "quadruped trots": (QUADRUPED, dict(gravity=DOWN, mu=0.7, floor=-0.001, more="")),
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
    if scene == "wheel":
        data.qvel[:] = [2, 0, 2]
    lift = {"quadruped stands": 0, "quadruped trots": 0.3}.get(scene)
    if lift is not None:
        data.qpos[7:] = posture(0, 0)
    fifth = round(seconds / step / 5)
    # What is commanded is known before, so that only it is handed over in time.
    commands = [posture(step * number, lift) for number in range(5 * fifth)] if lift else []
    if lift == 0:
        data.ctrl[:] = posture(0, 0)
    begun = time.thread_time()
    if commands:
        for command in commands[:fifth]:
            data.ctrl[:] = command
            mujoco.mj_step(model, data)
    else:
        mujoco.mj_step(model, data, nstep=fifth)
    place = float(data.qpos[0])
    if commands:
        for command in commands[fifth:]:
            data.ctrl[:] = command
            mujoco.mj_step(model, data)
    else:
        mujoco.mj_step(model, data, nstep=4 * fifth)
    spent = time.thread_time() - begun
    return {"seconds": spent, "q": [float(q) for q in data.qpos], "drift": float(data.qpos[0]) - place}


print(json.dumps({"version": mujoco.__version__, "answers": [run(*job) for job in json.load(sys.stdin)]}))
