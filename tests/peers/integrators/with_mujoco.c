/* MuJoCo on the machine: with_mujoco METHOD STEP REVOLUTIONS FILE, METHOD rk4 or euler, STEP in s.
 *
 * Bodies, joints, gravity and integration are MuJoCo's: the rod is free in the plane, the crosshead
 * slides. Its own contacts cannot have this force law, so contact, friction and gas act through its
 * callback for passive forces. Its steps are fixed; STEP divides the 0.1 ms between samples. */
#include "machine.h"

#include <mujoco/mujoco.h>
#include <string.h>

static const char MODEL[] =
    "<mujoco><option gravity='0 -9.81 0' integrator='%s' timestep='%.17g'>"
    "<flag contact='disable' constraint='disable'/></option><worldbody>"
    "<body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/>"
    "<joint type='hinge' axis='0 0 1'/><inertial pos='0 0 0' mass='12' diaginertia='.6 .6 .6'/></body>"
    "<body><joint type='slide' axis='1 0 0'/>"
    "<inertial pos='0 0 0' mass='18' diaginertia='1 1 1'/></body></worldbody></mujoco>";

static const Mode FREE = {.free = 1};

/* Adds the forces on rod (x, y, moment) and crosshead to those given. */
static void forces(double t, const double *q, const double *v, double *out)
{
    double c = cos(q[2]), s = sin(q[2]), rest = L - A_CENTRE;
    double pin[2] = {R * cos(SPEED * t), R * sin(SPEED * t)};
    double big[2] = {pin[0] - q[0] + A_CENTRE * c, pin[1] - q[1] + A_CENTRE * s};
    double small[2] = {q[3] - q[0] - rest * c, -q[1] - rest * s};
    double dbig[2] = {-SPEED * pin[1] - v[0] - A_CENTRE * s * v[2],
                      SPEED * pin[0] - v[1] + A_CENTRE * c * v[2]};
    double dsmall[2] = {v[3] - v[0] + rest * s * v[2], -v[1] - rest * c * v[2]};
    double fb[2], nb[2], fs[2], ns[2];
    joint(big, dbig, 0, SPEED, v[2], &FREE, fb, nb);
    joint(small, dsmall, 1, 0.0, v[2], &FREE, fs, ns);
    double bx = pin[0] + RADIUS_BIG * nb[0] - q[0], by = pin[1] + RADIUS_BIG * nb[1] - q[1];
    double sx = q[3] + RADIUS_SMALL * ns[0] - q[0], sy = RADIUS_SMALL * ns[1] - q[1];
    double gas = pressure(HEAD + R + L - q[3], is_toward(t, &FREE), &FREE) - BACK;
    out[0] -= fb[0] + fs[0];
    out[1] -= fb[1] + fs[1];
    out[2] -= bx * fb[1] - by * fb[0] + sx * fs[1] - sy * fs[0];
    out[3] += fs[0] - gas * AREA;
}

static void passive(const mjModel *model, mjData *data)
{
    (void)model;
    forces(data->time, data->qpos, data->qvel, data->qfrc_passive);
}

static void run(const mjModel *model, mjData *data, int count, int steps, double *samples)
{
    mj_resetData(model, data);
    double turn = -SPEED * R / L;
    double pose[4] = {R + A_CENTRE, 0.0, 0.0, R + L};
    double rates[4] = {0.0, SPEED * R + A_CENTRE * turn, turn, 0.0};
    memcpy(data->qpos, pose, sizeof pose);
    memcpy(data->qvel, rates, sizeof rates);
    for (int i = 0; i < count; i++) {
        double force[4] = {0.0};
        data->time = i * REVOLUTION / SAMPLES;
        forces(data->time, data->qpos, data->qvel, force);
        samples[i] = force[3] / CROSSHEAD_MASS;
        for (int j = 0; j < steps; j++)
            mj_step(model, data);
    }
}

int main(int argc, char **argv)
{
    if (argc != 5)
        return 2;
    char text[sizeof MODEL + 64], error[256];
    int steps = (int)round(REVOLUTION / SAMPLES / atof(argv[2]));
    const char *integrator = strcmp(argv[1], "euler") ? "RK4" : "Euler";
    snprintf(text, sizeof text, MODEL, integrator, REVOLUTION / SAMPLES / steps);
    mjSpec *spec = mj_parseXMLString(text, NULL, error, sizeof error);
    mjModel *model = spec ? mj_compile(spec, NULL) : NULL;
    if (!model) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    mjData *data = mj_makeData(model);
    mjcb_passive = passive;
    int count = SAMPLES * atoi(argv[3]);
    double *samples = malloc(count * sizeof *samples);
    double start = cpu_time(), spent;
    int runs = 0;
    do {
        run(model, data, count, steps, samples);
        spent = cpu_time() - start;
        runs++;
    } while (spent < 0.2);
    report(argv[4], samples, count, spent / runs);
    return 0;
}
