/* Finds the faces that two elements share, and orients their cells.
 *
 * Faces are sorted into buckets by their least sample, where the few that may be equal are next
 * to each other. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/cases/cell_topology.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "extract/irregular/cell_surface.h"

#include <stdlib.h>
#include <string.h>

int cwi_face_ring(const cwi_element *e, int face, uint8_t ring[4])
{
    const cwi_shape *s = cwi_shape_of(e);
    const int size = s->face_size[face];
    int count = 0;
    for (int n = 0; n < size; n++)
        if (e->corners[s->faces[face][n]] != e->corners[s->faces[face][(n + 1) % size]])
            ring[count++] = (uint8_t)n;
    return count;
}

int cwi_edge_position(const cwi_element *e, int face, uint32_t s, uint32_t t)
{
    const cwi_shape *shape = cwi_shape_of(e);
    const uint8_t *corners = shape->faces[face];
    int n = 0;
    for (; n + 1 < shape->face_size[face]; n++) {
        const uint32_t a = e->corners[corners[n]], b = e->corners[corners[n + 1]];
        if ((a == s && b == t) || (a == t && b == s))
            break;
    }
    return n;
}

cwi_face_key cwi_face_key_of(const cwi_element *e, int face)
{
    const uint8_t *corners = cwi_shape_of(e)->faces[face];
    cwi_face_key key = {.samples = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX}};
    uint32_t samples[4] = {0};
    uint8_t ring[4];
    const int count = cwi_face_ring(e, face, ring);
    int lowest = 0;
    for (int n = 0; n < count; n++) {
        samples[n] = e->corners[corners[ring[n]]];
        if (samples[n] < samples[lowest])
            lowest = n;
    }
    key.reversed = samples[(lowest + count - 1) % count] < samples[(lowest + 1) % count];
    for (int n = 0; n < count; n++)
        key.samples[n] = samples[(lowest + (key.reversed ? count - n : n)) % count];
    return key;
}

bool cwi_cells_join(const cwi_cells *g, const cwi_element *e, int face)
{
    const uint8_t *corners = cwi_shape_of(e)->faces[face];
    double v[2][2]; /* every other corner of the face */
    if (g->desc->simple_topology)
        return false;
    for (int n = 0; n < 4; n++)
        v[n & 1][n >> 1] = cwi_value_of(g, e->corners[corners[n]]);
    const int inside = cwi_corner_inside(e, corners[0]) ? 0 : 1;
    return cwi_face_joins(v[inside], v[1 - inside], g->level.invert == g->level.strict);
}

bool cwi_face_matters(const cwi_cells *g, const cwi_element *e, int face)
{
    const cwi_shape *s = cwi_shape_of(e);
    uint8_t ring[4];
    int inside = 0;
    for (int n = 0; n < s->face_size[face]; n++)
        inside += cwi_corner_inside(e, s->faces[face][n]);
    return inside && !(g->desc->leave_open && inside == s->face_size[face]) &&
           cwi_face_ring(e, face, ring) >= 3;
}

/* --- pairs ------------------------------------------------------------------------------- */

enum { SAMPLE_CHUNK = 4096 };

/* Bit of a pair of elements that run through their common face the same way: one of them is
 * inside out. */
#define TWISTED (UINT32_C(1) << 31)

/* A face without its least sample, which is its bucket's. */
typedef struct bucket_face {
    uint32_t others[3], face;
} bucket_face;

typedef struct pairing {
    cwi_cells *g;
    uint32_t *ends; /* of the samples' buckets; while they are filled, of their contents */
    bucket_face *faces;
} pairing;

static void count_faces(void *context, size_t chunk)
{
    pairing *p = context;
    size_t begin, end;
    cwi_chunk_of(p->g, chunk, &begin, &end);
    for (size_t n = begin; n < end; n++)
        for (int face = 0; face < cwi_shape_of(&p->g->elements[n])->face_count; face++)
            if (cwi_face_matters(p->g, &p->g->elements[n], face)) {
                const uint32_t lowest = cwi_face_key_of(&p->g->elements[n], face).samples[0];
                __atomic_fetch_add(&p->ends[lowest], 1, __ATOMIC_RELAXED);
            }
}

static void fill_buckets(void *context, size_t chunk)
{
    pairing *p = context;
    size_t begin, end;
    cwi_chunk_of(p->g, chunk, &begin, &end);
    for (size_t n = begin; n < end; n++)
        for (int face = 0; face < cwi_shape_of(&p->g->elements[n])->face_count; face++)
            if (cwi_face_matters(p->g, &p->g->elements[n], face)) {
                const cwi_face_key key = cwi_face_key_of(&p->g->elements[n], face);
                const uint32_t at =
                    __atomic_fetch_add(&p->ends[key.samples[0]], 1, __ATOMIC_RELAXED);
                p->faces[at] = (bucket_face){{key.samples[1], key.samples[2], key.samples[3]},
                                             (uint32_t)(n * CWI_CELL_FACES + (size_t)face)};
            }
}

