/* Divides a mesh into blocks at planes across the axes, and joins the blocks again once they
 * are simplified. */
#include "simplify/blocks/partition.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"

#include <math.h>
#include <string.h>

enum { BINS = 1024 };

/* State of a vertex. */
enum { FREE, LOCKED, GIVEN }; /* the last: held, and some block has its quadric */

static const uint32_t NOT_THERE = UINT32_MAX;

/* A box of space and the triangles whose middle is in it: low <= x < high. */
typedef struct leaf {
    size_t begin, end; /* in order */
    float low[3], high[3];
} leaf;

/* All that is needed to share triangles out. */
typedef struct plan {
    const cwi_mesh_block *whole;
    uint32_t *order; /* of the triangles, by leaf */
    uint32_t *spare;
    float *middles; /* of triangles, x 3 */
    leaf *leaves;
    size_t count;
    double cut_fraction; /* of a leaf's triangles that are below where it is divided */
    uint8_t *locked;     /* vertices: as above */
    uint32_t *obstacles; /* triangles by leaf, from first[leaf] on */
    size_t *first;
} plan;

void cwi_block_free(cwi_mesh_block *block)
{
    cwi_free(block->points);
    cwi_free(block->corners);
    cwi_free(block->global_ids);
    cwi_free(block->locked);
    cwi_free(block->seam);
    cwi_free(block->open);
    cwi_free(block->quadrics);
    cwi_free(block->values);
    cwi_free(block->areas);
    cwi_free(block->gradients);
    cwi_free(block->nearest_points);
    cwi_free(block->texture);
    *block = (cwi_mesh_block){0};
}

void cwi_block_span(cwi_mesh_block *block)
{
    block->interior_count = block->triangles;
    for (int a = 0; a < 3; a++) {
        block->low[a] = -INFINITY;
        block->high[a] = INFINITY;
        block->along[a] = 0;
    }
    block->from = -INFINITY;
    block->to = INFINITY;
}

void cwi_block_number(cwi_mesh_block *block)
{
    for (size_t v = 0; v < block->vertices; v++)
        block->global_ids[v] = (uint32_t)v;
}

cw_mesh cwi_block_view(const cwi_mesh_block *b)
{
    return (cw_mesh){.vertex_count = b->vertices,
                     .triangle_count = b->interior_count,
                     .positions = b->points,
                     .triangles = b->corners};
}

/* Makes an array longer; keeps it where there is no memory for that. */
static bool grow_array(void **array, size_t count, size_t size)
{
    void *longer = cwi_realloc_array(*array, count, size);
    *array = longer ? longer : *array;
    return longer;
}

static bool grow_vertices(cwi_mesh_block *b, size_t vertices)
{
    return grow_array((void **)&b->points, 3 * vertices, sizeof *b->points) &&
           grow_array((void **)&b->global_ids, vertices, sizeof *b->global_ids) &&
           grow_array((void **)&b->seam, vertices, sizeof *b->seam) &&
           grow_array((void **)&b->open, vertices, sizeof *b->open) &&
           grow_array((void **)&b->locked, vertices, sizeof *b->locked) &&
           grow_array((void **)&b->quadrics, vertices, sizeof *b->quadrics);
}

cw_status cwi_block_obstruct(cwi_mesh_block *b, const float *points, size_t count,
                             cw_error *err)
{
    const size_t vertices = b->vertices + 3 * count;
    if (count == 0)
        return CW_OK;
    if (!grow_vertices(b, vertices) ||
        !grow_array((void **)&b->corners, 3 * (b->triangles + count), sizeof *b->corners))
        return cwi_fail_memory(err);
    memcpy(b->points + 3 * b->vertices, points, 9 * count * sizeof *points);
    for (size_t v = b->vertices; v < vertices; v++) {
        b->corners[3 * b->triangles + v - b->vertices] = (uint32_t)v;
        b->global_ids[v] = NOT_THERE;
        b->seam[v] = b->locked[v] = 1;
        b->open[v] = 0;
        b->quadrics[v] = (cwi_quadric){.c = 0};
    }
    b->vertices = vertices;
    b->triangles += count;
    return CW_OK;
}

static float corner_coordinate(const cwi_mesh_block *b, size_t corner, int axis)
{
    return b->points[3 * (size_t)b->corners[corner] + (size_t)axis];
}

static void find_middles(plan *p)
{
    const cwi_mesh_block *b = p->whole;
    for (size_t t = 0; t < b->interior_count; t++)
        for (int a = 0; a < 3; a++)
            p->middles[3 * t + (size_t)a] =
                (corner_coordinate(b, 3 * t, a) + corner_coordinate(b, 3 * t + 1, a) +
                 corner_coordinate(b, 3 * t + 2, a)) /
                3;
}

