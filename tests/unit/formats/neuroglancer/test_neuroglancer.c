/* Tests meshes of Neuroglancer: read back by the format's document, their levels are closed and
 * where the surfaces were. */
#include "support/files/mesh_folder.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_LABELS = 16, MOST_LEVELS = 3 };

/* The segments of a label map, with their levels of detail. */
typedef struct label_levels {
    size_t label_count, level_count;
    char names[MOST_LABELS][16];
    cw_label labels[MOST_LABELS];
    cw_mesh meshes[MOST_LABELS * MOST_LEVELS]; /* levels of a label follow each other */
    cw_part parts[MOST_LABELS * MOST_LEVELS];
} label_levels;

static label_levels *make_levels(const cw_volume *volume, const cw_labels_desc *desc,
                                 size_t level_count)
{
    cw_error err = {0};
    cw_label_surfaces surfaces;
    label_levels *l = calloc(1, sizeof *l);
    assert_ok(cw_extract_labels(volume, desc, &surfaces, &err), err);
    assert_true(surfaces.label_count <= MOST_LABELS);
    l->label_count = surfaces.label_count;
    l->level_count = level_count;
    for (size_t level = 0; level < level_count; level++) {
        const cw_label_simplify_desc simplify = {.ratio = 0.3};
        cw_label_surfaces coarser;
        if (level > 0) {
            assert_ok(cw_label_simplify(&surfaces, &simplify, &coarser, &err), err);
            cw_label_surfaces_free(&surfaces);
            surfaces = coarser;
        }
        for (size_t n = 0; n < l->label_count; n++) {
            const size_t i = n * level_count + level;
            l->labels[n].value = surfaces.labels[n].label;
            snprintf(l->names[n], sizeof l->names[n], "part \"%zu\"", n);
            assert_ok(cw_label_mesh(&surfaces, l->labels[n].value, &l->meshes[i], &err), err);
            l->parts[i] = (cw_part){.mesh = &l->meshes[i],
                                    .name = l->names[n],
                                    .label = &l->labels[n],
                                    .level = level};
        }
    }
    cw_label_surfaces_free(&surfaces);
    return l;
}

static void free_levels(label_levels *l)
{
    for (size_t i = 0; i < l->label_count * l->level_count; i++)
        cw_mesh_free(&l->meshes[i]);
    free(l);
}

static cw_status write_folder(const char *name, const cw_part *parts, size_t count,
                              cw_write_desc desc, cw_error *err)
{
    desc.format = "neuroglancer";
    return cw_parts_write(test_path(name), parts, count, &desc, err);
}

/* How far the vertices of each are from the other at most: those of the joined one include the
 * cuts. */
static double distance_between(const cw_mesh *a, const cw_mesh *b)
{
    double most = 0;
    cw_error err = {0};
    const cw_mesh_distance_desc desc = {.vertices_only = true};
    for (int way = 0; way < 2; way++) {
        cw_distance d;
        assert_ok(cw_distance_to_mesh(way ? a : b, way ? b : a, &desc, &d, NULL, &err), err);
        most = fmax(most, d.max_mm);
    }
    return most;
}

/* Holds a level of a segment to the mesh that it was. rough: it has wedges thinner than a step,
 * whose sides rounding may join. */
static void check_level(const folder_segment *s, size_t level, const cw_mesh *was,
                        double error_mm, bool rough)
{
    const double step_mm = ldexp((double)s->shape[0] / ((1 << s->bits) - 1), (int)level),
                 bound_mm = 3 * step_mm;
    cw_mesh joined = test_segment_join(s, level);
    const cw_quality before = test_measure(was), after = test_measure(&joined);
    assert_int_equal(after.open_edges, before.open_edges);
    assert_int_equal(after.misoriented_edges, before.misoriented_edges);
    assert_true(rough || after.euler == before.euler);
    assert_true(rough || after.components == before.components);
    if (!before.open_edges)
        assert_near(after.volume_mm3, before.volume_mm3, bound_mm * before.area_mm2);
    const double apart_mm = distance_between(&joined, was);
    assert_true(apart_mm <= bound_mm * 1.001);
    if (level == 0)
        assert_true(apart_mm <= error_mm * 1.001);
    cw_mesh_free(&joined);
}

