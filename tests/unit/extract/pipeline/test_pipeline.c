/* The pipeline: its stages, in their order, are the calls that a user would make one by one. */
#include "support/surface.h"

#include "core/base/status.h"

#include <cubewright/pipeline.h>

#include <math.h>
#include <string.h>

enum { SIDE = 32 };
static const double ISO = 300;

/* A head full of noise: fragments, cavities, and a border. */
static cw_volume make_noisy(void)
{
    cw_volume v;
    cw_error err = {0};
    const cw_field_desc desc = {.field = CW_FIELD_CT_HEAD,
                                .dim = {SIDE, SIDE, SIDE},
                                .type = CW_I16,
                                .noise = 150,
                                .seed = 3};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    return v;
}

static cw_volume make_paint(void)
{
    cw_volume v;
    cw_error err = {0};
    const cw_field_desc desc = {.dim = {SIDE, SIDE, SIDE}, .type = CW_F32};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    return v;
}

static cw_status open_paint(void *user, const cw_volume **volume, cw_error *err)
{
    (void)err;
    *volume = user;
    return CW_OK;
}

/* --- by hand -------------------------------------------------------------------------------- */

static void simplify_by_hand(cw_mesh *mesh, const cw_simplify_desc *desc)
{
    cw_mesh reduced = {0};
    cw_error err = {0};
    assert_ok(cw_simplify(mesh, desc, &reduced, NULL, &err), err);
    cw_mesh_free(mesh);
    *mesh = reduced;
}

/* Does what the settings ask for by one call after the other. */
static cw_mesh make_by_hand(const cw_volume *v, const cw_pipeline_desc *d)
{
    cw_mesh mesh = {0}, cut = {0};
    cw_error err = {0};
    cw_sample_facts sampled;
    assert_ok(cw_extract(v, &d->extract, &mesh, NULL, &err), err);
    if (d->min_volume_mm3 > 0)
        assert_ok(cw_mesh_drop_volumes(&mesh, d->min_volume_mm3, NULL, &err), err);
    if (d->largest)
        assert_ok(cw_mesh_keep_largest(&mesh, d->largest, NULL, &err), err);
    if (d->fill_voids)
        assert_ok(cw_mesh_fill_voids(&mesh, 1, NULL, &err), err);
    if (d->close_handles) {
        assert_ok(cw_mesh_close_handles(&mesh, d->close_handles, &cut, NULL, &err), err);
        cw_mesh_free(&mesh);
        mesh = cut;
    }
    if (d->smooth)
        assert_ok(cw_mesh_smooth(&mesh, d->smooth, NULL, &err), err);
    if (d->cut) {
        assert_ok(cw_mesh_cut(&mesh, d->cut, &cut, NULL, &err), err);
        cw_mesh_free(&mesh);
        mesh = cut;
    }
    if (d->simplify)
        simplify_by_hand(&mesh, d->simplify);
    if (d->simplify && !d->close_handles && !d->smooth && !d->cut)
        assert_ok(cw_extract_normals(v, NULL, &mesh, &err), err);
    if (d->color) {
        assert_ok(cw_mesh_sample(&mesh, d->color->user, NULL, &sampled, &err), err);
        assert_ok(cw_mesh_color(&mesh, d->color->map, sampled.low, sampled.high, &err), err);
    }
    return mesh;
}

static void assert_same_colors(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(!a->colors, !b->colors);
    if (a->colors)
        assert_memory_equal(a->colors, b->colors, 4 * a->vertex_count);
    if (a->scalars)
        assert_memory_equal(a->scalars, b->scalars, a->vertex_count * sizeof *a->scalars);
}

