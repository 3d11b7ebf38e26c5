/* The sampled loop of one servo axis, by hand: what a careful engineer writes in C, one scenario after another.

   One mass, n Maxwell-slip elements, viscous friction; or that as the motor of two masses, with hysteresis of four
   elements, linear and cubic stiffness in the joint; or one mass with LuGre friction. Quantised encoder, filtered
   difference velocity, reversal detector, gains scheduled over the stroke since the last reversal, torque limit,
   semi-implicit Euler, running metrics.
   Arithmetic in the order of docs/architecture.md, so that strict C gives the bits that the generated kernels give:
   gcc -O3 -march=native -std=c99 -ffp-contract=off -shared -fPIC loop.c -o loop.so
   With -DLIBM, exp is that of the C library, whose last bits are the machine's own. */

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 64, JOINT = 4 };
enum { ONE_MASS, TWO_MASS, LUGRE };

typedef struct {
    double height, viscous, mass; /* N*m, N*m*s/rad, kg*m^2 */
    double stiffness[MOST], slip[MOST]; /* 1/rad, rad: sum of stiffness * slip is one */
    double torque_limit;
    double load_mass, load_viscous, linear, cubic, joint_height; /* two masses */
    double joint_stiffness[JOINT], joint_slip[JOINT];
    double sigma0, sigma1, x0, ratio, speed; /* LuGre */
} plant_t;

typedef struct {
    double sample_time, smoothing, resolution, back; /* back: distance that counts as a reversal */
    const double *table; /* kp = row[0] + row[1] A, kd = row[2] + row[3] A */
    double first, last;  /* knots at the ends, rad */
    int64_t shift, offset;
    double hold_band, hold; /* rad, samples */
} loop_t;

typedef struct {
    double target, inertia, friction, load, phase;
} scenario_t;

typedef struct {
    double position, velocity, k_outside, e_outside, e_inside, outside, k_settled;
    double peak, peak_speed, peak_torque, final_error, sum_u, sum_uu, reversals;
} metrics_t;

