/* The single-stage machine of the reference model, both joints clear: equations of motion.
 *
 * State: offset of the journal in the big end (x, y), in the small end (x, y), and their rates.
 * These are small where absolute coordinates are large, so rounding does not limit the accuracy.
 * Sections are those of the model's description: 1 pose, 2 contact, 3 gas, 5 numbers. */
#ifndef MACHINE_H
#define MACHINE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define PI 3.14159265358979323846
#define COMPONENTS 8
#define REVOLUTION 0.12
#define SPEED (2.0 * PI / REVOLUTION)
#define SAMPLES 1200 /* of a revolution, 10 kHz */

static const double R = 0.120, L = 0.600, A_CENTRE = 0.220;
static const double ROD_MASS = 12.0, ROD_INERTIA = 0.60, CROSSHEAD_MASS = 18.0, GRAVITY = 9.81;
static const double SUCTION = 0.105e6, DISCHARGE = 0.393e6, BACK = 0.0, EXPONENT = 1.4;
static const double HEAD = 0.024, AREA = PI * 0.050 * 0.050;
static const double CLEARANCE = 3e-4, DEPTH = 1e-5, DAMPING = 2e4, FRICTION = 0.05, SLIP = 0.01;
static const double RADIUS_BIG = 0.050, RADIUS_SMALL = 0.035;
static const double STIFFNESS_BIG = 2.4e10, STIFFNESS_SMALL = 2.0e10;
/* What counts as 1 for the tolerance: the clearance, and a thousand of it a second. */
static const double SCALE = 3e-4, SCALE_RATE = 0.3;

/* Which branches of contact and gas law hold. Where `free` they follow from the state; otherwise
 * they stand until an event is located, and the right-hand side is smooth beyond its boundary.
 * Of the two: big end, small end. */
typedef struct {
    int free;
    int half;        /* number of the half revolution; even: away from the head */
    int touching[2]; /* the journal is in contact */
    int pressed[2];  /* the law pushes, the maximum with 0 does not hold */
    int deep[2];     /* the damping is full */
    int beyond[2];   /* the piston is past the place where the discharge, the suction clamp holds */
} Mode;

/* A joint at an instant: penetration, its rate, normal, slip speed, and the law without maximum. */
typedef struct {
    double delta, approach, nx, ny, slip, push;
} Contact;

static inline Contact contact(const double *e, const double *de, int small, double omega_journal,
                              double omega_bearing, int deep)
{
    double radius = small ? RADIUS_SMALL : RADIUS_BIG;
    double stiffness = small ? STIFFNESS_SMALL : STIFFNESS_BIG;
    double r = sqrt(e[0] * e[0] + e[1] * e[1]), nx = e[0] / r, ny = e[1] / r;
    Contact at = {r - CLEARANCE, nx * de[0] + ny * de[1], nx, ny, 0.0, 0.0};
    at.slip = nx * de[1] - ny * de[0] + omega_journal * radius - omega_bearing * (radius + r);
    double s = deep ? 1.0 : at.delta / DEPTH;
    double spring = at.delta > 0.0 ? stiffness * at.delta * sqrt(at.delta) : 0.0;
    at.push = spring + DAMPING * s * s * (3.0 - 2.0 * s) * at.approach;
    return at;
}

/* Force (x, y) on the journal and the normal there, 0 where there is no contact. */
static inline void joint(const double *e, const double *de, int small, double omega_journal,
                         double omega_bearing, const Mode *mode, double force[2], double normal[2])
{
    force[0] = force[1] = normal[0] = normal[1] = 0.0;
    double r2 = e[0] * e[0] + e[1] * e[1], deep_at = CLEARANCE + DEPTH;
    int free = mode->free;
    int holds = free ? r2 > CLEARANCE * CLEARANCE : mode->touching[small] && mode->pressed[small];
    if (!holds)
        return;
    int deep = free ? r2 > deep_at * deep_at : mode->deep[small];
    Contact at = contact(e, de, small, omega_journal, omega_bearing, deep);
    if (free && at.push <= 0.0)
        return;
    double drag = FRICTION * at.push * at.slip / sqrt(at.slip * at.slip + SLIP * SLIP);
    normal[0] = at.nx;
    normal[1] = at.ny;
    force[0] = -at.push * at.nx + drag * at.ny;
    force[1] = -at.push * at.ny - drag * at.nx;
}

/* Distances from piston to head between which the gas is shut in, in the stroke toward the head or
 * away from it. */
static inline void shut_between(int toward, double bounds[2])
{
    static double ratio;
    if (ratio == 0.0)
        ratio = pow(DISCHARGE / SUCTION, 1.0 / EXPONENT);
    bounds[0] = toward ? (2.0 * R + HEAD) / ratio : HEAD;
    bounds[1] = toward ? 2.0 * R + HEAD : HEAD * ratio;
}

static inline double pressure(double distance, int toward, const Mode *mode)
{
    double bounds[2];
    shut_between(toward, bounds);
    if (mode->free ? distance <= bounds[0] : !mode->beyond[0])
        return DISCHARGE;
    if (mode->free ? distance >= bounds[1] : mode->beyond[1])
        return SUCTION;
    return toward ? SUCTION * pow(bounds[1] / distance, EXPONENT)
                  : DISCHARGE * pow(bounds[0] / distance, EXPONENT);
}

