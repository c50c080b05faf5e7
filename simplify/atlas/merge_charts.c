/* Merges charts that the tree of mergers keeps apart. */
#include "simplify/atlas/atlas_state.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"

#include <stdlib.h>
#include <string.h>

/* Rounds, and the triangles that all trials may have, as a multiple of those of the mesh. */
enum { MAX_ROUNDS = 40, EFFORT = 4 };

/* The share of the shorter outline that a seam has to be. */
static const double MIN_SEAM = 0.15;

/* Two charts beside each other. */
typedef struct chart_pair {
    uint32_t a, b; /* a < b */
    double seam;   /* its length; then as a share of the shorter outline */
} chart_pair;

typedef struct chart_merging {
    const cwi_sheet *sheet;
    cwi_chart *charts;
    size_t count;
    double max_stretch;
    uint32_t *index;
    uint32_t *owner; /* triangles: their charts */
    bool *is_tried;  /* charts: in a pair of this round */
    uint32_t *id;    /* charts: a merged one has a new one */
    uint32_t next_id;
    uint64_t *failed; /* pairs of ids that do not merge, sorted */
    size_t failed_count, failed_room;
    chart_pair *pairs;
    size_t pair_count, pair_room;
    cwi_chart *merged; /* pairs */
    size_t effort;     /* triangles that trials may still have */
    bool no_memory;
} chart_merging;

static int compare_places(const void *a, const void *b)
{
    const chart_pair *m = a, *n = b;
    if (m->a != n->a)
        return m->a < n->a ? -1 : 1;
    if (m->b != n->b)
        return m->b < n->b ? -1 : 1;
    return m->seam < n->seam ? -1 : m->seam > n->seam;
}

static int compare_seams(const void *a, const void *b)
{
    const chart_pair *m = a, *n = b;
    if (m->seam != n->seam)
        return m->seam > n->seam ? -1 : 1;
    return compare_places(a, b);
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t m = *(const uint64_t *)a, n = *(const uint64_t *)b;
    return m < n ? -1 : m > n;
}

static uint64_t key_of(const chart_merging *m, uint32_t a, uint32_t b)
{
    const uint32_t low = m->id[a] < m->id[b] ? m->id[a] : m->id[b];
    return (uint64_t)low << 32 | (m->id[a] ^ m->id[b] ^ low);
}

static bool has_failed(const chart_merging *m, uint32_t a, uint32_t b)
{
    const uint64_t key = key_of(m, a, b);
    return m->failed_count &&
           bsearch(&key, m->failed, m->failed_count, sizeof key, compare_keys);
}

static double length_of_side(const cwi_sheet *sheet, uint32_t corner)
{
    const uint32_t *v = sheet->mesh->triangles;
    return sqrt(
        cwi_point_distance_sq(sheet->mesh->positions + 3 * (size_t)v[corner],
                              sheet->mesh->positions + 3 * (size_t)v[cwi_corner_next(corner)]));
}

/* Lists the sides between charts, and measures outlines. */
static bool list_sides(chart_merging *m, double *outline)
{
    m->pair_count = 0;
    for (uint32_t n = 0; n < m->count; n++)
        for (size_t t = 0; t < m->charts[n].triangles; t++)
            m->owner[m->charts[n].triangle[t]] = n;
    for (uint32_t n = 0; n < m->count; n++) {
        outline[n] = 0;
        for (size_t c = 0; c < 3 * m->charts[n].triangles; c++) {
            const size_t corner = 3 * (size_t)m->charts[n].triangle[c / 3] + c % 3;
            const uint32_t twin = m->sheet->twin[corner],
                           other = twin == CWI_NO_CORNER ? UINT32_MAX : m->owner[twin / 3];
            if (other == n)
                continue;
            const double length = length_of_side(m->sheet, (uint32_t)corner);
            outline[n] += length;
            if (other == UINT32_MAX || other < n || has_failed(m, n, other))
                continue;
            chart_pair *grown =
                cwi_grow_array(m->pairs, m->pair_count, &m->pair_room, sizeof *grown);
            if (!grown)
                return false;
            m->pairs = grown;
            m->pairs[m->pair_count++] = (chart_pair){n, other, length};
        }
    }
    return true;
}

/* Lists pairs of charts, those with the longest seams for their outlines first. */
static bool list_pairs(chart_merging *m)
{
    double *outline = cwi_alloc_array(m->count, sizeof *outline);
    const bool ok = outline && list_sides(m, outline);
    size_t kept = 0;
    if (ok && m->pair_count)
        qsort(m->pairs, m->pair_count, sizeof *m->pairs, compare_places);
    for (size_t n = 0, next; ok && n < m->pair_count; n = next) {
        chart_pair pair = m->pairs[n];
        for (next = n + 1;
             next < m->pair_count && m->pairs[next].a == pair.a && m->pairs[next].b == pair.b;
             next++)
            pair.seam += m->pairs[next].seam;
        pair.seam /= fmin(outline[pair.a], outline[pair.b]);
        if (pair.seam >= MIN_SEAM)
            m->pairs[kept++] = pair;
    }
    m->pair_count = kept;
    if (kept)
        qsort(m->pairs, kept, sizeof *m->pairs, compare_seams);
    cwi_free(outline);
    return ok;
}