/* The stages of each row are those of the bits, and so is the result. */
static void stages_are_the_calls_one_after_the_other(void **state)
{
    (void)state;
    cw_volume volume = make_noisy(), paint = make_paint();
    const cw_close_handles_desc handles = {.length_mm = 8};
    const cw_smooth_desc smooth = {.method = CW_SMOOTH_HC, .iterations = 4};
    const cw_cut_desc cut = {
        .point = {0, 0, 40}, .normal = {0, 0, 1}, .point_is_percent = true};
    const cw_simplify_desc simplify = {.triangles = 1500};
    const cw_pipeline_color color = {.open = open_paint, .user = &paint};
    for (unsigned bits = 0; bits < 256; bits++) {
        cw_pipeline_desc d = {.extract = {.isovalue = ISO},
                              .min_volume_mm3 = bits & 1 ? 100 : 0,
                              .largest = bits & 2 ? 30 : 0,
                              .fill_voids = bits & 4,
                              .smooth = bits & 8 ? &smooth : NULL,
                              .cut = bits & 16 ? &cut : NULL,
                              .simplify =
                                  bits & 32 && cw_simplify_available() ? &simplify : NULL,
                              .color = bits & 64 ? &color : NULL,
                              .close_handles = bits & 128 ? &handles : NULL};
        const bool by_slabs = d.simplify && !(bits & (31 | 128));
        cw_pipeline_facts facts = {0};
        cw_mesh mesh = {0};
        cw_error err = {0};
        if (by_slabs || (test_is_short() && bits * 37 % 256 >= 48))
            continue;
        cw_mesh expected = make_by_hand(&volume, &d);
        assert_ok(cw_pipeline_mesh(&volume, NULL, &d, &mesh, &facts, &err), err);
        test_assert_same_mesh(&expected, &mesh);
        assert_same_colors(&expected, &mesh);
        assert_int_equal(facts.ran, cw_pipeline_stages(&d));
        assert_int_equal(facts.ran >> CW_STAGE_MIN_VOLUME & 1, bits & 1);
        assert_true(!(bits & 1) || facts.small.dropped > 0);
        assert_true(!(bits & 2) || facts.others.kept > 0);
        assert_true(!(bits & 128) || facts.handles.cut + facts.handles.filled > 0);
        assert_true(!(bits & 8) || facts.smoothed.max_mm > 0);
        assert_true(!(bits & 16) || facts.cut.area_mm2 > 0);
        cw_mesh_free(&expected);
        cw_mesh_free(&mesh);
    }
    cw_volume_free(&volume);
    cw_volume_free(&paint);
}

/* --- slices --------------------------------------------------------------------------------- */

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    const cw_volume *v = user;
    const size_t slice = (size_t)v->stride[2];
    (void)err;
    memcpy(to, (const char *)v->data + first * slice, count * slice);
    return CW_OK;
}

static cw_slice_source source_of(cw_volume *v)
{
    cw_slice_source source = {.shape = *v, .read = read_slices, .user = v};
    source.shape.data = NULL;
    return source;
}

/* Takes a mesh, or counts the triangles of a spool. */
typedef struct taken {
    cw_mesh mesh;
    size_t surfaces, spooled, stop_at;
} taken;

static cw_status take_surface(void *user, cw_pipeline_surface *surface,
                              const cw_pipeline_facts *facts, cw_error *err)
{
    taken *t = user;
    (void)facts;
    assert_int_equal(surface->level, t->surfaces);
    if (++t->surfaces == t->stop_at)
        return cwi_fail(err, CW_ERR_CANCELLED, "enough");
    if (surface->spool)
        t->spooled = cw_mesh_spool_frame(surface->spool)->triangle_count;
    if (!surface->mesh)
        return CW_OK;
    cw_mesh_free(&t->mesh);
    t->mesh = *surface->mesh;
    *surface->mesh = (cw_mesh){0};
    return CW_OK;
}