/* Pin of the crank, direction and angular speed of the rod, distance from piston to head. */
typedef struct {
    double pin_x, pin_y, along, up, turn, distance;
} Pose;

static inline Pose pose(double t, const double *y)
{
    Pose at = {R * cos(SPEED * t), R * sin(SPEED * t), 0.0, 0.0, 0.0, 0.0};
    at.up = -(at.pin_y - y[1] + y[3]) / L;
    at.along = sqrt(1.0 - at.up * at.up);
    at.turn = -(SPEED * at.pin_x - y[5] + y[7]) / (L * at.along);
    at.distance = HEAD + R + L - (at.pin_x - y[0] + L * at.along + y[2]);
    return at;
}

static inline int is_toward(double t, const Mode *mode)
{
    return mode->free ? fmod(SPEED * t, 2.0 * PI) >= PI : mode->half & 1;
}

/* Writes the derivative of the state and gives the crosshead's acceleration back. */
static inline double derivative(double t, const double *y, double *dy, const Mode *mode)
{
    Pose at = pose(t, y);
    double along = at.along, up = at.up, turn = at.turn;
    const double *big = y, *small = y + 2, *dbig = y + 4, *dsmall = y + 6;
    double fb[2], nb[2], fs[2], ns[2];
    joint(big, dbig, 0, SPEED, turn, mode, fb, nb);
    joint(small, dsmall, 1, 0.0, turn, mode, fs, ns);
    /* Points of contact, from the rod's centre of mass. */
    double bx = -A_CENTRE * along + big[0] + RADIUS_BIG * nb[0];
    double by = -A_CENTRE * up + big[1] + RADIUS_BIG * nb[1];
    double sx = (L - A_CENTRE) * along + small[0] + RADIUS_SMALL * ns[0];
    double sy = (L - A_CENTRE) * up + small[1] + RADIUS_SMALL * ns[1];
    double moment = -(bx * fb[1] - by * fb[0]) - (sx * fs[1] - sy * fs[0]);
    double ax = -(fb[0] + fs[0]) / ROD_MASS, ay = -(fb[1] + fs[1]) / ROD_MASS - GRAVITY;
    double turning = moment / ROD_INERTIA;
    double gas = pressure(at.distance, is_toward(t, mode), mode) - BACK;
    double acceleration = (fs[0] - gas * AREA) / CROSSHEAD_MASS;

    /* Acceleration of a point of the rod's axis per distance from its centre of mass. */
    double gx = -turning * up - turn * turn * along, gy = turning * along - turn * turn * up;
    for (int i = 0; i < 4; i++)
        dy[i] = y[4 + i];
    dy[4] = -SPEED * SPEED * at.pin_x - (ax - A_CENTRE * gx);
    dy[5] = -SPEED * SPEED * at.pin_y - (ay - A_CENTRE * gy);
    dy[6] = acceleration - (ax + (L - A_CENTRE) * gx);
    dy[7] = -(ay + (L - A_CENTRE) * gy);
    return acceleration;
}

#define EVENTS 8

/* What is 0 where a branch changes: penetration, law, depth of both joints, both clamps of the gas. */
static inline void events(double t, const double *y, const Mode *mode, double *values)
{
    Pose at = pose(t, y);
    for (int i = 0; i < 2; i++) {
        double omega = i ? 0.0 : SPEED;
        Contact joint = contact(y + 2 * i, y + 4 + 2 * i, i, omega, at.turn, mode->deep[i]);
        values[3 * i] = joint.delta;
        values[3 * i + 1] = mode->touching[i] ? joint.push : 1.0;
        values[3 * i + 2] = joint.delta - DEPTH;
    }
    double bounds[2];
    shut_between(is_toward(t, mode), bounds);
    values[6] = at.distance - bounds[0];
    values[7] = at.distance - bounds[1];
}

/* Changes the branch of event number `event`, whose value now grows or falls. */
static inline void switch_mode(Mode *mode, int event, int grows)
{
    if (event >= 6)
        mode->beyond[event - 6] = grows;
    else if (event % 3 == 0)
        mode->touching[event / 3] = mode->pressed[event / 3] = grows;
    else if (event % 3 == 1)
        mode->pressed[event / 3] = grows;
    else
        mode->deep[event / 3] = grows;
}

/* Begins a half revolution, where the gas jumps. */
static inline void begin_half(Mode *mode, int half, double t, const double *y)
{
    double bounds[2], distance = pose(t, y).distance;
    mode->half = half;
    shut_between(half & 1, bounds);
    for (int i = 0; i < 2; i++)
        mode->beyond[i] = distance > bounds[i];
}

static inline double cpu_time(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

/* Writes the samples and prints CPU milliseconds a revolution. */
static inline void report(const char *path, const double *samples, int count, double seconds)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(samples, sizeof *samples, count, file) != (size_t)count || fclose(file))
        exit(1);
    printf("%.6f\n", 1e3 * seconds * SAMPLES / count);
}

#endif
