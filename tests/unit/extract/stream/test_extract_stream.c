/* A surface from slices: the same bytes as from a volume in memory, for any layers and threads. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/stream/extract_stream.h"

#include <cubewright/stream.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A volume in memory, as slices. */
typedef struct slices {
    const cw_volume *volume;
    size_t next, reads, most; /* the slice expected next; slices read; of one call at most */
    size_t fail_at;           /* the slice that cannot be read; 0: none */
    bool is_part;             /* reading begins anywhere */
} slices;

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    slices *s = user;
    const size_t slice = (size_t)s->volume->stride[2];
    assert_true(first == s->next || first == 0 || s->is_part);
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

/* Chunks, put together. */
typedef struct gathered {
    cw_mesh mesh;
    size_t chunks, stop_at;
} gathered;

static cw_status take_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    gathered *g = user;
    cw_mesh *to = &g->mesh;
    const cw_mesh *m = &chunk->mesh;
    if (g->stop_at && ++g->chunks == g->stop_at)
        return cwi_fail(err, CW_ERR_OUTPUT, "full");
    assert_int_equal(chunk->first_vertex, to->vertex_count);
    assert_int_equal(chunk->first_triangle, to->triangle_count);
    const size_t v = to->vertex_count + m->vertex_count,
                 t = to->triangle_count + m->triangle_count;
    to->positions = realloc(to->positions, (3 * v + 1) * sizeof(float));
    memcpy(to->positions + 3 * to->vertex_count, m->positions, 12 * m->vertex_count);
    if (m->normals) {
        to->normals = realloc(to->normals, (3 * v + 1) * sizeof(float));
        memcpy(to->normals + 3 * to->vertex_count, m->normals, 12 * m->vertex_count);
    }
    to->triangles = realloc(to->triangles, (3 * t + 1) * sizeof(uint32_t));
    memcpy(to->triangles + 3 * to->triangle_count, m->triangles, 12 * m->triangle_count);
    to->vertex_count = v;
    to->triangle_count = t;
    memcpy(to->origin, m->origin, sizeof to->origin);
    memcpy(to->affine, m->affine, sizeof to->affine);
    return CW_OK;
}

static void free_gathered(gathered *g)
{
    free(g->mesh.positions);
    free(g->mesh.normals);
    free(g->mesh.triangles);
}

static void assert_streamed(const cw_mesh *whole, const cw_extract_counts *made,
                            const cw_volume *v, const cw_extract_desc *desc, size_t layers,
                            const cwi_engine *engine)
{
    slices s = {.volume = v};
    gathered g = {0};
    cw_extract_counts counts;
    cw_error err = {0};
    const cw_slice_source source = source_of(&s);
    const cw_stream_desc d = {.extract = *desc, .layers = layers};
    assert_ok(cwi_extract_stream_with(engine, &source, &d, (cw_chunk_sink){take_chunk, &g},
                                      &counts, &err),
              err);
    assert_int_equal(counts.vertices, whole->vertex_count);
    assert_int_equal(counts.triangles, whole->triangle_count);
    assert_int_equal(counts.border_loops, made->border_loops);
    assert_int_equal(g.mesh.vertex_count, whole->vertex_count);
    assert_int_equal(g.mesh.triangle_count, whole->triangle_count);
    if (whole->triangle_count) {
        assert_memory_equal(g.mesh.triangles, whole->triangles, 12 * whole->triangle_count);
        assert_memory_equal(g.mesh.positions, whole->positions, 12 * whole->vertex_count);
        assert_int_equal(g.mesh.normals != NULL, whole->normals != NULL);
        if (whole->normals)
            assert_memory_equal(g.mesh.normals, whole->normals, 12 * whole->vertex_count);
        assert_memory_equal(g.mesh.origin, whole->origin, sizeof whole->origin);
        assert_memory_equal(g.mesh.affine, whole->affine, sizeof whole->affine);
    }
    free_gathered(&g);
}