static float triangle_middle(const plan *p, size_t triangle, int axis)
{
    return p->middles[3 * triangle + (size_t)axis];
}

static int longest_axis(const plan *p, const leaf *l, float low[3], float high[3])
{
    int longest = 0;
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (size_t i = l->begin; i < l->end; i++) {
            const float x = triangle_middle(p, p->order[i], a);
            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
        }
        if (high[a] - low[a] > high[longest] - low[longest])
            longest = a;
    }
    return longest;
}

/* A bin along the axis with about the share of the triangles below. */
static float choose_cut(const plan *p, const leaf *l, int axis, float low, float high)
{
    size_t bins[BINS] = {0}, below = 0;
    const float scale = high > low ? BINS / (high - low) : 0;
    for (size_t i = l->begin; i < l->end; i++) {
        const float bin = (triangle_middle(p, p->order[i], axis) - low) * scale;
        bins[bin < BINS - 1 ? (size_t)bin : BINS - 1]++;
    }
    const size_t enough = (size_t)(p->cut_fraction * (double)(l->end - l->begin));
    size_t b = 0;
    while (b < BINS - 1 && below + bins[b] <= enough)
        below += bins[b++];
    return low + (float)(b + (b == 0)) * (high - low) / BINS;
}

/* Divides a leaf; the second part becomes *other. */
static void divide_leaf(plan *p, leaf *l, leaf *other)
{
    float low[3], high[3];
    const int axis = longest_axis(p, l, low, high);
    const float at = choose_cut(p, l, axis, low[axis], high[axis]);
    size_t kept = l->begin, gone = 0;
    for (size_t i = l->begin; i < l->end; i++) {
        const uint32_t t = p->order[i];
        if (triangle_middle(p, t, axis) < at)
            p->order[kept++] = t;
        else
            p->spare[gone++] = t;
    }
    memcpy(p->order + kept, p->spare, gone * sizeof *p->spare);
    *other = *l;
    other->begin = l->end = kept;
    other->low[axis] = l->high[axis] = at;
}

static void make_leaves(plan *p)
{
    size_t step = p->count;
    p->leaves[0] = (leaf){.end = p->whole->interior_count};
    for (int a = 0; a < 3; a++) {
        p->leaves[0].low[a] = -INFINITY;
        p->leaves[0].high[a] = INFINITY;
    }
    for (; step > 1; step /= 2)
        for (size_t n = 0; n < p->count; n += step)
            divide_leaf(p, p->leaves + n, p->leaves + n + step / 2);
}

static bool lies_in(const leaf *l, const float box[6])
{
    for (int a = 0; a < 3; a++)
        if (!(box[a] >= l->low[a] && box[a + 3] < l->high[a]))
            return false;
    return true;
}

static bool reaches_box(const leaf *l, const float box[6])
{
    for (int a = 0; a < 3; a++)
        if (box[a + 3] < l->low[a] || box[a] > l->high[a])
            return false;
    return true;
}

/* Calls put for each triangle that leaves a leaf, and each other leaf that it reaches; and for
 * those that are in no leaf. */
static void for_each_obstacle(plan *p, void (*put)(plan *p, size_t to, uint32_t triangle))
{
    float box[6];
    for (size_t n = 0; n < p->count; n++)
        for (size_t i = p->leaves[n].begin; i < p->leaves[n].end; i++) {
            cwi_boxes_triangle(p->whole->points, p->whole->corners + 3 * (size_t)p->order[i],
                               box);
            if (lies_in(p->leaves + n, box))
                continue;
            for (int k = 0; k < 3; k++)
                p->locked[p->whole->corners[3 * (size_t)p->order[i] + (size_t)k]] = LOCKED;
            for (size_t m = 0; m < p->count; m++)
                if (m != n && reaches_box(p->leaves + m, box))
                    put(p, m, p->order[i]);
        }
    for (size_t t = p->whole->interior_count; t < p->whole->triangles; t++) {
        cwi_boxes_triangle(p->whole->points, p->whole->corners + 3 * t, box);
        for (size_t m = 0; m < p->count; m++)
            if (reaches_box(p->leaves + m, box))
                put(p, m, (uint32_t)t);
    }
}

static void count_obstacle(plan *p, size_t to, uint32_t triangle)
{
    (void)triangle;
    p->first[to + 2]++;
}

static void put_obstacle(plan *p, size_t to, uint32_t triangle)
{
    p->obstacles[p->first[to + 1]++] = triangle;
}

