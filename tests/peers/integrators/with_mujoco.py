"""MuJoCo on the machine as its Python interface has it: the model of with_mujoco.c, the callback in
numba. METHOD is rk4; the tolerance is the step, s."""

import mujoco
import numpy as np
from bodies import POSE, RATES, acceleration, forces
from machine import REVOLUTION, SAMPLES, serve

MODEL = """<mujoco><option gravity='0 -9.81 0' integrator='RK4' timestep='{:.17g}'>
<flag contact='disable' constraint='disable'/></option><worldbody>
<body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/>
<joint type='hinge' axis='0 0 1'/><inertial pos='0 0 0' mass='12' diaginertia='.6 .6 .6'/></body>
<body><joint type='slide' axis='1 0 0'/><inertial pos='0 0 0' mass='18' diaginertia='1 1 1'/></body>
</worldbody></mujoco>"""


def passive(model, data):
    forces(data.time, data.qpos, data.qvel, data.qfrc_passive)


def run(method, step, revolutions, clearance):
    interval = REVOLUTION / SAMPLES
    steps = max(round(interval / step), 1)
    mujoco.set_mjcb_passive(None)
    model = mujoco.MjModel.from_xml_string(MODEL.format(interval / steps))
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = POSE, RATES
    mujoco.set_mjcb_passive(passive)
    out = np.empty(revolutions * SAMPLES)
    for i in range(len(out)):
        data.time = i * interval
        out[i] = acceleration(data.time, data.qpos, data.qvel)
        mujoco.mj_step(model, data, steps)
    return out


if __name__ == "__main__":
    serve(run)