/* Parts, put together by their numbers, are the whole. */
static void assert_parts(const cw_mesh *whole, const cw_volume *v, const cw_extract_desc *desc,
                         size_t parts)
{
    const cw_stream_desc d = {.extract = *desc, .layers = 3};
    gathered all = {0};
    bool in = false, out = false;
    for (size_t part = 0; part < parts; part++) {
        slices s = {.volume = v, .is_part = true};
        gathered g = {0};
        cw_part_counts counts;
        cw_error err = {0};
        const cw_slice_source source = source_of(&s);
        assert_ok(cw_extract_stream_part(&source, &d, part, parts,
                                         (cw_chunk_sink){take_chunk, &g}, &counts, &err),
                  err);
        assert_int_equal(counts.vertices, g.mesh.vertex_count);
        assert_int_equal(counts.triangles, g.mesh.triangle_count);
        cw_mesh_chunk chunk = {.mesh = g.mesh,
                               .first_vertex = all.mesh.vertex_count,
                               .first_triangle = all.mesh.triangle_count};
        for (size_t n = 0; n < 3 * g.mesh.triangle_count; n++)
            g.mesh.triangles[n] += (uint32_t)all.mesh.vertex_count;
        if (counts.vertices || counts.triangles)
            assert_ok(take_chunk(&all, &chunk, &err), err);
        in = in || counts.has_inside;
        out = out || counts.has_outside;
        free_gathered(&g);
    }
    assert_int_equal(in && out, whole->triangle_count > 0);
    if (in && out) {
        assert_int_equal(all.mesh.vertex_count, whole->vertex_count);
        assert_int_equal(all.mesh.triangle_count, whole->triangle_count);
        assert_memory_equal(all.mesh.triangles, whole->triangles, 12 * whole->triangle_count);
        assert_memory_equal(all.mesh.positions, whole->positions, 12 * whole->vertex_count);
        if (whole->normals)
            assert_memory_equal(all.mesh.normals, whole->normals, 12 * whole->vertex_count);
    }
    free_gathered(&all);
}

/* For all of these numbers of layers, and for one and two threads. */
static void assert_same_for_layers(const cw_volume *v, const cw_extract_desc *desc)
{
    static const size_t layers[] = {1, 2, 3, 7, 16, 64, 0};
    cw_extract_desc d = *desc;
    d.threads = 1;
    cw_extract_counts made;
    cw_mesh whole = test_extract(v, &d, &made);
    for (size_t n = 0; n < sizeof layers / sizeof *layers; n++) {
        d.threads = 1 + (int)(n & 1);
        assert_streamed(&whole, &made, v, &d, layers[n], cwi_engine_best());
    }
    if (v->dim[2] > 2)
        for (size_t parts = 2; parts < 2 * v->dim[2]; parts = 2 * parts + 1)
            assert_parts(&whole, v, &d, parts);
    cw_mesh_free(&whole);
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
        void *to = (char *)cw_volume_voxels(&v) + i * cw_type_size(type);
        switch (type) {
        case CW_U8:
            *(uint8_t *)to = (uint8_t)x;
            break;
        case CW_I16:
            *(int16_t *)to = (int16_t)x;
            break;
        case CW_F32:
            *(float *)to = (float)x;
            break;
        default:
            *(double *)to = x;
            break;
        }
    }
    const double affine[3][4] = {{0.5, 0.1, 0, 3}, {-0.1, 0.7, 0, -20}, {0, 0.2, 1.5, 100}};
    memcpy(v.affine, affine, sizeof affine);
    return v;
}

static void noise_is_the_same_from_slices(void **state)
{
    (void)state;
    static const cw_type types[] = {CW_U8, CW_I16, CW_F32, CW_F64};
    for (int n = 0; n < 4; n += test_is_short() ? 2 : 1) {
        cw_volume v = make_noise(types[n], (const size_t[3]){37, 19, 23 + (size_t)n}, 5,
                                 11 + (uint64_t)n);
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 2});
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 2.3, .inside_is_low = true});
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 2, .leave_open = true});
        assert_same_for_layers(&v,
                               &(cw_extract_desc){.isovalue = 1.5, .simple_topology = true});
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3, .cubic_placement = true});
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 2.5, .no_normals = true});
        v.slope = -2;
        v.intercept = 1;
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = -3});
        cw_volume_free(&v);
    }
}