static void slices_give_the_surface_of_the_volume(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    const cw_slice_source source = source_of(&volume);
    const cw_simplify_desc simplify = {.error_mm = 1};
    for (unsigned bits = 0; bits < 3; bits++) {
        const bool reduces = bits & 2;
        const cw_pipeline_desc d = {.extract = {.isovalue = ISO},
                                    .min_volume_mm3 = bits & 1 ? 100 : 0,
                                    .simplify = reduces ? &simplify : NULL,
                                    .check = true,
                                    .spool_path = test_path("surface")};
        cw_pipeline_facts facts = {0}, whole = {0};
        taken t = {0};
        cw_mesh mesh = {0};
        cw_error err = {0};
        if (reduces && !cw_simplify_available())
            continue;
        assert_ok(cw_pipeline_mesh(&volume, NULL, &d, &mesh, &whole, &err), err);
        assert_ok(cw_pipeline_run_slices(&source, &d, (cw_pipeline_sink){take_surface, &t},
                                         &facts, &err),
                  err);
        assert_int_equal(t.surfaces, 1);
        if (reduces)
            test_assert_same_mesh(&mesh, &t.mesh);
        else
            assert_int_equal(t.spooled, mesh.triangle_count);
        assert_memory_equal(&facts.small, &whole.small, sizeof facts.small);
        assert_int_equal(facts.quality.triangles, whole.quality.triangles);
        assert_int_equal(facts.quality.components, whole.quality.components);
        assert_int_equal(facts.ran, whole.ran);
        cw_mesh_free(&mesh);
        cw_mesh_free(&t.mesh);
    }
    cw_volume_free(&volume);
}

/* --- levels and sinks ----------------------------------------------------------------------- */

static void levels_are_given_away_one_by_one(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    const size_t counts[3] = {4000, 2000, 1500};
    const cw_pipeline_desc d = {.extract = {.isovalue = ISO}, .lod = counts, .lod_count = 3};
    cw_mesh full = {0}, levels[3] = {0};
    taken t = {0};
    cw_error err = {0};
    if (!cw_simplify_available())
        skip();
    const cw_extract_desc bare = {.isovalue = ISO, .no_normals = true};
    assert_ok(cw_extract(&volume, &bare, &full, NULL, &err), err);
    assert_ok(cw_simplify_levels(&full, &(cw_simplify_desc){0}, counts, 3, levels, NULL, &err),
              err);
    assert_ok(cw_extract_normals(&volume, NULL, &levels[2], &err), err);
    assert_ok(
        cw_pipeline_run(&volume, NULL, &d, (cw_pipeline_sink){take_surface, &t}, NULL, &err),
        err);
    assert_int_equal(t.surfaces, 3);
    test_assert_same_mesh(&levels[2], &t.mesh);
    cw_mesh_free(&t.mesh);
    t = (taken){.stop_at = 2};
    assert_fails(
        cw_pipeline_run(&volume, NULL, &d, (cw_pipeline_sink){take_surface, &t}, NULL, &err),
        CW_ERR_CANCELLED, "enough", err);
    assert_int_equal(t.surfaces, 2);
    cw_mesh_free(&t.mesh);
    cw_mesh_free(&full);
    assert_fails(cw_pipeline_mesh(&volume, NULL, &d, &full, NULL, &err), CW_ERR_ARGUMENT,
                 "lod_count is 3", err);
    for (size_t n = 0; n < 3; n++)
        cw_mesh_free(&levels[n]);
    cw_volume_free(&volume);
}

/* Surfaces with a normal map, as a sink receives them. */
typedef struct taken_maps {
    size_t count;
    cw_mesh mesh[2]; /* owned: the levels */
    cw_image map;    /* a copy: that of level 0 */
    bool shared;     /* later levels had the same */
} taken_maps;

