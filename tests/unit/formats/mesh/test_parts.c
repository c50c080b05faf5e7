/* Several meshes in one file: what becomes of their names, places and arrays. */
#include "support/meshes.h"

#include "core/base/module.h"
#include "formats/mesh/mesh_writer.h"
#include "formats/ply/ply_format.h"

#include <math.h>

/* A cube and a tetrahedron, apart from each other in the world and each with an origin. */
typedef struct pair {
    cw_mesh cube, tetrahedron;
    cw_part parts[2];
} pair;

static pair *make_pair(pair *p)
{
    memset(p, 0, sizeof *p);
    test_make_cube(&p->cube);
    test_make_tetrahedron(&p->tetrahedron);
    memcpy(p->cube.origin, (double[3]){10, 20, 30}, sizeof p->cube.origin);
    memcpy(p->tetrahedron.origin, (double[3]){15.5, 20, 30}, sizeof p->tetrahedron.origin);
    p->parts[0] = (cw_part){.mesh = &p->cube, .name = "cube"};
    p->parts[1] = (cw_part){.mesh = &p->tetrahedron, .name = "four faces"};
    return p;
}

static void free_pair(pair *p)
{
    cw_mesh_free(&p->cube);
    cw_mesh_free(&p->tetrahedron);
}

static void write_pair(const char *name, const pair *p, bool local)
{
    cw_error err = {0};
    const cw_write_desc desc = {.local = local};
    assert_ok(cw_parts_write(test_path(name), p->parts, 2, &desc, &err), err);
}

/* The two behind each other: 8 + 4 vertices, 12 + 4 triangles, each where it was. */
static void check_both(const cw_mesh *mesh)
{
    static const double low[3] = {10, 20, 30}, high[3] = {16.5, 21, 31};
    double is_low[3], is_high[3];
    cw_quality q;
    cw_error err = {0};
    assert_usable(mesh);
    assert_int_equal(mesh->vertex_count, 12);
    assert_int_equal(mesh->triangle_count, 16);
    cw_mesh_bounds(mesh, is_low, is_high);
    for (int a = 0; a < 3; a++) {
        assert_near(is_low[a], low[a], 1e-5); /* nodes of glTF are multiplied out */
        assert_near(is_high[a], high[a], 1e-5);
    }
    assert_ok(cw_quality_measure(mesh, NULL, &q, &err), err);
    assert_int_equal(q.components, 2);
    assert_int_equal(q.open_edges, 0);
    assert_near(q.volume_mm3, 1 + 1.0 / 6, 1e-6);
}

static void parts_stand_in_one_file_where_they_are(void **state)
{
    (void)state;
    static const char *const names[] = {"a.stl", "a.ply", "a.obj", "a.off",
                                        "a.vtp", "a.3mf", "a.glb"};
    pair p;
    make_pair(&p);
    for (size_t i = 0; i < 2 * sizeof names / sizeof *names; i++) {
        const char *name = names[i / 2];
        cw_mesh back;
        cw_mesh_file file;
        cw_error err = {0};
        if (strcmp(name, "a.glb") == 0 && !cwi_module_present("gltf"))
            continue;
        write_pair(name, &p, i % 2);
        assert_ok(cw_mesh_read(test_path(name), NULL, &back, &file, &err), err);
        assert_true(file.local == i % 2);
        check_both(&back);
        if (i % 2 && strcmp(name, "a.glb") != 0) /* whose nodes stand apart */
            assert_true(back.origin[0] == 10 && back.origin[1] == 20 && back.origin[2] == 30);
        cw_mesh_free(&back);
    }
    free_pair(&p);
}

