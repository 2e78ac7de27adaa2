/* SUNDIALS CVODE on the machine: cvode METHOD TOLERANCE REVOLUTIONS FILE.
 *
 * METHOD is bdf or adams; with `-events` contacts, clamps of the gas and dead centres are located
 * and the integration begins anew there. Newton's method, dense matrix, Jacobian by differences;
 * output by CVODE's interpolation. Written for SUNDIALS 6. */
#include "machine.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

static int right_hand_side(realtype t, N_Vector y, N_Vector dy, void *mode)
{
    derivative(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy), mode);
    return 0;
}

static int roots(realtype t, N_Vector y, realtype *values, void *mode)
{
    events(t, N_VGetArrayPointer(y), mode, values);
    return 0;
}

/* Goes on to `end`, beginning anew at the events on the way. */
static int reach(void *cvode, N_Vector y, Mode *mode, double end)
{
    realtype t;
    int found, which[EVENTS];
    while ((found = CVode(cvode, end, y, &t, CV_NORMAL)) == CV_ROOT_RETURN) {
        CVodeGetRootInfo(cvode, which);
        for (int i = 0; i < EVENTS; i++)
            if (which[i])
                switch_mode(mode, i, which[i] > 0);
        CVodeReInit(cvode, t, y);
    }
    return found < 0;
}

static int run(int method, int located, double tolerance, int count, double *samples)
{
    SUNContext context;
    if (SUNContext_Create(NULL, &context))
        return 1;
    N_Vector y = N_VNew_Serial(COMPONENTS, context), scale = N_VNew_Serial(COMPONENTS, context);
    SUNMatrix matrix = SUNDenseMatrix(COMPONENTS, COMPONENTS, context);
    SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
    Mode mode = {.free = !located};
    double rates[COMPONENTS];
    int failed = 0;
    N_VConst(0.0, y);
    for (int i = 0; i < COMPONENTS; i++)
        N_VGetArrayPointer(scale)[i] = tolerance * (i < 4 ? SCALE : SCALE_RATE);
    void *cvode = CVodeCreate(method, context);
    CVodeInit(cvode, right_hand_side, 0.0, y);
    CVodeSVtolerances(cvode, tolerance, scale);
    CVodeSetLinearSolver(cvode, solver, matrix);
    CVodeSetUserData(cvode, &mode);
    CVodeSetMaxNumSteps(cvode, 10000000);
    if (located)
        CVodeRootInit(cvode, EVENTS, roots);
    for (int i = 0; i < count && !failed; i++) {
        double t = i * REVOLUTION / SAMPLES;
        if (i > 0)
            failed = reach(cvode, y, &mode, t);
        if (located && i % (SAMPLES / 2) == 0) {
            begin_half(&mode, i / (SAMPLES / 2), t, N_VGetArrayPointer(y));
            CVodeReInit(cvode, t, y);
            CVodeSetStopTime(cvode, (i + SAMPLES / 2) * REVOLUTION / SAMPLES);
        }
        samples[i] = derivative(t, N_VGetArrayPointer(y), rates, &mode);
    }
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(y);
    N_VDestroy(scale);
    SUNContext_Free(&context);
    return failed;
}

int main(int argc, char **argv)
{
    if (argc != 5)
        return 2;
    int method = strncmp(argv[1], "adams", 5) ? CV_BDF : CV_ADAMS;
    int located = strstr(argv[1], "-events") != NULL;
    int count = SAMPLES * atoi(argv[3]);
    double *samples = malloc(count * sizeof *samples);
    double start = cpu_time(), spent;
    int runs = 0;
    do {
        if (run(method, located, atof(argv[2]), count, samples))
            return 1;
        spent = cpu_time() - start;
        runs++;
    } while (spent < 0.2);
    report(argv[4], samples, count, spent / runs);
    return 0;
}
