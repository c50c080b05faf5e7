/* Finds the light of four cells by two points of each, in single precision. */
#include "viewer/cpu/cell_batch.h"

#include "viewer/cpu/lighting_lanes.h"

#include <math.h>

typedef cwi_lanes lanes;

/* The way to a point takes this fraction of the value at the other point: 1/4 -+ sqrt(3) / 6. */
static const float TO_FIRST = -0.038675134594812866f, TO_SECOND = 0.53867513459481287f;

/* Looks up colours and extinctions of four rows. */
static inline void glow_of_rows(const cwi_table *table, lanes rows, lanes glow[4])
{
    const lanes max = cwi_lanes_spread(CWI_TABLE_ROWS - 1);
    const lanes at = cwi_lanes_max(cwi_lanes_min(rows, max), cwi_lanes_spread(0));
    const cwi_int_lanes below = __builtin_convertvector(at, cwi_int_lanes),
                        is_last = below > CWI_TABLE_ROWS - 2, n = below + is_last;
    const lanes fraction = at - __builtin_convertvector(n, lanes);
    for (int k = 0; k < 4; k++) {
        const float *row = table->rows + 4 * (ptrdiff_t)n[k];
        const lanes low = cwi_lanes_load(row), high = cwi_lanes_load(row + 4);
        glow[k] = low + fraction[k] * (high - low);
    }
    cwi_lanes_transpose(glow);
}

/* Changes the glow of a point of each cell by its gradient, given in index space. */
static void change_by_gradients(const cwi_batch_scene *s, const lanes t, const lanes along[3],
                                lanes shadow, lanes glow[4])
{
    lanes gradient[3];
    for (int r = 0; r < 3; r++) {
        const float *m = s->to_eye[r];
        gradient[r] = m[0] * along[0] + m[1] * along[1] + m[2] * along[2];
    }
    const lanes length = cwi_lanes_root(gradient[0] * gradient[0] + gradient[1] * gradient[1] +
                                        gradient[2] * gradient[2]);
    for (int k = 0; k < 4 && s->frame->transfer.gradient_count > 0; k++)
        glow[3][k] *= (float)cwi_frame_gradient_factor(s->frame, (double)(s->unit * length[k]));
    if (s->frame->scene.lit)
        cwi_lighting_shade_lanes(s->lighting, t, gradient, length, s->unit, shadow, glow);
}

static void change_by_depth(const cwi_batch_scene *s, lanes t, lanes glow[4])
{
    lanes cue;
    for (int k = 0; k < 4; k++)
        cue[k] = (float)cwi_frame_cue(s->frame, (double)t[k] * s->deepening);
    for (int c = 0; c < 3; c++)
        glow[c] = cue * glow[c] + (1 - cue) * s->background[c];
}

/* Returns the maximum difference of the two points of a segment in what they send. */
static lanes difference_of(const lanes front[4], const lanes back[4], lanes depth, lanes length)
{
    const lanes rise = (front[3] - back[3]) * length;
    lanes max = cwi_lanes_max(rise, -rise);
    for (int c = 0; c < 3; c++) {
        const lanes turn = depth * (front[c] - back[c]);
        max = cwi_lanes_max(max, cwi_lanes_max(turn, -turn));
    }
    return max;
}

cwi_batch_light cwi_cell_batch_light(const cwi_batch_scene *s, const cwi_cell_batch *batch)
{
    lanes rows[4], front[4], back[4], from, length;
    for (int k = 0; k < 4; k++) {
        rows[k] = batch->rows[k];
        from[k] = (float)batch->cells[k].from;
        length[k] = (float)(batch->cells[k].to - batch->cells[k].from);
    }
    cwi_lanes_transpose(rows);
    glow_of_rows(s->table, rows[1], front);
    glow_of_rows(s->table, rows[2], back);
    const lanes near = from + (float)CWI_FIRST_POINT * length,
                far = from + (float)CWI_SECOND_POINT * length;
    if (s->has_gradients) {
        lanes xy[4], zs[4];
        for (int k = 0; k < 4; k++) {
            xy[k] = batch->gradient_xy[k];
            zs[k] = batch->gradient_z_shadow[k];
        }
        cwi_lanes_transpose(xy);
        cwi_lanes_transpose(zs);
        change_by_gradients(s, near, (const lanes[3]){xy[0], xy[2], zs[0]}, zs[2], front);
        change_by_gradients(s, far, (const lanes[3]){xy[1], xy[3], zs[1]}, zs[3], back);
    }
    if (s->frame->scene.depth_cue > 0) {
        change_by_depth(s, near, front);
        change_by_depth(s, far, back);
    }

    /* The opacity is that of the optical depth, which is more exact than the sum over the
     * points alone; the points give the colour. */
    cwi_batch_light out;
    const lanes one = cwi_lanes_spread(1);
    out.depth = (front[3] + back[3]) * 0.5f * length;
    const lanes a = cwi_lanes_min(front[3] * length, one),
                b = cwi_lanes_min(back[3] * length, one);
    const lanes p = a * cwi_lanes_fade(0.25f * a + TO_FIRST * b),
                q = b * cwi_lanes_fade(TO_SECOND * a + 0.25f * b);
    out.left = cwi_lanes_fade(0.5f * (a + b));
    const lanes sum = p + q;
    const lanes fraction = (1 - out.left) / cwi_lanes_choose(sum > 0, sum, one);
    for (int c = 0; c < 3; c++)
        out.color[c] = fraction * (p * front[c] + q * back[c]);
    out.difference =
        s->has_gradients ? difference_of(front, back, out.depth, length) : cwi_lanes_spread(0);
    return out;
}
