/* Measures a surface that comes in chunks. In memory are only the vertices and triangles at its
 * front: those that later chunks may still change. */
#include <cubewright/quality.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "core/mesh/mesh.h"
#include "simplify/quality/triangle_shapes.h"
#include "simplify/quality/vertex_one_rings.h"
#include "simplify/quality/vertex_ranges.h"

#include <math.h>
#include <string.h>

/* Elements of the smallest array, and vertices that are settled at a time. A larger front is
 * settled in four steps, so that their arrays are small beside it. */
enum { MIN_CAPACITY = 512, MIN_STEP = 65536, STEPS = 4 };

enum { VERTEX_BYTES = 3 * sizeof(float), TRIANGLE_BYTES = 3 * sizeof(uint32_t) };

struct cw_quality_stream {
    cw_quality_stream_desc desc;
    cw_quality q; /* so far; vertices and triangles are those that came */
    cwi_border border;
    double origin[3];
    double low[3], high[3];
    size_t joined;          /* vertices that triangles joined to others */
    size_t named, named_by; /* one above the highest vertex named, and the triangle */

    size_t final;   /* vertices before this one get no more triangles */
    size_t settled; /* vertices before this one were measured */
    uint32_t *sets; /* union-find: vertices from `settled` on that share triangles */
    size_t set_count, set_capacity;

    size_t placed; /* positions begin with this vertex */
    float *positions;
    size_t position_capacity;

    uint32_t *triangles; /* held x 3 vertices of the surface */
    size_t held, triangle_capacity;
    size_t shaped; /* the first of them, which were added to the area and shapes */

    cw_status status; /* of the first chunk that failed */
    bool finished;
};

static uint32_t lowest_of(const uint32_t *c)
{
    const uint32_t low = c[0] < c[1] ? c[0] : c[1];
    return low < c[2] ? low : c[2];
}

static uint32_t highest_of(const uint32_t *c)
{
    const uint32_t high = c[0] > c[1] ? c[0] : c[1];
    return high > c[2] ? high : c[2];
}

/* --- area and shapes ---------------------------------------------------------------------- */

typedef struct shape_work {
    const cw_quality_stream *stream;
    cwi_shape_sum *sums;
    size_t end; /* of the held triangles */
} shape_work;

static void sum_shapes(void *context, size_t k)
{
    const shape_work *work = context;
    const cw_quality_stream *s = work->stream;
    const size_t begin = s->shaped + k * CWI_SHAPE_CHUNK, chunk_end = begin + CWI_SHAPE_CHUNK;
    cwi_shape_block block = {0};
    cwi_shape_sum_init(&work->sums[k]);
    for (size_t t = begin; t < chunk_end && t < work->end; t++) {
        const uint32_t *c = s->triangles + 3 * t;
        for (int n = 0; n < 3; n++)
            for (int a = 0; a < 3; a++)
                block.corner[n][a][block.count] =
                    (double)s->positions[3 * (c[n] - s->placed) + (size_t)a];
        block.collapsed[block.count++] = cwi_triangle_is_collapsed(c);
        if (block.count == CWI_SHAPE_BLOCK)
            cwi_shape_sum_add(&work->sums[k], &block);
    }
    cwi_shape_sum_add(&work->sums[k], &block);
}

/* Adds the shapes of triangles whose vertices came, and that follow each other. The sums are
 * those of cwi_measure_shapes(): of as many triangles, in the same order. */
static bool add_shapes(cw_quality_stream *s, bool last)
{
    shape_work work = {.stream = s, .end = s->shaped};
    while (work.end < s->held && highest_of(s->triangles + 3 * work.end) < s->q.vertices)
        work.end++;
    const size_t count = work.end - s->shaped;
    const size_t sums = (count + (last ? CWI_SHAPE_CHUNK - 1 : 0)) / CWI_SHAPE_CHUNK;
    const cw_progress silent = {0};
    if (!sums)
        return true;
    work.sums = cwi_alloc_array(sums, sizeof *work.sums);
    if (!work.sums)
        return false;
    const bool ok = cwi_parallel_for(sums, CWI_SHAPE_CHUNK * 32, s->desc.threads, &silent, NULL,
                                     sum_shapes, &work, NULL) == CW_OK;
    for (size_t k = 0; k < sums; k++)
        cwi_shape_sum_join(&work.sums[k], &s->q);
    cwi_free(work.sums);
    s->shaped = last ? work.end : s->shaped + sums * CWI_SHAPE_CHUNK;
    return ok;
}

