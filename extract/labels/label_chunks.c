/* Goes through chunks of layers of cubes: a first pass counts vertices and the triangles of each
 * pair of labels, and a second one writes them where they belong. */
#include "extract/labels/label_chunks.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <string.h>

enum { MARKS = 8 }; /* marks of cubes that are looked at together */

/* The buffers of a thread that goes through a chunk. Layers come and go: [0] is the one below. Cubes
 * that have no vertices have no shape. */
typedef struct scan {
    cwi_label_job *job;
    cwi_label_chunk *chunk;
    size_t width, height;    /* of layers of cubes */
    uint32_t *labels[2];     /* of voxels, with the border */
    uint8_t *are_alike[2];   /* of rows of voxels: 1 if all have one label */
    uint8_t *shapes[2];      /* of cubes: cwi_label_cube() */
    uint32_t *firsts[2];     /* their first vertices */
    uint8_t *marks;          /* of a row: columns of four voxels that differ; then cubes */
    uint32_t *columns;       /* of the cubes of the upper layer that have vertices */
    size_t *row_ends;        /* height: where a row's part of `columns` ends */
    ptrdiff_t offsets[8][4]; /* of the cubes around an edge, from the one at its start */
    size_t next;             /* vertex */
    bool is_bad;             /* a value was no label */
    uint64_t last_key;       /* of `last`; 0: none */
    cwi_key_count *last;
} scan;

/* Marks the cubes of a row whose corners are not all alike. */
static void mark_row(const scan *s, size_t y)
{
    const size_t wide = s->job->layers.width;
    const uint32_t *a = s->labels[0] + y * wide, *b = a + wide;
    const uint32_t *c = s->labels[1] + y * wide, *d = c + wide;
    uint8_t *marks = s->marks;
    for (size_t x = 0; x < wide; x++)
        marks[x] = (a[x] != b[x]) | (a[x] != c[x]) | (a[x] != d[x]);
    for (size_t x = 0; x < s->width; x++)
        marks[x] = marks[x] | marks[x + 1] | (a[x] != a[x + 1]);
}

static void load_corners(const scan *s, size_t x, size_t y, uint32_t corners[8])
{
    const size_t wide = s->job->layers.width;
    for (int z = 0; z < 2; z++) {
        const uint32_t *p = s->labels[z] + y * wide + x;
        corners[4 * z] = p[0];
        corners[4 * z + 1] = p[1];
        corners[4 * z + 2] = p[wide];
        corners[4 * z + 3] = p[wide + 1];
    }
}

/* Finds the axes along which a cube is partly beyond the volume. Returns its corners that are beyond,
 * as bits; none where borders are open. */
static uint32_t find_outside(const scan *s, size_t n, size_t k, bool beyond[3])
{
    const size_t at[3] = {n % s->width, n / s->width, k},
                 end[3] = {s->width - 1, s->height - 1, s->job->layers.count - 2};
    static const uint32_t upper[3] = {0xaa, 0xcc, 0xf0};
    uint32_t outside = 0;
    for (int a = 0; a < 3; a++) {
        const uint32_t corners =
            (at[a] == 0 ? 0xff & ~upper[a] : 0) | (at[a] == end[a] ? upper[a] : 0);
        beyond[a] = corners && !s->job->layers.copies_border;
        outside |= beyond[a] ? corners : 0;
    }
    return outside;
}

/* Returns the axis along which a cube that cannot be one point is two prisms, or -1: at the volume's
 * border, where the half beyond has one label. So all vertices there are in one plane. */
static int find_prism_axis(const scan *s, size_t n, size_t k)
{
    bool beyond[3];
    find_outside(s, n, k, beyond);
    for (int a = 0; a < 3; a++)
        if (beyond[a])
            return a;
    return -1;
}

/* Returns true if all voxels of two rows in both layers have one label. */
static bool is_plain_row(const scan *s, size_t y)
{
    const size_t at = y * s->job->layers.width, above = at + s->job->layers.width;
    const uint32_t label = s->labels[0][at];
    return s->are_alike[0][y] && s->are_alike[0][y + 1] && s->are_alike[1][y] &&
           s->are_alike[1][y + 1] && s->labels[0][above] == label &&
           s->labels[1][at] == label && s->labels[1][above] == label;
}

