/* Which closed shells face the wrong way: a solid's shell faces outward where nothing is around
 * it, a cavity's inward where one solid is. */
#include "simplify/quality/shell_orientation.h"

#include "core/base/parallel.h"
#include "core/geometry/bvh.h"
#include "core/geometry/exact_predicates.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "simplify/quality/triangle_shapes.h"
#include "simplify/quality/vertex_one_rings.h"

#include <math.h>
#include <string.h>

/* Triangles that are measured by themselves, and whose sums are then joined in order: so sums
 * do not depend on threads. SLOTS is the size of a table of the components of a chunk. */
enum { CHUNK = 4096, SLOTS = 4 * CHUNK };

/* Triangles that look for rays together, and rays that they may find. */
enum { BLOCK = 64, MAX_FOUND = 128 };

/* Sums over the triangles of a component, seen from its root. */
typedef struct sum {
    uint32_t root;
    double volume, area;
} sum;

/* The components of a chunk of triangles. */
typedef struct chunk_sums {
    sum *sums;
    size_t count;
    bool failed;
} chunk_sums;

/* A ray along +x from a closed shell: it starts infinitely close to a vertex, inside of a triangle there, so that
 * it tells sides also where shells touch in vertices and edges. */
typedef struct ray {
    uint32_t shell; /* its root, near which the ray starts */
    uint32_t towards
        [2]; /* the triangle's other vertices: moved to the first, and far less to the second */
    int winding;  /* how often the other shells wind around the start */
    uint32_t met; /* triangles of other closed shells */
} ray;

typedef struct work {
    const cwi_welded *welded;
    const cwi_shells *shells;
    uint32_t *part;
    double *volume, *area; /* of each root's component: signed, seen from the root */
    chunk_sums *chunks;
    ray *rays; /* of all closed shells */
    size_t ray_count;
    cwi_boxes tree;    /* of the starts of the rays */
    uint32_t *slot_of; /* rays: their slot in the tree */
    ray *
        node_sums; /* nodes of the tree: winding and met of triangles that all their rays meet */
} work;

/* Rays that may meet the triangles of a block. */
typedef struct found_rays {
    const work *w;
    uint32_t ray[MAX_FOUND];
    float start[3][MAX_FOUND];
    const float *box; /* around the block, from low to high */
    size_t count;
    bool too_many;
} found_rays;

/* A triangle that looks for rays by itself. */
typedef struct seeker {
    work *w;
    size_t triangle;
    const float *corner[3];
    float before[6];   /* box of the places whose rays may meet it */
    uint32_t own_slot; /* of its shell's ray, or UINT32_MAX */
} seeker;

/* --- components --------------------------------------------------------------------------- */

static size_t chunk_count(const work *w)
{
    return (w->welded->mesh->triangle_count + CHUNK - 1) / CHUNK;
}

static size_t chunk_end(const work *w, size_t k)
{
    const size_t count = w->welded->mesh->triangle_count, end = (k + 1) * CHUNK;
    return end < count ? end : count;
}

/* Names each vertex's root once and for all, so that threads may read it, and moves there what
 * edges say of their vertices. */
static void name_roots(work *w)
{
    uint8_t *unbounded = w->shells->unbounded;
    for (uint32_t v = 0; v < w->welded->mesh->vertex_count; v++) {
        const uint32_t root = w->part[v] = cwi_sets_find(w->part, v);
        if (root != v) {
            unbounded[root] |= unbounded[v];
            unbounded[v] = 0;
        }
    }
}

/* Returns the sum of a root among those of a chunk; a new one follows the others. */
static sum *find_sum(chunk_sums *c, uint16_t *slots, uint32_t root)
{
    uint32_t at = root * 2654435769u >> 18; /* to 14 bits, as many as SLOTS has */
    while (slots[at] && c->sums[slots[at] - 1].root != root)
        at = (at + 1) % SLOTS;
    if (!slots[at]) {
        c->sums[c->count] = (sum){.root = root};
        slots[at] = (uint16_t)++c->count;
    }
    return &c->sums[slots[at] - 1];
}

