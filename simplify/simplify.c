#include <cubewright/simplify.h>

#include "core/layers.h"
#include "core/memory.h"
#include "core/mesh.h"
#include "core/module.h"
#include "core/status.h"
#include "simplify/blocks.h"
#include "simplify/carry.h"
#include "simplify/openmesh_wrap.h"
#include "simplify/quality/within.h"

#include <math.h>
#include <string.h>

/* Triangles of a block: as few as pay for its seams, as many as a cache holds. */
enum { BLOCK = 1 << 15, MOST = 1 << 30 };

static cw_status load(const cwi_openmesh_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st =
        cwi_module_load("openmesh", "CUBEWRIGHT_OPENMESH", "libopenmesh-dev", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

bool cw_simplify_available(void)
{
    return cwi_module_present("openmesh");
}

/* One pass over one mesh. */
typedef struct job {
    const cw_mesh *mesh;
    const cwi_openmesh_functions *openmesh;
    const cw_simplify_desc *desc;
    cwi_block_desc block_desc;
    const size_t *targets; /* triangles of each level, falling */
    size_t levels;
    cw_mesh *out;             /* one a level */
    cw_simplify_facts *facts; /* the same */
    cwi_original original;    /* next is NULL without an error to keep */
    uint32_t *first, *around;
    uint8_t *care;
    uint32_t *lists, *names; /* of the result's triangles and vertices, with an error to keep */
    cwi_block whole;
    /* the blocks of the first pass */
    cwi_block *blocks;
    cwi_decimater **decimaters;
    cw_status *statuses;
    cw_error *errors;
    size_t count;
    float cost;
} job;

static cw_status check(const cw_mesh *mesh, const cw_simplify_desc *d, cw_error *err)
{
    if (!(d->error_mm >= 0) || !isfinite(d->error_mm))
        return cw_fail(err, CW_ERR_ARGUMENT, "error_mm is %g; it must be 0 or more",
                       d->error_mm);
    if (!(d->ratio >= 0) || !(d->ratio < 1))
        return cw_fail(err, CW_ERR_ARGUMENT, "ratio is %g; it must be at least 0 and below 1",
                       d->ratio);
    if (mesh->triangle_count > MOST || mesh->vertex_count > MOST)
        return cw_fail(err, CW_ERR_LIMIT,
                       "%zu triangles and %zu vertices; at most 2^30 of either are simplified",
                       mesh->triangle_count, mesh->vertex_count);
    return cw_mesh_check(mesh, err);
}

static size_t target_of(const cw_simplify_desc *d, size_t triangles)
{
    const bool is_share = d->ratio > 0 && d->ratio < 1;
    const size_t share = is_share ? (size_t)(d->ratio * (double)triangles) : 0;
    return share > d->triangles ? share : d->triangles;
}

/* Triangles that name a vertex twice are no part of any surface. */
static cw_status begin(job *j, cw_error *err)
{
    const cw_mesh *m = j->mesh;
    cwi_block *w = &j->whole;
    cwi_block_free(w);
    w->vertices = m->vertex_count;
    w->points = cwi_alloc_array(3 * w->vertices, sizeof *w->points);
    w->names = cwi_alloc_array(w->vertices, sizeof *w->names);
    w->corners = cwi_alloc_array(3 * m->triangle_count, sizeof *w->corners);
    if (!w->points || !w->names || !w->corners)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory to simplify %zu triangles",
                       m->triangle_count);
    if (w->vertices)
        memcpy(w->points, m->positions, 3 * w->vertices * sizeof *w->points);
    for (size_t v = 0; v < w->vertices; v++)
        w->names[v] = (uint32_t)v;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *c = m->triangles + 3 * t;
        if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
            memcpy(w->corners + 3 * w->triangles++, c, 3 * sizeof *c);
    }
    cwi_block_span(w);
    return CW_OK;
}

static void sort_around(job *j)
{
    const cw_mesh *m = j->mesh;
    memset(j->first, 0, (m->vertex_count + 2) * sizeof *j->first);
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        j->first[m->triangles[c] + 2]++;
    for (size_t v = 0; v < m->vertex_count; v++)
        j->first[v + 2] += j->first[v + 1];
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        j->around[j->first[m->triangles[c] + 1]++] = (uint32_t)(c / 3);
}