static bool find_obstacles(plan *p)
{
    for_each_obstacle(p, count_obstacle);
    for (size_t n = 0; n < p->count; n++)
        p->first[n + 2] += p->first[n + 1];
    p->obstacles = cwi_alloc_array(p->first[p->count + 1], sizeof *p->obstacles);
    if (!p->obstacles)
        return false;
    for_each_obstacle(p, put_obstacle);
    return true;
}

static uint32_t triangle_of(const plan *p, size_t n, size_t i)
{
    const leaf *l = p->leaves + n;
    return i < l->end - l->begin ? p->order[l->begin + i]
                                 : p->obstacles[p->first[n] + i - (l->end - l->begin)];
}

static bool alloc_vertices(cwi_mesh_block *b, const cwi_mesh_block *whole)
{
    b->points = cwi_alloc_array(3 * b->vertices, sizeof *b->points);
    b->locked = cwi_alloc_array(b->vertices, sizeof *b->locked);
    if (whole->quadrics)
        b->quadrics = cwi_alloc_array(b->vertices, sizeof *b->quadrics);
    if (whole->seam)
        b->seam = cwi_alloc_array(b->vertices, sizeof *b->seam);
    if (whole->open)
        b->open = cwi_alloc_array(b->vertices, sizeof *b->open);
    return b->points && b->locked && !b->quadrics == !whole->quadrics &&
           !b->seam == !whole->seam && !b->open == !whole->open;
}

/* Copies a vertex to a block. Its quadric and trends go to one block only, of those with a
 * triangle of their own at it. */
static void copy_vertex(const plan *p, cwi_mesh_block *b, size_t v, bool is_interior)
{
    const cwi_mesh_block *w = p->whole;
    const size_t from = b->global_ids[v];
    memcpy(b->points + 3 * v, w->points + 3 * from, 3 * sizeof *b->points);
    b->locked[v] = p->locked[from] != FREE;
    if (b->seam)
        b->seam[v] = w->seam[from];
    if (b->open)
        b->open[v] = w->open[from];
    if (!b->quadrics)
        return;
    const bool given = is_interior && p->locked[from] != GIVEN;
    b->quadrics[v] = given ? w->quadrics[from] : (cwi_quadric){.c = 0};
    if (b->gradients) {
        b->areas[v] = given ? w->areas[from] : 0;
        memcpy(b->gradients + w->attributes * v, w->gradients + w->attributes * from,
               w->attributes * sizeof *b->gradients);
    }
    if (is_interior && p->locked[from] == LOCKED)
        p->locked[from] = GIVEN;
}

static bool alloc_gradients(const cwi_mesh_block *whole, cwi_mesh_block *b)
{
    b->areas = cwi_alloc_array(b->vertices, sizeof *b->areas);
    b->gradients = cwi_alloc_array(whole->attributes * b->vertices, sizeof *b->gradients);
    return b->areas && b->gradients;
}

/* For vertices that have names. */
static bool fill_values(const cwi_mesh_block *whole, cwi_mesh_block *b)
{
    const size_t count = whole->attributes - (whole->texture ? CWI_TEXTURE_ATTRIBUTES : 0);
    b->attributes = whole->attributes;
    b->texture_scale = whole->texture_scale;
    if (whole->attributes && whole->gradients)
        return alloc_gradients(whole, b);
    if (!count)
        return true;
    b->values = cwi_alloc_array(count * b->vertices, sizeof *b->values);
    for (size_t v = 0; v < b->vertices && b->values; v++)
        memcpy(b->values + count * v, whole->values + count * b->global_ids[v],
               count * sizeof *b->values);
    return b->values;
}

/* Seams of a texture stay as they are in blocks, where not all of the texture is known.
 *
 * Numbers the vertices of leaf n as they come; *place must be NOT_THERE everywhere, and is so
 * again. */
