/* Makes samples of label interfaces, and keeps their lists. */
#include "simplify/interfaces/label_samples.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

/* ---- building --------------------------------------------------------------------------- */

/* Returns the next corner in a vertex's list, from `at` on, whose triangle is of a patch that no
 * corner before it is of. */
static uint32_t find_new_patch(const cwi_complex *c, uint32_t vertex, uint32_t at)
{
    for (; at != CWI_NO_INDEX; at = c->next[at]) {
        uint32_t before = c->heads[vertex];
        while (before != at && c->patches[before / 3] != c->patches[at / 3])
            before = c->next[before];
        if (before == at)
            return at;
    }
    return CWI_NO_INDEX;
}

static void count_samples(cwi_label_samples *s, const cwi_complex *c)
{
    for (size_t v = 0; v < c->vertex_count; v++) {
        s->first_sample[v] = (uint32_t)s->count;
        for (uint32_t at = find_new_patch(c, (uint32_t)v, c->heads[v]); at != CWI_NO_INDEX;
             at = find_new_patch(c, (uint32_t)v, c->next[at]))
            s->count++;
    }
    s->first_sample[c->vertex_count] = (uint32_t)s->count;
}

static void fill_samples(cwi_label_samples *s, const cwi_complex *c)
{
    size_t sample = 0, filled = 0;
    for (size_t v = 0; v < c->vertex_count; v++)
        for (uint32_t at = find_new_patch(c, (uint32_t)v, c->heads[v]); at != CWI_NO_INDEX;
             at = find_new_patch(c, (uint32_t)v, c->next[at])) {
            s->vertices[sample] = (uint32_t)v;
            s->patches[sample] = c->patches[at / 3];
            s->first_triangle[sample++] = (uint32_t)filled;
            for (uint32_t other = at; other != CWI_NO_INDEX; other = c->next[other])
                if (c->patches[other / 3] == c->patches[at / 3])
                    s->triangles[filled++] = other / 3;
        }
    s->first_triangle[sample] = (uint32_t)filled;
}

static bool alloc_samples(cwi_label_samples *s, const cwi_complex *c)
{
    s->vertices = cwi_alloc_array(s->count, sizeof *s->vertices);
    s->patches = cwi_alloc_array(s->count, sizeof *s->patches);
    s->first_triangle = cwi_alloc_array(s->count + 1, sizeof *s->first_triangle);
    s->triangles = cwi_alloc_array(3 * c->triangle_count, sizeof *s->triangles);
    s->tighten_levels = cwi_alloc_zeroed(s->count, sizeof *s->tighten_levels);
    s->next = cwi_alloc_array(s->count, sizeof *s->next);
    s->heads = cwi_alloc_array(c->triangle_count, sizeof *s->heads);
    s->collected = cwi_alloc_array(s->count, sizeof *s->collected);
    s->nearest = cwi_alloc_array(s->count, sizeof *s->nearest);
    s->originals = cwi_alloc_array(3 * c->vertex_count, sizeof *s->originals);
    s->sample_marks = cwi_alloc_zeroed(s->count, sizeof *s->sample_marks);
    s->triangle_marks = cwi_alloc_zeroed(c->triangle_count, sizeof *s->triangle_marks);
    s->met = cwi_alloc_array(c->triangle_count, sizeof *s->met);
    return s->vertices && s->patches && s->first_triangle && s->triangles &&
           s->tighten_levels && s->next && s->heads && s->collected && s->nearest &&
           s->originals && s->sample_marks && s->triangle_marks && s->met;
}

cw_status cwi_label_samples_build(cwi_label_samples *s, const cwi_complex *c,
                                  const uint32_t *corners, double error, cw_error *err)
{
    memset(s, 0, sizeof *s);
    s->error = error;
    s->corners = corners;
    s->first_sample = cwi_alloc_array(c->vertex_count + 1, sizeof *s->first_sample);
    if (s->first_sample)
        count_samples(s, c);
    if (!s->first_sample || !alloc_samples(s, c))
        return cwi_fail_memory(err);
    memcpy(s->originals, c->points, 3 * c->vertex_count * sizeof *s->originals);
    fill_samples(s, c);
    return CW_OK;
}

void cwi_label_samples_free(cwi_label_samples *s)
{
    cwi_free(s->originals);
    cwi_free(s->first_sample);
    cwi_free(s->vertices);
    cwi_free(s->patches);
    cwi_free(s->first_triangle);
    cwi_free(s->triangles);
    cwi_free(s->tighten_levels);
    cwi_free(s->next);
    cwi_free(s->heads);
    cwi_free(s->collected);
    cwi_free(s->nearest);
    cwi_free(s->sample_marks);
    cwi_free(s->triangle_marks);
    cwi_free(s->met);
    memset(s, 0, sizeof *s);
}

static void list_sample(cwi_label_samples *s, uint32_t sample, uint32_t triangle)
{
    s->next[sample] = s->heads[triangle];
    s->heads[triangle] = sample;
}

void cwi_label_samples_restart(cwi_label_samples *s, cwi_complex *c)
{
    memset(s->heads, 0xff, c->triangle_count * sizeof *s->heads);
    for (size_t n = 0; n < s->count; n++) {
        list_sample(s, (uint32_t)n, s->triangles[s->first_triangle[n]]);
        if (s->tighten_levels[n] >= CWI_LABEL_MAX_TIGHTENING)
            c->orders[s->vertices[n]] = CWI_ORDER_HELD;
    }
}

uint32_t cwi_label_samples_find(const cwi_label_samples *s, uint32_t vertex, uint32_t patch)
{
    for (uint32_t n = s->first_sample[vertex]; n < s->first_sample[vertex + 1]; n++)
        if (s->patches[n] == patch)
            return n;
    return CWI_NO_INDEX;
}

void cwi_label_samples_move(cwi_label_samples *s, const cwi_collapse_ring *ring)
{
    for (size_t i = 0; i < ring->triangle_count; i++)
        s->heads[ring->triangles[i].triangle] = CWI_NO_INDEX;
    for (size_t i = 0; i < ring->gone_count; i++)
        s->heads[ring->gone[i]] = CWI_NO_INDEX;
    for (size_t n = 0; n < s->collected_count; n++)
        list_sample(s, s->collected[n], ring->triangles[s->nearest[s->collected[n]]].triangle);
}