/* Puts every point into the list of one of its triangles. */
static void list_points(job *j)
{
    cwi_block *w = &j->whole;
    uint32_t *next = j->original.next;
    for (size_t v = 0; v < w->vertices; v++)
        next[v] = (uint32_t)v; /* in no list */
    memset(w->lists, 0xff, w->triangles * sizeof *w->lists);
    for (size_t c = 0; c < 3 * w->triangles; c++) {
        const uint32_t v = w->corners[c];
        if (next[v] != v)
            continue;
        next[v] = w->lists[c / 3];
        w->lists[c / 3] = v;
    }
}

static cw_status remember(job *j, cw_error *err)
{
    const cw_mesh *m = j->mesh;
    if (!j->first) {
        j->first = cwi_alloc_array(m->vertex_count + 2, sizeof *j->first);
        j->around = cwi_alloc_array(3 * m->triangle_count, sizeof *j->around);
        j->original.next = cwi_alloc_array(m->vertex_count, sizeof *j->original.next);
        j->care = cwi_alloc_zeroed(m->vertex_count, sizeof *j->care);
        if (j->first && j->around)
            sort_around(j);
    }
    j->whole.lists = cwi_alloc_array(j->whole.triangles, sizeof *j->whole.lists);
    if (!j->first || !j->around || !j->care || !j->original.next || !j->whole.lists)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory to keep the error of %zu triangles",
                       m->triangle_count);
    list_points(j);
    j->original.points = m->positions;
    j->original.corners = m->triangles;
    j->original.first = j->first;
    j->original.around = j->around;
    j->original.care = j->care;
    return CW_OK;
}

static const cwi_original *original_of(const job *j)
{
    return j->original.next ? &j->original : NULL;
}

static void open_block(void *context, size_t n)
{
    job *j = context;
    j->statuses[n] = j->openmesh->open(j->blocks + n, &j->block_desc, original_of(j),
                                       j->decimaters + n, j->errors + n);
    cwi_block_free(j->blocks + n);
}

static void run_block(void *context, size_t n)
{
    job *j = context;
    j->statuses[n] = j->openmesh->run(j->decimaters[n], j->cost, 0, j->errors + n);
}

static void take_block(void *context, size_t n)
{
    job *j = context;
    j->statuses[n] = j->openmesh->take(j->decimaters[n], j->blocks + n, j->errors + n);
    j->openmesh->close(j->decimaters[n]);
    j->decimaters[n] = NULL;
}

/* All blocks, shared out to threads; the first that failed is the one that is told. */
static cw_status each_block(job *j, void (*work)(void *context, size_t n), cw_error *err)
{
    cw_status st = cwi_each_layer(j->count, BLOCK, j->desc->threads, &j->desc->progress,
                                  "simplifying", work, j, err);
    for (size_t n = 0; n < j->count && st == CW_OK; n++)
        if (j->statuses[n] != CW_OK)
            return cw_fail(err, j->statuses[n], "%s", j->errors[n].message);
    return st;
}

static size_t count_left(const job *j, float *next)
{
    size_t left = 0;
    *next = INFINITY;
    for (size_t n = 0; n < j->count; n++) {
        left += j->openmesh->triangles(j->decimaters[n]);
        *next = fminf(*next, j->openmesh->next(j->decimaters[n]));
    }
    return left;
}

/* What costs the same anywhere goes at the same time everywhere: the limit rises by and by
 * until few enough triangles are left. Errors of size^4 on areas of size^2 make it rise by the
 * cube of what the number falls by; half of that way at a time. */
static cw_status run_blocks(job *j, size_t target, cw_error *err)
{
    cw_status st = CW_OK;
    float next;
    j->cost = target ? 0 : INFINITY;
    if (!target)
        return each_block(j, run_block, err);
    for (size_t left; (left = count_left(j, &next)) > target && next < INFINITY;) {
        const float more = (float)left / (float)target, step = more * sqrtf(more);
        j->cost = fmaxf(j->cost, next) * fminf(fmaxf(step, 1.1f), 8);
        st = each_block(j, run_block, err);
        if (st != CW_OK)
            break;
    }
    return st;
}

/* Seams between blocks stay as fine as they were: that many triangles more than the target are
 * left to the second pass. */
static size_t first_target(const job *j)
{
    size_t held = 0;
    for (size_t n = 0; n < j->count; n++)
        for (size_t v = 0; v < j->blocks[n].vertices; v++)
            held += j->blocks[n].held[v];
    return j->targets[0] ? j->targets[0] + 3 * held / 2 : 0;
}

