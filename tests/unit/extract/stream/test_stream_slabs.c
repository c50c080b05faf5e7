/* Slabs and normals from slices: the same bytes as from a volume in memory. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/stream.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A volume in memory, as slices. */
typedef struct slices {
    const cw_volume *volume;
    size_t next, reads, most; /* the slice expected next; slices read; of one call at most */
    size_t fail_at;           /* the slice that cannot be read; 0: none */
} slices;

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    slices *s = user;
    const size_t slice = (size_t)s->volume->stride[2];
    assert_true(first >= s->next || first == 0);
    assert_true(count > 0 && first + count <= s->volume->dim[2]);
    if (s->fail_at && first + count > s->fail_at)
        return cwi_fail(err, CW_ERR_IO, "slice %zu cannot be read", s->fail_at);
    memcpy(to, (const char *)s->volume->data + first * slice, count * slice);
    s->next = first + count;
    s->reads += count;
    s->most = count > s->most ? count : s->most;
    return CW_OK;
}

static cw_slice_source source_of(slices *s)
{
    cw_slice_source source = {.shape = *s->volume, .read = read_slices, .user = s};
    source.shape.data = NULL;
    return source;
}

/* Slabs, kept to be compared. */
typedef struct kept_slab {
    cw_slab slab;
    cw_mesh mesh;
    uint8_t *seam;
} kept_slab;

typedef struct kept_slabs {
    kept_slab slabs[64];
    size_t count, stop_at; /* the slab that is refused; 0: none */
} kept_slabs;

static void *copy_bytes(const void *from, size_t bytes)
{
    void *to = malloc(bytes + 1);
    assert_non_null(to);
    return memcpy(to, from, bytes);
}

static cw_status keep_slab(void *user, const cw_slab *slab, cw_error *err)
{
    kept_slabs *kept = user;
    kept_slab *k = &kept->slabs[kept->count++];
    const cw_mesh *m = slab->mesh;
    assert_in_range(kept->count, 1, 64);
    *k = (kept_slab){.slab = *slab, .mesh = *m};
    k->mesh.positions = copy_bytes(m->positions, 12 * m->vertex_count);
    k->mesh.triangles = copy_bytes(m->triangles, 12 * m->triangle_count);
    k->seam = copy_bytes(slab->seam, m->vertex_count);
    return kept->count == kept->stop_at ? cwi_fail(err, CW_ERR_CANCELLED, "enough") : CW_OK;
}

static void free_kept(kept_slabs *kept)
{
    for (size_t n = 0; n < kept->count; n++) {
        free(kept->slabs[n].mesh.positions);
        free(kept->slabs[n].mesh.triangles);
        free(kept->slabs[n].seam);
    }
    *kept = (kept_slabs){0};
}

static void assert_same_slab(const kept_slab *a, const kept_slab *b)
{
    assert_int_equal(a->mesh.vertex_count, b->mesh.vertex_count);
    assert_int_equal(a->mesh.triangle_count, b->mesh.triangle_count);
    assert_memory_equal(a->mesh.positions, b->mesh.positions, 12 * a->mesh.vertex_count);
    assert_memory_equal(a->mesh.triangles, b->mesh.triangles, 12 * a->mesh.triangle_count);
    assert_memory_equal(a->seam, b->seam, a->mesh.vertex_count);
    assert_null(a->mesh.normals);
    assert_memory_equal(a->mesh.origin, b->mesh.origin, sizeof a->mesh.origin);
    assert_memory_equal(a->mesh.affine, b->mesh.affine, sizeof a->mesh.affine);
    assert_memory_equal(a->slab.along, b->slab.along, sizeof a->slab.along);
    assert_memory_equal(&a->slab.low, &b->slab.low, sizeof a->slab.low);
    assert_memory_equal(&a->slab.high, &b->slab.high, sizeof a->slab.high);
    assert_int_equal(a->slab.triangles, b->slab.triangles);
    assert_int_equal(a->slab.last, b->slab.last);
}

