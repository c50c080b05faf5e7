/* Random solids in pairs, by seeds, and the check of what a boolean makes of them. */
#include "support/solids.h"

#include "core/base/memory.h"

#include <cubewright/field.h>
#include <cubewright/quality.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *const test_pair_names[PAIR_KINDS] = {"fields",  "scans",  "boxes",   "copies",
                                                 "needles", "shells", "spheres", "stars",
                                                 "faces",   "crops"};

double test_random(void)
{
    return rand() / ((double)RAND_MAX + 1);
}

static double random_between(double low, double high)
{
    return low + (high - low) * test_random();
}

/* --- parts ---------------------------------------------------------------------------------- */

cw_mesh test_make_boxes(size_t capacity)
{
    cw_mesh m = {0};
    m.positions = cwi_alloc_array(24 * capacity, sizeof *m.positions);
    m.triangles = cwi_alloc_array(36 * capacity, sizeof *m.triangles);
    assert_true(m.positions && m.triangles);
    return m;
}

void test_add_box(cw_mesh *m, const double low[3], const double high[3], bool inward)
{
    static const uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                         {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    const uint32_t base = (uint32_t)m->vertex_count;
    for (uint32_t v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++)
            m->positions[3 * (m->vertex_count + v) + (size_t)k] =
                (float)(v >> (2 - k) & 1 ? high[k] : low[k]);
    m->vertex_count += 8;
    for (int s = 0; s < 6; s++)
        for (int t = 0; t < 2; t++) {
            uint32_t *c = m->triangles + 3 * m->triangle_count++;
            c[0] = base + sides[s][0];
            c[1] = base + sides[s][inward ? 2 + t : 1 + t];
            c[2] = base + sides[s][inward ? 1 + t : 2 + t];
        }
}

cw_mesh test_extract_field(cw_field field, size_t n)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh mesh = test_extract(
        &volume, &(cw_extract_desc){.isovalue = (float)cw_field_isovalue(field)}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

/* Extracts noise of eight grey values, whose surface often passes through voxels and middles of edges. */
static cw_mesh extract_scan(size_t n)
{
    cw_volume volume = test_sample(CW_FIELD_SPHERE, n, CW_F32);
    float *voxels = (float *)(uintptr_t)volume.data;
    for (size_t i = 0; i < n * n * n; i++)
        voxels[i] = (float)(rand() % 8) + (voxels[i] > 0 ? 2 : 0);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.isovalue = 5}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static const char *scan_path(char path[4096])
{
    const char *data = getenv("CUBEWRIGHT_DATA");
    snprintf(path, 4096, "%s/data/headsq-ct/headsq.mha", data ? data : "");
    return path;
}

bool test_has_scan(void)
{
    char path[4096];
    return access(scan_path(path), R_OK) == 0;
}

/* Extracts a random block of a scan at a random value between its smallest and largest. */
static cw_mesh extract_crop(void)
{
    static cw_volume scan; /* of all pairs */
    char path[4096];
    cw_error err = {0};
    cw_mesh mesh = {0};
    if (!scan.data)
        assert_ok(cw_volume_read(scan_path(path), NULL, &scan, NULL, &err), err);
    while (!mesh.triangle_count) {
        cw_volume block;
        cw_box box;
        for (int k = 0; k < 3; k++) {
            box.count[k] = 4 + (size_t)(rand() % 6);
            box.first[k] = (size_t)(test_random() * (double)(scan.dim[k] - box.count[k] + 1));
        }
        assert_ok(cw_volume_crop(&scan, &box, &block, &err), err);
        memset(block.affine, 0, sizeof block.affine);
        const float level = (float)floor(random_between(100, 1500));
        assert_ok(cw_extract(&block, &(cw_extract_desc){.isovalue = level, .no_normals = true},
                             &mesh, NULL, &err),
                  err);
        cw_volume_free(&block);
    }
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.positions[i] = (float)((double)mesh.positions[i] + mesh.origin[i % 3]);
    memset(mesh.origin, 0, sizeof mesh.origin);
    return mesh;
}

/* Adds an octahedron whose sides are cut into squares of n, its points moved onto a sphere, or at random
 * distances of up to the radius. */
static void add_ball(cw_mesh *m, int n, const double at[3], double radius, double spikes,
                     bool inward)
{
    const size_t side = (size_t)n + 1, count = 8 * side * side;
    uint32_t *numbers = cwi_alloc_array(count, sizeof *numbers);
    double(*points)[3] = cwi_alloc_array(count, sizeof *points);
    size_t known = 0;
    m->positions = cwi_realloc_array(m->positions, m->vertex_count + count, 12);
    m->triangles = cwi_realloc_array(m->triangles, m->triangle_count + 8 * (size_t)(n * n), 12);
    assert_true(numbers && points && m->positions && m->triangles);
    for (int o = 0; o < 8; o++)
        for (int i = 0; i <= n; i++)
            for (int j = 0; i + j <= n; j++) {
                const double p[3] = {(o & 1 ? -1 : 1) * i, (o & 2 ? -1 : 1) * j,
                                     (o & 4 ? -1 : 1) * (n - i - j)};
                size_t v = 0;
                while (v < known &&
                       (points[v][0] != p[0] || points[v][1] != p[1] || points[v][2] != p[2]))
                    v++;
                numbers[((size_t)o * side + (size_t)i) * side + (size_t)j] =
                    (uint32_t)(m->vertex_count + v);
                if (v == known)
                    memcpy(points[known++], p, sizeof p);
            }
    for (size_t v = 0; v < known; v++) {
        const double *p = points[v], length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        const double r = radius * (1 - spikes * test_random()) / length;
        for (size_t k = 0; k < 3; k++)
            m->positions[3 * (m->vertex_count + v) + k] = (float)(at[k] + r * p[k]);
    }
    m->vertex_count += known;
    for (int o = 0; o < 8; o++)
        for (int i = 0; i < n; i++)
            for (int j = 0; i + j < n; j++)
                for (int half = 0; half < (i + j + 1 < n ? 2 : 1); half++) {
                    const uint32_t *at_i =
                        numbers + ((size_t)o * side + (size_t)i) * side + (size_t)j;
                    const uint32_t *next = at_i + side;
                    const bool flip = (o & 1) ^ (o >> 1 & 1) ^ (o >> 2 & 1) ^ inward;
                    const uint32_t last = half ? next[1] : at_i[1];
                    uint32_t *c = m->triangles + 3 * m->triangle_count++;
                    c[0] = at_i[half];
                    c[1] = flip ? last : next[0];
                    c[2] = flip ? next[0] : last;
                }
    cwi_free(numbers);
    cwi_free(points);
}

/* --- changes -------------------------------------------------------------------------------- */

void test_move_mesh(cw_mesh *m, double angle, double scale, const double by[3])
{
    for (size_t v = 0; v < m->vertex_count; v++) {
        float *p = m->positions + 3 * v;
        const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
        p[0] = (float)(scale * (x * cos(angle) - y * sin(angle) + by[0]));
        p[1] = (float)(scale * (x * sin(angle) + y * cos(angle) + by[1]));
        p[2] = (float)(scale * (z + by[2]));
    }
    cwi_free(m->normals);
    m->normals = NULL;
}

/* Turns a mesh about each axis in turn. */
static void turn_mesh(cw_mesh *m, const double angles[3])
{
    for (size_t k = 0; k < 3; k++)
        for (size_t v = 0; v < m->vertex_count; v++) {
            float *p = m->positions + 3 * v;
            const double x = (double)p[k], y = (double)p[(k + 1) % 3];
            p[k] = (float)(x * cos(angles[k]) - y * sin(angles[k]));
            p[(k + 1) % 3] = (float)(x * sin(angles[k]) + y * cos(angles[k]));
        }
}

static void turn_at_random(cw_mesh *m)
{
    const double angles[3] = {6.3 * test_random(), 6.3 * test_random(), 6.3 * test_random()};
    turn_mesh(m, angles);
}

static void move_at_random(cw_mesh *m, double reach)
{
    const double by[3] = {reach * test_random(), reach * test_random(), reach * test_random()};
    test_move_mesh(m, 0, 1, by);
}

static void append_mesh(cw_mesh *m, const cw_mesh *other)
{
    m->positions = cwi_realloc_array(m->positions, m->vertex_count + other->vertex_count, 12);
    m->triangles =
        cwi_realloc_array(m->triangles, m->triangle_count + other->triangle_count, 12);
    assert_true(m->positions && m->triangles);
    memcpy(m->positions + 3 * m->vertex_count, other->positions, 12 * other->vertex_count);
    for (size_t c = 0; c < 3 * other->triangle_count; c++)
        m->triangles[3 * m->triangle_count + c] =
            (uint32_t)m->vertex_count + other->triangles[c];
    m->vertex_count += other->vertex_count;
    m->triangle_count += other->triangle_count;
}

static cw_mesh copy_mesh(const cw_mesh *m)
{
    cw_mesh copy = {0};
    append_mesh(&copy, m);
    return copy;
}

/* --- pairs ---------------------------------------------------------------------------------- */

static cw_mesh make_star(void)
{
    cw_mesh m = {0};
    const double at[3] = {test_random(), test_random(), test_random()};
    add_ball(&m, 1 + rand() % 5, at, 1, random_between(0.1, 0.9), false);
    return m;
}

/* A few needles and plates about one point. */
static cw_mesh make_needles(void)
{
    cw_mesh m = {0};
    const double middle[3] = {0, 0, 0};
    const int count = 1 + rand() % 4;
    for (int i = 0; i < count; i++) {
        cw_mesh one = {0};
        add_ball(&one, 1 + rand() % 2, middle, 1, 0, false);
        for (size_t k = 0; k < 3; k++) {
            const double size = pow(10, random_between(-4, 1));
            for (size_t v = 0; v < one.vertex_count; v++)
                one.positions[3 * v + k] = (float)((double)one.positions[3 * v + k] * size);
        }
        turn_at_random(&one);
        append_mesh(&m, &one);
        cw_mesh_free(&one);
    }
    return m;
}

static cw_mesh make_shells(void)
{
    cw_mesh m = {0};
    double radius = 1;
    const double at[3] = {test_random() / 2, test_random() / 2, test_random() / 2};
    const int count = 1 + rand() % 5, n = 1 + rand() % 4;
    for (int i = 0; i < count; i++, radius *= random_between(0.5, 0.9))
        add_ball(&m, n, at, radius, 0, i % 2);
    return m;
}

static cw_mesh make_spheres(void)
{
    cw_mesh m = {0};
    const int count = 1 + rand() % 5;
    for (int i = 0; i < count; i++) {
        const double at[3] = {test_random(), test_random(), test_random()};
        add_ball(&m, 2 + rand() % 5, at, random_between(0.2, 0.8), 0, false);
    }
    return m;
}

static cw_mesh make_grid_boxes(void)
{
    const int count = 1 + rand() % 3;
    cw_mesh m = test_make_boxes((size_t)count);
    for (int i = 0; i < count; i++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = rand() % 4;
            high[k] = low[k] + 1 + rand() % 3;
        }
        test_add_box(&m, low, high, false);
    }
    return m;
}

/* Boxes on both sides of a plane, or several between whole numbers in each mesh, all turned as one. */
static void make_faces(cw_mesh pair[2])
{
    const double angles[3] = {6.3 * test_random(), 6.3 * test_random(), 6.3 * test_random()};
    const int what = rand() % 3;
    for (int n = 0; n < 2; n++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = what ? rand() % 4 / 2.0 : random_between(0, 1);
            high[k] = low[k] + (what ? 1 + rand() % 3 / 2.0 : random_between(0.5, 2));
        }
        low[0] = n ? 0 : -1;
        high[0] = n ? 1 : 0;
        pair[n] = what == 2 ? make_grid_boxes() : test_make_boxes(1);
        if (what < 2)
            test_add_box(&pair[n], low, high, false);
        turn_mesh(&pair[n], angles);
    }
}