static cw_status take_maps(void *user, cw_pipeline_surface *surface,
                           const cw_pipeline_facts *facts, cw_error *err)
{
    taken_maps *t = user;
    const cw_image *map = &surface->maps[CW_MAP_NORMALS];
    assert_non_null(surface->full);
    assert_true(surface->full->triangle_count > surface->mesh->triangle_count);
    assert_int_equal(facts->atlas.size, map->width);
    if (surface->level == 0) {
        assert_true(facts->baked.texels > 0);
        assert_ok(cw_image_alloc(&t->map, map->width, map->height, err), *err);
        memcpy(t->map.pixels, map->pixels, 4 * map->width * map->height);
    } else {
        t->shared = memcmp(t->map.pixels, map->pixels, 4 * map->width * map->height) == 0;
    }
    t->mesh[t->count++] = *surface->mesh;
    *surface->mesh = (cw_mesh){0};
    return CW_OK;
}

/* One square and one map for all levels, made as by hand, of the surface before it was simplified. */
static void levels_share_an_atlas_and_a_map(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    const size_t counts[2] = {1500, 900};
    const cw_atlas_desc atlas = {.size = 256};
    const cw_bake_desc bake = {.reach_mm = 10};
    const cw_close_handles_desc handles = {.length_mm = 8};
    cw_pipeline_desc d = {.extract = {.isovalue = ISO},
                          .largest = 1,
                          .close_handles = &handles,
                          .lod = counts,
                          .lod_count = 2,
                          .atlas = &atlas,
                          .bake = &bake};
    taken_maps t = {0};
    cw_error err = {0};
    cw_pipeline_facts facts = {0};
    if (!cw_simplify_available())
        skip();
    assert_ok(
        cw_pipeline_run(&volume, NULL, &d, (cw_pipeline_sink){take_maps, &t}, &facts, &err),
        err);
    assert_int_equal(t.count, 2);
    assert_true(t.shared);
    cw_pipeline_desc full_desc = d;
    full_desc.lod_count = 0;
    full_desc.atlas = NULL;
    full_desc.bake = NULL;
    cw_mesh full = make_by_hand(&volume, &full_desc), low[2] = {{0}};
    cw_mesh *const list[2] = {&low[0], &low[1]};
    cw_image maps[CW_MAP_COUNT];
    const cw_bake_desc same = {.size = 256, .margin = facts.atlas.margin, .reach_mm = 10};
    assert_ok(cw_simplify_levels(&full, &(cw_simplify_desc){.normal_weight = 0.1f}, counts, 2,
                                 low, NULL, &err),
              err);
    assert_ok(cw_meshes_atlas(list, (double[]){1, 0.5}, 2, &atlas, NULL, &err), err);
    assert_ok(cw_bake_meshes((const cw_mesh *const *)list, 2, &full, &same, maps, NULL, &err),
              err);
    assert_memory_equal(maps[CW_MAP_NORMALS].pixels, t.map.pixels, 4 * 256 * 256);
    for (size_t n = 0; n < 2; n++) {
        test_assert_same_mesh(&low[n], &t.mesh[n]);
        assert_memory_equal(cw_mesh_attribute_find(&low[n], CW_TEXTURE_COORDINATES)->data,
                            cw_mesh_attribute_find(&t.mesh[n], CW_TEXTURE_COORDINATES)->data,
                            low[n].triangle_count * 6 * sizeof(float));
        cw_mesh_free(&low[n]);
        cw_mesh_free(&t.mesh[n]);
    }
    cw_image_free(&t.map);
    cw_image_free(&maps[CW_MAP_NORMALS]);
    cw_mesh_free(&full);
    cw_volume_free(&volume);
}

