/* Implements the simplifier of surfaces that come one slab at a time: makes blocks of slabs and
 * passes them on. */
#include "simplify/slab_simplifier.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/triangle.h"
#include "simplify/blocks/partition.h"
#include "simplify/simplify_frame.h"

#include <math.h>
#include <string.h>

/* Down to a number of triangles slabs go by themselves, to this many times their share: where
 * triangles are needed most is seen when all are there. */
enum { SPARE = 3 };

/* Bytes that a slab takes at least for a triangle, with an error to keep: its arrays, and their
 * copies in blocks. */
enum { TRIANGLE_BYTES = 120 };

struct cw_simplifier {
    cw_simplify_desc desc;
    cwi_passes passes;
    cw_mesh frame; /* where positions are; no arrays */
    double scale;  /* of what follows; 0 until a slab came. As in cw_simplify() */
    bool ended;
    /* with an error to keep */
    cwi_slab_window window;
    /* with a number of triangles to meet */
    cwi_mesh_block *slabs;
    size_t count, capacity, triangles;
    size_t id_count, below; /* of vertices in seams so far; the first of the last seam */
};

/* --- a slab as a block -------------------------------------------------------------------- */

void cwi_slab_block_free(cwi_slab_block *s)
{
    cwi_block_free(&s->block);
    cwi_free(s->seam);
    cwi_free(s->rank);
    cwi_free(s->below);
    *s = (cwi_slab_block){0};
}

/* Numbers vertices as triangles name them. */
static void number_vertices(cwi_slab_block *s, const cw_mesh *m, uint32_t *number)
{
    cwi_mesh_block *b = &s->block;
    memset(number, 0xff, m->vertex_count * sizeof *number);
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        uint32_t *n = number + m->triangles[c];
        if (*n == UINT32_MAX)
            *n = (uint32_t)b->vertices++;
        b->corners[c] = *n;
    }
    b->triangles = m->triangle_count;
    s->vertices = b->vertices;
}

static void copy_vertices(cwi_slab_block *s, const cw_slab *from, double scale,
                          const uint32_t *number)
{
    cwi_mesh_block *b = &s->block;
    for (size_t v = 0; v < from->mesh->vertex_count; v++) {
        const size_t n = number[v];
        const uint8_t seam = from->seam[v];
        const size_t rank = seam ? s->ranks[seam]++ : 0;
        if (seam == 1)
            s->below[rank] = number[v];
        if (n == UINT32_MAX)
            continue;
        cwi_scale_points(from->mesh->positions + 3 * v, 1, scale, b->points + 3 * n);
        b->global_ids[n] = (uint32_t)n;
        b->locked[n] = s->seam[n] = seam;
        s->rank[n] = (uint32_t)rank;
    }
}