static void make_copies(cw_mesh pair[2])
{
    static const double angles[] = {0, 1e-15, 1e-8, 1e-7, 3e-7, 1e-6};
    const int what = rand() % 4;
    pair[0] = what == 0   ? test_extract_field(CW_FIELD_SPHERE, 6 + (size_t)(rand() % 6))
              : what == 1 ? make_star()
              : what == 2 ? make_spheres()
                          : make_grid_boxes();
    test_move_mesh(&pair[0], 0, 1, (const double[3]){0, 0, 0});
    pair[1] = copy_mesh(&pair[0]);
    test_move_mesh(&pair[1], angles[rand() % 6], 1, (const double[3]){0, 0, 0});
}

static cw_mesh make_solid(test_pair_kind kind)
{
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    switch (kind) {
    case PAIR_FIELDS:
        return test_extract_field(fields[rand() % 3], 8 + (size_t)(rand() % 6));
    case PAIR_SCANS:
        return extract_scan(4 + (size_t)(rand() % 4));
    case PAIR_CROPS:
        return extract_crop();
    case PAIR_BOXES:
        return make_grid_boxes();
    case PAIR_NEEDLES:
        return make_needles();
    case PAIR_SHELLS:
        return make_shells();
    case PAIR_SPHERES:
        return make_spheres();
    default:
        return make_star();
    }
}