/* The stages on a mesh are those on the volume that it came from, but for normals of the field. */
static void a_mesh_runs_through_the_same_stages(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    const cw_close_handles_desc handles = {.length_mm = 8};
    const cw_simplify_desc simplify = {.triangles = 1500};
    cw_pipeline_desc d = {.extract = {.isovalue = ISO},
                          .largest = 2,
                          .fill_voids = true,
                          .close_handles = &handles,
                          .simplify = cw_simplify_available() ? &simplify : NULL};
    taken t = {0};
    cw_mesh mesh = {0}, expected = {0}, empty = {0};
    cw_pipeline_facts facts = {0};
    cw_error err = {0};
    assert_ok(cw_extract(&volume, &d.extract, &mesh, NULL, &err), err);
    assert_ok(cw_pipeline_mesh(&volume, NULL, &d, &expected, NULL, &err), err);
    assert_ok(
        cw_pipeline_run_mesh(&mesh, &d, (cw_pipeline_sink){take_surface, &t}, &facts, &err),
        err);
    test_assert_same_mesh(&expected, &t.mesh);
    assert_int_equal(facts.extracted.triangles, mesh.triangle_count);
    cw_mesh_free(&t.mesh);
    t = (taken){0};
    assert_fails(
        cw_pipeline_run_mesh(&empty, &d, (cw_pipeline_sink){take_surface, &t}, NULL, &err),
        CW_ERR_EMPTY, "the mesh has no triangles", err);
    cw_mesh_free(&mesh);
    cw_mesh_free(&expected);
    cw_volume_free(&volume);
}

static void maps_need_an_atlas_and_fewer_triangles(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    const cw_atlas_desc atlas = {0};
    const cw_bake_desc bake = {0};
    cw_pipeline_desc d = {.extract = {.isovalue = ISO}, .atlas = &atlas, .bake = &bake};
    taken_maps t = {0};
    cw_error err = {0};
    cw_mesh mesh = {0};
    assert_fails(
        cw_pipeline_run(&volume, NULL, &d, (cw_pipeline_sink){take_maps, &t}, NULL, &err),
        CW_ERR_ARGUMENT, "maps are those of a surface before simplify or lod", err);
    assert_fails(cw_pipeline_mesh(&volume, NULL, &d, &mesh, NULL, &err), CW_ERR_ARGUMENT,
                 "maps need the sink", err);
    cw_volume_free(&volume);
}

/* The stages that ran, in their order. */
typedef struct watched {
    cw_stage stages[CW_STAGE_COUNT];
    size_t count;
} watched;

static void note_stage(void *user, cw_stage stage, size_t before, size_t after)
{
    watched *w = user;
    (void)before;
    assert_true(after > 0);
    w->stages[w->count++] = stage;
}

static void stages_run_in_the_order_of_the_recipe(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    const cw_smooth_desc smooth = {.iterations = 1};
    watched w = {.count = 0};
    const cw_pipeline_desc d = {.extract = {.isovalue = ISO},
                                .largest = 2,
                                .fill_voids = true,
                                .smooth = &smooth,
                                .check = true,
                                .watch = {.end = note_stage, .user = &w}};
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_pipeline_mesh(&volume, NULL, &d, &mesh, NULL, &err), err);
    assert_int_equal(w.count, 6); /* normals, too */
    for (size_t n = 1; n < w.count; n++)
        assert_true(w.stages[n] > w.stages[n - 1]);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* --- labels --------------------------------------------------------------------------------- */

static bool wants_odd(void *user, size_t layer, uint32_t label)
{
    (void)user;
    (void)layer;
    return label % 2;
}

/* Compares the surfaces of labels with those made by hand. */
typedef struct taken_labels {
    const cw_label_surfaces *expected;
    uint32_t last;
    size_t count;
} taken_labels;

static cw_status compare_label(void *user, cw_pipeline_surface *surface,
                               const cw_pipeline_facts *facts, cw_error *err)
{
    taken_labels *t = user;
    cw_mesh mesh = {0};
    assert_true(surface->label > t->last);
    t->last = surface->label;
    t->count++;
    assert_ok(cw_label_mesh(t->expected, surface->label, &mesh, err), *err);
    assert_ok(cw_mesh_normals(&mesh, err), *err);
    test_assert_same_mesh(&mesh, surface->mesh);
    assert_true(cw_quality_is_closed_manifold(&facts->quality));
    cw_mesh_free(&mesh);
    return CW_OK;
}