/* Keeps pairs in which no chart comes twice, as long as there is effort left. */
static void choose_pairs(chart_merging *m)
{
    size_t kept = 0;
    memset(m->is_tried, 0, m->count * sizeof *m->is_tried);
    for (size_t n = 0; n < m->pair_count; n++) {
        const chart_pair pair = m->pairs[n];
        const size_t triangles = m->charts[pair.a].triangles + m->charts[pair.b].triangles;
        if (m->is_tried[pair.a] || m->is_tried[pair.b] || triangles > m->effort)
            continue;
        m->is_tried[pair.a] = m->is_tried[pair.b] = true;
        m->effort -= triangles;
        m->pairs[kept++] = pair;
    }
    m->pair_count = kept;
}

static void try_pair(void *context, size_t n)
{
    chart_merging *m = context;
    const cwi_chart *a = &m->charts[m->pairs[n].a], *b = &m->charts[m->pairs[n].b];
    uint32_t *triangles = cwi_alloc_array(a->triangles + b->triangles, sizeof *triangles);
    bool no_memory = !triangles;
    if (triangles) {
        memcpy(triangles, a->triangle, a->triangles * sizeof *triangles);
        memcpy(triangles + a->triangles, b->triangle, b->triangles * sizeof *triangles);
        cwi_chart_make(&m->merged[n], m->sheet, triangles, a->triangles + b->triangles,
                       m->max_stretch, m->index, &no_memory);
    }
    if (no_memory)
        cwi_set_flag(&m->no_memory);
    cwi_free(triangles);
}

static bool note_failure(chart_merging *m, const chart_pair *pair)
{
    uint64_t *grown =
        cwi_grow_array(m->failed, m->failed_count, &m->failed_room, sizeof *grown);
    if (!grown)
        return false;
    m->failed = grown;
    m->failed[m->failed_count++] = key_of(m, pair->a, pair->b);
    return true;
}

/* Puts what was merged in place of the first of its two charts. Returns false when memory is
 * out. */
static bool take_merged(chart_merging *m)
{
    size_t kept = 0;
    for (size_t n = 0; n < m->pair_count; n++) {
        const chart_pair pair = m->pairs[n];
        if (!m->merged[n].triangles) {
            if (!note_failure(m, &pair))
                return false;
            continue;
        }
        cwi_chart_free(&m->charts[pair.a]);
        cwi_chart_free(&m->charts[pair.b]);
        m->charts[pair.a] = m->merged[n];
        m->merged[n] = (cwi_chart){0};
        m->id[pair.a] = m->next_id++;
    }
    for (size_t n = 0; n < m->count; n++)
        if (m->charts[n].triangles) {
            m->id[kept] = m->id[n];
            m->charts[kept++] = m->charts[n];
        }
    m->count = kept;
    if (m->failed_count)
        qsort(m->failed, m->failed_count, sizeof *m->failed, compare_keys);
    return true;
}

/* Tries pairs of charts; sets how many were tried. */
static cw_status merge_round(chart_merging *m, const cw_atlas_desc *desc, size_t *tried,
                             cw_error *err)
{
    if (!list_pairs(m))
        return cwi_fail_memory(err);
    choose_pairs(m);
    *tried = m->pair_count;
    if (!m->pair_count)
        return CW_OK;
    m->merged = cwi_alloc_zeroed(m->pair_count, sizeof *m->merged);
    bool ok = m->merged;
    if (ok) {
        cwi_parallel_for_all(m->pair_count, (size_t)1 << 16, desc->threads, try_pair, m);
        ok = !m->no_memory && take_merged(m);
    }
    for (size_t n = 0; m->merged && n < m->pair_count; n++)
        cwi_chart_free(&m->merged[n]);
    cwi_free(m->merged);
    return ok ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_charts_merge(cwi_chart *charts, size_t *count, const cwi_sheet *sheet,
                           double max_stretch, uint32_t *index, const cw_atlas_desc *desc,
                           cw_error *err)
{
    const size_t triangles = sheet->mesh->triangle_count;
    chart_merging m = {.sheet = sheet,
                       .charts = charts,
                       .count = *count,
                       .max_stretch = max_stretch,
                       .index = index,
                       .effort = EFFORT * triangles,
                       .next_id = (uint32_t)*count};
    m.owner = cwi_alloc_array(triangles, sizeof *m.owner);
    m.is_tried = cwi_alloc_array(*count, sizeof *m.is_tried);
    m.id = cwi_alloc_array(*count, sizeof *m.id);
    cw_status st = m.owner && m.is_tried && m.id ? CW_OK : cwi_fail_memory(err);
    for (uint32_t n = 0; st == CW_OK && n < *count; n++)
        m.id[n] = n;
    size_t tried = 1;
    for (int round = 0; round < MAX_ROUNDS && tried && st == CW_OK; round++) {
        st = cwi_progress(&desc->progress, "merging charts", (double)round / MAX_ROUNDS, err);
        if (st == CW_OK)
            st = merge_round(&m, desc, &tried, err);
    }
    *count = m.count;
    cwi_free(m.owner);
    cwi_free(m.is_tried);
    cwi_free(m.id);
    cwi_free(m.failed);
    cwi_free(m.pairs);
    return st;
}