static void objects_of_obj_have_their_names(void **state)
{
    (void)state;
    pair p;
    size_t size;
    cw_error err = {0};
    make_pair(&p);
    write_pair("a.obj", &p, false);
    char *text = test_file_read(test_path("a.obj"), &size);
    assert_non_null(strstr(text, "\no cube\nv 10 20 30\n"));
    const char *second = strstr(text, "\no four faces\nv 15.5 20 30\n");
    assert_non_null(second);
    assert_non_null(strstr(second, "\nf 9//9 11//11 10//10\n"));
    free(text);
    p.parts[0].name = p.parts[1].name = NULL;
    assert_ok(cw_parts_write(test_path("a.obj"), p.parts, 2, NULL, &err), err);
    text = test_file_read(test_path("a.obj"), &size);
    assert_non_null(strstr(text, "\no a 1\n"));
    assert_non_null(strstr(text, "\no a 2\n"));
    free(text);
    free_pair(&p);
}

/* The file's own name goes before that of its only part, and that before the path's. */
static void one_part_is_named_by_the_call_or_itself(void **state)
{
    (void)state;
    static const struct {
        const char *called, *part, *written;
    } rows[] = {{"skull", "bone", "\no skull\n"},
                {NULL, "bone", "\no bone\n"},
                {NULL, NULL, "\no a\n"}};
    pair p;
    cw_error err = {0};
    make_pair(&p);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const cw_write_desc desc = {.name = rows[i].called};
        size_t size;
        p.parts[0].name = rows[i].part;
        assert_ok(cw_parts_write(test_path("a.obj"), p.parts, 1, &desc, &err), err);
        char *text = test_file_read(test_path("a.obj"), &size);
        assert_non_null(strstr(text, rows[i].written));
        free(text);
    }
    free_pair(&p);
}

static void arrays_that_one_part_lacks_are_left_out(void **state)
{
    (void)state;
    static uint8_t colors[4 * 8];
    static float scalars[8];
    pair p;
    cw_mesh back;
    cw_error err = {0};
    make_pair(&p);
    free(p.tetrahedron.normals);
    p.tetrahedron.normals = NULL;
    p.cube.colors = colors;
    p.cube.scalars = p.tetrahedron.scalars = scalars;
    write_pair("a.ply", &p, false);
    assert_ok(cw_mesh_read(test_path("a.ply"), NULL, &back, NULL, &err), err);
    assert_true(back.scalars && !back.normals && !back.colors && !back.labels);
    cw_mesh_free(&back);
    write_pair("a.obj", &p, false); /* whose objects may have normals or none */
    size_t size;
    char *text = test_file_read(test_path("a.obj"), &size);
    assert_non_null(strstr(text, "\nf 1//1 "));
    assert_non_null(strstr(text, "\nf 9 11 10\n"));
    free(text);
    p.parts[0] = p.parts[1];
    p.parts[1] = (cw_part){.mesh = &p.cube, .name = NULL};
    write_pair("a.obj", &p, false);
    text = test_file_read(test_path("a.obj"), &size);
    assert_non_null(strstr(text, "\nf 1 3 2\n"));
    assert_non_null(strstr(text, "\nf 5//1 "));
    free(text);
    p.cube.colors = NULL;
    p.cube.scalars = p.tetrahedron.scalars = NULL;
    free_pair(&p);
}

static void empty_parts_are_left_out_and_alone_refused(void **state)
{
    (void)state;
    const cw_mesh none = {0};
    pair p;
    size_t size;
    cw_error err = {0};
    make_pair(&p);
    const cw_part parts[] = {
        {.mesh = &none, .name = "none"}, p.parts[0], {.mesh = &none, .name = "none"}};
    assert_ok(cw_parts_write(test_path("a.obj"), parts, 3, NULL, &err), err);
    char *text = test_file_read(test_path("a.obj"), &size);
    assert_null(strstr(text, "none"));
    free(text);
    assert_fails(cw_parts_write(test_path("b.obj"), parts, 1, NULL, &err), CW_ERR_ARGUMENT,
                 "b.obj: the mesh is empty", err);
    assert_fails(cw_parts_write(test_path("b.obj"), NULL, 0, NULL, &err), CW_ERR_ARGUMENT,
                 "b.obj: the mesh is empty", err);
    p.cube.triangles[3] = 99;
    assert_fails(cw_parts_write(test_path("b.obj"), parts, 3, NULL, &err), CW_ERR_ARGUMENT,
                 "b.obj: triangle 1 names vertex 99 of 8", err);
    assert_int_equal(test_folder_entries(), 1);
    free_pair(&p);
}