/* Two values: most gradients that vanish are those of thin parts, whose normals come from
 * triangles of several slabs. */
static void vanishing_gradients_are_repaired_across_slabs(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (test_is_short() ? 3 : 8); seed++) {
        cw_volume v = make_noise(CW_U8, (const size_t[3]){70, 9, 13}, 2, seed);
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 0.5});
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 1, .leave_open = true});
        assert_same_for_layers(&v,
                               &(cw_extract_desc){.isovalue = 0.4, .cubic_placement = true});
        cw_volume_free(&v);
    }
}

static void voxels_without_a_value_are_the_same(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_F32, (const size_t[3]){33, 15, 21}, 7, 5);
    v.has_nodata = true;
    v.nodata = 100; /* no voxel has it */
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3});
    v.nodata = 6;
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3});
    v.has_nodata = false;
    float *voxels = cw_volume_voxels(&v);
    for (size_t i = 0; i < 33 * 15 * 21; i += 97)
        voxels[i] = i % 2 ? NAN : INFINITY;
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3});
    cw_volume_free(&v);
}

/* Where some cells at the border share an edge alone, they are dropped: sweep by sweep. */
static void open_surfaces_around_gaps_are_the_same(void **state)
{
    (void)state;
    static const size_t every[] = {2, 3, 5, 7, 12, 19, 50};
    for (size_t n = 0; n < sizeof every / sizeof *every; n += test_is_short() ? 3 : 1) {
        cw_volume v = make_noise(CW_F32, (const size_t[3]){67, 15, 26}, 6, 30 + n);
        cw_volume gaps = make_noise(CW_F32, v.dim, (unsigned)every[n], 60 + n);
        float *voxels = cw_volume_voxels(&v);
        const float *at = gaps.data;
        for (size_t i = 0; i < 67 * 15 * 26; i++)
            voxels[i] = at[i] == 0 ? NAN : voxels[i];
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 2, .leave_open = true});
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 2.5,
                                                      .leave_open = true,
                                                      .cubic_placement = true,
                                                      .inside_is_low = true});
        v.has_nodata = true;
        v.nodata = 1;
        assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3, .leave_open = true});
        cw_volume_free(&gaps);
        cw_volume_free(&v);
    }
}

/* A window with too few sweeps notices that its cells are not settled. */
static void cells_that_are_not_settled_are_reported(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_F32, (const size_t[3]){67, 15, 26}, 6, 30);
    for (size_t i = 0; i < 67 * 15 * 26; i++)
        if (((float *)cw_volume_voxels(&v))[i] == 5)
            ((float *)cw_volume_voxels(&v))[i] = NAN;
    slices s = {.volume = &v};
    const cw_slice_source source = source_of(&s);
    for (size_t sweeps = 1; sweeps <= CWI_SWEEPS; sweeps += CWI_SWEEPS - 1) {
        cwi_slice_window w = {.sweeps = sweeps};
        cw_error err = {0};
        const cw_extract_desc d = {.isovalue = 2, .leave_open = true};
        assert_ok(cwi_volume_resolve_shape(&source.shape, &w.whole, &err), err);
        assert_ok(cwi_slice_window_init(&w, cwi_engine_best(), &source, &d, 26, &err), err);
        cwi_slice_window_start(&w, 0);
        const cw_status st = cwi_slice_window_move(&w, 0, 26, &err);
        assert_int_equal(st, sweeps == 1 ? CW_ERR_UNSUPPORTED : CW_OK);
        if (st != CW_OK)
            assert_non_null(strstr(err.message, "voxels without a value"));
        cwi_slice_window_free(&w);
    }
    cw_volume_free(&v);
}

