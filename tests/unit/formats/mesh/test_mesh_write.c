/* Tests mesh writing in every format: refused paths and formats, ended writes, names, and
 * reported loss. */
#define _GNU_SOURCE /* mkfifo, setrlimit */
#include "support/support.h"

#include "core/base/status.h"

#include <stdio.h>

#include "core/base/memory.h"
#include "core/base/module.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Mistakes that are found before a writer is called, as one row each. */
static void mistakes_are_named_with_the_path(void **state)
{
    (void)state;
    cw_mesh mesh = {0}, empty = {0}, broken = {0};
    cw_error err = {0};
    test_make_tetrahedron(&mesh);
    test_make_tetrahedron(&broken);
    broken.positions[4] = NAN;
    const struct {
        const char *path, *format;
        const cw_mesh *mesh;
        cw_status status;
        const char *words;
    } rows[] = {
        {"a.xyz", NULL, &mesh, CW_ERR_ARGUMENT, "a.xyz: its extension is of no mesh format"},
        {"a.nrrd", NULL, &mesh, CW_ERR_ARGUMENT,
         "there are .glb .gltf .stl .ply .obj .off .3mf .vtp"},
        {"a.stl", "nrrd", &mesh, CW_ERR_ARGUMENT,
         "no mesh format is named 'nrrd'; there are glb"},
        {"a.stl", NULL, &empty, CW_ERR_ARGUMENT, "a.stl: the mesh is empty"},
        {"a.stl", NULL, &broken, CW_ERR_ARGUMENT, "vertex 1 is not finite"},
        {"no/a.stl", NULL, &mesh, CW_ERR_OUTPUT, "no/a.stl: the folder '"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const cw_write_desc desc = {.format = rows[i].format};
        assert_fails(cw_mesh_write(test_path(rows[i].path), rows[i].mesh, &desc, &err),
                     rows[i].status, rows[i].words, err);
    }
    broken.positions[4] = 0;
    broken.origin[2] = 1e300;
    assert_fails(cw_mesh_write(test_path("a.stl"), &broken, NULL, &err), CW_ERR_LIMIT,
                 "single precision", err);
    assert_int_equal(test_folder_entries(), 0);
    cw_mesh_free(&mesh);
    cw_mesh_free(&broken);
}

static void a_named_format_wins_over_the_extension(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_tetrahedron(&mesh);
    const cw_write_desc desc = {.format = "stl"};
    assert_ok(cw_mesh_write(test_path("a.ply"), &mesh, &desc, &err), err);
    free(test_file_read(test_path("a.ply"), &size));
    assert_int_equal(size, 84 + 4 * 50);
    cw_mesh_free(&mesh);
}

/* Formats that are text anyway take the wish, too; volumes have no such choices. */
static void text_is_refused_where_there_is_none(void **state)
{
    (void)state;
    const cw_write_desc text = {.text = true}, ras = {.axes = {.ras = true}};
    const cw_volume none = {0};
    cw_mesh mesh = {0};
    cw_error err = {0};
    test_make_tetrahedron(&mesh);
    assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, &text, &err), err);
    assert_fails(cw_mesh_write(test_path("a.glb"), &mesh, &text, &err), CW_ERR_ARGUMENT,
                 "a.glb: glb has no form as text; those that have are gltf stl ply obj off",
                 err);
    assert_fails(cw_volume_write(test_path("a.nrrd"), &none, &text, &err), CW_ERR_ARGUMENT,
                 "for meshes only", err);
    assert_fails(cw_volume_write(test_path("a.nrrd"), &none, &ras, &err), CW_ERR_ARGUMENT,
                 "for meshes only", err);
    assert_int_equal(test_folder_entries(), 1);
    cw_mesh_free(&mesh);
}

static bool refuse(void *user, const char *step, double done)
{
    assert_string_equal(step, "writing");
    assert_true(done >= 0 && done <= 1);
    ++*(int *)user;
    return false;
}

/* The n-th way to write a mesh that this build has: its formats, then GLB by each compression.
 * No format after the last. */
static cw_write_desc way_to_write(size_t n)
{
    static const char *const modules[] = {[CW_COMPRESS_QUANTIZE] = "gltf",
                                          [CW_COMPRESS_DRACO] = "draco",
                                          [CW_COMPRESS_MESHOPT] = "meshopt"};
    size_t count;
    const cw_format *formats = cw_formats(&count);
    for (size_t i = 0; i < count; i++)
        if (formats[i].writes_mesh && formats[i].in_this_build && n-- == 0)
            return (cw_write_desc){.format = formats[i].name};
    for (int k = CW_COMPRESS_QUANTIZE; k <= CW_COMPRESS_MESHOPT; k++)
        if (cwi_module_present("gltf") && cwi_module_present(modules[k]) && n-- == 0)
            return (cw_write_desc){.format = "glb", .compression = (cw_compression)k};
    return (cw_write_desc){0};
}