static void check_labels(const label_levels *l, cw_write_desc desc, bool rough)
{
    cw_error err = {0};
    cw_compressed told = {0};
    desc.compressed = &told;
    assert_ok(write_folder("mesh", l->parts, l->label_count * l->level_count, desc, &err), err);
    size_t fragments = 0;
    assert_int_equal(told.bits, desc.bits ? desc.bits : 16);
    if (desc.tolerance_mm > 0)
        assert_true(told.error_mm <= desc.tolerance_mm);
    for (size_t n = 0; n < l->label_count; n++) {
        char id[16];
        snprintf(id, sizeof id, "%u", l->labels[n].value);
        folder_segment s = test_segment_read(test_path("mesh"), id);
        assert_int_equal(s.level_count, l->level_count);
        assert_near((double)s.shape[0] / ((1 << s.bits) - 1), told.step_mm, 0);
        for (size_t level = 0; level < l->level_count; level++) {
            check_level(&s, level, &l->meshes[n * l->level_count + level], told.error_mm,
                        rough);
            for (uint32_t f = 0; f < s.levels[level].count; f++)
                fragments += s.levels[level].fragments[f].size > 0;
        }
        test_segment_free(&s);
    }
    assert_int_equal(fragments, told.fragments);
}

static void levels_of_labels_are_closed_and_in_place(void **state)
{
    (void)state;
    cw_volume volume;
    cw_error err = {0};
    if (!cwi_module_present("draco"))
        skip();
    const cw_label_field_desc field = {.dim = {16, 18, 20}, .type = CW_U8, .labels = 8};
    assert_ok(cw_label_field_sample(&field, &volume, &err), err);
    for (size_t levels = 1; levels <= MOST_LEVELS; levels += test_is_short() ? 2 : 1) {
        label_levels *l = make_levels(&volume, NULL, levels);
        check_labels(l, (cw_write_desc){0}, false);
        check_labels(l, (cw_write_desc){.bits = 10}, false);
        check_labels(l, (cw_write_desc){.tolerance_mm = 1e-3}, false);
        check_labels(l, (cw_write_desc){.bits = 10, .tolerance_mm = 4e-3}, false);
        free_levels(l);
    }
    cw_volume_free(&volume);
}

