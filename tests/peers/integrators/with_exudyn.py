"""Exudyn on the machine: its equations of second order with all masses, and a user function in numba
for the forces, which no connector of its own has. METHOD is an explicit solver of fixed step (RK44,
RK67); the tolerance is the step, s."""

import exudyn as exu
import numpy as np
from bodies import CROSSHEAD_MASS, MASSES, POSE, RATES, WEIGHT, forces
from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2
from machine import REVOLUTION, SAMPLES, serve


def user_force(system, t, item, q, v):
    out = WEIGHT.copy()
    forces(t, np.ascontiguousarray(q), np.ascontiguousarray(v), out)
    return out


def run(method, step, revolutions, clearance):
    interval = REVOLUTION / SAMPLES
    steps = max(round(interval / step), 1)
    count = revolutions * SAMPLES
    states = np.empty((count, 8))
    container = exu.SystemContainer()
    system = container.AddSystem()
    zero = np.zeros(4)
    node = system.AddNode(NodeGenericODE2(referenceCoordinates=zero, initialCoordinates=POSE,
                                          initialCoordinates_t=RATES, numberOfODE2Coordinates=4))
    system.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(MASSES),
                                       forceUserFunction=user_force))

    # Called with the time that the step leads to, while the state is that of its beginning.
    def before_step(system, t):
        number = round(t / interval * steps) - 1
        if number % steps == 0:
            i = number // steps
            states[i, :4] = system.systemData.GetODE2Coordinates()
            states[i, 4:] = system.systemData.GetODE2Coordinates_t()
        return True

    system.SetPreStepUserFunction(before_step)
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = count * steps
    settings.timeIntegration.endTime = revolutions * REVOLUTION
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.show.computationTime = False
    system.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, method))
    out = np.empty(count)
    for i, state in enumerate(states):
        force = np.zeros(4)
        forces(i * interval, state[:4].copy(), state[4:].copy(), force)
        out[i] = force[3] / CROSSHEAD_MASS
    return out


if __name__ == "__main__":
    serve(run)