/* The n-th way that writes a file; folders are tested with their format. */
static cw_write_desc way_to_file(size_t n)
{
    cw_write_desc desc = {0};
    for (size_t i = 0; (desc = way_to_write(i)).format; i++)
        if (strcmp(desc.format, "neuroglancer") != 0 && n-- == 0)
            break;
    return desc;
}

static void a_cancelled_write_leaves_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    int calls = 0, ways = 0;
    test_make_cube(&mesh);
    for (cw_write_desc desc; (desc = way_to_write((size_t)ways)).format; ways++) {
        desc.progress = (cw_progress){refuse, &calls};
        assert_fails(cw_mesh_write(test_path("a"), &mesh, &desc, &err), CW_ERR_CANCELLED,
                     "interrupted while writing", err);
    }
    assert_true(ways >= 3);
    assert_int_equal(calls, ways);
    assert_int_equal(test_folder_entries(), 0);
    cw_mesh_free(&mesh);
}

/* Runs in a child: a write that the system ends. 0 when it was told as it should be. */
static int write_to_full_disk(const cw_mesh *mesh, cw_write_desc desc)
{
    const struct rlimit limit = {4096, 4096};
    cw_error err = {0};
    signal(SIGXFSZ, SIG_IGN);
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0)
        return 1;
    if (cw_mesh_write(test_path("a"), mesh, &desc, &err) != CW_ERR_OUTPUT)
        return 2;
    return strstr(err.message, "it cannot be written: File too large") ? 0 : 3;
}

static bool kill_process(void *user, const char *step, double done)
{
    (void)user, (void)step;
    if (done > 0)
        raise(SIGKILL);
    return true;
}

static int write_until_killed(const cw_mesh *mesh, cw_write_desc desc)
{
    cw_error err = {0};
    desc.progress = (cw_progress){kill_process, NULL};
    return cw_mesh_write(test_path("a"), mesh, &desc, &err) == CW_OK ? 1 : 2;
}

/* Whatever ends a write, the old file stays: whole, under its name. */
static void writes_that_are_ended_keep_the_old_file(void **state)
{
    (void)state;
    static int (*const ends[])(const cw_mesh *, cw_write_desc) = {write_to_full_disk,
                                                                  write_until_killed};
    const cw_field_desc field = {.field = CW_FIELD_GYROID, .dim = {40, 40, 40}, .type = CW_F32};
    cw_volume v;
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &v, &err), err);
    assert_ok(cw_extract(&v, NULL, &mesh, NULL, &err), err);
    test_file_write(test_path("a"), "old", 3);
    for (size_t i = 0; way_to_file(i / 2).format; i++) {
        const cw_write_desc way = way_to_file(i / 2);
        int status;
        size_t size;
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0)
            _exit(ends[i % 2](&mesh, way));
        assert_int_equal(waitpid(child, &status, 0), child);
        if (i % 2 ? !WIFSIGNALED(status) : !WIFEXITED(status) || WEXITSTATUS(status) != 0)
            fail_msg("%s, %d, %zu: status %d", way.format, way.compression, i % 2, status);
        char *bytes = test_file_read(test_path("a"), &size);
        assert_string_equal(bytes, "old");
        free(bytes);
        if (i % 2 == 0)
            assert_int_equal(test_folder_entries(), 1 + i / 2); /* what was killed left some */
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* The path is looked at before anything is written, whatever the format. */
static void only_files_are_replaced(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    test_make_tetrahedron(&mesh);
    assert_int_equal(mkdir(test_path("folder"), 0700), 0);
    assert_int_equal(mkfifo(test_path("pipe"), 0600), 0);
    for (size_t i = 0; way_to_file(i).format; i++) {
        const cw_write_desc desc = way_to_file(i);
        cw_write_desc kept = desc;
        kept.no_clobber = true;
        assert_fails(cw_mesh_write(test_path("folder"), &mesh, &desc, &err), CW_ERR_OUTPUT,
                     "it is a folder", err);
        assert_fails(cw_mesh_write(test_path("pipe"), &mesh, &desc, &err), CW_ERR_OUTPUT,
                     "it is a device, pipe or socket", err);
        assert_fails(cw_mesh_write(test_path("none/a"), &mesh, &desc, &err), CW_ERR_OUTPUT,
                     "does not exist", err);
        assert_fails(cw_mesh_write("/proc/a", &mesh, &desc, &err), CW_ERR_OUTPUT,
                     "no file can be made in its folder", err);
        assert_ok(cw_mesh_write(test_path("a"), &mesh, &desc, &err), err);
        assert_fails(cw_mesh_write(test_path("a"), &mesh, &kept, &err), CW_ERR_OUTPUT,
                     "it exists", err);
    }
    assert_int_equal(test_folder_entries(), 3);
    cw_mesh_free(&mesh);
}