/* Lists the cubes of a row whose corners are not all alike. Returns the end of the list. */
static uint32_t *list_row(const scan *s, size_t y, uint32_t *to)
{
    if (is_plain_row(s, y))
        return to;
    mark_row(s, y);
    memset(s->marks + s->width, 0, MARKS);
    for (size_t x = 0; x < s->width; x += MARKS) {
        uint64_t marks;
        memcpy(&marks, s->marks + x, sizeof marks);
        for (size_t n = x; marks && n < x + MARKS; n++) {
            *to = (uint32_t)n;
            to += s->marks[n];
        }
    }
    return to;
}

/* Finds the shapes of the upper layer of cubes, and numbers their vertices. */
static void shape_layer(scan *s, size_t k)
{
    uint32_t corners[8], *end = s->columns;
    for (size_t y = 0; y < s->height; y++) {
        const uint32_t *column = end;
        end = list_row(s, y, end);
        s->row_ends[y] = (size_t)(end - s->columns);
        for (; column < end; column++) {
            const size_t n = y * s->width + *column;
            load_corners(s, *column, y, corners);
            uint8_t shape = cwi_label_cube(&s->job->rules, corners);
            const int axis = shape == CWI_CUBE_SIMPLE ? -1 : find_prism_axis(s, n, k);
            if (axis >= 0)
                shape = (uint8_t)(CWI_CUBE_PRISMS | axis);
            s->shapes[1][n] = shape;
            s->firsts[1][n] = (uint32_t)s->next;
            s->next += cwi_label_cube_vertices(shape);
        }
    }
}

/* Returns the vertex of a tetrahedron. */
static uint32_t vertex_of(const scan *s, const cwi_label_ring *ring, int t, size_t n)
{
    const int8_t *cube = ring->cube[t];
    const size_t index = n - (cube[1] < 0 ? s->width : 0) - (cube[0] < 0);
    const int layer = cube[2] < 0 ? 0 : 1;
    return s->firsts[layer][index] +
           cwi_label_cube_vertex(&s->job->rules, s->shapes[layer][index], ring->tet[t]);
}

/* Finds the polygon around an edge whose cubes have one vertex each. Returns the number of corners, or
 * -1 if a cube has more vertices. */
static int find_simple_polygon(const scan *s, int edge, size_t n, uint32_t polygon[CWI_RING])
{
    const cwi_label_edge_cubes *around = &s->job->rules.around[edge];
    for (int i = 0; i < around->count; i++) {
        const int layer = around->cube[i][2] < 0 ? 0 : 1;
        const size_t index = n + (size_t)s->offsets[edge][i];
        if (s->shapes[layer][index] != CWI_CUBE_SIMPLE)
            return -1;
        polygon[i] = s->firsts[layer][index];
    }
    return around->count;
}

/* Finds the polygon around an edge that starts at the corner 0 of a cube. Tetrahedra with the
 * same vertex follow each other. Returns the number of corners; fewer than 3 make no polygon. */
static int find_polygon(const scan *s, int edge, size_t n, uint32_t polygon[CWI_RING])
{
    const cwi_label_ring *ring = &s->job->rules.rings[edge];
    int count = find_simple_polygon(s, edge, n, polygon);
    if (count >= 0)
        return count;
    count = 0;
    for (int t = 0; t < ring->count; t++) {
        const uint32_t v = vertex_of(s, ring, t, n);
        if (count == 0 || polygon[count - 1] != v)
            polygon[count++] = v;
    }
    while (count > 1 && polygon[count - 1] == polygon[0])
        count--;
    return count;
}

/* Orders a pair of labels: the background is the second, of others the larger. Returns true if
 * they changed positions. */
static bool order_pair(const cwi_label_job *j, uint32_t pair[2])
{
    const uint32_t background = j->layers.background;
    const bool changes = pair[0] == background || (pair[1] != background && pair[0] > pair[1]);
    if (changes) {
        const uint32_t first = pair[0];
        pair[0] = pair[1];
        pair[1] = first;
    }
    return changes;
}