/* Inside from the first slice on: only the rest tells if there is a surface. */
static void a_volume_inside_at_first_is_looked_through(void **state)
{
    (void)state;
    const size_t dim[3] = {12, 10, 90};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_U8, dim, 1, 1, &err), err);
    uint8_t *voxels = cw_volume_voxels(&v);
    memset(voxels, 9, 12 * 10 * 90);
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 5});
    voxels[12 * 10 * 80 + 50] = 1;
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 5});
    memset(voxels, 0, 12 * 10 * 90);
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 5});
    voxels[12 * 10 * 89] = 7;
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 5});
    cw_volume_free(&v);
}

/* Layers with more bytes than a chunk are cut between rows, with every engine. */
static void large_layers_are_cut_between_rows(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){500, 430, 5}, 200, 3);
    const cw_extract_desc d = {.isovalue = 90};
    cw_extract_counts made;
    cw_mesh whole = test_extract(&v, &d, &made);
    assert_true(12 * whole.triangle_count > 5 * (4 << 20));
    const cwi_engine *engine;
    for (size_t n = 0; (engine = cwi_engine_at(n)); n += test_is_short() ? 3 : 1)
        assert_streamed(&whole, &made, &v, &d, 1 + 4 * (n % 2), engine);
    cw_mesh_free(&whole);
    cw_volume_free(&v);
}

static void thin_volumes_are_the_same(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_I16, (const size_t[3]){5, 4, 2}, 6, 9);
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3});
    cw_volume_free(&v);
}

/* With normals, and without. */
static void assert_same_on_grid(cw_volume *v, const double *const coordinates[3])
{
    memcpy(v->coordinates, coordinates, sizeof v->coordinates);
    assert_same_for_layers(v, &(cw_extract_desc){.isovalue = 3, .no_normals = true});
    assert_same_for_layers(v, &(cw_extract_desc){.isovalue = 3});
    assert_same_for_layers(v, &(cw_extract_desc){.isovalue = 2.2, .inside_is_low = true});
    memset(v->coordinates, 0, sizeof v->coordinates);
}

static void rectilinear_grids_are_the_same(void **state)
{
    (void)state;
    static const double x[] = {0, 1, 3, 4, 9}, y[] = {-3, 0, 2, 2.5}, z[] = {0, 2, 3, 7, 8, 20};
    cw_volume v = make_noise(CW_I16, (const size_t[3]){5, 4, 6}, 6, 10);
    assert_same_on_grid(&v, (const double *const[3]){x, y, z});
    assert_same_on_grid(&v, (const double *const[3]){NULL, NULL, NULL});
    cw_volume_free(&v);
    /* also voxels without a value, and surfaces that are open */
    double uneven[3][24];
    for (size_t n = 0; n < 72; n++)
        uneven[n / 24][n % 24] = (double)(n % 24) + 0.3 * sin(2.0 * (double)n);
    const double *const axes[3] = {uneven[0], uneven[1], uneven[2]};
    v = make_noise(CW_F32, (const size_t[3]){23, 17, 24}, 7, 12);
    memcpy(v.coordinates, axes, sizeof v.coordinates);
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3, .leave_open = true});
    memset(v.coordinates, 0, sizeof v.coordinates);
    for (size_t i = 0; i < 23 * 17 * 24; i += 97)
        ((float *)cw_volume_voxels(&v))[i] = NAN;
    assert_same_on_grid(&v, axes);
    memcpy(v.coordinates, axes, sizeof v.coordinates);
    assert_same_for_layers(&v, &(cw_extract_desc){.isovalue = 3, .leave_open = true});
    memset(v.coordinates, 0, sizeof v.coordinates);
    cw_volume_free(&v);
}