/* Each part loses what it would lose alone; a local file keeps the first, whose origin
 * it has. */
static void losses_of_parts_add_up(void **state)
{
    (void)state;
    pair p;
    cw_write_loss loss, one;
    cw_error err = {0};
    make_pair(&p);
    p.cube.origin[2] = p.tetrahedron.origin[2] = 1e8;
    assert_ok(cw_mesh_write_loss("a.stl", &p.cube, NULL, &one, &err), err);
    assert_ok(cw_parts_write_loss("a.stl", p.parts, 2, NULL, &loss, &err), err);
    assert_int_equal(one.merged_vertices, 4);
    assert_int_equal(loss.merged_vertices, 4 + 1);
    const cw_write_desc local = {.local = true};
    assert_ok(cw_parts_write_loss("a.stl", p.parts, 2, &local, &loss, &err), err);
    assert_int_equal(loss.merged_vertices, 0);
    p.cube.origin[2] = 0;
    assert_ok(cw_parts_write_loss("a.stl", p.parts, 2, &local, &loss, &err), err);
    assert_int_equal(loss.merged_vertices, 1);
    free_pair(&p);
}

/* --- reading ----------------------------------------------------------------------------- */

typedef struct read_parts {
    cw_part *items;
    size_t count;
    cw_mesh_file file;
} read_parts;

static read_parts read_all(const char *name)
{
    read_parts r;
    cw_error err = {0};
    assert_ok(cw_parts_read(test_path(name), NULL, &r.items, &r.count, &r.file, &err), err);
    for (size_t i = 0; i < r.count; i++)
        assert_usable(r.items[i].mesh);
    return r;
}

static void check_part(const cw_part *part, const char *name, size_t vertices, size_t triangles)
{
    if (name)
        assert_string_equal(part->name, name);
    else
        assert_null(part->name);
    assert_int_equal(part->mesh->vertex_count, vertices);
    assert_int_equal(part->mesh->triangle_count, triangles);
}

static void objects_come_back_as_they_were(void **state)
{
    (void)state;
    pair p;
    make_pair(&p);
    for (int n = 0; n < 2; n++) {
        const char *name = n ? "a.3mf" : "a.obj";
        write_pair(name, &p, true);
        read_parts r = read_all(name);
        assert_int_equal(r.count, 2);
        assert_int_equal(r.file.parts, 2);
        check_part(&r.items[0], "cube", 8, 12);
        check_part(&r.items[1], "four faces", 4, 4);
        check_triangles(r.items[1].mesh, 4, p.tetrahedron.triangles);
        check_positions(r.items[0].mesh, 8, p.cube.positions);
        for (size_t i = 0; i < 12 && n == 0; i++)
            assert_true(r.items[1].mesh->normals[i] == p.tetrahedron.normals[i]);
        for (int a = 0; a < 3; a++)
            assert_true(r.items[1].mesh->origin[a] == p.cube.origin[a]);
        cw_parts_free(r.items, r.count);
    }
    free_pair(&p);
}

#define FOUR "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\nv 8 8 8\nv 7 8 9\n"