/* For several sizes of slabs and windows, and for one and two threads. */
static void assert_same_slabs(const cw_volume *v, const cw_extract_desc *desc)
{
    static const size_t triangles[] = {1, 1500, 1 << 19}, layers[] = {1, 3, 16, 23, 0};
    for (size_t t = 0; t < 3; t++) {
        kept_slabs whole = {0};
        cw_extract_counts expected, counts;
        cw_error err = {0};
        assert_ok(cw_extract_slabs(v, desc, triangles[t], (cw_slab_sink){keep_slab, &whole},
                                   &expected, &err),
                  err);
        for (size_t n = 0; n < sizeof layers / sizeof *layers; n++) {
            slices s = {.volume = v};
            kept_slabs parts = {0};
            cw_stream_desc d = {.extract = *desc, .layers = layers[n]};
            const cw_slice_source source = source_of(&s);
            d.extract.threads = 1 + (int)(n & 1);
            assert_ok(cw_extract_stream_slabs(&source, &d, triangles[t],
                                              (cw_slab_sink){keep_slab, &parts}, &counts, &err),
                      err);
            assert_int_equal(counts.vertices, expected.vertices);
            assert_int_equal(counts.triangles, expected.triangles);
            assert_int_equal(counts.border_loops, expected.border_loops);
            assert_int_equal(parts.count, whole.count);
            for (size_t k = 0; k < whole.count; k++)
                assert_same_slab(&parts.slabs[k], &whole.slabs[k]);
            free_kept(&parts);
        }
        free_kept(&whole);
    }
}

/* Values that repeat, so that some are the isovalue and some gradients vanish. */
static cw_volume make_noise(cw_type type, const size_t dim[3], unsigned values, uint64_t seed)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const unsigned x = (unsigned)(seed >> 33) % values;
        void *to = cw_volume_voxels(&v);
        if (type == CW_U8)
            ((uint8_t *)to)[i] = (uint8_t)x;
        else if (type == CW_U16)
            ((uint16_t *)to)[i] = (uint16_t)x;
        else
            ((float *)to)[i] = (float)x;
    }
    const double affine[3][4] = {{0.5, 0.1, 0, 3}, {-0.1, 0.7, 0, -20}, {0, 0.2, 1.5, 100}};
    memcpy(v.affine, affine, sizeof affine);
    return v;
}

/* Uneven distances along all axes. */
static void space_unevenly(cw_volume *v)
{
    static double coordinates[3][160];
    for (int a = 0; a < 3; a++) {
        for (size_t i = 0; i < v->dim[a]; i++)
            coordinates[a][i] = (double)i + 0.3 * sin((double)i);
        v->coordinates[a] = coordinates[a];
    }
}

static void slabs_are_those_of_a_volume_in_memory(void **state)
{
    (void)state;
    static const cw_type types[] = {CW_U8, CW_U16, CW_F32};
    for (size_t n = 0; n < 3; n++) {
        cw_volume v = make_noise(types[n], (const size_t[3]){19, 11, 70 + 5 * n}, 5, 11 + n);
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 2});
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 2.3, .inside_is_low = true});
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 2, .leave_open = true});
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 1.5, .simple_topology = true});
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 3, .cubic_placement = true});
        v.slope = -2;
        v.intercept = 1;
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = -3});
        v.has_nodata = true;
        v.nodata = 4;
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = -3});
        space_unevenly(&v);
        assert_same_slabs(&v, &(cw_extract_desc){.isovalue = -3});
        v.coordinates[0] = v.coordinates[1] = v.coordinates[2] = NULL;
        cw_volume_free(&v);
    }
}

/* Open surfaces end at voxels without a value, too. */
static void open_slabs_around_gaps_are_the_same(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_F32, (const size_t[3]){19, 11, 70}, 9, 11);
    v.has_nodata = true;
    v.nodata = 8;
    assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 3, .leave_open = true});
    cw_volume_free(&v);
}