static void starve(const cw_mesh *mesh, cw_write_desc desc, const char *name)
{
    const size_t before = test_folder_entries();
    cw_error err = {0};
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        cw_status st = cw_mesh_write(test_path(name), mesh, &desc, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(test_folder_entries(), failed ? before : before + 1);
    }
}

static void running_out_of_memory_leaves_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    test_make_cube(&mesh);
    for (size_t i = 0; way_to_write(i).format; i++)
        starve(&mesh, way_to_write(i), (char[]){(char)('a' + i), '\0'});
    cw_mesh_free(&mesh);
}

static void the_table_of_formats_is_whole_and_always_the_same(void **state)
{
    (void)state;
    static const char expected[] =
        "nrrd nifti metaimage vtk vtu vtm vti vtkhdf mrc inr mgh npy npz dicom tiff png bmp zarr n5 "
        "precomputed vdb plot3d raw glb gltf stl ply obj off 3mf vtp gifti freesurfer drc neuroglancer ";
    char names[400] = "";
    size_t count, again;
    const cw_format *formats = cw_formats(&count);
    assert_ptr_equal(formats, cw_formats(&again));
    assert_int_equal(count, again);
    for (size_t i = 0; i < count; i++) {
        strcat(strcat(names, formats[i].name), " ");
        const bool is_folder = strcmp(formats[i].name, "neuroglancer") == 0 ||
                               strcmp(formats[i].name, "precomputed") == 0;
        assert_true(is_folder != (formats[i].extensions[0] == '.') && formats[i].about[0]);
        assert_non_null(formats[i].lost);
        assert_true(formats[i].reads_volume || formats[i].writes_mesh || formats[i].reads_mesh);
    }
    assert_string_equal(names, expected);
}

/* Names end up in JSON and in lines of text, so nothing but printable UTF-8 may pass. */
static void names_are_made_safe_for_every_format(void **state)
{
    (void)state;
    static const struct {
        const char *name, *written;
    } rows[] = {
        {NULL, "o bone.v2\n"},
        {"left femur", "o left femur\n"},
        {"two\nlines", "o two_lines\n"},
        {"Sch\xc3\xa4"
         "del",
         "o Sch\xc3\xa4"
         "del\n"},
        {"joined\\", "o joined_\n"},
        {"latin\xe4 x", "o latin_ x\n"},
        {"surrogate\xed\xa0\x80", "o surrogate___\n"},
        {"cut\xe2\x82", "o cut__\n"},
    };
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_cube(&mesh);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const cw_write_desc desc = {.name = rows[i].name};
        assert_ok(cw_mesh_write(test_path("bone.v2.obj"), &mesh, &desc, &err), err);
        char *text = test_file_read(test_path("bone.v2.obj"), &size);
        assert_non_null(strstr(text, rows[i].written));
        free(text);
    }
    cw_mesh_free(&mesh);
}

/* A cube of 0.5 mm where single precision has steps of 1 mm: each corner goes to the one below
 * it on that axis or stays, as its half rounds to even; the twelve triangles follow. */