/* Brings the second solid of a pair to its place. */
static void place_second(test_pair_kind kind, cw_mesh *m)
{
    const double angle = rand() % 4 ? 6.3 * test_random() : 1e-7;
    if (kind == PAIR_FIELDS) {
        move_at_random(m, rand() % 4 ? 30 : 0);
        test_move_mesh(m, angle, 1, (const double[3]){0, 0, 0});
    } else if (kind == PAIR_SCANS) {
        test_move_mesh(m, rand() % 3 ? 0 : angle, 1,
                       (const double[3]){rand() % 5 / 2.0, rand() % 5 / 2.0, rand() % 5 / 2.0});
    } else if (kind == PAIR_NEEDLES) {
        move_at_random(m, rand() % 2 ? 0.001 : 0.1);
    } else if (kind == PAIR_SHELLS || kind == PAIR_SPHERES) {
        if (rand() % 2)
            turn_at_random(m);
    }
}

void test_make_pair(test_pair_kind kind, unsigned seed, cw_mesh pair[2])
{
    srand(seed);
    const int size = rand() % 5;
    if (kind == PAIR_COPIES)
        make_copies(pair);
    else if (kind == PAIR_FACES)
        make_faces(pair);
    else
        for (int n = 0; n < 2; n++) {
            pair[n] = make_solid(kind);
            if (n)
                place_second(kind, &pair[n]);
        }
    for (int n = 0; n < 2; n++)
        test_move_mesh(&pair[n], 0,
                       size == 0   ? 1e-6
                       : size == 1 ? 1e6
                                   : 1,
                       (const double[3]){0, 0, 0});
}

/* --- results -------------------------------------------------------------------------------- */

static size_t count_crossings(const cw_mesh *m)
{
    cw_error err = {0};
    cw_crossings crossings = {0};
    assert_ok(
        cw_self_intersections(m, &(cw_crossings_desc){.weld = CW_WELD_WORLD}, &crossings, &err),
        err);
    const size_t count = crossings.count;
    cw_crossings_free(&crossings);
    return count;
}

const char *test_solid_fault(const cw_mesh *m)
{
    const cw_quality q = test_measure(m);
    return q.open_edges             ? "it is open"
           : q.nonmanifold_edges    ? "edges are not manifold"
           : q.nonmanifold_vertices ? "vertices are not manifold"
           : q.misoriented_edges    ? "triangles do not face the same way"
           : q.degenerate           ? "triangles have no area"
           : count_crossings(m)     ? "triangles cross"
                                    : NULL;
}

void test_check_solid(const cw_mesh *m)
{
    const char *fault = m->triangle_count ? test_solid_fault(m) : NULL;
    if (fault)
        fail_msg("%s", fault);
}