static void sum_chunk(void *context, size_t k)
{
    const work *w = context;
    chunk_sums *c = &w->chunks[k];
    uint16_t slots[SLOTS] = {0};
    sum *last = NULL;
    c->sums = cwi_alloc_array(CHUNK, sizeof *c->sums);
    c->failed = !c->sums;
    for (size_t t = k * CHUNK; t < chunk_end(w, k) && c->sums; t++) {
        if (cwi_is_collapsed(w->welded, t))
            continue;
        const uint32_t root = w->part[w->welded->vertex[3 * t]];
        if (!last || last->root != root)
            last = find_sum(c, slots, root);
        cwi_add_triangle(w->welded->mesh, t, root, &last->volume, &last->area);
    }
    if (c->sums && c->count < CHUNK) {
        sum *fitting = cwi_realloc_array(c->sums, c->count, sizeof *c->sums);
        c->sums = fitting ? fitting : c->sums;
    }
}

/* Finds the area and the volume of each component. */
static bool measure_components(work *w, const cw_quality_desc *d)
{
    w->chunks = cwi_alloc_zeroed(chunk_count(w), sizeof *w->chunks);
    bool ok =
        w->chunks && cwi_parallel_for(chunk_count(w), CHUNK * 32, d->threads, &d->progress,
                                      "checking", sum_chunk, w, NULL) == CW_OK;
    for (size_t k = 0; k < chunk_count(w) && w->chunks; k++) {
        const chunk_sums *c = &w->chunks[k];
        ok = ok && !c->failed;
        for (size_t n = 0; n < c->count && ok; n++) {
            w->volume[c->sums[n].root] += c->sums[n].volume;
            w->area[c->sums[n].root] += c->sums[n].area;
        }
        cwi_free(c->sums);
    }
    cwi_free(w->chunks);
    return ok;
}

/* --- rays --------------------------------------------------------------------------------- */

static int sign_of(float x)
{
    return (x > 0) - (x < 0);
}

/* A start, and the points to which it is moved: corner 0, 1, 2 of a triangle. */
typedef struct moved_start {
    const float *corner[3];
} moved_start;

/* Returns on which side of the edge a b, seen along x, the start is. What its triangle leaves open is decided by
 * moving it by a little in z and far less in y: then it is on none. */
static int side_of(const float *a, const float *b, const moved_start *start)
{
    for (int n = 0; n < 3; n++) {
        const int side = cwi_orient2d(a, b, start->corner[n], 0);
        if (side)
            return side;
    }
    const int next = sign_of(b[1] - a[1]);
    return next ? next : -sign_of(b[2] - a[2]);
}

static bool is_above(const float *a, const moved_start *start)
{
    const float z = start->corner[0][2];
    for (int n = 1; n < 3 && a[2] == z; n++)
        if (start->corner[n][2] != z)
            return start->corner[n][2] < z;
    return a[2] > z;
}

/* Returns how often the triangle, seen along x, winds around the start: -1, 0 or 1. */
static int winding_of(const float *const corner[3], const moved_start *start)
{
    int winding = 0;
    for (int n = 0; n < 3; n++) {
        const float *a = corner[n], *b = corner[(n + 1) % 3];
        const bool a_above = is_above(a, start), b_above = is_above(b, start);
        if (a_above != b_above && side_of(a, b, start) == (b_above ? 1 : -1))
            winding += b_above ? 1 : -1;
    }
    return winding;
}

/* Returns on which side of the triangle's plane the start is; 0: its own triangle lies in that plane. */
static int side_of_plane(const float *const corner[3], const moved_start *start)
{
    int side = 0;
    for (int n = 0; n < 3 && !side; n++)
        side = cwi_orient3d(corner[0], corner[1], corner[2], start->corner[n]);
    return side;
}

static const float *start_of(const work *w, uint32_t k)
{
    return w->welded->points + 3 * (size_t)w->rays[k].shell;
}

static bool starts_in(const float start[3], const float box[6])
{
    return start[1] >= box[1] && start[1] <= box[4] && start[2] >= box[2] &&
           start[2] <= box[5] && start[0] <= box[3];
}

static void count_meeting(const work *w, ray *r, size_t triangle, int winding)
{
    __atomic_fetch_add(&r->winding, winding, __ATOMIC_RELAXED);
    if (!w->shells->unbounded[w->part[w->welded->vertex[3 * triangle]]])
        __atomic_fetch_add(&r->met, 1, __ATOMIC_RELAXED);
}

/* Counts a triangle, unless it is of the ray's shell. One without area meets no ray. */
static void meet_ray(work *w, uint32_t k, size_t triangle)
{
    const uint32_t *v = w->welded->vertex + 3 * triangle;
    const float *corner[3];
    moved_start start = {{start_of(w, k)}};
    if (w->part[v[0]] == w->rays[k].shell)
        return;
    for (int n = 0; n < 2; n++)
        start.corner[n + 1] = w->welded->points + 3 * (size_t)w->rays[k].towards[n];
    for (int n = 0; n < 3; n++)
        corner[n] = w->welded->points + 3 * (size_t)v[n];
    const int winding = winding_of(corner, &start);
    if (winding && winding * side_of_plane(corner, &start) < 0)
        count_meeting(w, &w->rays[k], triangle, winding);
}