/* Voxels of noise: surfaces that touch, and labels in many components. */
static void random_label_maps_stay_closed(void **state)
{
    (void)state;
    if (!cwi_module_present("draco"))
        skip();
    srand(test_seed(31));
    for (int round = 0; round < test_some(24); round++) {
        enum { EDGE = 7 };
        uint8_t voxels[EDGE * EDGE * EDGE];
        for (size_t i = 0; i < sizeof voxels; i++)
            voxels[i] = (uint8_t)(rand() % 5 * (rand() % 3 > 0));
        cw_volume volume = {.dim = {EDGE, EDGE, EDGE},
                            .components = 1,
                            .steps = 1,
                            .type = CW_U8,
                            .data = voxels,
                            .affine = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
        if (round % 4 == 3)
            test_turn(&volume, round);
        label_levels *l = make_levels(&volume, &(cw_labels_desc){.no_smoothing = round % 2},
                                      1 + (size_t)round % 2);
        check_labels(l, (cw_write_desc){.bits = round % 3 ? 16 : 10},
                     l->level_count > 1 || round % 4 == 3);
        free_levels(l);
    }
}

/* A gyroid of any size, anywhere. */
static void units_and_places_do_not_matter(void **state)
{
    (void)state;
    static const struct {
        double scale, shift; /* mm */
    } rows[] = {{1e-4, 0}, {1e-4, 3}, {1, 123456.789}, {1e4, -5e6}, {1, 0}};
    if (!cwi_module_present("draco"))
        skip();
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r += test_is_short() ? 2 : 1) {
        cw_error err = {0};
        cw_compressed told = {0};
        cw_volume v = test_sample(CW_FIELD_GYROID, 16, CW_F32);
        for (int a = 0; a < 3; a++) {
            for (int c = 0; c < 4; c++)
                v.affine[a][c] *= rows[r].scale;
            v.affine[a][3] += rows[r].shift * (a + 1);
        }
        cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 0}, NULL);
        for (int fine = 0; fine < 2; fine++) {
            const double tolerance_mm = fine ? 2e-4 * rows[r].scale : 0;
            assert_ok(
                write_folder("mesh", &(cw_part){.mesh = &mesh}, 1,
                             (cw_write_desc){.compressed = &told, .tolerance_mm = tolerance_mm},
                             &err),
                err);
            folder_segment s = test_segment_read(test_path("mesh"), "1");
            assert_int_equal(s.level_count, 1);
            assert_true(!fine == (s.levels[0].count <= 8));
            /* the joined mesh has positions of single precision near the origin */
            check_level(&s, 0, &mesh, told.error_mm + 1e-6 * rows[r].scale, false);
            test_segment_free(&s);
        }
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* Twelve triangles, each cut in thousands; faces lie in planes of the octree. */
static void large_triangles_are_cut_and_close_again(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh cube;
    cw_compressed told = {0};
    if (!cwi_module_present("draco"))
        skip();
    test_make_cube(&cube);
    assert_ok(
        write_folder(
            "mesh", &(cw_part){.mesh = &cube}, 1,
            (cw_write_desc){.bits = 10, .tolerance_mm = 3.01 / 1024 / 16, .compressed = &told},
            &err),
        err);
    folder_segment s = test_segment_read(test_path("mesh"), "1");
    assert_true(s.levels[0].count > 1000);
    cw_mesh joined = test_segment_join(&s, 0);
    const cw_quality q = test_measure(&joined);
    assert_int_equal(q.open_edges + q.misoriented_edges, 0);
    assert_int_equal(q.euler, 2);
    assert_near(q.volume_mm3, test_measure(&cube).volume_mm3, 6 * told.error_mm);
    cw_mesh_free(&joined);
    test_segment_free(&s);
    cw_mesh_free(&cube);
}

/* Both sides of a square share their corners; neither cancels the other. */
static void two_sided_sheets_stay(void **state)
{
    (void)state;
    float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    uint32_t triangles[] = {0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0};
    cw_error err = {0};
    const cw_mesh sheet = {
        .vertex_count = 4, .triangle_count = 4, .positions = positions, .triangles = triangles};
    if (!cwi_module_present("draco"))
        skip();
    assert_ok(write_folder("mesh", &(cw_part){.mesh = &sheet}, 1, (cw_write_desc){0}, &err),
              err);
    folder_segment s = test_segment_read(test_path("mesh"), "1");
    cw_mesh joined = test_segment_join(&s, 0);
    assert_near(test_measure(&joined).area_mm2, 2, 1e-3);
    cw_mesh_free(&joined);
    test_segment_free(&s);
}

static char *read_all(const char *name)
{
    size_t size;
    return test_file_read(test_path(name), &size);
}

static void assert_text(const char *text, const char *words)
{
    if (!strstr(text, words))
        fail_msg("no %s in\n%s", words, text);
}

/* Two labels: a cube and a tetrahedron. */
typedef struct label_pair {
    cw_mesh cube, tetrahedron;
    cw_label labels[2];
    cw_part parts[2];
} label_pair;

static void make_pair(label_pair *p)
{
    *p = (label_pair){.labels = {{.value = 17}, {.value = 4000000000u}}};
    test_make_cube(&p->cube);
    test_make_tetrahedron(&p->tetrahedron);
    p->tetrahedron.origin[0] = 5;
    p->parts[0] = (cw_part){.mesh = &p->cube, .name = "left \"lobe\"", .label = p->labels};
    p->parts[1] = (cw_part){.mesh = &p->tetrahedron, .name = "rest", .label = p->labels + 1};
}

