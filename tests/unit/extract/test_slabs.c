/* A surface a slab at a time: the same triangles, and seams that fit. */
#include "support/surface.h"

#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct taken {
    const cw_mesh *whole;
    size_t slabs, triangles, most; /* taken; of the largest */
    float *seam;                   /* positions of the last upper seam */
    size_t seam_count;
    bool ended;
    size_t stop_at; /* the slab that is refused; 0: none */
} taken;

static double height(const cw_slab *slab, const float *x)
{
    return slab->along[0] * (double)x[0] + slab->along[1] * (double)x[1] +
           slab->along[2] * (double)x[2];
}

/* The n-th vertex of the seam below is the n-th of the one above, before. */
static void check_seams(taken *t, const cw_slab *slab)
{
    const cw_mesh *m = slab->mesh;
    size_t n = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
        if (slab->seam[v] == 1) {
            assert_in_range(n, 0, t->seam_count - 1);
            assert_memory_equal(m->positions + 3 * v, t->seam + 3 * n, 3 * sizeof(float));
            n++;
        }
    assert_int_equal(n, t->seam_count);
    free(t->seam);
    t->seam = malloc((3 * m->vertex_count + 1) * sizeof *t->seam);
    t->seam_count = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
        if (slab->seam[v] == 2)
            memcpy(t->seam + 3 * t->seam_count++, m->positions + 3 * v, 3 * sizeof(float));
}

static cw_status take(void *user, const cw_slab *slab, cw_error *err)
{
    taken *t = user;
    const cw_mesh *m = slab->mesh, *w = t->whole;
    (void)err;
    assert_false(t->ended);
    assert_int_equal(slab->triangles, w->triangle_count);
    assert_true(t->triangles + m->triangle_count <= w->triangle_count);
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        const float *x = m->positions + 3 * (size_t)m->triangles[c],
                    *y = w->positions + 3 * (size_t)w->triangles[3 * t->triangles + c];
        assert_memory_equal(x, y, 3 * sizeof *x);
        if (!slab->seam[m->triangles[c]]) {
            assert_true(height(slab, x) > slab->low);
            assert_true(height(slab, x) < slab->high);
        }
    }
    check_seams(t, slab);
    t->triangles += m->triangle_count;
    t->most = m->triangle_count > t->most ? m->triangle_count : t->most;
    t->ended = slab->last;
    return ++t->slabs == t->stop_at ? cwi_fail(err, CW_ERR_CANCELLED, "enough") : CW_OK;
}

static void fill(cw_volume *v, int round)
{
    float *x = cw_volume_voxels(v);
    for (size_t n = 0; n < v->dim[0] * v->dim[1] * v->dim[2]; n++)
        x[n] = rand() % 50 ? (float)rand() / (float)RAND_MAX : (round & 1 ? NAN : 0.5f);
    v->affine[0][1] = round & 2 ? 0.3 : 0;
    v->affine[1][2] = round & 2 ? -0.4 : 0;
    v->affine[0][0] = round & 4 ? -0.7 : 0.7;
    v->affine[2][2] = 2.5;
    v->affine[2][3] = 1000;
    static double uneven[3][100];
    for (int a = 0; a < 3 && round & 16; a++) {
        for (size_t i = 0; i < v->dim[a]; i++)
            uneven[a][i] = (double)i + 0.3 * sin((double)i);
        v->coordinates[a] = uneven[a];
    }
}

static void slabs_are_the_surface(void **state)
{
    (void)state;
    test_seed(5);
    for (int round = 0; round < 32; round++) {
        cw_volume v;
        cw_mesh whole = {0};
        cw_error err = {0};
        cw_extract_counts counts;
        const cw_extract_desc desc = {
            .isovalue = 0.5, .leave_open = round & 8, .no_normals = true, .threads = round % 3};
        assert_ok(cw_volume_alloc(&v, CW_F32, (size_t[3]){9, 14, 100}, 1, 1, &err), err);
        fill(&v, round);
        assert_ok(cw_extract(&v, &desc, &whole, NULL, &err), err);
        taken t = {.whole = &whole};
        assert_ok(cw_extract_slabs(&v, &desc, 1000, (cw_slab_sink){take, &t}, &counts, &err),
                  err);
        assert_true(t.ended);
        assert_true(t.slabs >= 5);
        assert_true(t.most < whole.triangle_count / 3);
        assert_int_equal(t.triangles, whole.triangle_count);
        assert_int_equal(counts.triangles, whole.triangle_count);
        assert_int_equal(counts.vertices, whole.vertex_count);
        free(t.seam);
        cw_mesh_free(&whole);
        cw_volume_free(&v);
    }
}

static void what_the_sink_says_is_returned(void **state)
{
    (void)state;
    cw_volume v;
    cw_mesh whole = {0};
    cw_error err = {0};
    cw_extract_desc desc = {.isovalue = 0.5};
    assert_ok(cw_volume_alloc(&v, CW_F32, (size_t[3]){9, 14, 100}, 1, 1, &err), err);
    fill(&v, 0);
    assert_ok(cw_extract(&v, &desc, &whole, NULL, &err), err);
    taken t = {.whole = &whole, .stop_at = 2};
    const cw_slab_sink sink = {take, &t};
    assert_int_equal(cw_extract_slabs(&v, &desc, 1000, sink, NULL, &err), CW_ERR_CANCELLED);
    assert_string_equal(err.message, "enough");
    assert_int_equal(t.slabs, 2);
    desc.snap = 0.3;
    assert_int_equal(cw_extract_slabs(&v, &desc, 1000, sink, NULL, &err), CW_ERR_ARGUMENT);
    desc.snap = 0;
    desc.max_triangles = 1000;
    assert_int_equal(cw_extract_slabs(&v, &desc, 1000, sink, NULL, &err), CW_ERR_LIMIT);
    desc.max_triangles = 0;
    desc.max_bytes = 50000; /* less than a slab */
    assert_int_equal(cw_extract_slabs(&v, &desc, 1000, sink, NULL, &err), CW_ERR_LIMIT);
    assert_int_equal(t.slabs, 2);
    desc.max_bytes = 0;
    desc.isovalue = 2;
    cw_extract_counts counts;
    assert_ok(cw_extract_slabs(&v, &desc, 1000, sink, &counts, &err), err);
    assert_int_equal(counts.triangles, 0);
    assert_int_equal(t.slabs, 2);
    free(t.seam);
    cw_mesh_free(&whole);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_are_the_surface),
        cmocka_unit_test(what_the_sink_says_is_returned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