static bool find_rays(void *context, size_t node)
{
    found_rays *f = context;
    for (size_t c = 0; c < CWI_WIDTH && node * CWI_WIDTH + c < f->w->ray_count; c++) {
        const uint32_t k = f->w->tree.order[node * CWI_WIDTH + c];
        const float *start = start_of(f->w, k);
        if (!starts_in(start, f->box))
            continue;
        if (f->count == MAX_FOUND) {
            f->too_many = true;
            return false;
        }
        for (int a = 0; a < 3; a++)
            f->start[a][f->count] = start[a];
        f->ray[f->count++] = k;
    }
    return true;
}

static ray *find_ray(const work *w, uint32_t shell)
{
    size_t low = 0, high = w->ray_count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (w->rays[middle].shell < shell)
            low = middle + 1;
        else
            high = middle;
    }
    return low < w->ray_count && w->rays[low].shell == shell ? &w->rays[low] : NULL;
}

static void get_corner(const float box[6], unsigned n, float p[3])
{
    for (unsigned a = 0; a < 3; a++)
        p[a] = box[a + (n >> a & 1 ? 3 : 0)];
}

/* Returns the side of an edge on which all of a box is, seen along x; 0 if that is none for certain. */
static int side_of_box(const float *a, const float *b, const float box[6])
{
    int side = 0;
    for (unsigned n = 0; n < 8; n += 2) { /* corners that differ in y or z */
        float p[3];
        get_corner(box, n, p);
        const int here = cwi_orient2d(a, b, p, 0);
        if (!here || (n && here != side))
            return 0;
        side = here;
    }
    return side;
}

/* Returns the winding of a triangle around all places in a box whose rays meet it, 0 if none does.
 * *mixed: set to true if that is not the same for all of them for certain. */
static int winding_around(const float *const corner[3], const float box[6], bool *mixed)
{
    const int turn = cwi_orient2d(corner[0], corner[1], corner[2], 0);
    int within = 0, ahead = 0;
    float p[3];
    for (int e = 0; e < 3; e++) {
        const int side = side_of_box(corner[e], corner[(e + 1) % 3], box);
        if (!turn || side == -turn)
            return 0;
        within += side == turn;
    }
    for (unsigned n = 0; n < 8 && within == 3; n++) {
        get_corner(box, n, p);
        const int side = cwi_orient3d(corner[0], corner[1], corner[2], p);
        if (!side || (n && side != ahead))
            within = 0;
        ahead = side;
    }
    *mixed = within < 3;
    const int winding = *mixed ? 0 : winding_of(corner, &(moved_start){{p, p, p}});
    return winding * ahead < 0 ? winding : 0;
}

/* Lets a triangle meet the rays of a node. It is counted once for all rays of a child that meet it for
 * certain, unless the ray of its own shell is among them. */
static void meet_node(const seeker *s, int level, size_t node)
{
    work *w = s->w;
    const cwi_boxes_node *boxes = &w->tree.nodes[w->tree.first[level] + node];
    for (unsigned left = cwi_boxes_meeting(boxes, s->before); left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        const size_t child = node * CWI_WIDTH + c;
        if (level == 0) {
            meet_ray(w, w->tree.order[child], s->triangle);
            continue;
        }
        const float box[6] = {boxes->low[0][c],  boxes->low[1][c],  boxes->low[2][c],
                              boxes->high[0][c], boxes->high[1][c], boxes->high[2][c]};
        bool mixed = s->own_slot >> 3 * level == child;
        const int winding = mixed ? 0 : winding_around(s->corner, box, &mixed);
        if (mixed)
            meet_node(s, level - 1, child);
        else if (winding)
            count_meeting(w, &w->node_sums[w->tree.first[level - 1] + child], s->triangle,
                          winding);
    }
}

static void meet_all(work *w, size_t triangle, const float box[6])
{
    const uint32_t *v = w->welded->vertex + 3 * triangle;
    const ray *own = find_ray(w, w->part[v[0]]);
    seeker s = {.w = w,
                .triangle = triangle,
                .before = {-INFINITY, box[1], box[2], box[3], box[4], box[5]},
                .own_slot = own ? w->slot_of[own - w->rays] : UINT32_MAX};
    for (int n = 0; n < 3; n++)
        s.corner[n] = w->welded->points + 3 * (size_t)v[n];
    meet_node(&s, w->tree.levels - 1, 0);
}