static void labels_are_simplified_together_and_given_away_apart(void **state)
{
    (void)state;
    uint8_t voxels[16][16][16];
    for (size_t n = 0; n < sizeof voxels; n++) /* four slabs of four labels, along x */
        (&voxels[0][0][0])[n] = (uint8_t)(1 + n % 16 / 4);
    cw_volume volume = {.data = voxels, .type = CW_U8, .dim = {16, 16, 16}};
    for (int a = 0; a < 3; a++)
        volume.affine[a][a] = 1;
    cw_label_surfaces surfaces, *layers[1] = {&surfaces}, expected;
    const cw_pipeline_labels labels = {.layers = layers, .layer_count = 1, .wants = wants_odd};
    const cw_simplify_desc simplify = {.error_mm = 0.2};
    const cw_label_simplify_desc by_hand = {.error_mm = 0.2};
    const cw_pipeline_desc d = {.simplify = &simplify, .check = true};
    cw_pipeline_facts facts = {0};
    cw_error err = {0};
    assert_ok(cw_extract_labels(&volume, NULL, &surfaces, &err), err);
    const size_t before = surfaces.mesh.triangle_count;
    assert_ok(cw_label_simplify(&surfaces, &by_hand, &expected, &err), err);
    taken_labels t = {.expected = &expected};
    assert_ok(cw_pipeline_run_labels(&labels, &d, (cw_pipeline_sink){compare_label, &t}, &facts,
                                     &err),
              err);
    assert_int_equal(t.count, 2);
    assert_int_equal(facts.extracted.triangles, before);
    assert_true(surfaces.mesh.triangle_count < before);
    const cw_pipeline_desc wrong = {.largest = 1};
    assert_fails(cw_pipeline_run_labels(&labels, &wrong, (cw_pipeline_sink){compare_label, &t},
                                        NULL, &err),
                 CW_ERR_ARGUMENT, "largest is for a single surface", err);
    cw_label_surfaces_free(&surfaces);
    cw_label_surfaces_free(&expected);
}

/* --- rules ---------------------------------------------------------------------------------- */

enum {
    TEXTURE = 1u << CW_STAGE_ATLAS | 1u << CW_STAGE_MAPS,
    CREASES = 1u << CW_STAGE_CREASES,
    TEXT = 1u << CW_STAGE_ENGRAVE
};

/* Stages that a source excludes, by themselves. */
static const struct excluded {
    cw_surface_source source;
    unsigned stages;
} EXCLUDED[CW_SOURCE_COUNT] = {
    {CW_SOURCE_MEMORY, 0},
    {CW_SOURCE_SLICES, 1u << CW_STAGE_VIEWS | 1u << CW_STAGE_LARGEST |
                           1u << CW_STAGE_FILL_VOIDS | 1u << CW_STAGE_HANDLES |
                           1u << CW_STAGE_SMOOTH | 1u << CW_STAGE_CUT | 1u << CW_STAGE_CULL |
                           1u << CW_STAGE_LOD | 1u << CW_STAGE_COLOR | TEXTURE | CREASES |
                           TEXT},
    {CW_SOURCE_PARTS, 1u << CW_STAGE_VIEWS | 1u << CW_STAGE_LARGEST |
                          1u << CW_STAGE_FILL_VOIDS | 1u << CW_STAGE_HANDLES |
                          1u << CW_STAGE_SMOOTH | 1u << CW_STAGE_CUT | 1u << CW_STAGE_CULL |
                          1u << CW_STAGE_LOD | 1u << CW_STAGE_COLOR | 1u << CW_STAGE_SIMPLIFY |
                          TEXTURE | CREASES | TEXT},
    {CW_SOURCE_LABELS, 1u << CW_STAGE_VIEWS | 1u << CW_STAGE_MIN_VOLUME |
                           1u << CW_STAGE_LARGEST | 1u << CW_STAGE_FILL_VOIDS |
                           1u << CW_STAGE_HANDLES | 1u << CW_STAGE_SMOOTH | 1u << CW_STAGE_CUT |
                           1u << CW_STAGE_CULL | 1u << CW_STAGE_COLOR | TEXTURE | TEXT},
    {CW_SOURCE_MESH, 1u << CW_STAGE_VIEWS | 1u << CW_STAGE_CULL},
};