static int compare_faces(const void *a, const void *b)
{
    const bucket_face *f = a, *h = b;
    for (int n = 0; n < 3; n++)
        if (f->others[n] != h->others[n])
            return f->others[n] < h->others[n] ? -1 : 1;
    return (f->face > h->face) - (f->face < h->face);
}

static void sort_faces(bucket_face *faces, size_t count)
{
    if (count > 32) {
        qsort(faces, count, sizeof *faces, compare_faces);
        return;
    }
    for (size_t n = 1; n < count; n++) {
        const bucket_face face = faces[n];
        size_t m = n;
        for (; m && compare_faces(&face, &faces[m - 1]) < 0; m--)
            faces[m] = faces[m - 1];
        faces[m] = face;
    }
}

static bool is_reversed(const cwi_cells *g, uint32_t face)
{
    return cwi_face_key_of(&g->elements[face / CWI_CELL_FACES], face % CWI_CELL_FACES).reversed;
}

/* Returns true if all corners of a cell are corners of another. */
static bool lies_in(const cwi_element *e, const cwi_element *other)
{
    const int count = cwi_shape_of(e)->corner_count, others = cwi_shape_of(other)->corner_count;
    for (int c = 0; c < count; c++) {
        int d = 0;
        while (d < others && other->corners[d] != e->corners[c])
            d++;
        if (d == others)
            return false;
    }
    return true;
}

/* Joins two faces, unless one cell lies in the other: such cells are not neighbours. */
static void join_faces(cwi_cells *g, uint32_t a, uint32_t b)
{
    const cwi_element *e = &g->elements[a / CWI_CELL_FACES],
                      *o = &g->elements[b / CWI_CELL_FACES];
    if (lies_in(e, o) || lies_in(o, e))
        return;
    const uint32_t twist = is_reversed(g, a) == is_reversed(g, b) ? TWISTED : 0;
    g->across[a] = b | twist;
    g->across[b] = a | twist;
}

/* Pairs the faces of a bucket. Faces of a single element belong to the border, and so do those
 * of three or more: nothing shows which of them belong together. */
static void pair_bucket(cwi_cells *g, bucket_face *faces, size_t count)
{
    sort_faces(faces, count);
    for (size_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count; end++)
            if (memcmp(faces[n].others, faces[end].others, sizeof faces[n].others) != 0)
                break;
        if (end - n == 2)
            join_faces(g, faces[n].face, faces[n + 1].face);
    }
}

static void pair_chunk(void *context, size_t chunk)
{
    pairing *p = context;
    const size_t begin = chunk * SAMPLE_CHUNK, last = p->g->volume.dim[0];
    const size_t end = begin + SAMPLE_CHUNK < last ? begin + SAMPLE_CHUNK : last;
    for (size_t n = begin; n < end; n++) {
        const uint32_t first = n ? p->ends[n - 1] : 0;
        pair_bucket(p->g, p->faces + first, p->ends[n] - first);
    }
}

/* Turns counts into the places where buckets begin; returns their sum. */
static size_t place_buckets(pairing *p)
{
    uint32_t sum = 0;
    for (size_t n = 0; n < p->g->volume.dim[0]; n++) {
        const uint32_t count = p->ends[n];
        p->ends[n] = sum;
        sum += count;
    }
    return sum;
}

static cw_status pair_faces(pairing *p, cw_error *err)
{
    cwi_cells *g = p->g;
    const size_t chunks = cwi_chunks_of(g);
    const cw_progress *progress = &g->desc->progress;
    const int threads = g->desc->threads;
    cw_status st = cwi_parallel_for(chunks, CWI_CELL_CHUNK * 64, threads, progress, "pairing",
                                    count_faces, p, err);
    if (st != CW_OK)
        return st;
    const size_t count = place_buckets(p);
    g->pairing_bytes = count * sizeof *p->faces + g->volume.dim[0] * sizeof *p->ends;
    p->faces = cwi_alloc_large(count, sizeof *p->faces);
    if (!p->faces)
        return cwi_fail_memory(err);
    st = cwi_parallel_for(chunks, CWI_CELL_CHUNK * 64, threads, progress, "pairing",
                          fill_buckets, p, err);
    return st == CW_OK ? cwi_parallel_for((g->volume.dim[0] + SAMPLE_CHUNK - 1) / SAMPLE_CHUNK,
                                          SAMPLE_CHUNK * 64, threads, progress, "pairing",
                                          pair_chunk, p, err)
                       : st;
}

cw_status cwi_cells_pair_faces(cwi_cells *g, cw_error *err)
{
    pairing p = {.g = g};
    g->across = cwi_alloc_large(g->count, CWI_CELL_FACES * sizeof *g->across);
    p.ends = cwi_alloc_zeroed(g->volume.dim[0], sizeof *p.ends);
    cw_status st = g->across && p.ends ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        memset(g->across, 0xff, g->count * CWI_CELL_FACES * sizeof *g->across);
        st = pair_faces(&p, err);
    }
    cwi_free(p.ends);
    cwi_free(p.faces);
    return st;
}

/* --- which way round --------------------------------------------------------------------- */

/* Sets of elements that common faces connect, each named by its least, and whether an element
 * is oriented opposite to its parent. */