static void meet_found(work *w, const found_rays *f, size_t triangle, const float box[6])
{
    for (size_t n = 0; n < f->count; n++) {
        const float x = f->start[0][n], y = f->start[1][n], z = f->start[2][n];
        if ((y >= box[1]) & (y <= box[4]) & (z >= box[2]) & (z <= box[5]) & (x <= box[3]))
            meet_ray(w, f->ray[n], triangle);
    }
}

/* Lets the triangles of a block meet the rays near it. Neighbours in number mostly are
 * neighbours in space: they look for rays together, unless they find too many. */
static void meet_block(work *w, size_t first, size_t count)
{
    float boxes[BLOCK][6],
        around[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    found_rays found;
    for (size_t i = 0; i < count; i++) {
        cwi_boxes_triangle(w->welded->points, w->welded->vertex + 3 * (first + i), boxes[i]);
        for (int a = 0; a < 3; a++) {
            around[a] = boxes[i][a] < around[a] ? boxes[i][a] : around[a];
            around[a + 3] = boxes[i][a + 3] > around[a + 3] ? boxes[i][a + 3] : around[a + 3];
        }
    }
    found.w = w;
    found.box = around;
    found.count = 0;
    found.too_many = false;
    /* rays that run along +x into a box start within it or before it */
    const float before[6] = {-INFINITY, around[1], around[2], around[3], around[4], around[5]};
    cwi_boxes_visit(&w->tree, before, 0, find_rays, &found);
    for (size_t i = 0; i < count && found.count; i++)
        if (found.too_many)
            meet_all(w, first + i, boxes[i]);
        else
            meet_found(w, &found, first + i, boxes[i]);
}

static void meet_chunk(void *context, size_t k)
{
    work *w = context;
    for (size_t t = k * CHUNK; t < chunk_end(w, k); t += BLOCK) {
        const size_t left = chunk_end(w, k) - t;
        meet_block(w, t, left < BLOCK ? left : BLOCK);
    }
}

static bool is_closed(const work *w, uint32_t v)
{
    return w->part[v] == v && w->shells->used[v] && !w->shells->unbounded[v];
}

/* Returns false when memory is out. */
static bool prepare_sums(work *w)
{
    const size_t root = w->tree.levels ? w->tree.first[w->tree.levels - 1] : 0;
    w->node_sums = cwi_alloc_zeroed(root + 1, sizeof *w->node_sums);
    w->slot_of = cwi_alloc_array(w->ray_count, sizeof *w->slot_of);
    for (uint32_t s = 0; s < w->ray_count && w->slot_of; s++)
        w->slot_of[w->tree.order[s]] = s;
    return w->node_sums && w->slot_of;
}

/* Adds to each ray the sums of the nodes above it. */
static void add_node_sums(work *w)
{
    for (size_t s = 0; s < w->ray_count; s++)
        for (int level = 0; level < w->tree.levels; level++) {
            const ray *sums = &w->node_sums[w->tree.first[level] + (s >> 3 * (level + 1))];
            w->rays[w->tree.order[s]].winding += sums->winding;
            w->rays[w->tree.order[s]].met += sums->met;
        }
}

/* Sends a ray from each closed shell. Returns false when memory is out. */
static bool start_rays(work *w)
{
    const size_t vertices = w->welded->mesh->vertex_count;
    size_t count = 0;
    for (uint32_t v = 0; v < vertices; v++)
        count += is_closed(w, v);
    w->rays = cwi_alloc_zeroed(count, sizeof *w->rays);
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    for (uint32_t v = 0; v < vertices && w->rays && boxes; v++)
        if (is_closed(w, v)) {
            w->rays[w->ray_count].shell = v;
            memcpy(boxes[w->ray_count], w->welded->points + 3 * (size_t)v, 3 * sizeof(float));
            memcpy(boxes[w->ray_count++] + 3, w->welded->points + 3 * (size_t)v,
                   3 * sizeof(float));
        }
    const bool ok =
        w->rays && boxes &&
        cwi_boxes_build(&w->tree, (const float(*)[6])boxes, w->ray_count, NULL) == CW_OK;
    cwi_free(boxes);
    return ok && prepare_sums(w);
}

static bool has_area(const work *w, const uint32_t v[3])
{
    const float *points = w->welded->points;
    double normal[3];
    cwi_facet_normal(points + 3 * (size_t)v[0], points + 3 * (size_t)v[1],
                     points + 3 * (size_t)v[2], normal);
    return normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
}

/* Chooses the triangle into which each start is moved: the first one with an area at the vertex. */
static void move_starts(work *w)
{
    for (size_t k = 0; k < w->ray_count; k++)
        w->rays[k].towards[0] = w->rays[k].towards[1] = w->rays[k].shell;
    for (size_t t = 0; t < w->welded->mesh->triangle_count; t++) {
        const uint32_t *v = w->welded->vertex + 3 * t;
        for (int n = 0; n < 3; n++) {
            ray *r = w->part[v[n]] == v[n] ? find_ray(w, v[n]) : NULL;
            if (!r || r->towards[0] != r->shell || !has_area(w, v))
                continue;
            r->towards[0] = v[(n + 1) % 3];
            r->towards[1] = v[(n + 2) % 3];
        }
    }
}

/* Counts how often other shells wind around each closed shell. */
static bool wind_around(work *w, const cw_quality_desc *d, const cw_quality *q)
{
    if (!start_rays(w))
        return false;
    if (w->ray_count && q->components > 1)
        move_starts(w);
    const bool ok = !w->ray_count || q->components < 2 ||
                    cwi_parallel_for(chunk_count(w), CHUNK * 32, d->threads, &d->progress,
                                     "checking", meet_chunk, w, NULL) == CW_OK;
    add_node_sums(w);
    return ok;
}

/* --- verdicts ----------------------------------------------------------------------------- */

/* An open shell has no volume for certain. One that has a tenth of a sphere's of its area, seen
 * from a point of its own, is nearly closed, and its sign tells how it faces. */
static void find_open_inward(const work *w, uint8_t *wrong, cw_quality *q)
{
    for (size_t v = 0; v < w->welded->mesh->vertex_count; v++) {
        const double area = w->area[v], whole = area * sqrt(area) / (6 * sqrt(CWI_PI));
        wrong[v] = wrong[v] == 1 && w->volume[v] < -0.1 * whole;
        q->open_inward += wrong[v];
    }
}

enum { WRONG = 1, TURN = 2 };

/* Judges shells: the direction that a shell should face follows from its place, whichever way
 * others do. In a solid it faces inwards where it is inside an odd number of them. An open
 * shell is never turned: a bowl may face either way. */
static void judge_shells(const work *w, const cw_quality_desc *d, cw_quality *q)
{
    uint8_t *found = w->shells->unbounded; /* has served its purpose */
    find_open_inward(w, found, q);
    for (size_t k = 0; k < w->ray_count; k++) {
        const ray *r = &w->rays[k];
        const bool inward = w->volume[r->shell] < 0;
        q->cavities += inward && r->winding == 1;
        q->inside_out += inward && r->winding != 1;
        q->nested += !inward && r->winding != 0;
        found[r->shell] = (r->winding != (inward ? 1 : 0) ? WRONG : 0) |
                          (inward != (r->met % 2 == 1) ? TURN : 0);
        q->to_turn += (found[r->shell] & TURN) != 0;
    }
    for (size_t t = 0; t < w->welded->mesh->triangle_count && (d->defects || d->turn); t++) {
        const uint8_t here = found[w->part[w->welded->vertex[3 * t]]];
        if (d->turn)
            d->turn[t] = here & TURN ? 1 : 0;
        if (d->defects && here & WRONG && !cwi_is_collapsed(w->welded, t))
            d->defects[t] |= CW_DEFECT_INSIDE_OUT;
    }
}

bool cwi_measure_shells(const cwi_welded *welded, const cwi_shells *shells,
                        const cw_quality_desc *desc, cw_quality *q)
{
    const size_t vertices = welded->mesh->vertex_count;
    work w = {.welded = welded, .shells = shells, .part = shells->part};
    w.volume = cwi_alloc_zeroed(vertices, sizeof *w.volume);
    w.area = cwi_alloc_zeroed(vertices, sizeof *w.area);
    bool ok = w.volume && w.area;
    if (ok) {
        name_roots(&w);
        ok = measure_components(&w, desc) && wind_around(&w, desc, q);
    }
    if (ok)
        judge_shells(&w, desc, q);
    cwi_boxes_free(&w.tree);
    cwi_free(w.slot_of);
    cwi_free(w.node_sums);
    cwi_free(w.rays);
    cwi_free(w.volume);
    cwi_free(w.area);
    return ok;
}