/* Finds a pair's entry, mostly that of the polygon before. NULL when memory is out. */
static cwi_key_count *find_pair(scan *s, const uint32_t pair[2])
{
    const uint64_t key = (uint64_t)pair[0] << 32 | pair[1];
    if (key != s->last_key) {
        s->last = cwi_key_counts_need(&s->chunk->pairs, key);
        s->last_key = s->last ? key : 0;
    }
    return s->last;
}

/* Counts or writes the triangles of a polygon; pair[0] is at the edge's start. Returns false
 * when memory is out. */
static bool take_polygon(scan *s, int edge, uint32_t pair[2], const uint32_t *polygon,
                         int count)
{
    const cwi_label_job *j = s->job;
    const bool flips = order_pair(j, pair) != j->is_mirrored;
    cwi_key_count *entry = find_pair(s, pair);
    if (!entry)
        return false;
    uint32_t *to = j->is_writing ? j->out->mesh.triangles + 3 * entry->count : NULL;
    for (int n = 1; n + 1 < count && to; n++, to += 3) {
        to[0] = polygon[0];
        to[1] = polygon[flips ? n + 1 : n];
        to[2] = polygon[flips ? n : n + 1];
    }
    for (int n = 0; n + 2 < count && to && j->net.polygons; n++)
        j->net.polygons[entry->count + (size_t)n] = n == 0 ? (uint8_t)edge : 0;
    entry->count += (size_t)count - 2;
    return true;
}

/* Takes the polygons around the edges that start at the corner 0 of a cube of the upper layer. In an
 * open border edges have cubes on one side only, and no polygon. */
static bool take_cube(scan *s, size_t x, size_t y, size_t k)
{
    uint32_t corners[8], polygon[CWI_RING];
    const int inner = (x > 0) | (y > 0) << 1 | (k > 0) << 2;
    const size_t n = y * s->width + x;
    load_corners(s, x, y, corners);
    for (int edge = 1; edge < 8; edge++) {
        if (corners[0] == corners[edge] || (inner | edge) != 7)
            continue;
        uint32_t pair[2] = {corners[0], corners[edge]};
        const int count = find_polygon(s, edge, n, polygon);
        if (count >= 3 && !take_polygon(s, edge, pair, polygon, count))
            return false;
    }
    return true;
}

static bool take_layer(scan *s, size_t k)
{
    size_t next = 0;
    for (size_t y = 0; y < s->height; y++)
        for (; next < s->row_ends[y]; next++)
            if (!take_cube(s, s->columns[next], y, k))
                return false;
    return true;
}

/* Puts a vertex at a position counted in voxels, from the first. */
static void put_vertex(const cwi_label_job *j, const double position[3], uint32_t number)
{
    float *to = j->out->mesh.positions + 3 * (size_t)number;
    for (int a = 0; a < 3; a++)
        to[a] = (float)position[a];
}

/* Sets a bit of a vertex's kind; another chunk may set another one. */
static void mark_kind(uint8_t *kind, bool is_curve, int bit)
{
    if (is_curve)
        __atomic_fetch_or(kind, (uint8_t)(1 << bit), __ATOMIC_RELAXED);
}

/* Tells a cube and the one before it along an axis that they are neighbours, if the face
 * between them is part of an interface; and if three labels meet there. The outside counts as a
 * label of its own: so the edges of the surface that closes a label at the border are curves. */
static void join_cubes(const scan *s, size_t n, int axis, const uint32_t c[8], uint32_t outside)
{
    const size_t back[3] = {1, s->width, 0};
    const int layer = axis == 2 ? 0 : 1;
    const size_t other = n - back[axis];
    cwi_label_net *net = &s->job->net;
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int around[4] = {0, u, u | v, v};
    int changes = 0, meetings = 0;
    for (int i = 0; i < 4; i++) {
        const int a = around[i], b = around[(i + 1) % 4];
        changes += c[a] != c[b];
        meetings += c[a] != c[b] || (outside >> a & 1) != (outside >> b & 1);
    }
    if (changes == 0)
        return;
    const uint32_t here = s->firsts[1][n], there = s->firsts[layer][other];
    if (s->shapes[1][n] == CWI_CUBE_SIMPLE) {
        net->neighbours[here][axis] = there;
        mark_kind(&net->kinds[here], meetings > 2, axis);
    }
    if (s->shapes[layer][other] == CWI_CUBE_SIMPLE) {
        net->neighbours[there][axis + 3] = here;
        mark_kind(&net->kinds[there], meetings > 2, axis + 3);
    }
}

