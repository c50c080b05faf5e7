/* The promise on any input, on the inputs that extractors break on: support/hostile.h in every
 * frame, with every setting. cgal/ looks at the same volumes for surfaces that cross
 * themselves. */
#include "support/hostile.h"
#include "support/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS = 32 };

/* Fills in the volume: half of the settings let values fall as numbers rise. */
static cw_extract_desc make(const test_hostile *h, unsigned setting, cw_volume *v)
{
    cw_error err = {0};
    assert_ok(test_hostile_make(h, v, &err), err);
    v->slope = setting & 8 ? -1 : 1;
    return (cw_extract_desc){.isovalue = v->slope * h->isovalue,
                             .leave_open = setting & 1,
                             .inside_is_low = setting & 2,
                             .simple_topology = setting & 4,
                             .cubic_placement = setting & 16,
                             .threads = 1};
}

static int compare_edges(const void *a, const void *b)
{
    const uint64_t s = *(const uint64_t *)a, t = *(const uint64_t *)b;
    return s < t ? -1 : s > t;
}

/* Sides of triangles, lower vertex first, sorted: equal ones are neighbours. */
static uint64_t *sorted_edges(const cw_mesh *mesh)
{
    const size_t count = 3 * mesh->triangle_count;
    uint64_t *edges = malloc(count * sizeof *edges + 1);
    assert_non_null(edges);
    for (size_t i = 0; i < count; i++) {
        const uint64_t v = mesh->triangles[i];
        const uint64_t w = mesh->triangles[i % 3 == 2 ? i - 2 : i + 1];
        edges[i] = v < w ? v << 32 | w : w << 32 | v;
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    return edges;
}

static bool has_value(const cw_volume *v, const size_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] >= v->dim[a])
            return false;
    const double x = cw_volume_value(v, at[0], at[1], at[2]);
    return !isnan(x) && !(v->has_nodata && x == v->slope * v->nodata);
}

/* A cell of which all samples have values. */
static bool is_live(const cw_volume *v, const size_t at[3])
{
    bool live = true;
    for (size_t c = 0; c < 8; c++)
        live = live && has_value(v, (size_t[3]){at[0] + (c & 1), at[1] + (c >> 1 & 1),
                                                at[2] + (c >> 2)});
    return live;
}

/* Whether this cell or one around it has a sample without a value. */
static bool is_near_border(const cw_volume *v, const size_t cell[3])
{
    for (size_t n = 0; n < 27; n++) /* an index below 0 wraps around */
        if (!is_live(v, (size_t[3]){cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1,
                                    cell[2] + n / 9 - 1}))
            return true;
    return false;
}

/* An open edge lies in a wall between cells, on the volume's border or, where there are gaps,
 * near one: cells beside gaps are dropped, too, where two would meet in an edge. */
static bool is_on_border(const cw_volume *v, const cw_mesh *mesh, uint64_t edge, bool gaps)
{
    double p[2][3], world[3];
    const size_t ends[2] = {edge >> 32, edge & UINT32_MAX};
    for (int e = 0; e < 2; e++) {
        for (size_t a = 0; a < 3; a++)
            world[a] = mesh->origin[a] + (double)mesh->positions[3 * ends[e] + a];
        assert_int_equal(cw_volume_to_index(v, world, p[e], NULL), CW_OK);
    }
    for (int a = 0; a < 3; a++) {
        const double wall = rint(p[0][a]);
        if (fabs(p[0][a] - wall) > 2e-4 || fabs(p[1][a] - wall) > 2e-4)
            continue;
        if (!gaps && (wall == 0 || wall + 1 == (double)v->dim[a]))
            return true;
        size_t cell[3];
        for (int b = 0; b < 3; b++)
            cell[b] = (size_t)(a == b ? wall : floor(0.5 * (p[0][b] + p[1][b])));
        if (gaps && is_near_border(v, cell))
            return true;
    }
    return false;
}

static bool has_gaps(const cw_volume *v)
{
    for (size_t n = 0; n < v->dim[0] * v->dim[1] * v->dim[2]; n++)
        if (!has_value(v, (size_t[3]){n % v->dim[0], n / v->dim[0] % v->dim[1],
                                      n / v->dim[0] / v->dim[1]}))
            return true;
    return false;
}

static const char *border_fault(const cw_volume *v, const cw_mesh *mesh)
{
    const size_t count = 3 * mesh->triangle_count;
    const bool gaps = has_gaps(v);
    bool inner = false;
    uint64_t *edges = sorted_edges(mesh);
    for (size_t i = 0; i < count; i++)
        if ((i == 0 || edges[i] != edges[i - 1]) &&
            (i + 1 == count || edges[i] != edges[i + 1]))
            inner = inner || !is_on_border(v, mesh, edges[i], gaps);
    free(edges);
    return inner ? "an open edge off the border" : NULL;
}

