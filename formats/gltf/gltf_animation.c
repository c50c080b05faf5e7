/* Plans the animation that shows one piece after another: the keys of each node's scale. */
#include "formats/gltf/gltf_pack.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

/* The scales of a node in time. A row is: hidden, shown, hidden, hidden to the end; the last
 * piece has: hidden, shown, shown to the end. A piece that is shown from the start omits the
 * first of its row. */
enum { LAST_ROW = 4, ROWS = 7 };
static const float scales[ROWS] = {0, 1, 0, 0, 0, 1, 1};
enum { SCALE_BYTES = 12, VALUES_BYTES = ROWS * SCALE_BYTES };

static void add_key(cwi_gltf_piece *piece, double time_s)
{
    piece->times[piece->time_count++] = (float)time_s;
}

/* Sets the times of a piece. Every piece has a key at the end, so all samplers end together. */
static void set_keys(cwi_gltf_piece *piece, double end_s)
{
    const cwi_part *part = piece->part;
    const bool first = part->from_s == 0, last = part->until_s == end_s;
    if (!first)
        add_key(piece, 0);
    add_key(piece, part->from_s);
    if (!last)
        add_key(piece, part->until_s);
    add_key(piece, end_s);
    piece->first_scale = (last ? LAST_ROW : 0) + (first ? 1 : 0);
}

static unsigned char *put_single(unsigned char *to, float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    return cwi_put_u32(to, bits);
}

static void put_keys(const cwi_gltf_plan *plan, unsigned char *to)
{
    for (size_t i = 0; i < ROWS * 3; i++)
        to = put_single(to, scales[i / 3]);
    for (size_t p = 0; p < plan->parts.count; p++)
        for (size_t n = 0; n < plan->pieces[p].time_count; n++)
            to = put_single(to, plan->pieces[p].times[n]);
}

cw_status cwi_gltf_plan_animation(cwi_gltf_plan *plan, cw_error *err)
{
    cwi_gltf_document *d = &plan->document;
    size_t times = 0;
    d->end_s = plan->parts.end_s;
    if (d->end_s == 0)
        return CW_OK;
    for (size_t p = 0; p < plan->parts.count; p++) {
        set_keys(&plan->pieces[p], d->end_s);
        times += plan->pieces[p].time_count;
    }
    d->scale_count = ROWS;
    d->keys_at = d->bytes;
    plan->keys_size = VALUES_BYTES + 4 * times;
    plan->keys = cwi_alloc_array(plan->keys_size, 1);
    if (!plan->keys)
        return cwi_fail_memory(err);
    put_keys(plan, plan->keys);
    d->bytes += plan->keys_size;
    return CW_OK;
}