static void a_volume_on_one_side_has_no_slabs(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){12, 10, 40}, 1, 1);
    uint8_t *voxels = cw_volume_voxels(&v);
    assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 5});
    memset(voxels, 9, 12 * 10 * 40);
    assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 5});
    voxels[12 * 10 * 39 + 50] = 1;
    assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 5});
    cw_volume_free(&v);
    v = make_noise(CW_U8, (const size_t[3]){12, 10, 2}, 7, 1);
    assert_same_slabs(&v, &(cw_extract_desc){.isovalue = 3});
    cw_volume_free(&v);
}

/* Moves the vertices a little, some of them out of the volume, as simplification does. */
static void disturb_mesh(cw_mesh *mesh)
{
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        mesh->positions[n] += 0.2F * (float)sin(7.0 * (double)n);
}

static void assert_same_normals(const cw_volume *v, const cw_mesh *mesh,
                                const cw_normals_desc *desc, size_t max_bytes)
{
    slices s = {.volume = v};
    cw_error err = {0};
    cw_mesh expected = *mesh, made = *mesh;
    const cw_slice_source source = source_of(&s);
    expected.normals = made.normals = NULL;
    assert_ok(cw_extract_normals(v, desc, &expected, &err), err);
    assert_ok(cw_extract_stream_normals(&source, desc, max_bytes, &made, &err), err);
    assert_memory_equal(made.normals, expected.normals, 12 * mesh->vertex_count);
    assert_true(s.reads <= v->dim[2]);
    cwi_free(made.normals);
    cwi_free(expected.normals);
}

static void normals_are_those_of_a_volume_in_memory(void **state)
{
    (void)state;
    static const cw_type types[] = {CW_U8, CW_U16, CW_F32};
    for (size_t n = 0; n < 6; n++) {
        cw_volume v =
            make_noise(types[n % 3], (const size_t[3]){36, 30, 33 + n}, 3 + (unsigned)n, n);
        const cw_normals_desc d = {.inside_is_low = n & 1, .threads = 1 + (int)(n & 1)};
        cw_extract_desc desc = {
            .isovalue = 1.5, .inside_is_low = n & 1, .leave_open = n & 2, .no_normals = true};
        if (n == 4)
            space_unevenly(&v);
        v.has_nodata = n == 5;
        desc.leave_open = desc.leave_open && n != 5;
        cw_mesh mesh = test_extract(&v, &desc, NULL);
        const size_t slice = (size_t)v.stride[2],
                     beside = 17 * mesh.vertex_count + 8 * v.dim[2] + 16;
        for (size_t held = 4; held < 50; held += 3 + held)
            assert_same_normals(&v, &mesh, &d, beside + held * slice);
        disturb_mesh(&mesh);
        assert_same_normals(&v, &mesh, &d, beside + 5 * slice);
        assert_same_normals(&v, &mesh, &d, 0);
        cw_mesh_free(&mesh);
        v.coordinates[0] = v.coordinates[1] = v.coordinates[2] = NULL;
        cw_volume_free(&v);
    }
}