/* Slices so close that a float does not tell them apart: normals come from slices farther away. */
static void slices_closer_than_positions_tell_are_the_same(void **state)
{
    (void)state;
    double x[9], y[8], z[40];
    cw_volume v = make_noise(CW_U8, (const size_t[3]){9, 8, 40}, 6, 13);
    for (size_t n = 0; n < 40; n++) {
        z[n] = n ? z[n - 1] + (n % 10 < 6 ? 3e-7 : 5) : -40;
        x[n % 9] = (double)(n % 9);
        y[n % 8] = 2 * (double)(n % 8);
    }
    assert_same_on_grid(&v, (const double *const[3]){x, y, z});
    v.affine[0][3] = 1e9;
    assert_same_on_grid(&v, (const double *const[3]){x, y, z});
    cw_volume_free(&v);
}

/* Each slice is read once, and no more of them are in memory than the layers need. */
static void slices_are_read_once(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){20, 20, 100}, 9, 1);
    slices s = {.volume = &v};
    gathered g = {0};
    cw_error err = {0};
    const cw_slice_source source = source_of(&s);
    const cw_stream_desc d = {.extract = {.isovalue = 4}, .layers = 5};
    assert_ok(cw_extract_stream(&source, &d, (cw_chunk_sink){take_chunk, &g}, NULL, &err), err);
    assert_int_equal(s.reads, 100);
    assert_true(s.most <= 8);
    free_gathered(&g);
    cw_volume_free(&v);
}

/* 20 slices, of which some are read at a time, of numbers that are no data, and not finite. */
static cw_volume make_slices(cw_type type)
{
    cw_volume v;
    cw_error err = {0};
    const size_t dim[3] = {601, 593, 20};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    v.slope = -2.02;
    v.intercept = 7;
    v.has_nodata = true;
    v.nodata = 3;
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const int x = rand() % 100;
        if (type == CW_F32)
            ((float *)v.data)[n] = x == 5 ? NAN : x == 6 ? INFINITY : 0.37f * (float)x;
        else if (type == CW_I16)
            ((int16_t *)v.data)[n] = (int16_t)(x * x - 1000);
        else
            ((uint32_t *)v.data)[n] = (uint32_t)(x * x);
    }
    return v;
}

static void statistics_are_those_of_the_volume(void **state)
{
    (void)state;
    const cw_type types[] = {CW_F32, CW_I16, CW_U32};
    const size_t bins[] = {0, 1, 512};
    for (size_t t = 0; t < 3; t++)
        for (size_t b = 0; b < 3; b++) {
            cw_volume v = make_slices(types[t]);
            slices s = {.volume = &v};
            const cw_slice_source source = source_of(&s);
            cw_statistics whole, parts;
            cw_error err = {0};
            assert_ok(cw_volume_statistics(&v, bins[b], 1, &whole, &err), err);
            assert_ok(cw_stream_statistics(&source, bins[b], 2, &parts, &err), err);
            assert_true(s.most < v.dim[2]);
            assert_true(whole.min == parts.min && whole.max == parts.max);
            assert_true(whole.finite == parts.finite && whole.nodata == parts.nodata);
            assert_true(whole.not_finite == parts.not_finite);
            assert_true(whole.quantum == parts.quantum);
            assert_true(whole.bin_width == parts.bin_width || bins[b] == 0);
            assert_int_equal(whole.bin_count, parts.bin_count);
            assert_true(!whole.bins == !parts.bins);
            if (whole.bins)
                assert_memory_equal(whole.bins, parts.bins,
                                    whole.bin_count * sizeof *whole.bins);
            cw_statistics_free(&whole);
            cw_statistics_free(&parts);
            cw_volume_free(&v);
        }
}

static void statistics_fail_as_their_source(void **state)
{
    (void)state;
    cw_volume v = make_slices(CW_I16);
    slices s = {.volume = &v, .fail_at = 12};
    cw_slice_source source = source_of(&s);
    cw_statistics statistics;
    cw_error err = {0};
    assert_int_equal(cw_stream_statistics(&source, 9, 1, &statistics, &err), CW_ERR_IO);
    assert_null(statistics.bins);
    source.shape.stride[2] = 0;
    assert_int_equal(cw_stream_statistics(&source, 9, 1, &statistics, &err), CW_ERR_ARGUMENT);
    assert_int_equal(cw_stream_statistics(NULL, 9, 1, &statistics, &err), CW_ERR_ARGUMENT);
    cw_volume_free(&v);
}