static void free_pair(label_pair *p)
{
    cw_mesh_free(&p->cube);
    cw_mesh_free(&p->tetrahedron);
}

static void properties_name_and_measure_segments(void **state)
{
    (void)state;
    label_pair p;
    cw_error err = {0};
    if (!cwi_module_present("draco"))
        skip();
    make_pair(&p);
    assert_ok(write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err), err);
    char *text = read_all("mesh/segment_properties/info");
    assert_text(text, "\"@type\": \"neuroglancer_segment_properties\"");
    assert_text(text, "\"ids\": [\"17\", \"4000000000\"]");
    assert_text(text, "\"values\": [\"left \\\"lobe\\\"\", \"rest\"]");
    assert_text(text,
                "{\"id\": \"triangles\", \"type\": \"number\", \"data_type\": \"uint32\", "
                "\"values\": [12, 4]}");
    char volumes[128];
    snprintf(volumes, sizeof volumes,
             "\"volume_mm3\", \"type\": \"number\", \"data_type\": "
             "\"float32\", \"values\": [%.9g, %.9g]",
             test_measure(&p.cube).volume_mm3, test_measure(&p.tetrahedron).volume_mm3);
    assert_text(text, volumes);
    free(text);
    text = read_all("mesh/info");
    assert_text(text, "\"segment_properties\": \"segment_properties\"");
    assert_text(text, "\"lod_scale_multiplier\": 1,");
    free(text);
    /* an open surface has no volume; without labels segments are counted */
    p.cube.triangle_count--;
    p.parts[0].label = p.parts[1].label = NULL;
    assert_ok(write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err), err);
    text = read_all("mesh/segment_properties/info");
    assert_text(text, "\"ids\": [\"1\", \"2\"]");
    assert_null(strstr(text, "volume_mm3"));
    free(text);
    free_pair(&p);
}

static void coordinates_turn_with_the_frame(void **state)
{
    (void)state;
    label_pair p;
    cw_error err = {0};
    if (!cwi_module_present("draco"))
        skip();
    make_pair(&p);
    assert_ok(write_folder("mesh", p.parts, 2, (cw_write_desc){.axes = {.ras = true}}, &err),
              err);
    folder_segment s = test_segment_read(test_path("mesh"), "4000000000");
    cw_mesh joined = test_segment_join(&s, 0);
    double low[3], high[3], was_low[3], was_high[3];
    assert_true(cw_mesh_bounds(&joined, low, high));
    assert_true(cw_mesh_bounds(&p.tetrahedron, was_low, was_high));
    assert_near(low[0], -was_high[0], 1e-3);
    assert_near(high[1], -was_low[1], 1e-3);
    assert_near(high[2], was_high[2], 1e-3);
    cw_mesh_free(&joined);
    test_segment_free(&s);
    free_pair(&p);
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    label_pair p;
    cw_error err = {0};
    if (!cwi_module_present("draco"))
        skip();
    make_pair(&p);
    const struct {
        cw_write_desc desc;
        const char *words;
    } rows[] = {{{.bits = 12}, "12 bits a coordinate; neuroglancer has 10 or 16"},
                {{.local = true}, "no place for a local origin"},
                {{.axes = {.unit = CW_UNIT_UM}}, "no other unit"},
                {{.text = true}, "no form as text"},
                {{.animated = true}, "no animation"},
                {{.compression = CW_COMPRESS_MESHOPT}, "one form only"},
                {{.tolerance_mm = 1e-9}, "there can be 256"}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        assert_fails(write_folder("mesh", p.parts, 2, rows[r].desc, &err), CW_ERR_ARGUMENT,
                     rows[r].words, err);
    p.labels[1].value = 17;
    assert_fails(write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err), CW_ERR_ARGUMENT,
                 "label 17 is there twice", err);
    p.labels[0].value = 0;
    assert_fails(write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err), CW_ERR_ARGUMENT,
                 "label 0 cannot be a segment", err);
    p.parts[0].label = NULL;
    assert_fails(write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err), CW_ERR_ARGUMENT,
                 "1 of 2 parts have a label", err);
    p.parts[0].label = &p.labels[0];
    p.labels[0].value = 1;
    /* a part smaller than a step */
    for (size_t i = 0; i < 3 * p.tetrahedron.vertex_count; i++)
        p.tetrahedron.positions[i] *= 1e-7f;
    assert_fails(write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err), CW_ERR_CHECK,
                 "'rest' is smaller than the steps", err);
    for (size_t i = 0; i < 3 * p.tetrahedron.vertex_count; i++)
        p.tetrahedron.positions[i] = 0;
    assert_fails(write_folder("mesh", p.parts + 1, 1, (cw_write_desc){0}, &err), CW_ERR_CHECK,
                 "at one place", err);
    assert_int_equal(test_folder_entries(), 0);
    free_pair(&p);
}

