// Simbody on the machine: with_simbody METHOD ACCURACY REVOLUTIONS FILE, METHOD merson (Runge-Kutta)
// or cpodes (a relative of CVODE).
//
// Bodies, mobilizers, gravity and integration are Simbody's: the rod moves in the plane, the crosshead
// slides. Contact, friction and gas are a force of their own, as none of Simbody's has this law.
#include "Simbody.h"

extern "C" {
#include "machine.h"
}

#include <cstring>
#include <memory>
#include <vector>

using namespace SimTK;

static const Mode FREE = {1, 0, {0, 0}, {0, 0}, {0, 0}, {0, 0}};

// Forces on rod (moment, x, y) and crosshead; q and u of the rod are angle, x, y.
static void forces(double t, const Vec3 &q, const Vec3 &u, double xs, double vs, Vec3 &rod,
                   double &crosshead)
{
    double c = std::cos(q[0]), s = std::sin(q[0]), rest = L - A_CENTRE;
    double pin[2] = {R * std::cos(SPEED * t), R * std::sin(SPEED * t)};
    double big[2] = {pin[0] - q[1] + A_CENTRE * c, pin[1] - q[2] + A_CENTRE * s};
    double small[2] = {xs - q[1] - rest * c, -q[2] - rest * s};
    double dbig[2] = {-SPEED * pin[1] - u[1] - A_CENTRE * s * u[0],
                      SPEED * pin[0] - u[2] + A_CENTRE * c * u[0]};
    double dsmall[2] = {vs - u[1] + rest * s * u[0], -u[2] - rest * c * u[0]};
    double fb[2], nb[2], fs[2], ns[2];
    joint(big, dbig, 0, SPEED, u[0], &FREE, fb, nb);
    joint(small, dsmall, 1, 0.0, u[0], &FREE, fs, ns);
    double bx = pin[0] + RADIUS_BIG * nb[0] - q[1], by = pin[1] + RADIUS_BIG * nb[1] - q[2];
    double sx = xs + RADIUS_SMALL * ns[0] - q[1], sy = RADIUS_SMALL * ns[1] - q[2];
    double gas = pressure(HEAD + R + L - xs, is_toward(t, &FREE), &FREE) - BACK;
    rod = Vec3(-(bx * fb[1] - by * fb[0] + sx * fs[1] - sy * fs[0]), -fb[0] - fs[0], -fb[1] - fs[1]);
    crosshead = fs[0] - gas * AREA;
}

class Joints : public Force::Custom::Implementation {
public:
    Joints(const MobilizedBody::Planar &rod, const MobilizedBody::Slider &crosshead)
        : rod(rod), crosshead(crosshead)
    {
    }
    void calcForce(const State &state, Vector_<SpatialVec> &, Vector_<Vec3> &,
                   Vector &mobility) const override
    {
        Vec3 on_rod;
        double on_crosshead;
        at(state, on_rod, on_crosshead);
        for (int i = 0; i < 3; i++)
            rod.applyOneMobilityForce(state, i, on_rod[i], mobility);
        crosshead.applyOneMobilityForce(state, 0, on_crosshead, mobility);
    }
    Real calcPotentialEnergy(const State &) const override { return 0.0; }
    void at(const State &state, Vec3 &on_rod, double &on_crosshead) const
    {
        forces(state.getTime(), rod.getQ(state), rod.getU(state), crosshead.getQ(state),
               crosshead.getU(state), on_rod, on_crosshead);
    }

private:
    MobilizedBody::Planar rod;
    MobilizedBody::Slider crosshead;
};

static void run(const char *method, double accuracy, std::vector<double> &samples)
{
    MultibodySystem system;
    SimbodyMatterSubsystem matter(system);
    GeneralForceSubsystem general(system);
    Force::UniformGravity gravity(general, matter, Vec3(0, -GRAVITY, 0));
    Body::Rigid rod_body(MassProperties(ROD_MASS, Vec3(0), Inertia(ROD_INERTIA)));
    Body::Rigid slider(MassProperties(CROSSHEAD_MASS, Vec3(0), Inertia(1)));
    MobilizedBody::Planar rod(matter.updGround(), rod_body);
    MobilizedBody::Slider crosshead(matter.updGround(), slider);
    Joints *joints = new Joints(rod, crosshead); // the force owns it
    Force::Custom force(general, joints);
    State state = system.realizeTopology();
    double turn = -SPEED * R / L;
    rod.setQ(state, Vec3(0, R + A_CENTRE, 0));
    rod.setU(state, Vec3(turn, 0, SPEED * R + A_CENTRE * turn));
    crosshead.setQ(state, R + L);
    std::unique_ptr<Integrator> integrator;
    if (!std::strcmp(method, "merson"))
        integrator.reset(new RungeKuttaMersonIntegrator(system));
    else
        integrator.reset(new CPodesIntegrator(system));
    integrator->setAccuracy(accuracy);
    integrator->setFinalTime(samples.size() * REVOLUTION / SAMPLES);
    integrator->initialize(state);
    for (size_t i = 0; i < samples.size(); i++) {
        double t = i * REVOLUTION / SAMPLES;
        while (integrator->getTime() < t)
            integrator->stepTo(t);
        Vec3 on_rod;
        double on_crosshead;
        joints->at(integrator->getState(), on_rod, on_crosshead);
        samples[i] = on_crosshead / CROSSHEAD_MASS;
    }
}

int main(int argc, char **argv)
{
    if (argc != 5)
        return 2;
    std::vector<double> samples(SAMPLES * std::atoi(argv[3]));
    double start = cpu_time(), spent;
    int runs = 0;
    do {
        run(argv[1], std::atof(argv[2]), samples);
        spent = cpu_time() - start;
        runs++;
    } while (spent < 0.2);
    report(argv[4], samples.data(), samples.size(), spent / runs);
    return 0;
}