/* Places the vertices of a cube: each in the middle of its tetrahedra's. */
static void put_cube(const scan *s, uint8_t shape, const double middle[3], uint32_t first)
{
    double sums[CWI_TETS][3] = {0};
    int counts[CWI_TETS] = {0};
    const bool is_whole = shape & (CWI_CUBE_SIMPLE | CWI_CUBE_PRISMS);
    for (int t = 0; t < CWI_TETS; t++) {
        const uint32_t v = cwi_label_cube_vertex(&s->job->rules, shape, t);
        if (!is_whole && !(shape >> t & 1))
            continue;
        for (int a = 0; a < 3; a++)
            sums[v][a] += s->job->corners[t][a];
        counts[v]++;
    }
    for (uint32_t v = 0; v < cwi_label_cube_vertices(shape); v++) {
        double position[3];
        for (int a = 0; a < 3; a++)
            position[a] = middle[a] + sums[v][a] / counts[v];
        put_vertex(s->job, position, first + v);
    }
}

/* Places the vertices of a cube of the upper layer, and tells which are beside which. */
static void take_vertices(const scan *s, size_t x, size_t y, size_t k)
{
    const size_t n = y * s->width + x;
    const uint8_t shape = s->shapes[1][n];
    const uint32_t number = s->firsts[1][n];
    const double middle[3] = {(double)x - 0.5, (double)y - 0.5, (double)k - 0.5};
    uint32_t corners[8];
    bool beyond[3];
    if (shape == CWI_CUBE_SIMPLE)
        put_vertex(s->job, middle, number);
    else
        put_cube(s, shape, middle, number);
    if (!s->job->net.kinds)
        return;
    for (size_t v = 0; v < cwi_label_cube_vertices(shape) && shape != CWI_CUBE_SIMPLE; v++)
        s->job->net.kinds[number + v] = CWI_NET_FIXED | CWI_NET_BACK;
    const uint32_t outside = find_outside(s, n, k, beyond);
    load_corners(s, x, y, corners);
    if (x > 0)
        join_cubes(s, n, 0, corners, outside);
    if (y > 0)
        join_cubes(s, n, 1, corners, outside);
    if (k > 0)
        join_cubes(s, n, 2, corners, outside);
}

static void put_vertices(const scan *s, size_t k)
{
    size_t next = 0;
    for (size_t y = 0; y < s->height; y++)
        for (; next < s->row_ends[y]; next++)
            take_vertices(s, s->columns[next], y, k);
}

/* Numbers the vertices of the upper layer of cubes as those before the chunk's first. */
static void number_below(scan *s)
{
    const uint32_t shift = (uint32_t)(s->chunk->vertices - s->next);
    size_t next = 0;
    for (size_t y = 0; y < s->height; y++)
        for (; next < s->row_ends[y]; next++)
            s->firsts[1][y * s->width + s->columns[next]] += shift;
    s->next = s->chunk->vertices;
}

static void swap_layers(scan *s)
{
    uint32_t *labels = s->labels[0], *firsts = s->firsts[0];
    uint8_t *shapes = s->shapes[0], *are_alike = s->are_alike[0];
    s->labels[0] = s->labels[1], s->labels[1] = labels;
    s->firsts[0] = s->firsts[1], s->firsts[1] = firsts;
    s->shapes[0] = s->shapes[1], s->shapes[1] = shapes;
    s->are_alike[0] = s->are_alike[1], s->are_alike[1] = are_alike;
}

/* Finds the rows of the upper layer of voxels that have one label. */
static void compare_rows(const scan *s)
{
    const size_t wide = s->job->layers.width;
    for (size_t y = 0; y <= s->height; y++) {
        const uint32_t *row = s->labels[1] + y * wide;
        s->are_alike[1][y] = memcmp(row, row + 1, (wide - 1) * sizeof *row) == 0;
    }
}

