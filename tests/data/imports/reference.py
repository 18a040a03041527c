"""Writes expected.json: accelerations of machine.xml by MuJoCo, at random states, in the names and speeds of the
imported model. `pip install mujoco numpy`, then `python3 reference.py`."""

import json

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path("machine.xml")
model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
data = mujoco.MjData(model)
random = np.random.default_rng(7)
states = []
for _ in range(5):
    q, u, udot, inputs = {}, {}, {}, {}
    data.qpos[:] = random.uniform(-1, 1, model.nq)
    data.qvel[:] = random.uniform(-1, 1, model.nv)
    data.ctrl[:] = random.uniform(-1, 1, model.nu)
    mujoco.mj_normalizeQuat(model, data.qpos)
    mujoco.mj_forward(model, data)
    # without the solver of constraints: M qacc = passive + actuator - bias
    mass = np.zeros((model.nv, model.nv))
    for column, unit in enumerate(np.eye(model.nv)):
        product = np.zeros(model.nv)
        mujoco.mj_mulM(model, data, product, unit)
        mass[:, column] = product
    acceleration = np.linalg.solve(mass, data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias)
    for joint in range(model.njnt):
        name, kind = model.joint(joint).name, model.jnt_type[joint]
        at, dof = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            q |= {f"q_{name}_{c}": data.qpos[at + i] for i, c in enumerate("xyz")}
            q |= {f"q_{name}_e{i}": data.qpos[at + 3 + i] for i in range(4)}
            turn = np.zeros(9)
            mujoco.mju_quat2Mat(turn, data.qpos[at + 3 : at + 7])
            turn = turn.reshape(3, 3)
            # the speeds of a free body are along its own axes
            omega = data.qvel[dof + 3 : dof + 6]
            v = turn.T @ data.qvel[dof : dof + 3]
            a = turn.T @ acceleration[dof : dof + 3] - np.cross(omega, v)
            u |= {f"u_{name}_{c}": v[i] for i, c in enumerate("xyz")}
            udot |= {f"u_{name}_{c}": a[i] for i, c in enumerate("xyz")}
            u |= {f"u_{name}_r{c}": omega[i] for i, c in enumerate("xyz")}
            udot |= {f"u_{name}_r{c}": acceleration[dof + 3 + i] for i, c in enumerate("xyz")}
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            q |= {f"q_{name}_e{i}": data.qpos[at + i] for i in range(4)}
            u |= {f"u_{name}_r{c}": data.qvel[dof + i] for i, c in enumerate("xyz")}
            udot |= {f"u_{name}_r{c}": acceleration[dof + i] for i, c in enumerate("xyz")}
        else:
            q[f"q_{name}"], u[f"u_{name}"], udot[f"u_{name}"] = data.qpos[at], data.qvel[dof], acceleration[dof]
    inputs = {f"ctrl_{model.actuator(i).name}": data.ctrl[i] for i in range(model.nu)}
    states.append({"q": q, "u": u, "inputs": inputs, "udot": udot})
with open("expected.json", "w") as out:
    json.dump({"origin": f"MuJoCo {mujoco.__version__}, reference.py", "states": states}, out, indent=1)