static double longest_edge(const cwi_mesh_block *b)
{
    double longest = 0;
    for (size_t c = 0; c < 3 * b->triangles; c++) {
        const float *p = b->points + 3 * (size_t)b->corners[c],
                    *q = b->points + 3 * (size_t)b->corners[cwi_corner_next((uint32_t)c)];
        const double d[3] = {(double)(q[0] - p[0]), (double)(q[1] - p[1]),
                             (double)(q[2] - p[2])};
        longest = fmax(longest, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    return sqrt(longest);
}

/* Heights in the unit of the points. */
static void set_planes(cwi_mesh_block *b, const cw_slab *from, double scale)
{
    const double length =
        sqrt(from->along[0] * from->along[0] + from->along[1] * from->along[1] +
             from->along[2] * from->along[2]);
    for (int a = 0; a < 3; a++)
        b->along[a] = (float)(from->along[a] / length);
    b->from = (float)(from->low / length * scale);
    b->to = (float)(from->high / length * scale);
}

cw_status cwi_slab_block_init(cwi_slab_block *s, const cw_slab *from, double scale,
                              cw_error *err)
{
    const cw_mesh *m = from->mesh;
    *s = (cwi_slab_block){.last = from->last};
    cwi_mesh_block *b = &s->block;
    uint32_t *number = cwi_alloc_array(m->vertex_count, sizeof *number);
    b->corners = cwi_alloc_array(3 * m->triangle_count, sizeof *b->corners);
    if (number && b->corners)
        number_vertices(s, m, number);
    b->points = cwi_alloc_array(3 * b->vertices, sizeof *b->points);
    b->global_ids = cwi_alloc_array(b->vertices, sizeof *b->global_ids);
    b->locked = cwi_alloc_array(b->vertices, sizeof *b->locked);
    s->seam = cwi_alloc_array(b->vertices, sizeof *s->seam);
    s->rank = cwi_alloc_array(b->vertices, sizeof *s->rank);
    s->below = cwi_alloc_array(m->vertex_count, sizeof *s->below);
    const bool ok = number && b->corners && b->points && b->global_ids && b->locked &&
                    s->seam && s->rank && s->below;
    if (ok)
        copy_vertices(s, from, scale, number);
    cwi_free(number);
    cwi_block_span(b);
    set_planes(b, from, scale);
    s->longest = ok ? longest_edge(b) : 0;
    return ok ? CW_OK : cwi_fail_memory(err);
}

/* --- down to a number of triangles -------------------------------------------------------- */

/* Vertices in seams get names of their own among those of all slabs; the others need none. */
static cw_status number_seams(cw_simplifier *s, const cwi_slab_block *slab, cwi_mesh_block *b,
                              cw_error *err)
{
    const size_t first[3] = {0, s->below, s->id_count};
    b->locked = cwi_alloc_array(b->vertices, sizeof *b->locked);
    if (!b->locked)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < b->vertices; v++) {
        const uint32_t n = b->global_ids[v];
        b->locked[v] = slab->seam[n];
        b->global_ids[v] = b->locked[v] ? (uint32_t)(first[b->locked[v]] + slab->rank[n]) : 0;
    }
    s->below = s->id_count;
    s->id_count += slab->ranks[2];
    return CW_OK;
}

static cw_status add_slab(cw_simplifier *s, cwi_slab_block *slab, cw_error *err)
{
    if (s->count == s->capacity) {
        const size_t capacity = 2 * s->capacity + 8;
        cwi_mesh_block *slabs = cwi_realloc_array(s->slabs, capacity, sizeof *slabs);
        if (!slabs)
            return cwi_fail_memory(err);
        s->slabs = slabs;
        s->capacity = capacity;
    }
    cwi_mesh_block *b = s->slabs + s->count++;
    *b = slab->block;
    slab->block = (cwi_mesh_block){0};
    const double fraction = (double)b->triangles / (double)s->triangles,
                 target = (double)cwi_simplify_target(&s->desc, s->triangles);
    cw_status st =
        cwi_passes_blocks(&s->passes, b, (size_t)(SPARE * fraction * target) + 1, err);
    return st == CW_OK ? number_seams(s, slab, b, err) : st;
}

static cw_status join_slabs(cw_simplifier *s, cwi_mesh_block *left, cw_error *err)
{
    const size_t target = cwi_simplify_target(&s->desc, s->triangles);
    cwi_mesh_block whole;
    cw_status st = cwi_blocks_join(s->slabs, s->count, s->id_count + 1, &whole, err);
    for (size_t n = 0; n < s->count; n++)
        cwi_block_free(s->slabs + n);
    s->count = 0;
    cwi_block_number(&whole);
    if (st == CW_OK && whole.triangles > CWI_BLOCK)
        st = cwi_passes_blocks(&s->passes, &whole, target, err);
    if (st == CW_OK)
        st = cwi_passes_seams(&s->passes, &whole, target, err);
    if (st == CW_OK)
        st = cwi_passes_whole(&s->passes, &whole, &target, 1, left, err);
    cwi_block_free(&whole);
    return st;
}

/* Fails before the work where a slab does not fit. */
static cw_status expect_memory(const cw_slab *from, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    const size_t left = cwi_memory_left(), needed = TRIANGLE_BYTES * from->mesh->triangle_count;
    if (needed <= left)
        return CW_OK;
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(left, left_text);
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "a slab of %zu triangles takes at least %s, and cw_memory_limit() leaves %s",
        from->mesh->triangle_count, needed_text, left_text);
}

/* --- the public calls --------------------------------------------------------------------- */