static void foreign_folders_are_kept(void **state)
{
    (void)state;
    label_pair p;
    cw_error err = {0};
    if (!cwi_module_present("draco"))
        skip();
    make_pair(&p);
    const cw_write_desc none = {0};
    assert_int_equal(mkdir(test_path("theirs"), 0777), 0);
    test_file_write(test_path("theirs/info"), "{\"@type\": \"neuroglancer_legacy_mesh\"}", 37);
    assert_fails(write_folder("theirs", p.parts, 2, none, &err), CW_ERR_OUTPUT,
                 "is no neuroglancer mesh", err);
    assert_ok(write_folder("mesh", p.parts, 2, none, &err), err);
    assert_ok(write_folder("mesh", p.parts, 1, none, &err), err);
    struct stat info;
    assert_int_not_equal(stat(test_path("mesh/4000000000"), &info), 0);
    assert_fails(write_folder("mesh", p.parts, 1, (cw_write_desc){.no_clobber = true}, &err),
                 CW_ERR_OUTPUT, "it exists", err);
    static const char *const names[] = {"notes.txt", "17.old", "segment_properties/more"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        char path[64];
        snprintf(path, sizeof path, "mesh/%s", names[n]);
        test_file_write(test_path(path), "x", 1);
        assert_fails(write_folder("mesh", p.parts, 1, none, &err), CW_ERR_OUTPUT,
                     "is not of a neuroglancer mesh", err);
        assert_int_equal(remove(test_path(path)), 0);
    }
    assert_int_equal(mkdir(test_path("mesh/5"), 0777), 0);
    assert_fails(write_folder("mesh", p.parts, 1, none, &err), CW_ERR_OUTPUT,
                 "holds '5', which is not of a neuroglancer mesh", err);
    assert_int_equal(test_folder_entries(), 2);
    free_pair(&p);
}

static void interrupted_and_starved_writes_leave_nothing(void **state)
{
    (void)state;
    label_pair p;
    if (!cwi_module_present("draco"))
        skip();
    make_pair(&p);
    for (int polls = 0; polls < 2; polls++) {
        int left = polls;
        cw_error err = {0};
        const cw_write_desc desc = {.progress = {.report = test_stop_after, .user = &left}};
        assert_fails(write_folder("mesh", p.parts, 2, desc, &err), CW_ERR_CANCELLED, "", err);
        assert_int_equal(test_folder_entries(), 0);
    }
    for (long n = 0;; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = write_folder("mesh", p.parts, 2, (cw_write_desc){0}, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "memory", err);
        assert_int_equal(test_folder_entries(), 0);
    }
    free_pair(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define TEST(f) cmocka_unit_test_setup_teardown(f, test_folder_make, test_folder_remove)
        TEST(levels_of_labels_are_closed_and_in_place),
        TEST(random_label_maps_stay_closed),
        TEST(units_and_places_do_not_matter),
        TEST(large_triangles_are_cut_and_close_again),
        TEST(two_sided_sheets_stay),
        TEST(properties_name_and_measure_segments),
        TEST(coordinates_turn_with_the_frame),
        TEST(bad_requests_are_refused),
        TEST(foreign_folders_are_kept),
        TEST(interrupted_and_starved_writes_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