static cw_status fill_block(const plan *p, size_t n, uint32_t *index_of, cwi_mesh_block *b,
                            cw_error *err)
{
    const cwi_mesh_block *w = p->whole;
    b->interior_count = p->leaves[n].end - p->leaves[n].begin;
    b->triangles = b->interior_count + p->first[n + 1] - p->first[n];
    memcpy(b->low, p->leaves[n].low, sizeof b->low);
    memcpy(b->high, p->leaves[n].high, sizeof b->high);
    memcpy(b->along, w->along, sizeof b->along);
    b->from = w->from;
    b->to = w->to;
    b->corners = cwi_alloc_array(3 * b->triangles, sizeof *b->corners);
    b->global_ids = cwi_alloc_array(3 * b->triangles, sizeof *b->global_ids);
    if (w->nearest_points)
        b->nearest_points = cwi_alloc_array(b->interior_count, sizeof *b->nearest_points);
    if (w->texture)
        b->texture = cwi_alloc_array(6 * b->interior_count, sizeof *b->texture);
    b->holds_seams = true;
    if (!b->corners || !b->global_ids || !b->nearest_points != !w->nearest_points ||
        !b->texture != !w->texture)
        return cwi_fail_memory(err);
    size_t interior = 0; /* vertices of own triangles come first */
    for (size_t i = 0; i < b->triangles; i++) {
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = w->corners[3 * (size_t)triangle_of(p, n, i) + k];
            if (index_of[v] == NOT_THERE) {
                index_of[v] = (uint32_t)b->vertices;
                b->global_ids[b->vertices++] = v;
            }
            b->corners[3 * i + k] = index_of[v];
        }
        interior = i < b->interior_count ? b->vertices : interior;
    }
    for (size_t i = 0; i < b->interior_count && w->nearest_points; i++)
        b->nearest_points[i] = w->nearest_points[triangle_of(p, n, i)];
    for (size_t i = 0; i < b->interior_count && w->texture; i++)
        memcpy(b->texture + 6 * i, w->texture + 6 * (size_t)triangle_of(p, n, i),
               6 * sizeof *b->texture);
    const bool ok = alloc_vertices(b, w) && fill_values(w, b);
    for (size_t v = 0; v < b->vertices; v++) {
        if (ok)
            copy_vertex(p, b, v, v < interior);
        index_of[b->global_ids[v]] = NOT_THERE;
    }
    return ok ? CW_OK : cwi_fail_memory(err);
}

static cw_status fill_blocks(const plan *p, cwi_mesh_block *blocks, cw_error *err)
{
    uint32_t *index_of = cwi_alloc_array(p->whole->vertices, sizeof *index_of);
    if (!index_of)
        return cwi_fail_memory(err);
    memset(index_of, 0xff, p->whole->vertices * sizeof *index_of);
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++)
        st = fill_block(p, n, index_of, blocks + n, err);
    cwi_free(index_of);
    return st;
}

cw_status cwi_blocks_cut(const cwi_mesh_block *whole, size_t max_triangles, double cut_fraction,
                         cwi_mesh_block **out, size_t *count, cw_error *err)
{
    plan p = {.whole = whole, .count = 1, .cut_fraction = cut_fraction};
    while (p.count * max_triangles < whole->interior_count)
        p.count *= 2;
    *count = p.count;
    p.order = cwi_alloc_array(whole->interior_count, sizeof *p.order);
    p.spare = cwi_alloc_array(whole->interior_count, sizeof *p.spare);
    p.middles = cwi_alloc_array(3 * whole->interior_count, sizeof *p.middles);
    p.leaves = cwi_alloc_array(p.count, sizeof *p.leaves);
    p.locked = cwi_alloc_zeroed(whole->vertices, sizeof *p.locked);
    p.first = cwi_alloc_zeroed(p.count + 2, sizeof *p.first);
    *out = cwi_alloc_zeroed(p.count, sizeof **out);
    bool ok = p.order && p.spare && p.middles && p.leaves && p.locked && p.first && *out;
    for (size_t t = 0; t < whole->interior_count && ok; t++)
        p.order[t] = (uint32_t)t;
    for (size_t v = 0; v < whole->vertices && ok && whole->locked; v++)
        p.locked[v] = whole->locked[v] ? LOCKED : FREE;
    if (ok) {
        find_middles(&p);
        make_leaves(&p);
    }
    cwi_free(p.spare);
    cwi_free(p.middles);
    ok = ok && find_obstacles(&p);
    cw_status st = ok ? fill_blocks(&p, *out, err) : cwi_fail_memory(err);
    for (size_t n = 0; n < p.count && st != CW_OK && *out; n++)
        cwi_block_free(*out + n);
    if (st != CW_OK) {
        cwi_free(*out);
        *out = NULL;
    }
    cwi_free(p.order);
    cwi_free(p.leaves);
    cwi_free(p.locked);
    cwi_free(p.first);
    cwi_free(p.obstacles);
    return st;
}

/* Vertex v of a block has become n of the whole, which may know it from another block. */
static void join_vertex(const cwi_mesh_block *b, size_t v, cwi_mesh_block *whole, size_t n,
                        bool known)
{
    const size_t count = whole->attributes;
    if (known) {
        cwi_quadric_add(whole->quadrics + n, b->quadrics + v);
        if (count)
            cwi_attribute_gradients_join(whole->quadrics + n, whole->areas + n,
                                         whole->gradients + count * n, b->areas[v],
                                         b->gradients + count * v, count);
        return;
    }
    whole->quadrics[n] = b->quadrics[v];
    if (count) {
        whole->areas[n] = b->areas[v];
        memcpy(whole->gradients + count * n, b->gradients + count * v,
               count * sizeof *b->gradients);
    }
}