/* A small surface in a tall volume: the slices around it are enough. */
static void slices_far_from_vertices_are_not_read(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){300, 300, 100}, 1, 1);
    ((uint8_t *)cw_volume_voxels(&v))[300 * 300 * 60 + 300 * 50 + 50] = 9;
    cw_mesh mesh =
        test_extract(&v, &(cw_extract_desc){.isovalue = 5, .no_normals = true}, NULL);
    slices s = {.volume = &v};
    cw_error err = {0};
    const cw_slice_source source = source_of(&s);
    assert_ok(cw_extract_stream_normals(&source, NULL, 8 * 300 * 300, &mesh, &err), err);
    assert_true(s.reads < 20);
    assert_same_normals(&v, &mesh, NULL, 8 * 300 * 300);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void limits_and_failures_are_reported(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){40, 40, 60}, 9, 1);
    slices s = {.volume = &v};
    kept_slabs kept = {.stop_at = 2};
    cw_error err = {0};
    const cw_slab_sink sink = {keep_slab, &kept};
    const cw_slice_source source = source_of(&s);
    cw_stream_desc d = {.extract = {.isovalue = 4}};
    assert_int_equal(cw_extract_stream_slabs(&source, &d, 1, sink, NULL, &err),
                     CW_ERR_CANCELLED);
    assert_string_equal(err.message, "enough");
    assert_int_equal(kept.count, 2);
    free_kept(&kept);
    d.extract.snap = 0.3;
    assert_int_equal(cw_extract_stream_slabs(&source, &d, 1, sink, NULL, &err),
                     CW_ERR_UNSUPPORTED);
    d.extract = (cw_extract_desc){.isovalue = 4, .max_triangles = 1000};
    assert_int_equal(cw_extract_stream_slabs(&source, &d, 1, sink, NULL, &err), CW_ERR_LIMIT);
    assert_non_null(strstr(err.message, "max_triangles"));
    d.extract = (cw_extract_desc){.isovalue = 4, .max_bytes = 10000};
    assert_int_equal(cw_extract_stream_slabs(&source, &d, 1, sink, NULL, &err), CW_ERR_LIMIT);
    assert_non_null(strstr(err.message, "slices of 40 x 40 voxels need"));
    d.extract.max_bytes = cw_extract_stream_bytes(&source.shape, &d, true);
    assert_int_equal(cw_extract_stream_slabs(&source, &d, 1 << 19, sink, NULL, &err),
                     CW_ERR_LIMIT);
    assert_non_null(strstr(err.message, "(desc->max_bytes)"));
    assert_int_equal(kept.count, 0);
    s.fail_at = 59;
    d.extract.max_bytes = 0;
    assert_int_equal(cw_extract_stream_slabs(&source, &d, 1, sink, NULL, &err), CW_ERR_IO);
    s.fail_at = 0;
    d.extract.no_normals = true;
    cw_mesh mesh = test_extract(&v, &d.extract, NULL);
    assert_int_equal(cw_extract_stream_normals(&source, NULL, 10000, &mesh, &err),
                     CW_ERR_LIMIT);
    assert_non_null(strstr(err.message, "(max_bytes)"));
    s.fail_at = 59;
    assert_int_equal(cw_extract_stream_normals(&source, NULL, 0, &mesh, &err), CW_ERR_IO);
    assert_null(mesh.normals);
    cw_mesh_free(&mesh);
    free_kept(&kept);
    cw_volume_free(&v);
}

static void a_lack_of_memory_is_reported(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){12, 6, 40}, 3, 1);
    slices s = {.volume = &v};
    kept_slabs kept = {0};
    cw_error err = {0};
    const cw_slice_source source = source_of(&s);
    const cw_stream_desc d = {.extract = {.isovalue = 1, .no_normals = true}, .layers = 3};
    cw_status st = CW_ERR_NO_MEMORY;
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        free_kept(&kept);
        cwi_alloc_fail_after(n);
        st = cw_extract_stream_slabs(&source, &d, 1, (cw_slab_sink){keep_slab, &kept}, NULL,
                                     &err);
        cwi_alloc_fail_after(-1);
    }
    assert_ok(st, err);
    free_kept(&kept);
    cw_mesh mesh = test_extract(&v, &d.extract, NULL);
    st = CW_ERR_NO_MEMORY;
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        assert_null(mesh.normals);
        cwi_alloc_fail_after(n);
        st = cw_extract_stream_normals(&source, NULL, 0, &mesh, &err);
        cwi_alloc_fail_after(-1);
    }
    assert_ok(st, err);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_are_those_of_a_volume_in_memory),
        cmocka_unit_test(open_slabs_around_gaps_are_the_same),
        cmocka_unit_test(a_volume_on_one_side_has_no_slabs),
        cmocka_unit_test(normals_are_those_of_a_volume_in_memory),
        cmocka_unit_test(slices_far_from_vertices_are_not_read),
        cmocka_unit_test(limits_and_failures_are_reported),
        cmocka_unit_test(a_lack_of_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