static cw_status first_pass(job *j, cw_error *err)
{
    cw_status st = cwi_blocks_cut(&j->whole, BLOCK, &j->blocks, &j->count, err);
    if (st != CW_OK)
        return st;
    const size_t target = first_target(j);
    j->decimaters = cwi_alloc_zeroed(j->count, sizeof(cwi_decimater *));
    j->statuses = cwi_alloc_zeroed(j->count, sizeof *j->statuses);
    j->errors = cwi_alloc_zeroed(j->count, sizeof *j->errors);
    if (!j->decimaters || !j->statuses || !j->errors)
        st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu blocks", j->count);
    cwi_block_free(&j->whole);
    if (st == CW_OK)
        st = each_block(j, open_block, err);
    if (st == CW_OK)
        st = run_blocks(j, target, err);
    if (st == CW_OK)
        st = each_block(j, take_block, err);
    if (st == CW_OK)
        st = cwi_blocks_join(j->blocks, j->count, j->mesh->vertex_count, &j->whole, err);
    for (size_t n = 0; n < j->count; n++) {
        cwi_block_free(j->blocks + n);
        if (j->decimaters && j->decimaters[n])
            j->openmesh->close(j->decimaters[n]);
    }
    cwi_free(j->blocks);
    cwi_free(j->decimaters);
    cwi_free(j->statuses);
    cwi_free(j->errors);
    j->count = 0;
    return st;
}

static cw_status finish(const job *j, const cwi_block *from, cw_mesh *out, cw_error *err)
{
    cw_status st = cwi_mesh_alloc(out, from->vertices, from->triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, j->mesh->origin, sizeof out->origin);
    memcpy(out->affine, j->mesh->affine, sizeof out->affine);
    memcpy(out->positions, from->points, 3 * from->vertices * sizeof *from->points);
    memcpy(out->triangles, from->corners, 3 * from->triangles * sizeof *from->corners);
    return CW_OK;
}

/* Goes on from level to level. */
static cw_status second_pass(job *j, cw_error *err)
{
    cwi_decimater *d;
    cw_status st = j->openmesh->open(&j->whole, &j->block_desc, original_of(j), &d, err);
    if (st != CW_OK)
        return st;
    for (size_t n = 0; n < j->levels && st == CW_OK; n++) {
        cwi_block left = {0};
        st = j->openmesh->run(d, INFINITY, j->targets[n], err);
        if (st == CW_OK)
            st = j->openmesh->take(d, &left, err);
        if (st == CW_OK)
            st = finish(j, &left, j->out + n, err);
        cwi_free(j->lists);
        cwi_free(j->names);
        j->lists = left.lists;
        j->names = left.names;
        left.lists = left.names = NULL;
        cwi_block_free(&left);
        j->facts[n].cut = j->openmesh->cut(d);
        j->facts[n].vertices = j->out[n].vertex_count;
        j->facts[n].triangles = j->out[n].triangle_count;
        j->facts[n].passes++;
    }
    j->openmesh->close(d);
    return st;
}

static cw_status simplify_once(job *j, cw_error *err)
{
    cw_status st = begin(j, err);
    if (st == CW_OK && j->desc->error_mm > 0)
        st = remember(j, err);
    if (st == CW_OK && j->whole.triangles > BLOCK)
        st = first_pass(j, err);
    if (st == CW_OK)
        st = second_pass(j, err);
    cwi_block_free(&j->whole);
    return st;
}

enum { MARK = 0x80 };

/* More care for the points of the input that are too far from the result, and for those near to
 * which the result is too far from the input. Counts the triangles of either where that is so.
 */
static size_t take_care(const job *j, const uint8_t *input_beyond, const uint8_t *beyond)
{
    const cw_mesh *m = j->mesh, *out = j->out;
    size_t broken = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        broken += input_beyond[t];
        for (size_t k = 0; k < 3 && input_beyond[t]; k++)
            j->care[m->triangles[3 * t + k]] |= MARK;
    }
    for (size_t t = 0; t < out->triangle_count; t++) {
        broken += beyond[t];
        for (size_t k = 0; k < 3 && beyond[t]; k++)
            j->care[j->names[out->triangles[3 * t + k]]] |= MARK;
        for (uint32_t p = beyond[t] ? j->lists[t] : UINT32_MAX; p != UINT32_MAX;
             p = j->original.next[p])
            j->care[p] |= MARK;
    }
    for (size_t v = 0; v < m->vertex_count; v++)
        if (j->care[v] & MARK)
            j->care[v] = (uint8_t)((j->care[v] & ~MARK) + 1);
    return broken;
}

/* Whether the result keeps the distance; where it does not, more care is taken the next time.
 */