/* Rows of files, with the names of the parts and how many triangles each has. */
static void groups_are_parts_where_there_are_no_objects(void **state)
{
    (void)state;
    static const struct {
        const char *text, *names[3];
        size_t triangles[3];
    } rows[] = {
        {FOUR "f 1 2 3\nf 5 6 7\n", {NULL}, {2}},
        {FOUR "g  a  b \r\nf 1 2 3\ng\nf 5 6 7", {"a  b", NULL}, {1, 1}},
        {FOUR "g a\nf 1 2 3\ng b\nf 2 3 4\n", {"a"}, {2}}, /* they share 2, 3 */
        {FOUR "g a\nf 1 2 3\ng b\nf 5 6 7\ng c\nf 3 4 1\n", {"a", "b"}, {2, 1}},
        {FOUR "f 1 2 3\no late\nf 5 6 7\n", {NULL, "late"}, {1, 1}},
        {FOUR "g none\no one\ng x\nf 1 2 3\ng y\nf 5 6 7\n", {"one"}, {2}},
        {FOUR "o one\no\tt\033wo\\\nf 1 2 3\no three\nl 1 2\n", {"t_wo_"}, {1}},
        {FOUR "o nothing\n", {NULL}, {0}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        test_file_write(test_path("a.obj"), rows[i].text, strlen(rows[i].text));
        read_parts r = read_all("a.obj");
        const size_t count = rows[i].triangles[1] ? 2 : 1;
        if (r.count != count)
            fail_msg("row %zu has %zu parts", i, r.count);
        for (size_t p = 0; p < count && rows[i].triangles[p]; p++)
            check_part(&r.items[p], rows[i].names[p],
                       count == 1 ? r.items[p].mesh->vertex_count : rows[i].triangles[p] + 2,
                       rows[i].triangles[p]);
        cw_parts_free(r.items, r.count);
    }
}

#define FACET(z)                                                                               \
    "facet normal 0 0 1\nouter loop\nvertex 0 0 " z "\nvertex 1 0 " z "\nvertex 0 1 " z        \
    "\nendloop\nendfacet\n"

static void solids_are_parts_and_other_formats_have_one(void **state)
{
    (void)state;
    static const char text[] =
        "solid two words\n" FACET("0") "endsolid two words\n"
                                       "solid\n" FACET("1") FACET("2") "endsolid\n";
    pair p;
    make_pair(&p);
    test_file_write(test_path("a.stl"), text, strlen(text));
    read_parts r = read_all("a.stl");
    assert_int_equal(r.count, 2);
    check_part(&r.items[0], "two words", 3, 1);
    check_part(&r.items[1], NULL, 6, 2);
    cw_parts_free(r.items, r.count);
    write_pair("a.ply", &p, false);
    r = read_all("a.ply");
    assert_int_equal(r.count, 1);
    check_part(&r.items[0], NULL, 12, 16);
    cw_parts_free(r.items, r.count);
    free_pair(&p);
}

static void no_parts_are_left_of_a_file_that_is_refused(void **state)
{
    (void)state;
    static const char text[] = FOUR "o a\nf 1 2 3\no b\nf 5 6 7\n";
    const cw_mesh_read_desc desc = {.max_bytes = 400};
    cw_part *parts = (cw_part *)&desc;
    size_t count = 9;
    cw_error err = {0};
    assert_fails(cw_parts_read(test_path("none"), NULL, &parts, &count, NULL, &err), CW_ERR_IO,
                 "none", err);
    assert_true(!parts && count == 0);
    test_file_write(test_path("a.obj"), text, strlen(text));
    assert_fails(cw_parts_read(test_path("a.obj"), &desc, &parts, &count, NULL, &err),
                 CW_ERR_LIMIT, "400 bytes allowed", err);
    assert_true(!parts && count == 0);
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st =
            cw_parts_read(test_path("a.obj"), NULL, &parts, &count, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(count, failed ? 0 : 2);
    }
    cw_parts_free(parts, count);
    cw_parts_free(NULL, 0);
}

/* More vertices than its numbers can say: counted before any of them is touched. */
static void too_many_vertices_for_ply_are_refused(void **state)
{
    (void)state;
    const cwi_parts parts = {.count = 2, .vertices = (uint64_t)UINT32_MAX + 1};
    cwi_mesh_output out = {0};
    cw_error err = {0};
    assert_fails(cwi_ply_write(&parts, &out, &err), CW_ERR_LIMIT, "at most 4294967295 vertices",
                 err);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const char *const names[] = {"a.stl", "a.obj", "a.glb"};
    pair p;
    make_pair(&p);
    p.parts[1].time_s = 1;
    for (size_t i = 0; i < 3; i++) {
        const cw_write_desc desc = {.animated = i == 2};
        bool failed = strcmp(names[i], "a.glb") != 0 || cwi_module_present("gltf");
        for (long n = 0; failed; n++) {
            cw_error err = {0};
            cwi_alloc_fail_after(n);
            const cw_status st = cw_parts_write(test_path(names[i]), p.parts, 2, &desc, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
            assert_int_equal(test_folder_entries(), failed ? i : i + 1);
        }
    }
    free_pair(&p);
}

/* A cube with a tetrahedron for its coarser form, and a part by itself behind them. */
static void levels_are_named_by_their_first_and_not_read(void **state)
{
    (void)state;
    pair p;
    cw_error err = {0};
    size_t size, count;
    cw_part *back;
    cw_mesh mesh;
    cw_mesh_file file;
    make_pair(&p);
    cw_part parts[] = {
        {.mesh = &p.cube, .name = "fine", .max_error_mm = 0.25, .rms_error_mm = 0.125},
        {.mesh = &p.tetrahedron, .name = "coarse", .level = 1},
        {.mesh = &p.tetrahedron, .name = "other"}};
    if (!cwi_module_present("gltf")) {
        free_pair(&p);
        return;
    }
    assert_ok(cw_parts_write(test_path("a.gltf"), parts, 3, NULL, &err), err);
    char *text = test_file_read(test_path("a.gltf"), &size);
    assert_non_null(strstr(text, "\"extensionsUsed\":[\"MSFT_lod\"]"));
    assert_null(strstr(text, "extensionsRequired"));
    assert_non_null(strstr(text, "\"MSFT_lod\":{\"ids\":[1]}"));
    assert_non_null(strstr(text, "\"MSFT_screencoverage\":[0.3333333333333333,0.0]"));
    assert_non_null(strstr(text, "\"max_error_mm\":0.25"));
    assert_non_null(strstr(text, "\"rms_error_mm\":0.125"));
    assert_non_null(strstr(text, "\"scenes\":[{\"nodes\":[0,2]}]"));
    free(text);
    assert_ok(cw_mesh_read(test_path("a.gltf"), NULL, &mesh, &file, &err), err);
    check_both(&mesh);
    cw_mesh_free(&mesh);
    assert_int_equal(file.levels, 1);
    assert_ok(cw_parts_read(test_path("a.gltf"), NULL, &back, &count, &file, &err), err);
    assert_int_equal(file.levels, 1);
    assert_int_equal(count, 2);
    assert_int_equal(back[0].mesh->triangle_count, 12);
    assert_int_equal(back[1].mesh->triangle_count, 4);
    cw_parts_free(back, count);
    free_pair(&p);
}

/* --- animations --------------------------------------------------------------------------- */

enum { SHOWN = 4, NUMBERS = 21 + 10 };

/* A tetrahedron, nothing, a cube, and the tetrahedron again. */
static void make_frames(const pair *p, const cw_mesh *nothing, cw_part frames[SHOWN])
{
    frames[0] = (cw_part){.mesh = &p->tetrahedron, .name = "a", .time_s = 10};
    frames[1] = (cw_part){.mesh = nothing, .name = "b", .time_s = 10.5};
    frames[2] = (cw_part){.mesh = &p->cube, .name = "c", .time_s = 11.5};
    frames[3] = (cw_part){.mesh = &p->tetrahedron, .name = "d", .time_s = 12};
}

/* The floats at the end of a .glb file. */
static void last_floats(const char *name, float numbers[NUMBERS])
{
    size_t size;
    char *bytes = test_file_read(test_path(name), &size);
    memcpy(numbers, bytes + size - NUMBERS * sizeof *numbers, NUMBERS * sizeof *numbers);
    free(bytes);
}

/* Scales of a node that is shown in the middle or at the end, each for x, y and z; then times:
 * the first is seen to 0.5, the cube from 1.5 to 2, the last to 2.5, as long as the
 * one before. */
static void check_keys(const char *name)
{
    static const float scales[] = {0, 1, 0, 0, 0, 1, 1};
    static const float times[] = {0, 0.5f, 2.5f, 0, 1.5f, 2, 2.5f, 0, 2, 2.5f};
    float is[NUMBERS];
    last_floats(name, is);
    for (size_t i = 0; i < NUMBERS; i++)
        assert_true(is[i] == (i < 21 ? scales[i / 3] : times[i - 21]));
}

/* Each sampler: its times, and which of the scales it begins with. */
static void check_animation(const char *text)
{
    static const char *const said[] = {
        "\"scenes\":[{\"nodes\":[3,4,5]}]",
        "{\"children\":[0],\"extras\":{\"time_s\":10.0},\"name\":\"a\"}",
        "{\"children\":[1],\"extras\":{\"time_s\":11.5},\"name\":\"c\",\"scale\":[0.0,0.0,0.0]"
        "}",
        "{\"children\":[2],\"extras\":{\"time_s\":12.0},\"name\":\"d\",\"scale\":[0.0,0.0,0.0]"
        "}",
        "\"channels\":[{\"sampler\":0,\"target\":{\"node\":3,\"path\":\"scale\"}},"
        "{\"sampler\":1,\"target\":{\"node\":4,\"path\":\"scale\"}},"
        "{\"sampler\":2,\"target\":{\"node\":5,\"path\":\"scale\"}}]",
        "\"byteOffset\":12,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}",
        "\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}",
        "\"byteOffset\":48,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}",
        "\"componentType\":5126,\"count\":3,\"max\":[2.5],\"min\":[0.0],\"type\":\"SCALAR\"}",
        "\"byteOffset\":12,\"componentType\":5126,\"count\":4,\"max\":[2.5],\"min\":[0.0]",
        "\"byteOffset\":28,\"componentType\":5126,\"count\":3,\"max\":[2.5],\"min\":[0.0]",
        "\"interpolation\":\"STEP\"",
    };
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        if (!strstr(text, said[i]))
            fail_msg("%s is not in %s", said[i], text);
    assert_null(strstr(text, "extensionsRequired"));
}

static void an_animation_shows_one_part_after_another(void **state)
{
    (void)state;
    const cw_mesh nothing = {0};
    const cw_write_desc desc = {.animated = true};
    pair p;
    cw_part frames[SHOWN], *back;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    size_t size, count;
    if (!cwi_module_present("gltf"))
        return;
    make_frames(make_pair(&p), &nothing, frames);
    assert_ok(cw_parts_write(test_path("a.glb"), frames, SHOWN, &desc, &err), err);
    check_keys("a.glb");
    assert_ok(cw_parts_write(test_path("a.gltf"), frames, SHOWN, &desc, &err), err);
    char *text = test_file_read(test_path("a.gltf"), &size);
    check_animation(text);
    free(text);
    assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &mesh, &file, &err), err);
    assert_int_equal(file.hidden, 2);
    assert_int_equal(file.parts, 1);
    assert_int_equal(mesh.triangle_count, 4);
    assert_memory_equal(mesh.positions, p.tetrahedron.positions, 4 * 12);
    assert_memory_equal(mesh.origin, p.tetrahedron.origin, sizeof mesh.origin);
    cw_mesh_free(&mesh);
    assert_ok(cw_parts_read(test_path("a.gltf"), NULL, &back, &count, &file, &err), err);
    assert_int_equal(count, 1);
    assert_int_equal(file.hidden, 2);
    cw_parts_free(back, count);
    free_pair(&p);
}