static void loss_is_counted_where_the_format_has_it(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        double origin[3];
        bool local;
        size_t merged, flat;
    } rows[] = {
        {"a.stl", {0, 0, 0}, false, 0, 0},        {"a.stl", {1e4, 1e4, 1e4}, false, 0, 0},
        {"a.stl", {0, 0, 1e7}, false, 4, 8},      {"a.ply", {0, 1e7, 1e7}, false, 6, 12},
        {"a.obj", {1e7, 1e7, 1e7}, false, 7, 12}, {"a.stl", {1e300, 1e7, 1e7}, false, 7, 12},
        {"a.stl", {1e7, 1e7, 1e7}, true, 0, 0},   {"a.gltf", {1e7, 1e7, 1e7}, false, 0, 0},
    };
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_write_loss loss;
    test_make_cube(&mesh);
    for (size_t i = 0; i < 24; i++)
        mesh.positions[i] *= 0.5f;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const cw_write_desc desc = {.local = rows[i].local};
        const cw_status st = (memcpy(mesh.origin, rows[i].origin, sizeof mesh.origin),
                              cw_mesh_write_loss(rows[i].path, &mesh, &desc, &loss, &err));
        if (st == CW_ERR_UNSUPPORTED) /* glTF, in a build without it */
            continue;
        assert_ok(st, err);
        assert_int_equal(loss.merged_vertices, rows[i].merged);
        assert_int_equal(loss.flat_triangles, rows[i].flat);
    }
    cw_mesh_free(&mesh);
}

static void what_a_format_does_not_keep_is_told(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        unsigned dropped;
    } rows[] = {
        {"a.ply", CW_KEEPS_AFFINE},
        {"a.vtp", CW_KEEPS_AFFINE},
        {"a.off", CW_KEEPS_SCALARS | CW_KEEPS_LABELS | CW_KEEPS_AFFINE},
        {"a.obj", CW_KEEPS_SCALARS | CW_KEEPS_LABELS | CW_KEEPS_AFFINE},
        {"a.3mf", CW_KEEPS_NORMALS | CW_KEEPS_SCALARS | CW_KEEPS_LABELS | CW_KEEPS_AFFINE},
        {"a.stl",
         CW_KEEPS_ALL &
             ~(unsigned)(CW_KEEPS_OPACITY | CW_KEEPS_PLACES | CW_KEEPS_PARTS |
                         CW_KEEPS_ATTRIBUTES | CW_KEEPS_TEXTURE | CW_KEEPS_PICTURES |
                         CW_KEEPS_MATERIALS | CW_KEEPS_FACE_COLORS | CW_KEEPS_CREASES)},
    };
    static uint8_t colors[32];
    static float scalars[8];
    static uint32_t labels[8];
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_write_loss loss;
    test_make_cube(&mesh);
    assert_ok(cw_mesh_write_loss("a.ply", &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped, 0);
    mesh.colors = colors;
    mesh.scalars = scalars;
    mesh.labels = labels;
    mesh.affine[1][3] = 1;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_ok(cw_mesh_write_loss(rows[i].path, &mesh, NULL, &loss, &err), err);
        assert_int_equal(loss.dropped, rows[i].dropped);
    }
    mesh.origin[0] = 1e9;
    const cw_part parts[] = {{.mesh = &mesh, .name = "one"}, {.mesh = &mesh, .name = "two"}};
    assert_ok(cw_parts_write_loss("a.stl", parts, 2, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped,
                     CW_KEEPS_ALL & ~(unsigned)(CW_KEEPS_ATTRIBUTES | CW_KEEPS_TEXTURE |
                                                CW_KEEPS_PICTURES | CW_KEEPS_MATERIALS |
                                                CW_KEEPS_FACE_COLORS | CW_KEEPS_OPACITY |
                                                CW_KEEPS_CREASES));
    mesh.colors = NULL;
    mesh.scalars = NULL;
    mesh.labels = NULL;
    cw_mesh_free(&mesh);
}

static void attributes_that_no_format_keeps_are_named(void **state)
{
    (void)state;
    static const char *const paths[] = {"a.ply", "a.vtp", "a.off", "a.obj", "a.3mf", "a.stl"};
    cw_mesh mesh = {0}, other = {0};
    cw_error err = {0};
    cw_write_loss loss;
    cw_attribute like = {.name = "uv", .on = CW_ON_CORNERS, .type = CW_F32, .components = 2};
    test_make_cube(&mesh);
    test_make_cube(&other);
    assert_ok(cw_mesh_attribute_add(&mesh, &like, NULL, &err), err);
    assert_ok(cw_mesh_attribute_add(&other, &like, NULL, &err), err);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        assert_ok(cw_mesh_write_loss(paths[i], &mesh, NULL, &loss, &err), err);
        assert_true(loss.dropped & CW_KEEPS_ATTRIBUTES);
        assert_string_equal(loss.attributes, "uv");
    }
    strcpy(like.name, "thickness");
    assert_ok(cw_mesh_attribute_add(&other, &like, NULL, &err), err);
    const cw_part parts[] = {{.mesh = &mesh, .name = "one"}, {.mesh = &other, .name = "two"}};
    assert_ok(cw_parts_write_loss("a.obj", parts, 2, NULL, &loss, &err), err);
    assert_string_equal(loss.attributes, "uv, thickness");
    cw_mesh_free(&mesh);
    cw_mesh_free(&other);
}