cw_status cw_simplifier_new(const cw_simplify_desc *desc, cw_simplifier **out, cw_error *err)
{
    CWI_REQUIRE(err, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    *out = NULL;
    if ((desc->error_mm == 0) == (desc->ratio == 0 && desc->triangles == 0))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "slabs are simplified to an error, or to a number of triangles or a "
                        "ratio: one of these");
    if (desc->normal_weight != 0 || desc->color_weight != 0 || desc->scalar_weight != 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "slabs have neither normals, nor colours or scalars to weigh");
    cw_simplifier *s = cwi_alloc_zeroed(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    s->desc = *desc;
    cw_status st = cwi_passes_init(&s->passes, &s->desc, err);
    if (st != CW_OK)
        cw_simplifier_free(s);
    else
        *out = s;
    return st;
}

void cw_simplifier_free(cw_simplifier *s)
{
    if (!s)
        return;
    for (size_t n = 0; n < s->count; n++)
        cwi_block_free(s->slabs + n);
    cwi_free(s->slabs);
    cwi_window_free(&s->window);
    cwi_passes_free(&s->passes);
    cwi_free(s);
}

cw_status cw_simplifier_take(void *simplifier, const cw_slab *from, cw_error *err)
{
    CWI_REQUIRE(err, simplifier, from);
    cw_simplifier *s = simplifier;
    cwi_slab_block slab;
    cwi_stop_init(&s->passes.stop, &s->desc.progress); /* this thread may be another one */
    if (s->ended)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a slab after the last");
    memcpy(s->frame.origin, from->mesh->origin, sizeof s->frame.origin);
    memcpy(s->frame.affine, from->mesh->affine, sizeof s->frame.affine);
    s->triangles = from->triangles;
    s->ended = from->last;
    if (s->scale == 0) {
        s->scale = cwi_simplify_scale(from->mesh);
        cwi_passes_place(&s->passes, s->frame.origin, s->scale);
    }
    cw_status st = s->desc.error_mm > 0 ? expect_memory(from, err) : CW_OK;
    if (st != CW_OK)
        return st;
    st = cwi_slab_block_init(&slab, from, s->scale, err);
    if (st == CW_OK)
        st = s->desc.error_mm > 0 ? cwi_window_take(&s->window, &s->passes, &slab, err)
                                  : add_slab(s, &slab, err);
    cwi_slab_block_free(&slab);
    return st;
}

static cw_status finish_mesh(cw_simplifier *s, cw_mesh *out, size_t *nonmanifold_count,
                             cw_error *err)
{
    cwi_slab_window *w = &s->window;
    cwi_mesh_block left = {.vertices = w->vertices,
                           .triangles = w->triangles,
                           .points = w->points,
                           .corners = w->corners,
                           .nonmanifold_count = w->nonmanifold_count};
    cw_status st = CW_OK;
    if (s->desc.error_mm == 0)
        st = join_slabs(s, &left, err);
    *nonmanifold_count = left.nonmanifold_count;
    if (st == CW_OK)
        st = cwi_finish_mesh(&s->frame, &left, out, err);
    cwi_scale_points(out->positions, out->vertex_count, 1 / s->scale, out->positions);
    if (s->desc.error_mm == 0)
        cwi_block_free(&left);
    return st;
}

cw_status cw_simplifier_finish(cw_simplifier *s, cw_mesh *out, cw_simplify_facts *facts,
                               cw_error *err)
{
    CWI_REQUIRE(err, s, out);
    size_t nonmanifold_count = 0;
    cw_status st = CW_OK;
    *out = (cw_mesh){0};
    cwi_stop_init(&s->passes.stop, &s->desc.progress);
    if (s->scale > 0 && !s->ended)
        return cwi_fail(err, CW_ERR_ARGUMENT, "slabs are missing: there was no last one");
    if (s->scale > 0)
        st = finish_mesh(s, out, &nonmanifold_count, err);
    if (st == CW_OK && facts)
        *facts = (cw_simplify_facts){.vertices = out->vertex_count,
                                     .triangles = out->triangle_count,
                                     .cut = nonmanifold_count,
                                     .passes = 1 + s->passes.repeats};
    return st;
}