typedef struct orientation {
    cwi_cells *g;
    uint32_t *parent;
    bool *turned;
    double *volume; /* of each element, as its corners are numbered */
} orientation;

/* Returns the set of an element, and whether it is oriented opposite to the set. */
static uint32_t find_root(orientation *o, uint32_t n, bool *turned)
{
    uint32_t root = n;
    bool odd = false;
    for (; o->parent[root] != root; root = o->parent[root])
        odd ^= o->turned[root];
    *turned = odd;
    while (o->parent[n] != root && n != root) {
        const uint32_t next = o->parent[n];
        const bool own = o->turned[n];
        o->parent[n] = root;
        o->turned[n] = odd;
        odd ^= own;
        n = next;
    }
    return root;
}

/* Joins the elements at a face. An element that would have to be turned both ways, as in a
 * Moebius strip of cells, is not joined here: the face becomes a border. */
static void join_across(orientation *o, uint32_t face)
{
    const uint32_t code = o->g->across[face], other = code & ~TWISTED;
    bool a_turned, b_turned;
    if (code == CWI_NO_FACE || other < face)
        return;
    const bool twisted = code != other;
    uint32_t a = find_root(o, face / CWI_CELL_FACES, &a_turned),
             b = find_root(o, other / CWI_CELL_FACES, &b_turned);
    const bool turned = (a_turned != b_turned) != twisted;
    o->g->across[face] = other;
    o->g->across[other] = face;
    if (a == b && turned)
        o->g->across[face] = o->g->across[other] = CWI_NO_FACE;
    if (a == b)
        return;
    o->parent[a > b ? a : b] = a > b ? b : a;
    o->turned[a > b ? a : b] = turned;
}

/* Measures volumes: fans of triangles in faces, seen from corner 0; a quadrangle is halved both
 * ways. In the space of the points, where the longest side is 1. */
static void measure_chunk(void *context, size_t chunk)
{
    orientation *o = context;
    const cwi_cells *g = o->g;
    const double scale = g->reach > 0 ? 1 / g->reach : 1;
    size_t begin, end;
    cwi_chunk_of(g, chunk, &begin, &end);
    for (size_t n = begin; n < end; n++) {
        const cwi_element *e = &g->elements[n];
        const cwi_shape *s = cwi_shape_of(e);
        double p[8][3];
        o->volume[n] = 0;
        for (int c = 0; c < s->corner_count; c++)
            for (int a = 0; a < 3; a++)
                p[c][a] = scale * (g->volume.cells->points[3 * (size_t)e->corners[c] + a] -
                                   g->centre[a]);
        for (int face = 0; face < s->face_count; face++) {
            const uint8_t *c = s->faces[face];
            const int size = s->face_size[face];
            for (int i = 0; i < size; i++)
                o->volume[n] += cwi_tetrahedron_sixfold(p[0], p[c[i]], p[c[(i + 1) % size]],
                                                        p[c[(i + 2) % size]]) /
                                (size == 4 ? 2 : 3);
        }
    }
}

/* Turns every set so that its cells' volumes in the world have a positive sum. */
static void turn_sets(orientation *o)
{
    cwi_cells *g = o->g;
    const bool mirrored = cwi_affine_determinant(g->volume.affine[0]) < 0;
    for (uint32_t n = 0; n < g->count; n++) {
        bool turned;
        const uint32_t set = find_root(o, n, &turned);
        g->elements[n].flip = turned;
        if (set != n) /* the least of a set comes first */
            o->volume[set] += turned ? -o->volume[n] : o->volume[n];
    }
    for (uint32_t n = 0; n < g->count; n++) {
        bool turned;
        const double volume = o->volume[find_root(o, n, &turned)];
        g->elements[n].flip ^= mirrored ? volume > 0 : volume < 0;
    }
}

static cw_status orient_elements(orientation *o, cw_error *err)
{
    cwi_cells *g = o->g;
    cw_status st = cwi_parallel_for((g->count + CWI_CELL_CHUNK - 1) / CWI_CELL_CHUNK,
                                    CWI_CELL_CHUNK * 64, g->desc->threads, &g->desc->progress,
                                    "orienting", measure_chunk, o, err);
    if (st != CW_OK)
        return st;
    for (uint32_t n = 0; n < g->count; n++) {
        o->parent[n] = n;
        o->turned[n] = false;
    }
    for (uint32_t face = 0; face < g->count * CWI_CELL_FACES; face++)
        join_across(o, face);
    turn_sets(o);
    return CW_OK;
}

cw_status cwi_cells_orient(cwi_cells *g, cw_error *err)
{
    orientation o = {.g = g,
                     .parent = cwi_alloc_array(g->count, sizeof *o.parent),
                     .turned = cwi_alloc_array(g->count, sizeof *o.turned),
                     .volume = cwi_alloc_array(g->count, sizeof *o.volume)};
    cw_status st =
        o.parent && o.turned && o.volume ? orient_elements(&o, err) : cwi_fail_memory(err);
    cwi_free(o.parent);
    cwi_free(o.turned);
    cwi_free(o.volume);
    return st;
}