static void sources_exclude_what_they_cannot_give(void **state)
{
    (void)state;
    for (size_t n = 0; n < CW_SOURCE_COUNT; n++)
        for (int s = 0; s < CW_STAGE_COUNT; s++) {
            cw_stage first = CW_STAGE_COUNT, second = CW_STAGE_COUNT;
            cw_error err = {0};
            const bool allowed = !(EXCLUDED[n].stages >> s & 1);
            const cw_status st =
                cw_pipeline_check(EXCLUDED[n].source, 1u << s, &first, &second, &err);
            if ((st == CW_OK) != allowed)
                fail_msg("source %zu, stage %s: %s", n, cw_stage_name((cw_stage)s),
                         err.message);
            if (allowed)
                continue;
            assert_int_equal(first, s);
            assert_int_equal(second, s);
            assert_ptr_equal(strstr(err.message, cw_stage_name((cw_stage)s)), err.message);
        }
}

static void stages_exclude_each_other(void **state)
{
    (void)state;
    static const struct {
        cw_surface_source source;
        cw_stage first, second;
    } rows[] = {
        {CW_SOURCE_MEMORY, CW_STAGE_CULL, CW_STAGE_HANDLES},
        {CW_SOURCE_MEMORY, CW_STAGE_CULL, CW_STAGE_SMOOTH},
        {CW_SOURCE_MEMORY, CW_STAGE_CULL, CW_STAGE_CUT},
        {CW_SOURCE_MEMORY, CW_STAGE_CULL, CW_STAGE_ENGRAVE},
        {CW_SOURCE_MEMORY, CW_STAGE_LOD, CW_STAGE_SIMPLIFY},
        {CW_SOURCE_MEMORY, CW_STAGE_LOD, CW_STAGE_VIEWS},
        {CW_SOURCE_SLICES, CW_STAGE_MIN_VOLUME, CW_STAGE_SIMPLIFY},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_stage first, second;
        cw_error err = {0};
        assert_int_equal(cw_pipeline_check(rows[n].source,
                                           1u << rows[n].first | 1u << rows[n].second, &first,
                                           &second, &err),
                         CW_ERR_ARGUMENT);
        assert_int_equal(first, rows[n].first);
        assert_int_equal(second, rows[n].second);
    }
}

static void reduced_slices_are_in_memory(void **state)
{
    (void)state;
    cw_error err = {0};
    assert_ok(cw_pipeline_check(CW_SOURCE_SLICES, CREASES | 1u << CW_STAGE_SIMPLIFY, NULL, NULL,
                                &err),
              err);
    assert_fails(
        cw_pipeline_check(CW_SOURCE_SLICES, TEXT | 1u << CW_STAGE_SIMPLIFY, NULL, NULL, &err),
        CW_ERR_ARGUMENT, "engrave needs the whole surface in memory", err);
}

static void later_versions_are_refused(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_pipeline_desc d = {.extract = {.isovalue = ISO}, .largest = 1};
    cw_pipeline_facts facts = {.version = 1, .culled = 7};
    assert_fails(cw_pipeline_mesh(&volume, NULL, &d, &mesh, &facts, &err), CW_ERR_ARGUMENT,
                 "facts->version is 1; this library knows up to 0", err);
    assert_int_equal(facts.culled, 7);
    assert_true(cw_pipeline_stages(&d) >> CW_STAGE_LARGEST & 1);
    d.version = 1;
    assert_int_equal(cw_pipeline_stages(&d), 0);
    cw_volume_free(&volume);
}