/* --- the front ---------------------------------------------------------------------------- */

/* Drops the sets of the first vertices. A set whose root is one of them gets another root. */
static void drop_sets(cw_quality_stream *s, uint32_t count)
{
    uint32_t *sets = s->sets;
    for (uint32_t v = count; v < s->set_count; v++)
        sets[v] = cwi_sets_find(sets, v);
    for (uint32_t v = count; v < s->set_count; v++) {
        const uint32_t root = sets[v];
        if (root >= count)
            continue;
        if (sets[root] == root)
            sets[root] = v;
        sets[v] = sets[root];
    }
    s->set_count -= count;
    for (size_t v = 0; v < s->set_count; v++)
        sets[v] = sets[v + count] - count;
}

/* Measures the topology around the next vertices that are final. */
static bool measure_next(cw_quality_stream *s, size_t count)
{
    const uint32_t begin = (uint32_t)s->settled, end = (uint32_t)(s->settled + count);
    cwi_vertex_ranges ranges;
    const cwi_one_rings rings = {.triangles = s->triangles,
                                 .count = s->held,
                                 .ranges = &ranges,
                                 .begin = begin,
                                 .end = end,
                                 .threads = s->desc.threads};
    const bool ok =
        cwi_vertex_ranges_init(&ranges, s->triangles, s->held, begin, end, s->desc.threads) &&
        cwi_measure_one_rings(&rings, &s->q, &s->border);
    cwi_vertex_ranges_free(&ranges);
    return ok && cwi_border_join(&s->border);
}

static bool settle_vertices(cw_quality_stream *s)
{
    const size_t part = s->set_count / STEPS, step = part > MIN_STEP ? part : MIN_STEP;
    while (s->settled < s->final) {
        const size_t left = s->final - s->settled, count = left < step ? left : step;
        if (!measure_next(s, count))
            return false;
        drop_sets(s, (uint32_t)count);
        s->settled += count;
    }
    return true;
}

/* Drops triangles that are measured and have final vertices only, and the positions that no other
 * triangle needs for its shape. */
static void drop_measured(cw_quality_stream *s)
{
    size_t kept = 0, shaped = 0, first = s->final;
    for (size_t t = 0; t < s->held; t++) {
        const uint32_t c[3] = {s->triangles[3 * t], s->triangles[3 * t + 1],
                               s->triangles[3 * t + 2]};
        const bool is_shaped = t < s->shaped;
        if (is_shaped && highest_of(c) < s->settled)
            continue;
        const uint32_t low = lowest_of(c);
        first = !is_shaped && low < first ? low : first;
        shaped += is_shaped;
        for (size_t n = 0; n < 3; n++)
            s->triangles[3 * kept + n] = c[n];
        kept++;
    }
    s->held = kept;
    s->shaped = shaped;
    memmove(s->positions, s->positions + 3 * (first - s->placed),
            (s->q.vertices - first) * VERTEX_BYTES);
    s->placed = first;
}

static cw_status settle_front(cw_quality_stream *s, bool last, cw_error *err)
{
    if (!add_shapes(s, last) || !settle_vertices(s))
        return cwi_fail_memory(err);
    drop_measured(s);
    return CW_OK;
}

/* --- chunks ------------------------------------------------------------------------------- */

static size_t count_bytes(const cw_quality_stream *s)
{
    return s->position_capacity * VERTEX_BYTES + s->triangle_capacity * TRIANGLE_BYTES +
           s->set_capacity * sizeof *s->sets + s->border.capacity * sizeof *s->border.ends;
}

/* Makes an array longer unless an eighth of it remains: settling a full front takes time, and
 * must not happen for every few elements. */
static cw_status grow_array(cw_quality_stream *s, void **array, size_t *capacity, size_t needed,
                            size_t element, cw_error *err)
{
    if (*array && needed <= *capacity - *capacity / 8)
        return CW_OK;
    const size_t more = needed + needed / 4 + MIN_CAPACITY,
                 bytes = count_bytes(s) + (more - *capacity) * element;
    if (s->desc.max_bytes && bytes > s->desc.max_bytes) {
        char needed_text[CWI_MEMORY_TEXT], limit_text[CWI_MEMORY_TEXT];
        cwi_print_memory(bytes, needed_text);
        cwi_print_memory(s->desc.max_bytes, limit_text);
        return cwi_fail(err, CW_ERR_LIMIT,
                        "checking the surface's front needs %s so far; the limit is %s",
                        needed_text, limit_text);
    }
    void *memory = cwi_realloc_array(*array, more, element);
    if (!memory)
        return cwi_fail_memory(err);
    *array = memory;
    *capacity = more;
    return CW_OK;
}