static double clip(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

#ifdef LIBM
#define decay exp
#else
/* e^x for x <= 0, by the arithmetic of workbench/effects/elementary.py; the power of two is put together from its bits. */
static inline double decay(double x) {
    if (x < -708.0) return 0.0;
    const double k = floor((x + 0.34657359027997) * 1.4426950408889634);
    const double r = x - k * 0.6931471803691238 - k * 1.9082149292705877e-10, z = r * r;
    const double q = 0.16666666666666358 + z * (-0.00277777777751129 + z * (6.613755866949925e-05
                     + z * (-1.6533477746561568e-06 + z * 4.124531899682314e-08)));
    const int64_t bits = ((int64_t)k + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return (1.0 + 2.0 * r / (2.0 + (z * q - r))) * power;
}
#endif

static double larger(double a, double b) { return b > a ? b : a; }

static inline void simulate(const plant_t *plant, const loop_t *loop, const scenario_t *scenario, metrics_t *out,
                            int kind, int n, int substeps, int64_t samples, int64_t window_from) {
    const double h = loop->sample_time / substeps, rate = 1.0 / loop->sample_time;
    const double target = scenario->target, band = 0.01 * fabs(target);
    const double sign = (target > 0.0) - (target < 0.0);
    const double per_mass = 1.0 / (scenario->inertia * plant->mass);
    const double limit = plant->torque_limit, resolution = loop->resolution, phase = scenario->phase;
    const double per_load = 1.0 / (scenario->inertia * plant->load_mass);
    double x[MOST] = {0.0}, joint[JOINT] = {0.0}, ql = 0.0, vl = 0.0, before_joint = 0.0, z = 0.0;
    double q = 0.0, v = 0.0, vh = 0.0, k_astray = -1.0;
    double y = resolution * floor(q / resolution + phase), furthest = y, turned = y, way = 0.0, share = 1.0;
    metrics_t m = {.k_outside = -1.0, .k_settled = -2.0};

    for (int64_t k = 0; k < samples; k++) {
        /* reading, velocity */
        const double before = y;
        y = resolution * floor(q / resolution + phase);
        vh += loop->smoothing * ((y - before) * rate - vh);

        /* reversals */
        const double delta = y - furthest;
        if (way * delta > 0.0) {
            furthest = y;
        } else if (fabs(delta) > loop->back) {
            turned = furthest;
            furthest = y;
            if (way != 0.0) {
                share = 0.5;
                m.reversals += 1.0;
            }
            way = delta > 0.0 ? 1.0 : -1.0;
        }

        /* gains at the amplitude of the equivalent motion, command */
        const double amplitude = clip(share * fabs(y - turned), loop->first, loop->last);
        int64_t bits;
        memcpy(&bits, &amplitude, sizeof bits);
        const double *row = loop->table + 4 * ((bits >> loop->shift) - loop->offset);
        const double kp = row[0] + row[1] * amplitude, kd = row[2] + row[3] * amplitude;
        const double u = clip(kp * (target - y) - kd * vh, -limit, limit);

        /* metrics */
        const double position = kind == TWO_MASS ? ql : q;
        const double error = target - position;
        if (m.outside != 0.0) m.e_inside = error;
        m.outside = fabs(error) > band;
        if (m.outside != 0.0) {
            m.k_outside = (double)k;
            m.e_outside = error;
        }
        if (fabs(target - y) > loop->hold_band) k_astray = (double)k;
        if ((double)k - k_astray >= loop->hold && m.k_settled < -1.0) m.k_settled = k_astray;
        m.peak = larger(m.peak, position * sign);
        m.peak_speed = larger(m.peak_speed, fabs(v));
        m.peak_torque = larger(m.peak_torque, fabs(u));
        if (k >= window_from) {
            m.final_error = larger(m.final_error, fabs(error));
            m.sum_u += u;
            m.sum_uu += u * u;
        }

        /* plant */
        for (int j = 0; j < substeps; j++) {
            const double dq = v * h;
            if (kind == LUGRE) {
                const double s = v / plant->speed;
                const double g = plant->x0 * (1.0 + plant->ratio * decay(-(s * s)));
                const double slid = ((dq > 0.0) - (dq < 0.0)) * g;
                const double after = slid + (z - slid) * decay(-fabs(dq) / g);
                const double bristles = plant->sigma0 * after + plant->sigma1 * ((after - z) / h);
                z = after;
                const double force = scenario->friction * bristles
                                     + scenario->friction * (plant->viscous * v) + scenario->load;
                v += (u - force) * per_mass * h;
                q += v * h;
                continue;
            }
            double direction = 0.0;
            for (int i = 0; i < n; i++) {
                x[i] = clip(x[i] + dq, -plant->slip[i], plant->slip[i]);
                direction += plant->stiffness[i] * x[i];
            }
            if (kind == TWO_MASS) {
                const double deflection = q - ql, moved = deflection - before_joint;
                double carried = 0.0;
                before_joint = deflection;
                for (int i = 0; i < JOINT; i++) {
                    joint[i] = clip(joint[i] + moved, -plant->joint_slip[i], plant->joint_slip[i]);
                    carried += plant->joint_stiffness[i] * joint[i];
                }
                const double torque = plant->linear * deflection
                                      + plant->cubic * (deflection * deflection * deflection)
                                      + scenario->friction * (plant->joint_height * carried);
                const double at_motor = scenario->friction * (plant->height * direction)
                                        + scenario->friction * (plant->viscous * v) + torque;
                const double at_load = scenario->friction * (plant->load_viscous * vl) - torque + scenario->load;
                v += (u - at_motor) * per_mass * h;
                vl += -at_load * per_load * h;
                q += v * h;
                ql += vl * h;
                continue;
            }
            const double force = scenario->friction * (plant->height * direction)
                                 + scenario->friction * (plant->viscous * v) + scenario->load;
            v += (u - force) * per_mass * h;
            q += v * h;
        }
    }
    m.position = kind == TWO_MASS ? ql : q;
    m.velocity = v;
    *out = m;
}

/* kind, n and substeps as constants where they are the benchmark's, so that the compiler may unroll. */
#define RUN(kind, n, substeps) simulate(plant, loop, scenarios + i, out + i, kind, n, substeps, samples, window_from)

void simulate_all(const plant_t *plant, const loop_t *loop, const scenario_t *scenarios, metrics_t *out, int64_t count,
                  int kind, int n, int substeps, int64_t samples, int64_t window_from) {
    for (int64_t i = 0; i < count; i++) {
        if (kind == TWO_MASS && n == 10 && substeps == 2) RUN(TWO_MASS, 10, 2);
        else if (kind == TWO_MASS) RUN(TWO_MASS, n, substeps);
        else if (kind == LUGRE && substeps == 2) RUN(LUGRE, 0, 2);
        else if (kind == LUGRE) RUN(LUGRE, 0, substeps);
        else if (n == 1 && substeps == 2) RUN(ONE_MASS, 1, 2);
        else if (n == 4 && substeps == 2) RUN(ONE_MASS, 4, 2);
        else if (n == 10 && substeps == 2) RUN(ONE_MASS, 10, 2);
        else RUN(ONE_MASS, n, substeps);
    }
}