/* Loads a layer of voxels above the one before; keeps the first voxel that is no label. */
static bool load_layer(scan *s, size_t k)
{
    cwi_label_job *j = s->job;
    size_t bad[3];
    if (cwi_label_layer_load(&j->layers, k, s->labels[1], bad)) {
        compare_rows(s);
        return true;
    }
    s->is_bad = true;
    pthread_mutex_lock(&j->bad_lock);
    const bool is_first = !j->is_bad || bad[2] < j->bad[2] ||
                          (bad[2] == j->bad[2] &&
                           (bad[1] < j->bad[1] || (bad[1] == j->bad[1] && bad[0] < j->bad[0])));
    if (is_first)
        memcpy(j->bad, bad, sizeof bad);
    j->is_bad = true;
    pthread_mutex_unlock(&j->bad_lock);
    return false;
}

/* Goes through the cube layers of a chunk, and the one below it for its vertices' numbers.
 * Returns false when memory is out or a value is no label. */
static bool scan_chunk(scan *s, size_t first, size_t end)
{
    cwi_label_job *j = s->job;
    const size_t from = first > 0 ? first - 1 : 0;
    bool is_well = load_layer(s, from);
    s->next = s->chunk->vertices;
    for (size_t k = from; k < end && is_well; k++) {
        cwi_memory_trim();
        swap_layers(s);
        is_well = load_layer(s, k + 1);
        if (!is_well)
            break;
        if (k < first) { /* its vertices end where the chunk's begin */
            s->next = 0;
            shape_layer(s, k);
            number_below(s);
            continue;
        }
        shape_layer(s, k);
        is_well = take_layer(s, k);
        if (j->is_writing)
            put_vertices(s, k);
        else if (is_well && k + 2 < j->layers.count)
            is_well = cwi_label_layer_count(&j->layers, s->labels[1], &s->chunk->voxels);
    }
    if (!j->is_writing)
        s->chunk->vertices = s->next - s->chunk->vertices;
    return is_well;
}

/* Makes the buffers. Returns false when memory is out. */
static bool prepare_scan(scan *s)
{
    const size_t voxels = s->job->layers.width * s->job->layers.height;
    bool is_whole = true;
    for (int i = 0; i < 2; i++) {
        s->labels[i] = cwi_alloc_array(voxels, sizeof *s->labels[i]);
        s->are_alike[i] = cwi_alloc_array(s->job->layers.height, 1);
        s->shapes[i] = cwi_alloc_array(voxels, 1);
        s->firsts[i] = cwi_alloc_array(voxels, sizeof *s->firsts[i]);
        is_whole = is_whole && s->labels[i] && s->are_alike[i] && s->shapes[i] && s->firsts[i];
    }
    s->marks = cwi_alloc_array(s->job->layers.width + MARKS, 1);
    s->columns = cwi_alloc_array(voxels, sizeof *s->columns);
    s->row_ends = cwi_alloc_array(s->height, sizeof *s->row_ends);
    for (int edge = 1; edge < 8; edge++)
        for (int i = 0; i < s->job->rules.around[edge].count; i++) {
            const int8_t *cube = s->job->rules.around[edge].cube[i];
            s->offsets[edge][i] = cube[0] + cube[1] * (ptrdiff_t)s->width;
        }
    return is_whole && s->marks && s->columns && s->row_ends;
}

static void free_scan(scan *s)
{
    for (int i = 0; i < 2; i++) {
        cwi_free(s->labels[i]);
        cwi_free(s->are_alike[i]);
        cwi_free(s->shapes[i]);
        cwi_free(s->firsts[i]);
    }
    cwi_free(s->marks);
    cwi_free(s->columns);
    cwi_free(s->row_ends);
}

void cwi_label_chunk_work(void *context, size_t chunk)
{
    cwi_label_job *j = context;
    const size_t n = j->first_chunk + chunk;
    scan s = {.job = j,
              .chunk = &j->chunks[n],
              .width = j->layers.width - 1,
              .height = j->layers.height - 1};
    const size_t layers = j->layers.count - 1, first = n * CWI_LABEL_CHUNK,
                 end = first + CWI_LABEL_CHUNK < layers ? first + CWI_LABEL_CHUNK : layers;
    if (!prepare_scan(&s) || (!scan_chunk(&s, first, end) && !s.is_bad))
        cwi_set_flag(&j->is_starved);
    free_scan(&s);
}