static void an_empty_surface_tells_the_range(void **state)
{
    (void)state;
    cw_volume volume = make_noisy();
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_pipeline_desc d = {.extract = {.isovalue = 1e6}};
    assert_fails(cw_pipeline_mesh(&volume, NULL, &d, &mesh, NULL, &err), CW_ERR_EMPTY,
                 "no surface at isovalue 1e+06: values are -", err);
    d = (cw_pipeline_desc){.extract = {.isovalue = ISO}, .cull = true};
    assert_fails(cw_pipeline_mesh(&volume, NULL, &d, &mesh, NULL, &err), CW_ERR_ARGUMENT,
                 "cull needs views", err);
    d = (cw_pipeline_desc){.extract = {.isovalue = ISO}, .min_volume_mm3 = 1e9};
    assert_fails(cw_pipeline_mesh(&volume, NULL, &d, &mesh, NULL, &err), CW_ERR_EMPTY,
                 "no component encloses 1e+09 mm3", err);
    cw_volume_free(&volume);
}

/* Voxels without a value may hide a surface: the message counts them. */
static void an_empty_surface_tells_of_missing_values(void **state)
{
    (void)state;
    static const struct {
        double background, nodata, slope, intercept, box;
        bool has_nodata;
        const char *words;
    } rows[] = {
        {0, 0, 1, 0, 100, true,
         "; 992 voxels have no value, since 0 stands for none (desc->nodata = CW_NODATA_NONE"},
        {-3, -3, 2, 1000, 100, true, "; 992 voxels have no value, since 994 stands for none"},
        {NAN, 0, 1, 0, 100, false, "; 992 voxels are NaN or infinite"},
        {NAN, 100, 1, 0, 100, true,
         "no voxel has a finite value; 8 voxels have no value, since 100 stands"},
        {NAN, 100, 1, 0, 100, true, "makes a value of it); 992 voxels are NaN or infinite"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_volume v;
        cw_mesh mesh = {0};
        cw_error err = {0};
        const cw_pipeline_desc d = {.extract = {.isovalue = 50}};
        assert_int_equal(cw_volume_alloc(&v, CW_F32, (const size_t[3]){10, 10, 10}, 1, 1, NULL),
                         CW_OK);
        float *voxels = cw_volume_voxels(&v);
        for (int i = 0; i < 1000; i++) {
            const bool in = i / 100 % 5 == 2 && i / 10 % 10 / 2 == 2 && i % 10 / 2 == 2;
            voxels[i] = (float)(in ? rows[n].box : rows[n].background);
        }
        v.slope = rows[n].slope;
        v.intercept = rows[n].intercept;
        v.has_nodata = rows[n].has_nodata;
        v.nodata = rows[n].nodata;
        assert_fails(cw_pipeline_mesh(&v, NULL, &d, &mesh, NULL, &err), CW_ERR_EMPTY,
                     rows[n].words, err);
        cw_volume_free(&v);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stages_are_the_calls_one_after_the_other),
        cmocka_unit_test_setup_teardown(slices_give_the_surface_of_the_volume, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test(levels_are_given_away_one_by_one),
        cmocka_unit_test(levels_share_an_atlas_and_a_map),
        cmocka_unit_test(a_mesh_runs_through_the_same_stages),
        cmocka_unit_test(maps_need_an_atlas_and_fewer_triangles),
        cmocka_unit_test(stages_run_in_the_order_of_the_recipe),
        cmocka_unit_test(labels_are_simplified_together_and_given_away_apart),
        cmocka_unit_test(sources_exclude_what_they_cannot_give),
        cmocka_unit_test(stages_exclude_each_other),
        cmocka_unit_test(reduced_slices_are_in_memory),
        cmocka_unit_test(later_versions_are_refused),
        cmocka_unit_test(an_empty_surface_tells_the_range),
        cmocka_unit_test(an_empty_surface_tells_of_missing_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