/* One that is empty comes first: then nothing is seen, and who plays nothing sees the next. */
static void an_animation_may_begin_with_nothing_and_be_compressed(void **state)
{
    (void)state;
    static const float times[] = {0, 0.5f, 1, 2, 0, 1, 1.5f, 2}; /* of a cube, and another */
    const cw_mesh nothing = {0};
    pair p;
    cw_part frames[SHOWN];
    cw_error err = {0};
    make_frames(make_pair(&p), &nothing, frames);
    frames[3].mesh = &nothing;
    frames[0] = frames[1];
    frames[1] = frames[2];
    frames[1].time_s = 11;
    for (int kind = CW_COMPRESS_NONE; kind <= CW_COMPRESS_MESHOPT; kind++) {
        const cw_write_desc desc = {.animated = true, .compression = (cw_compression)kind};
        float is[NUMBERS];
        cw_mesh mesh;
        cw_mesh_file file;
        const cw_status st = cw_parts_write(test_path("a.glb"), frames, SHOWN, &desc, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue;
        assert_ok(st, err);
        last_floats("a.glb", is);
        for (size_t i = 0; i < 8; i++)
            assert_true(is[NUMBERS - 8 + i] == times[i]);
        assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &mesh, &file, &err), err);
        assert_int_equal(file.hidden, 1);
        assert_int_equal(mesh.triangle_count, 12);
        cw_mesh_free(&mesh);
    }
    free_pair(&p);
}

