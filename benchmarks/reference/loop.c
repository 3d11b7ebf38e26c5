/* The sampled loop of one servo axis, by hand: what a careful engineer writes in C, one scenario after another.

   One mass, n Maxwell-slip elements, viscous friction; quantised encoder, filtered difference velocity, reversal
   detector, gains scheduled over the stroke since the last reversal, torque limit, semi-implicit Euler, running metrics.
   Arithmetic in the order of docs/architecture.md, so that strict C gives the bits that the generated kernels give:
   gcc -O3 -march=native -std=c99 -ffp-contract=off -shared -fPIC loop.c -o loop.so */

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 64 };

typedef struct {
    double height, viscous, mass; /* N*m, N*m*s/rad, kg*m^2 */
    double stiffness[MOST], slip[MOST]; /* 1/rad, rad: sum of stiffness * slip is one */
    double torque_limit;
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

static double larger(double a, double b) { return b > a ? b : a; }

static inline void simulate(const plant_t *plant, const loop_t *loop, const scenario_t *scenario, metrics_t *out,
                            int n, int substeps, int64_t samples, int64_t window_from) {
    const double h = loop->sample_time / substeps, rate = 1.0 / loop->sample_time;
    const double target = scenario->target, band = 0.01 * fabs(target);
    const double sign = (target > 0.0) - (target < 0.0);
    const double per_mass = 1.0 / (scenario->inertia * plant->mass);
    const double limit = plant->torque_limit, resolution = loop->resolution, phase = scenario->phase;
    double x[MOST] = {0.0};
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
        const double error = target - q;
        if (m.outside != 0.0) m.e_inside = error;
        m.outside = fabs(error) > band;
        if (m.outside != 0.0) {
            m.k_outside = (double)k;
            m.e_outside = error;
        }
        if (fabs(target - y) > loop->hold_band) k_astray = (double)k;
        if ((double)k - k_astray >= loop->hold && m.k_settled < -1.0) m.k_settled = k_astray;
        m.peak = larger(m.peak, q * sign);
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
            double direction = 0.0;
            for (int i = 0; i < n; i++) {
                x[i] = clip(x[i] + dq, -plant->slip[i], plant->slip[i]);
                direction += plant->stiffness[i] * x[i];
            }
            const double force = scenario->friction * (plant->height * direction)
                                 + scenario->friction * (plant->viscous * v) + scenario->load;
            v += (u - force) * per_mass * h;
            q += v * h;
        }
    }
    m.position = q;
    m.velocity = v;
    *out = m;
}

/* n and substeps as constants where they are the benchmark's, so that the compiler may unroll. */
void simulate_all(const plant_t *plant, const loop_t *loop, const scenario_t *scenarios, metrics_t *out, int64_t count,
                  int n, int substeps, int64_t samples, int64_t window_from) {
    for (int64_t i = 0; i < count; i++) {
        if (n == 1 && substeps == 2) simulate(plant, loop, scenarios + i, out + i, 1, 2, samples, window_from);
        else if (n == 4 && substeps == 2) simulate(plant, loop, scenarios + i, out + i, 4, 2, samples, window_from);
        else if (n == 10 && substeps == 2) simulate(plant, loop, scenarios + i, out + i, 10, 2, samples, window_from);
        else simulate(plant, loop, scenarios + i, out + i, n, substeps, samples, window_from);
    }
}