static cw_status judge(job *j, bool *kept, cw_error *err)
{
    const cw_mesh *m = j->mesh, *out = j->out;
    const cw_simplify_desc *d = j->desc;
    uint8_t *input_beyond = cwi_alloc_array(m->triangle_count, 1);
    uint8_t *beyond = cwi_alloc_array(out->triangle_count, 1);
    cw_status st = input_beyond && beyond
                       ? CW_OK
                       : cw_fail(err, CW_ERR_NO_MEMORY, "no memory to keep the error");
    if (st == CW_OK)
        st = cwi_mesh_within(m, out, d->error_mm, d->threads, &d->progress, input_beyond, err);
    if (st == CW_OK)
        st = cwi_mesh_within(out, m, d->error_mm, d->threads, &d->progress, beyond, err);
    if (st == CW_OK)
        *kept = take_care(j, input_beyond, beyond) == 0;
    cwi_free(input_beyond);
    cwi_free(beyond);
    return st;
}

/* Distances are looked at in some points only, and between them may be larger. Where they are,
 * all is done again with more care in those places; after some times there is nothing left to
 * change there. */
static cw_status simplify_all(job *j, cw_error *err)
{
    cw_status st = CW_OK;
    j->block_desc.error = 0.95 * j->desc->error_mm; /* others may bound it by 5 % more */
    for (bool kept = false; st == CW_OK && !kept;) {
        for (size_t n = 0; n < j->levels; n++)
            cw_mesh_free(j->out + n);
        st = simplify_once(j, err);
        kept = j->desc->error_mm == 0 || j->out->triangle_count == 0;
        if (st == CW_OK && !kept)
            st = judge(j, &kept, err);
    }
    for (size_t n = 0; n < j->levels && st == CW_OK; n++)
        st = cwi_carry(j->mesh, j->desc->threads, j->out + n, err);
    return st;
}

static cw_status simplify_levels(const cw_mesh *mesh, const cw_simplify_desc *desc,
                                 const size_t *targets, size_t levels, cw_mesh *out,
                                 cw_simplify_facts *facts, cw_error *err)
{
    job j = {.mesh = mesh, .desc = desc, .targets = targets, .levels = levels, .out = out};
    for (size_t n = 0; n < levels; n++)
        out[n] = (cw_mesh){0};
    cw_status st = check(mesh, desc, err);
    if (st == CW_OK)
        st = load(&j.openmesh, err);
    j.facts = cwi_alloc_zeroed(levels, sizeof *j.facts);
    if (st == CW_OK && !j.facts)
        st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu levels", levels);
    j.block_desc.allow_crossings = desc->allow_crossings;
    if (st == CW_OK)
        st = simplify_all(&j, err);
    if (st == CW_OK && facts)
        memcpy(facts, j.facts, levels * sizeof *facts);
    cwi_free(j.facts);
    cwi_free(j.first);
    cwi_free(j.around);
    cwi_free(j.care);
    cwi_free(j.lists);
    cwi_free(j.names);
    cwi_free(j.original.next);
    for (size_t n = 0; n < levels && st != CW_OK; n++)
        cw_mesh_free(out + n);
    return st;
}

cw_status cw_simplify(const cw_mesh *mesh, const cw_simplify_desc *desc, cw_mesh *out,
                      cw_simplify_facts *facts, cw_error *err)
{
    const size_t target = target_of(desc, mesh->triangle_count);
    *out = (cw_mesh){0};
    if (desc->error_mm == 0 && desc->ratio == 0 && desc->triangles == 0)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "simplification needs an error, a number of triangles or a ratio");
    return simplify_levels(mesh, desc, &target, 1, out, facts, err);
}

cw_status cw_simplify_levels(const cw_mesh *mesh, const cw_simplify_desc *desc,
                             const size_t *triangles, size_t levels, cw_mesh *out,
                             cw_simplify_facts *facts, cw_error *err)
{
    for (size_t n = 0; n < levels; n++)
        out[n] = (cw_mesh){0};
    for (size_t n = 0; n < levels; n++)
        if (triangles[n] == 0 || (n && triangles[n] >= triangles[n - 1]))
            return cw_fail(err, CW_ERR_ARGUMENT,
                           "level %zu has %zu triangles; each must have some, and fewer than "
                           "the one before",
                           n, triangles[n]);
    if (levels == 0 || desc->triangles || desc->ratio > 0 || desc->error_mm > 0)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "levels need their own numbers of triangles, and nothing else");
    return simplify_levels(mesh, desc, triangles, levels, out, facts, err);
}