static void animations_that_cannot_be_are_refused(void **state)
{
    (void)state;
    const cw_mesh nothing = {0};
    const cw_write_desc desc = {.animated = true};
    pair p;
    cw_part frames[SHOWN];
    cw_error err = {0};
    make_frames(make_pair(&p), &nothing, frames);
    assert_fails(cw_parts_write(test_path("a.stl"), frames, SHOWN, &desc, &err),
                 CW_ERR_ARGUMENT, "stl has no animation; glTF (.glb, .gltf) has", err);
    assert_fails(cw_mesh_write_check(test_path("a.vtp"), &desc, &err), CW_ERR_ARGUMENT,
                 "vtp has no animation", err);
    if (cwi_module_present("gltf")) {
        const struct {
            size_t part, count;
            double time_s;
            const char *words;
        } rows[] = {
            {2, SHOWN, 10.5, "part 1 of an animation stands at 0.5 s and the next at 0.5"},
            {1, SHOWN, 9, "part 0 of an animation stands at 0 s and the next at -1"},
            {3, SHOWN, 11.5 + 1e-9, "times must ascend"},
            {3, SHOWN, 1e300, "part 2 of an animation"},
            {2, SHOWN, NAN, "times must ascend"},
            {0, 1, 10, "an animation of 1 part; it has at least two"}};
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            make_frames(&p, &nothing, frames);
            frames[rows[i].part].time_s = rows[i].time_s;
            assert_fails(cw_parts_write(test_path("a.glb"), frames, rows[i].count, &desc, &err),
                         CW_ERR_ARGUMENT, rows[i].words, err);
        }
        make_frames(&p, &nothing, frames);
        frames[3].level = 1;
        assert_fails(cw_parts_write(test_path("a.glb"), frames, SHOWN, &desc, &err),
                     CW_ERR_ARGUMENT, "an animation of levels", err);
    }
    assert_int_equal(test_folder_entries(), 0);
    free_pair(&p);
}

