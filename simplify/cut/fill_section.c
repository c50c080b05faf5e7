/* Fills the closed loops of a section with triangles: holes are joined to the loops around them, and
 * then ears are cut off. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/cut/section.h"

#include <math.h>

/* Chooses the coordinates, so that triangles against the clock face away from what is kept, or
 * toward it if the mesh is inside out. */
static void choose_axes(cwi_section *s, bool inverted)
{
    const cwi_cut *c = s->cut;
    s->direction = (c->normal[c->axis] < 0) != inverted ? 1 : -1;
    s->u = (c->axis + (s->direction > 0 ? 1 : 2)) % 3;
    s->v = (c->axis + (s->direction > 0 ? 2 : 1)) % 3;
}

/* Measures the area of a loop, and finds its leftmost node. */
static void measure_loop(const cwi_section *s, cwi_section_loop *loop)
{
    const float *origin = cwi_section_point(s, loop->begin);
    double sum = 0;
    loop->leftmost = loop->begin;
    for (uint32_t n = loop->begin; n < loop->end; n++) {
        const float *p = cwi_section_point(s, n), *q = cwi_section_point(s, s->nodes[n].next),
                    *left = cwi_section_point(s, loop->leftmost);
        const double pu = (double)p[s->u] - (double)origin[s->u],
                     pv = (double)p[s->v] - (double)origin[s->v],
                     qu = (double)q[s->u] - (double)origin[s->u],
                     qv = (double)q[s->v] - (double)origin[s->v];
        sum += pu * qv - pv * qu;
        if (p[s->u] < left[s->u] || (p[s->u] == left[s->u] && p[s->v] < left[s->v]))
            loop->leftmost = n;
    }
    loop->area = sum / 2;
}

static double measure_loops(cwi_section *s)
{
    double sum = 0;
    for (size_t n = 0; n < s->loop_count; n++) {
        measure_loop(s, s->loops + n);
        sum += s->loops[n].area;
    }
    return sum;
}

static bool make_rings(cwi_section *s)
{
    const cwi_cut *c = s->cut;
    const size_t count = c->loop_count ? c->loop_ends[c->loop_count - 1] : 0;
    s->nodes = cwi_alloc_array(count + 2 * c->loop_count, sizeof *s->nodes);
    s->loops = cwi_alloc_zeroed(c->loop_count, sizeof *s->loops);
    if (!s->nodes || !s->loops)
        return false;
    for (size_t n = 0; n < c->loop_count; n++) {
        const uint32_t begin = (uint32_t)s->node_count, end = (uint32_t)c->loop_ends[n];
        s->loops[s->loop_count++] = (cwi_section_loop){.begin = begin, .end = end};
        for (uint32_t i = begin; i < end; i++)
            s->nodes[s->node_count++] =
                (cwi_section_node){c->loop_vertices[i], i + 1 < end ? i + 1 : begin,
                                   i > begin ? i - 1 : end - 1, (uint32_t)n};
    }
    return true;
}

static bool add_triangle(void *user, uint32_t a, uint32_t b, uint32_t c)
{
    cwi_cut *cut = user;
    cut->facts.cap_triangles++;
    return cwi_cut_add_triangle(cut, a, b, c);
}

cw_status cwi_section_clip_ears(cwi_section *s, const cwi_section_loop *loop, cw_error *err)
{
    cwi_ears ears = {.positions = s->cut->positions,
                     .nodes = s->nodes,
                     .node_count = s->node_count,
                     .axis = s->cut->axis,
                     .direction = s->direction,
                     .tolerance = s->cut->tolerance,
                     .is_flipped = loop->is_free,
                     .add = add_triangle,
                     .user = s->cut,
                     .progress = &s->cut->desc.progress};
    return cwi_clip_ears(&ears, loop->begin, err);
}

static cw_status fill_rings(cwi_section *s, cw_error *err)
{
    cw_cut_facts *f = &s->cut->facts;
    const size_t first = s->cut->triangle_count;
    cw_status st = cwi_section_join_holes(s, err);
    for (size_t n = 0; n < s->loop_count && st == CW_OK; n++)
        if (!s->loops[n].is_joined)
            st = cwi_section_clip_ears(s, s->loops + n, err);
    f->loops_closed = s->loop_count;
    return st == CW_OK ? cwi_section_flip(s, first, err) : st;
}

cw_status cwi_cut_fill(cwi_cut *c, cw_error *err)
{
    cwi_section s = {.cut = c};
    double area = 0;
    cw_status st = make_rings(&s) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && s.loop_count) {
        choose_axes(&s, false);
        if (measure_loops(&s) < 0) {
            choose_axes(&s, true);
            measure_loops(&s);
        }
        if (c->desc.leave_open)
            c->facts.loops_open += s.loop_count;
        else
            st = fill_rings(&s, err);
        for (size_t n = 0; n < s.loop_count; n++)
            area += s.loops[n].is_free ? -s.loops[n].area : s.loops[n].area;
        c->facts.area_mm2 = area / fabs(c->normal[c->axis]);
    }
    cwi_free(s.nodes);
    cwi_free(s.loops);
    return st;
}