/* Vertices at one place, or flat triangles, before the rounding are no loss. */
static void what_was_not_there_cannot_be_lost(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_write_loss loss;
    test_make_cube(&mesh);
    mesh.origin[0] = 1e7;
    memset(mesh.positions, 0, 21 * sizeof(float));
    mesh.positions[3] = -0.0f;
    assert_ok(cw_mesh_write_loss("a.stl", &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.merged_vertices + loss.flat_triangles, 0);
    cw_mesh_free(&mesh);
}

static void loss_fails_as_writing_does(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_write_loss loss;
    test_make_cube(&mesh);
    assert_fails(cw_mesh_write_loss("a.xyz", &mesh, NULL, &loss, &err), CW_ERR_ARGUMENT,
                 "a.xyz: its extension is of no mesh format", err);
    for (long n = 0; n < 3; n++) {
        cwi_alloc_fail_after(n);
        assert_fails(cw_mesh_write_loss("a.stl", &mesh, NULL, &loss, &err), CW_ERR_NO_MEMORY,
                     "a.stl: no memory", err);
        cwi_alloc_fail_after(-1);
    }
    mesh.triangles[0] = 8;
    assert_fails(cw_mesh_write_loss("a.stl", &mesh, NULL, &loss, &err), CW_ERR_ARGUMENT,
                 "triangle 0 names vertex 8 of 8", err);
    cw_mesh_free(&mesh);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

/* An answer, and what the path held when it was asked for. */
typedef struct answer {
    const char *path;
    cw_status status;
    size_t asked;
    long size_before;
} answer;

static long file_size(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (!f)
        return -1;
    fseek(f, 0, SEEK_END);
    const long size = ftell(f);
    fclose(f);
    return size;
}

static cw_status give_answer(void *user, cw_error *err)
{
    answer *a = user;
    a->asked++;
    a->size_before = file_size(a->path);
    return a->status == CW_OK ? CW_OK : cwi_fail(err, a->status, "no consent");
}

static void a_file_appears_with_consent_only(void **state)
{
    (void)state;
    static const char *const names[] = {"a.stl", "a.ply", "a.obj", "a.off", "a.vtp"};
    cw_mesh mesh = {0};
    test_make_cube(&mesh);
    const cw_part part = {.mesh = &mesh};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        const char *path = test_path(names[n]);
        answer a = {.path = path, .status = CW_ERR_CHECK};
        const cw_write_consent consent = {give_answer, &a};
        cw_error err = {0};
        assert_fails(cw_parts_write_with_consent(path, &part, 1, NULL, &consent, &err),
                     CW_ERR_CHECK, "no consent", err);
        assert_int_equal(a.asked, 1);
        assert_int_equal(file_size(path), -1);
        a.status = CW_OK;
        assert_ok(cw_parts_write_with_consent(path, &part, 1, NULL, &consent, &err), err);
        assert_int_equal(a.asked, 2);
        assert_int_equal(a.size_before, -1);
        const long whole = file_size(path);
        assert_true(whole > 0);
        a.status = CW_ERR_CANCELLED;
        mesh.triangle_count--;
        assert_fails(cw_parts_write_with_consent(path, &part, 1, NULL, &consent, &err),
                     CW_ERR_CANCELLED, "no consent", err);
        mesh.triangle_count++;
        assert_int_equal(a.size_before, whole);
        assert_int_equal(file_size(path), whole);
    }
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(mistakes_are_named_with_the_path),
        CASE(a_named_format_wins_over_the_extension),
        CASE(text_is_refused_where_there_is_none),
        CASE(a_cancelled_write_leaves_nothing),
        CASE(writes_that_are_ended_keep_the_old_file),
        CASE(only_files_are_replaced),
        CASE(running_out_of_memory_leaves_nothing),
        CASE(the_table_of_formats_is_whole_and_always_the_same),
        CASE(names_are_made_safe_for_every_format),
        CASE(loss_is_counted_where_the_format_has_it),
        CASE(what_a_format_does_not_keep_is_told),
        CASE(attributes_that_no_format_keeps_are_named),
        CASE(what_was_not_there_cannot_be_lost),
        CASE(loss_fails_as_writing_does),
        CASE(a_file_appears_with_consent_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