static void levels_out_of_place_are_refused(void **state)
{
    (void)state;
    const cw_mesh none = {0};
    pair p;
    cw_error err = {0};
    make_pair(&p);
    cw_part parts[] = {{.mesh = &p.cube}, {.mesh = &p.tetrahedron, .level = 1}};
    assert_fails(cw_parts_write(test_path("a.obj"), parts, 2, NULL, &err), CW_ERR_ARGUMENT,
                 "obj has no levels of detail", err);
    if (cwi_module_present("gltf")) {
        parts[1].level = 2;
        assert_fails(cw_parts_write(test_path("a.glb"), parts, 2, NULL, &err), CW_ERR_ARGUMENT,
                     "part 1 is of level 2: one of level 1 must be in front of it", err);
        assert_fails(cw_parts_write(test_path("a.glb"), parts + 1, 1, NULL, &err),
                     CW_ERR_ARGUMENT, "part 0 is of level 2", err);
        parts[1].level = 1;
        parts[0].mesh = &none;
        assert_fails(cw_parts_write(test_path("a.glb"), parts, 2, NULL, &err), CW_ERR_ARGUMENT,
                     "no triangles", err);
    }
    assert_int_equal(test_folder_entries(), 0);
    free_pair(&p);
}

/* Another order, and the same triangles with what their vertices have. */
static void an_order_for_drawing_changes_nothing_else(void **state)
{
    (void)state;
    cw_mesh mesh, plain;
    cw_error err = {0};
    cw_quality a, b;
    test_make_far_sphere(&mesh);
    test_make_far_sphere(&plain);
    const size_t count = mesh.vertex_count;
    mesh.labels = malloc(count * sizeof *mesh.labels);
    for (size_t v = 0; v < count; v++)
        mesh.labels[v] = (uint32_t)v;
    const cw_status st = cw_mesh_optimize(&mesh, &err);
    if (!cwi_module_present("meshopt")) {
        assert_int_equal(st, CW_ERR_UNSUPPORTED);
        assert_memory_equal(mesh.triangles, plain.triangles, 12 * plain.triangle_count);
    } else {
        assert_ok(st, err);
        assert_memory_not_equal(mesh.triangles, plain.triangles, 12 * plain.triangle_count);
        for (size_t v = 0; v < count; v++) {
            const size_t from = mesh.labels[v];
            assert_memory_equal(mesh.positions + 3 * v, plain.positions + 3 * from, 12);
            assert_memory_equal(mesh.normals + 3 * v, plain.normals + 3 * from, 12);
        }
        uint32_t next = 0; /* vertices come in the order in which they are named */
        for (size_t c = 0; c < 3 * mesh.triangle_count; c++) {
            assert_true(mesh.triangles[c] <= next);
            next += mesh.triangles[c] == next;
        }
        assert_ok(cw_quality_measure(&mesh, NULL, &a, &err), err);
        assert_ok(cw_quality_measure(&plain, NULL, &b, &err), err);
        assert_true(cw_quality_is_closed_manifold(&a) && a.euler == b.euler);
        assert_within(a.volume_mm3, b.volume_mm3, 1e-9);
    }
    cw_mesh_free(&mesh);
    cw_mesh_free(&plain);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(parts_stand_in_one_file_where_they_are),
        TEST(objects_of_obj_have_their_names),
        TEST(one_part_is_named_by_the_call_or_itself),
        TEST(arrays_that_one_part_lacks_are_left_out),
        TEST(empty_parts_are_left_out_and_alone_refused),
        TEST(losses_of_parts_add_up),
        TEST(objects_come_back_as_they_were),
        TEST(groups_are_parts_where_there_are_no_objects),
        TEST(solids_are_parts_and_other_formats_have_one),
        TEST(no_parts_are_left_of_a_file_that_is_refused),
        TEST(too_many_vertices_for_ply_are_refused),
        TEST(memory_may_run_out_anywhere),
        TEST(levels_are_named_by_their_first_and_not_read),
        TEST(levels_out_of_place_are_refused),
        TEST(an_animation_shows_one_part_after_another),
        TEST(an_animation_may_begin_with_nothing_and_be_compressed),
        TEST(animations_that_cannot_be_are_refused),
        TEST(an_order_for_drawing_changes_nothing_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
