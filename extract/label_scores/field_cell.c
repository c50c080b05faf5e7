/* Finds where fields are equal in a cube: on its edges [JuLosassoSchaeferWarren2002], and from there by steps
 * of Gauss and Newton, damped as by Levenberg. */
#include "extract/label_scores/field_cell.h"

#include <math.h>
#include <string.h>

enum { STEPS = 6 };

/* Part of the equations' trace that is added to their diagonal: where fields leave directions open,
 * the point stays near its start. */
static const double DAMPING = 1e-3;

/* Steps shorter than this, in voxels, end the search. */
static const double SHORT = 1e-4;

/* Returns where two fields are equal between two corners, as a fraction of the way. Half way, if the
 * fields do not tell. */
static double find_equal(const cwi_field_cell *c, int a, int b)
{
    const int f = c->field_of[a], g = c->field_of[b];
    const double at_a = c->values[f][a] - c->values[g][a],
                 at_b = c->values[f][b] - c->values[g][b];
    if (at_a >= 0 && at_b <= 0 && at_a > at_b)
        return at_a / (at_a - at_b);
    return at_a < 0 && at_b < 0 ? 0 : at_a > 0 && at_b > 0 ? 1 : 0.5;
}

bool cwi_field_cell_mean(const cwi_field_cell *c, uint64_t edges, double at[3])
{
    int count = 0;
    double sum[3] = {0};
    for (int a = 0; a < 8; a++)
        for (int b = a + 1; b < 8; b++) {
            if (!(edges >> (8 * a + b) & 1) || !(c->corners >> a & 1) ||
                !(c->corners >> b & 1) || c->group[c->field_of[a]] == c->group[c->field_of[b]])
                continue;
            const double t = find_equal(c, a, b);
            for (int n = 0; n < 3; n++)
                sum[n] += (1 - t) * (a >> n & 1) + t * (b >> n & 1);
            count++;
        }
    for (int n = 0; n < 3 && count > 0; n++)
        at[n] = sum[n] / count;
    return count > 0;
}

/* A value and its slopes. */
typedef struct sample {
    double value, slope[3];
} sample;

/* Computes a trilinear function of the corners' values. */
static sample interpolate(const double v[8], const double at[3])
{
    double face[4], edge[2];
    const double x = at[0], y = at[1], z = at[2];
    for (int n = 0; n < 4; n++)
        face[n] = v[2 * n] + x * (v[2 * n + 1] - v[2 * n]);
    for (int n = 0; n < 2; n++)
        edge[n] = face[2 * n] + y * (face[2 * n + 1] - face[2 * n]);
    sample s = {.value = edge[0] + z * (edge[1] - edge[0])};
    s.slope[0] = (1 - z) * ((1 - y) * (v[1] - v[0]) + y * (v[3] - v[2])) +
                 z * ((1 - y) * (v[5] - v[4]) + y * (v[7] - v[6]));
    s.slope[1] = (1 - z) * (face[1] - face[0]) + z * (face[3] - face[2]);
    s.slope[2] = edge[1] - edge[0];
    return s;
}

/* The differences of all groups' fields from their mean at a point. */
typedef struct differences {
    int count;
    sample of[8];
    double sum_sq; /* of their values */
} differences;

/* Computes them. Of the fields of a group the largest counts. */
static void find_differences(const cwi_field_cell *c, const double at[3], differences *d)
{
    sample mean = {0};
    d->count = 0;
    d->sum_sq = 0;
    for (int f = 0; f < c->count; f++) {
        const int group = c->group[f];
        const sample s = interpolate(c->values[f], at);
        if (group >= d->count) {
            d->of[group] = s;
            d->count = group + 1;
        } else if (s.value > d->of[group].value)
            d->of[group] = s;
    }
    for (int g = 0; g < d->count; g++) {
        mean.value += d->of[g].value / d->count;
        for (int a = 0; a < 3; a++)
            mean.slope[a] += d->of[g].slope[a] / d->count;
    }
    for (int g = 0; g < d->count; g++) {
        d->of[g].value -= mean.value;
        for (int a = 0; a < 3; a++)
            d->of[g].slope[a] -= mean.slope[a];
        d->sum_sq += d->of[g].value * d->of[g].value;
    }
}

/* Finds the damped step to where the differences vanish. Returns false if there is none. */
static bool find_step(const differences *d, double step[3])
{
    double m[3][4] = {0};
    for (int g = 0; g < d->count; g++)
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < 3; b++)
                m[a][b] += d->of[g].slope[a] * d->of[g].slope[b];
            m[a][3] -= d->of[g].slope[a] * d->of[g].value;
        }
    const double trace = m[0][0] + m[1][1] + m[2][2];
    for (int a = 0; a < 3; a++)
        m[a][a] += DAMPING * trace;
    for (int a = 0; a < 3; a++) /* positive definite: no rows change places */
        for (int b = a + 1; b < 3; b++) {
            const double by = m[b][a] / m[a][a];
            for (int n = a; n < 4; n++)
                m[b][n] -= by * m[a][n];
        }
    for (int a = 2; a >= 0; a--) {
        step[a] = m[a][3];
        for (int b = a + 1; b < 3; b++)
            step[a] -= m[a][b] * step[b];
        step[a] /= m[a][a];
    }
    return isfinite(step[0]) && isfinite(step[1]) && isfinite(step[2]);
}

void cwi_field_cell_meet(const cwi_field_cell *c, double at[3])
{
    differences d;
    find_differences(c, at, &d);
    for (int n = 0; n < STEPS && d.sum_sq > 0 && isfinite(d.sum_sq); n++) {
        double step[3], to[3], length_sq = 0;
        differences next;
        if (!find_step(&d, step))
            return;
        for (int a = 0; a < 3; a++) {
            to[a] = fmin(fmax(at[a] + step[a], 0), 1);
            length_sq += (to[a] - at[a]) * (to[a] - at[a]);
        }
        find_differences(c, to, &next);
        if (!(next.sum_sq < d.sum_sq))
            return;
        memcpy(at, to, sizeof to);
        d = next;
        if (length_sq < SHORT * SHORT)
            return;
    }
}
