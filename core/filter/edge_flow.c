/* Computes the flow between voxels in diffusion that goes along edges and not across.
 *
 * The gradient of the smoothed values tells the direction n of an edge and how steep it is. Of the
 * gradient G of the values, the part along n is weighed by g = exp(-|S|^2), with S the gradient of
 * the smoothed ones in units of the contrast: the flow is G - (1 - g) (G n) n. */
#include "core/filter/edge_flow.h"

#include "core/filter/fast_exp.h"

/* The values on both sides of faces, and those beside each along the two other axes: before and
 * behind. */
typedef struct face_row {
    const float *low, *high;
    const float *low_beside[4], *high_beside[4];
} face_row;

static inline float known_difference(float a, float b)
{
    const float d = a - b;
    return d == d ? d : 0;
}

/* Describes a row of faces between slices. Each `beside` is a mean of differences of two voxels. */
static face_row describe_faces(const float *const slices[3], size_t pitch, size_t row, int axis)
{
    const size_t at = row * pitch + 1, to = axis == 0 ? 1 : axis == 1 ? pitch : 0;
    const float *low = slices[1] + at, *high = axis == 2 ? slices[2] + at : low + to;
    face_row f = {.low = low, .high = high};
    for (int a = 0, n = 0; a < 3; a++) {
        const size_t step = a == 0 ? 1 : pitch;
        if (a == axis)
            continue;
        f.low_beside[n] = a == 2 ? slices[0] + at : low - step;
        f.high_beside[n++] = a == 2 ? slices[0] + at + to : high - step;
        f.low_beside[n] = a == 2 ? slices[2] + at : low + step;
        f.high_beside[n++] = a == 2 ? slices[2] + at + to : high + step;
    }
    return f;
}

/* Sets the gradient at faces: across them, where it is NaN beside a voxel without a value, and along
 * the two other axes. */
static void find_gradients(const face_row *f, const float scale[3], size_t count,
                           float *restrict across, float *restrict first,
                           float *restrict second)
{
    const float *restrict low = f->low, *restrict high = f->high;
    const float *restrict l0 = f->low_beside[0], *restrict l1 = f->low_beside[1],
                          *restrict l2 = f->low_beside[2], *restrict l3 = f->low_beside[3];
    const float *restrict h0 = f->high_beside[0], *restrict h1 = f->high_beside[1],
                          *restrict h2 = f->high_beside[2], *restrict h3 = f->high_beside[3];
    const float by = scale[0], by_first = scale[1] / 4, by_second = scale[2] / 4;
#ifndef __clang__ /* which warns where optimisation is off */
#pragma omp simd
#endif
    for (size_t i = 0; i < count; i++) {
        across[i] = by * (high[i] - low[i]);
        first[i] = by_first * (known_difference(l1[i], l0[i]) + known_difference(h1[i], h0[i]));
        second[i] =
            by_second * (known_difference(l3[i], l2[i]) + known_difference(h3[i], h2[i]));
    }
}

void cwi_edge_flow(const cwi_flow_slices *s, size_t row, int axis, size_t count, float *work,
                   float *flow)
{
    const float *unit = s->per_voxel;
    const float scale[3] = {unit[axis], unit[axis == 0], unit[axis == 2 ? 1 : 2]};
    const face_row raw = describe_faces(s->raw, s->pitch, row, axis),
                   smooth = describe_faces(s->smooth, s->pitch, row, axis);
    float *restrict g[3], *restrict n[3], *restrict to = flow;
    for (int a = 0; a < 3; a++) {
        g[a] = work + (size_t)a * count;
        n[a] = work + (size_t)(3 + a) * count;
    }
    find_gradients(&raw, scale, count, g[0], g[1], g[2]);
    find_gradients(&smooth, scale, count, n[0], n[1], n[2]);
    const float *restrict g0 = g[0], *restrict g1 = g[1], *restrict g2 = g[2],
                          *restrict n0 = n[0], *restrict n1 = n[1], *restrict n2 = n[2];
#ifndef __clang__
#pragma omp simd
#endif
    for (size_t i = 0; i < count; i++) {
        const float steep_sq = n0[i] * n0[i] + n1[i] * n1[i] + n2[i] * n2[i];
        const float along = g0[i] * n0[i] + g1[i] * n1[i] + g2[i] * n2[i];
        const float kept = (1 - cwi_fast_exp(steep_sq)) / (steep_sq + 1e-20f);
        const float flows = scale[0] * (g0[i] - kept * along * n0[i]);
        to[i] = flows == flows ? flows : 0;
    }
}

/* Smooths along an axis. A missing neighbour counts as the value in the middle. */
static void smooth_row(const float *before, const float *middle, const float *behind,
                       size_t count, float *restrict to)
{
#ifndef __clang__
#pragma omp simd
#endif
    for (size_t i = 0; i < count; i++) {
        const float m = middle[i];
        to[i] = m + 0.25f * (known_difference(before[i], m) + known_difference(behind[i], m));
    }
}

void cwi_smooth_slice(const float *const raw[3], size_t pitch, size_t rows, float *work,
                      float *to)
{
    float *row = work + pitch * (rows + 2);
    smooth_row(raw[0], raw[1], raw[2], pitch * (rows + 2), work);
    for (size_t j = 1; j <= rows; j++) {
        const float *at = work + j * pitch;
        smooth_row(at - pitch, at, at + pitch, pitch, row);
        smooth_row(row, row + 1, row + 2, pitch - 2, to + j * pitch + 1);
    }
}