/* Makes room for vertices that come, vertices that are named, and a triangle. */
static cw_status ensure_capacity(cw_quality_stream *s, size_t vertices, cw_error *err)
{
    const size_t end =
        s->q.vertices + vertices > s->named ? s->q.vertices + vertices : s->named;
    if (end - s->settled <= s->set_capacity && s->held < s->triangle_capacity &&
        s->q.vertices + vertices - s->placed <= s->position_capacity)
        return CW_OK;
    cw_status st = s->triangles ? settle_front(s, false, err) : CW_OK;
    if (st == CW_OK)
        st = grow_array(s, (void **)&s->positions, &s->position_capacity,
                        s->q.vertices + vertices - s->placed, VERTEX_BYTES, err);
    if (st == CW_OK)
        st = grow_array(s, (void **)&s->sets, &s->set_capacity, end - s->settled,
                        sizeof *s->sets, err);
    if (st == CW_OK)
        st = grow_array(s, (void **)&s->triangles, &s->triangle_capacity, s->held + 1,
                        TRIANGLE_BYTES, err);
    if (st == CW_OK && s->triangle_capacity > CWI_MAX_TRIANGLES)
        st = cwi_fail(err, CW_ERR_LIMIT, "%zu triangles at once are more than can be numbered",
                      s->triangle_capacity);
    return st;
}

static cw_status check_corners(cw_quality_stream *s, const cw_mesh_chunk *chunk, cw_error *err)
{
    for (size_t i = 0; i < 3 * chunk->mesh.triangle_count; i++) {
        const uint32_t v = chunk->mesh.triangles[i];
        if (v < chunk->first_vertex)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "triangle %zu names vertex %u; its chunk begins with vertex %zu",
                            chunk->first_triangle + i / 3, v, chunk->first_vertex);
        if (v >= s->named) {
            s->named = (size_t)v + 1;
            s->named_by = chunk->first_triangle + i / 3;
        }
    }
    return CW_OK;
}

static cw_status check_chunk(cw_quality_stream *s, const cw_mesh_chunk *chunk, cw_error *err)
{
    const cw_mesh *m = &chunk->mesh;
    const cw_quality *q = &s->q;
    if ((m->vertex_count && !m->positions) || (m->triangle_count && !m->triangles))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a chunk with elements needs positions and triangles");
    if (chunk->first_vertex != q->vertices || chunk->first_triangle != q->triangles)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a chunk from vertex %zu and triangle %zu on, where %zu and %zu follow",
                        chunk->first_vertex, chunk->first_triangle, q->vertices, q->triangles);
    if (m->vertex_count > UINT32_MAX - q->vertices)
        return cwi_fail(err, CW_ERR_LIMIT, "more than 2^32 - 1 vertices");
    for (int a = 0; a < 3; a++)
        if (!isfinite(m->origin[a]) ||
            (m->origin[a] != s->origin[a] && (q->vertices || q->triangles)))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "the origin of a chunk is not finite, or not that of the first");
    for (size_t i = 0; i < 3 * m->vertex_count; i++)
        if (!isfinite(m->positions[i]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "the position of vertex %zu is not finite",
                            q->vertices + i / 3);
    return check_corners(s, chunk, err);
}

static void append_vertices(cw_quality_stream *s, const cw_mesh *m)
{
    cwi_box_add_points(s->low, s->high, m->positions, m->vertex_count);
    if (m->vertex_count)
        memcpy(s->positions + 3 * (s->q.vertices - s->placed), m->positions,
               m->vertex_count * VERTEX_BYTES);
    s->q.vertices += m->vertex_count;
    const size_t end = s->q.vertices > s->named ? s->q.vertices : s->named;
    for (; s->set_count < end - s->settled; s->set_count++)
        s->sets[s->set_count] = (uint32_t)s->set_count;
}