/* Prints what is wrong, if anything. */
static bool is_faulty(const test_hostile *h, const test_frame *frame, unsigned setting)
{
    cw_volume v;
    const cw_extract_desc d = make(h, setting, &v);
    memcpy(v.affine, frame->affine, sizeof v.affine);
    cw_mesh mesh = test_extract(&v, &d, NULL);
    const char *fault = d.leave_open ? border_fault(&v, &mesh) : NULL;
    if (frame->far) /* the promise is about local positions there */
        memset(mesh.origin, 0, sizeof mesh.origin);
    cw_quality q = {0};
    if (!fault)
        fault = test_mesh_fault(&mesh, d.leave_open, &q);
    if (!fault && !d.leave_open && mesh.triangle_count > 0 && !(q.volume_mm3 > 0))
        fault = "its outside inside";
    if (fault)
        print_message("%s, %s%s%s%s%s: the mesh has %s\n", h->name, frame->name,
                      d.leave_open ? ", open" : "", d.inside_is_low ? ", low" : "",
                      d.simple_topology ? ", simple" : "", v.slope < 0 ? ", falling" : "",
                      fault);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
    return fault != NULL;
}

static void hostile_volumes_keep_the_promise_with_every_setting(void **state)
{
    (void)state;
    int faulty = 0;
    for (size_t n = 0; test_hostile_at(n); n++)
        for (unsigned s = test_is_short() ? n % 9 : 0; s < SETTINGS;
             s += test_is_short() ? 9 : 1)
            faulty += is_faulty(test_hostile_at(n), test_frame_at(0), s);
    assert_int_equal(faulty, 0);
}

static void hostile_volumes_keep_the_promise_in_every_frame(void **state)
{
    (void)state;
    int faulty = 0;
    for (size_t n = 0; test_hostile_at(n); n++)
        for (size_t f = test_is_short() ? 1 + n % 4 : 1; test_frame_at(f);
             f += test_is_short() ? 4 : 1)
            faulty +=
                is_faulty(test_hostile_at(n), test_frame_at(f), (unsigned)(n + f) % SETTINGS);
    assert_int_equal(faulty, 0);
}

static bool same_bytes(const void *a, const void *b, size_t count)
{
    return count == 0 || memcmp(a, b, count) == 0;
}

static bool same_surface(const cw_mesh *a, const cw_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           same_bytes(a->positions, b->positions, 12 * a->vertex_count) &&
           same_bytes(a->triangles, b->triangles, 12 * a->triangle_count);
}

/* Bytes, compared without normals and with an isovalue of another sign. */
static bool is_changed(const test_hostile *h, unsigned setting)
{
    cw_volume v;
    cw_extract_desc d = make(h, setting, &v);
    cw_mesh mesh = test_extract(&v, &d, NULL), other[2];
    d.isovalue = d.isovalue == 0 ? -d.isovalue : d.isovalue;
    other[0] = test_extract(&v, &d, NULL);
    d.no_normals = true;
    other[1] = test_extract(&v, &d, NULL);
    const bool sign = !same_surface(&mesh, &other[0]) ||
                      !same_bytes(mesh.normals, other[0].normals, 12 * mesh.vertex_count);
    const bool normals = !same_surface(&mesh, &other[1]);
    if (sign || normals)
        print_message("%s: another surface %s\n", h->name, sign ? "at -0" : "without normals");
    cw_mesh_free(&mesh);
    for (int o = 0; o < 2; o++)
        cw_mesh_free(&other[o]);
    cw_volume_free(&v);
    return sign || normals;
}

static void normals_and_the_sign_of_zero_do_not_change_the_surface(void **state)
{
    (void)state;
    int changed = 0;
    for (size_t n = 0; test_hostile_at(n); n++)
        changed += is_changed(test_hostile_at(n), (unsigned)n % SETTINGS);
    assert_int_equal(changed, 0);
}

/* A sphere is smooth, and a grid fine enough shows it: every normal agrees with every triangle
 * around it, outward of the ball, and into the hole that is left where low is inside. */
static void normals_point_outward_in_every_frame(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    for (size_t f = 0; test_frame_at(f); f++)
        for (int low = 0; low < 2; low++) {
            const cw_extract_desc d = {.inside_is_low = low, .leave_open = true};
            memcpy(v.affine, test_frame_at(f)->affine, sizeof v.affine);
            cw_mesh mesh = test_extract(&v, &d, NULL);
            assert_true(test_normals_agree(&mesh));
            memset(mesh.origin, 0, sizeof mesh.origin);
            const double volume = test_check_promise(&mesh, false).volume_mm3;
            assert_true(low ? volume < 0 : volume > 0);
            cw_mesh_free(&mesh);
        }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hostile_volumes_keep_the_promise_with_every_setting),
        cmocka_unit_test(hostile_volumes_keep_the_promise_in_every_frame),
        cmocka_unit_test(normals_and_the_sign_of_zero_do_not_change_the_surface),
        cmocka_unit_test(normals_point_outward_in_every_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