static void limits_and_failures_are_reported(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){40, 40, 40}, 9, 1);
    slices s = {.volume = &v};
    gathered g = {0};
    cw_error err = {0};
    const cw_chunk_sink sink = {take_chunk, &g};
    cw_slice_source source = source_of(&s);
    cw_stream_desc d = {.extract = {.isovalue = 4, .max_bytes = 10000}};
    assert_int_equal(cw_extract_stream(&source, &d, sink, NULL, &err), CW_ERR_LIMIT);
    assert_non_null(strstr(err.message, "slices of 40 x 40 voxels need"));
    assert_int_equal(g.mesh.vertex_count, 0);
    d.extract.max_bytes = cw_extract_stream_bytes(&source.shape, &d, true);
    assert_true(d.extract.max_bytes < (5 << 20));
    assert_ok(cw_extract_stream(&source, &d, sink, NULL, &err), err);
    d.extract = (cw_extract_desc){.isovalue = 4, .max_triangles = 1000};
    assert_int_equal(cw_extract_stream(&source, &d, sink, NULL, &err), CW_ERR_LIMIT);
    d.extract = (cw_extract_desc){.isovalue = 4, .snap = 0.3};
    assert_int_equal(cw_extract_stream(&source, &d, sink, NULL, &err), CW_ERR_UNSUPPORTED);
    d.extract = (cw_extract_desc){.isovalue = NAN};
    assert_int_equal(cw_extract_stream(&source, &d, sink, NULL, &err), CW_ERR_ARGUMENT);
    free_gathered(&g);
    g = (gathered){.stop_at = 1};
    d.extract = (cw_extract_desc){.isovalue = 4};
    assert_int_equal(cw_extract_stream(&source, &d, sink, NULL, &err), CW_ERR_OUTPUT);
    g.stop_at = 0;
    s.fail_at = 39;
    assert_int_equal(cw_extract_stream(&source, &d, sink, NULL, &err), CW_ERR_IO);
    free_gathered(&g);
    cw_volume_free(&v);
}

static void a_lack_of_memory_is_reported(void **state)
{
    (void)state;
    cw_volume v = make_noise(CW_U8, (const size_t[3]){12, 6, 9}, 3, 1);
    slices s = {.volume = &v};
    gathered g = {0};
    cw_error err = {0};
    const cw_chunk_sink sink = {take_chunk, &g};
    for (int open = 0; open < 2; open++) {
        const cw_stream_desc d = {.extract = {.isovalue = 1, .leave_open = open}, .layers = 3};
        cw_status st = CW_ERR_NO_MEMORY;
        v.has_nodata = open; /* two windows, one after the other */
        for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
            const cw_slice_source source = source_of(&s);
            g = (gathered){0};
            cwi_alloc_fail_after(n);
            st = cw_extract_stream(&source, &d, sink, NULL, &err);
            cwi_alloc_fail_after(-1);
            free_gathered(&g);
        }
        assert_ok(st, err);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_the_same_from_slices),
        cmocka_unit_test(vanishing_gradients_are_repaired_across_slabs),
        cmocka_unit_test(voxels_without_a_value_are_the_same),
        cmocka_unit_test(open_surfaces_around_gaps_are_the_same),
        cmocka_unit_test(cells_that_are_not_settled_are_reported),
        cmocka_unit_test(a_volume_inside_at_first_is_looked_through),
        cmocka_unit_test(large_layers_are_cut_between_rows),
        cmocka_unit_test(thin_volumes_are_the_same),
        cmocka_unit_test(rectilinear_grids_are_the_same),
        cmocka_unit_test(slices_closer_than_positions_tell_are_the_same),
        cmocka_unit_test(slices_are_read_once),
        cmocka_unit_test(statistics_are_those_of_the_volume),
        cmocka_unit_test(statistics_fail_as_their_source),
        cmocka_unit_test(limits_and_failures_are_reported),
        cmocka_unit_test(a_lack_of_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