static void append_triangle(cw_quality_stream *s, const uint32_t *c)
{
    memcpy(s->triangles + 3 * s->held++, c, TRIANGLE_BYTES);
    s->q.triangles++;
    if (cwi_triangle_is_collapsed(c))
        return;
    s->q.euler++;
    for (int n = 1; n < 3; n++) {
        const uint32_t one = cwi_sets_find(s->sets, c[0] - (uint32_t)s->settled),
                       other = cwi_sets_find(s->sets, c[n] - (uint32_t)s->settled);
        s->joined += one != other;
        cwi_sets_join(s->sets, one, other);
    }
}

static cw_status append_chunk(cw_quality_stream *s, const cw_mesh_chunk *chunk, cw_error *err)
{
    const cw_mesh *m = &chunk->mesh;
    cw_status st = s->finished ? cwi_fail(err, CW_ERR_ARGUMENT, "a chunk after the last one")
                               : check_chunk(s, chunk, err);
    if (st != CW_OK)
        return st;
    memcpy(s->origin, m->origin, sizeof s->origin);
    s->final = chunk->first_vertex;
    st = ensure_capacity(s, m->vertex_count, err);
    if (st == CW_OK)
        append_vertices(s, m);
    for (size_t t = 0; t < m->triangle_count && st == CW_OK; t++) {
        st = ensure_capacity(s, 0, err);
        if (st == CW_OK)
            append_triangle(s, m->triangles + 3 * t);
    }
    return st;
}

static cw_status take_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    cw_quality_stream *s = user;
    if (s->status != CW_OK)
        return cwi_fail(err, s->status, "an earlier chunk could not be measured");
    s->status = append_chunk(s, chunk, err);
    return s->status;
}

/* --- public ------------------------------------------------------------------------------- */

cw_status cw_quality_stream_new(const cw_quality_stream_desc *desc, cw_quality_stream **out,
                                cw_error *err)
{
    CWI_REQUIRE(err, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_quality_stream *s = *out = cwi_alloc_zeroed(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    s->desc = desc ? *desc : (cw_quality_stream_desc){0};
    s->q.shapes.min_angle_deg = 180;
    s->q.shapes.min_edge_mm = INFINITY;
    cwi_box_clear(s->low, s->high);
    return CW_OK;
}

cw_chunk_sink cw_quality_stream_sink(cw_quality_stream *stream)
{
    return (cw_chunk_sink){take_chunk, stream};
}

/* Fills in the fields that need the whole surface. */
static void derive_totals(cw_quality_stream *s)
{
    cw_quality *q = &s->q;
    q->components -= s->joined;
    q->border_loops = s->border.loops;
    const bool oriented =
        !q->nonmanifold_edges && !q->misoriented_edges && !q->nonmanifold_vertices;
    q->genus =
        oriented ? (int64_t)q->components - (q->euler + (int64_t)q->border_loops) / 2 : -1;
    if (q->degenerate == q->triangles)
        q->shapes.min_angle_deg = q->shapes.min_edge_mm = 0;
    for (int a = 0; a < 3; a++) {
        q->min[a] = q->vertices ? s->origin[a] + s->low[a] : 0;
        q->max[a] = q->vertices ? s->origin[a] + s->high[a] : 0;
    }
}

cw_status cw_quality_stream_finish(cw_quality_stream *s, cw_quality *out, cw_error *err)
{
    CWI_REQUIRE(err, s, out);
    *out = (cw_quality){0};
    if (s->status != CW_OK || s->finished)
        return cwi_fail(err, s->status != CW_OK ? s->status : CW_ERR_ARGUMENT,
                        s->finished ? "the surface was finished before"
                                    : "a chunk of the surface could not be measured");
    s->finished = true;
    if (s->named > s->q.vertices)
        return cwi_fail(err, CW_ERR_ARGUMENT, "triangle %zu names vertex %zu of %zu",
                        s->named_by, s->named - 1, s->q.vertices);
    s->final = s->q.vertices;
    if (s->q.vertices) {
        cw_status st = settle_front(s, true, err);
        if (st != CW_OK)
            return st;
    }
    derive_totals(s);
    *out = s->q;
    return CW_OK;
}

size_t cw_quality_stream_bytes(const cw_quality_stream *stream)
{
    if (!stream)
        return 0;
    return count_bytes(stream);
}

void cw_quality_stream_free(cw_quality_stream *s)
{
    if (!s)
        return;
    cwi_border_free(&s->border);
    cwi_free(s->sets);
    cwi_free(s->positions);
    cwi_free(s->triangles);
    cwi_free(s);
}