/* Where the vertices of a block go: held ones of one name to one place. */
static void join_vertices(const cwi_mesh_block *b, uint32_t *index_of, uint32_t *to,
                          cwi_mesh_block *whole)
{
    for (size_t v = 0; v < b->vertices; v++) {
        const size_t id = b->global_ids[v];
        const bool known = b->locked[v] && index_of[id] != NOT_THERE;
        const size_t n = known ? index_of[id] : whole->vertices++;
        to[v] = (uint32_t)n;
        if (b->locked[v])
            index_of[id] = (uint32_t)n;
        whole->global_ids[n] = (uint32_t)id;
        whole->seam[n] = b->locked[v] || (b->seam && b->seam[v]);
        whole->open[n] = b->locked[v] || !b->open || b->open[v];
        memcpy(whole->points + 3 * n, b->points + 3 * v, 3 * sizeof *whole->points);
        join_vertex(b, v, whole, n, known);
    }
}

static bool alloc_joined(const cwi_mesh_block *blocks, size_t count, cwi_mesh_block *whole)
{
    size_t vertices = 0, triangles = 0;
    for (size_t n = 0; n < count; n++) {
        vertices += blocks[n].vertices;
        triangles += blocks[n].triangles;
    }
    whole->points = cwi_alloc_array(3 * vertices, sizeof *whole->points);
    whole->global_ids = cwi_alloc_array(vertices, sizeof *whole->global_ids);
    whole->seam = cwi_alloc_array(vertices, sizeof *whole->seam);
    whole->open = cwi_alloc_array(vertices, sizeof *whole->open);
    whole->quadrics = cwi_alloc_array(vertices, sizeof *whole->quadrics);
    whole->corners = cwi_alloc_array(3 * triangles, sizeof *whole->corners);
    if (count && blocks[0].nearest_points)
        whole->nearest_points = cwi_alloc_array(triangles, sizeof *whole->nearest_points);
    if (count && blocks[0].texture)
        whole->texture = cwi_alloc_array(6 * triangles, sizeof *whole->texture);
    whole->attributes = count ? blocks[0].attributes : 0;
    whole->texture_scale = count ? blocks[0].texture_scale : 0;
    if (whole->attributes) {
        whole->areas = cwi_alloc_array(vertices, sizeof *whole->areas);
        whole->gradients =
            cwi_alloc_array(whole->attributes * vertices, sizeof *whole->gradients);
        if (!whole->areas || !whole->gradients)
            return false;
    }
    return whole->points && whole->global_ids && whole->seam && whole->open &&
           whole->quadrics && whole->corners &&
           (!count || !blocks[0].nearest_points || whole->nearest_points) &&
           (!count || !blocks[0].texture || whole->texture);
}

cw_status cwi_blocks_join(const cwi_mesh_block *blocks, size_t count, size_t id_count,
                          cwi_mesh_block *whole, cw_error *err)
{
    *whole = (cwi_mesh_block){0};
    size_t max_vertices = 0;
    for (size_t n = 0; n < count; n++)
        max_vertices = blocks[n].vertices > max_vertices ? blocks[n].vertices : max_vertices;
    uint32_t *index_of = cwi_alloc_array(id_count, sizeof *index_of);
    uint32_t *to = cwi_alloc_array(max_vertices, sizeof *to);
    const bool ok = alloc_joined(blocks, count, whole) && index_of && to;
    if (ok)
        memset(index_of, 0xff, id_count * sizeof *index_of);
    for (size_t n = 0; n < count && ok; n++) {
        const cwi_mesh_block *b = blocks + n;
        join_vertices(b, index_of, to, whole);
        for (size_t c = 0; c < 3 * b->triangles; c++)
            whole->corners[3 * whole->triangles + c] = to[b->corners[c]];
        if (whole->nearest_points)
            memcpy(whole->nearest_points + whole->triangles, b->nearest_points,
                   b->triangles * sizeof *b->nearest_points);
        if (whole->texture)
            memcpy(whole->texture + 6 * whole->triangles, b->texture,
                   6 * b->triangles * sizeof *b->texture);
        whole->triangles += b->triangles;
    }
    cwi_block_span(whole);
    cwi_free(index_of);
    cwi_free(to);
    if (ok)
        return CW_OK;
    cwi_block_free(whole);
    return cwi_fail_memory(err);
}
