/* Tests every mesh reader: meshes that we write come back; limits, names, starvation. */
#include "support/meshes.h"

#include <math.h>
#include <stdio.h>

/* A sphere with every array that a mesh can have, at places that are no short numbers. */
static void make_full_mesh(cw_mesh *mesh)
{
    const cw_field_desc desc = {.field = CW_FIELD_SPHERE, .dim = {17, 17, 17}, .type = CW_F32};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    for (int a = 0; a < 3; a++)
        v.affine[a][3] = 123.456 * (a + 1);
    *mesh = (cw_mesh){0};
    assert_ok(cw_extract(&v, NULL, mesh, NULL, &err), err);
    cw_volume_free(&v);
    mesh->colors = malloc(4 * mesh->vertex_count);
    mesh->scalars = malloc(mesh->vertex_count * sizeof *mesh->scalars);
    mesh->labels = malloc(mesh->vertex_count * sizeof *mesh->labels);
    assert_true(mesh->colors && mesh->scalars && mesh->labels && mesh->normals);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        for (size_t c = 0; c < 4; c++)
            mesh->colors[4 * i + c] = (uint8_t)(i * 7 + c * 50);
        mesh->scalars[i] = sinf((float)i) * 1000;
        mesh->labels[i] = (uint32_t)(i * 2654435761u);
    }
}

static void read_written(const char *name, const cw_mesh *mesh, bool local, cw_mesh *back,
                         cw_mesh_file *file)
{
    const cw_write_desc desc = {.local = local};
    cw_error err = {0};
    assert_ok(cw_mesh_write(test_path(name), mesh, &desc, &err), err);
    assert_ok(cw_mesh_read(test_path(name), NULL, back, file, &err), err);
    assert_usable(back);
    assert_true(file->local == local);
    assert_int_equal(file->known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
    assert_int_equal(file->parts, 1);
    assert_int_equal(file->polygons + file->skipped, 0);
}

static void check_same_origin(const cw_mesh *a, const cw_mesh *b)
{
    for (int i = 0; i < 3; i++)
        if (a->origin[i] != b->origin[i])
            fail_msg("origin[%d] is %.17g, not %.17g", i, a->origin[i], b->origin[i]);
}

/* Arrays of floats that must be equal as numbers; a missing one equals a missing one. */
static void check_same_floats(const float *a, const float *b, size_t count)
{
    assert_true(!a == !b);
    for (size_t i = 0; a && i < count; i++)
        if (a[i] != b[i])
            fail_msg("number %zu is %.9g, not %.9g", i, (double)a[i], (double)b[i]);
}

/* The n-th format that this build writes and reads, and a name for a file of it; NULL after the
 * last. Draco rounds to a grid, and is left to test_compress. */
static const cw_format *written(size_t n, const char **name)
{
    static char names[16][16];
    size_t count;
    const cw_format *formats = cw_formats(&count);
    for (size_t i = 0; i < count; i++)
        if (formats[i].writes_mesh && formats[i].reads_mesh && formats[i].in_this_build &&
            strcmp(formats[i].name, "drc") != 0 && n-- == 0) {
            snprintf(names[i % 16], sizeof *names, "a%.*s",
                     (int)strcspn(formats[i].extensions, " "), formats[i].extensions);
            *name = names[i % 16];
            return &formats[i];
        }
    return NULL;
}

/* The arrays that the format keeps; others are not made up. */
static void check_arrays(const cw_mesh *back, const cw_mesh *mesh, unsigned keeps)
{
    const size_t n = mesh->vertex_count;
    check_same_floats(back->normals, keeps & CW_KEEPS_NORMALS ? mesh->normals : NULL, 3 * n);
    check_same_floats(back->scalars, keeps & CW_KEEPS_SCALARS ? mesh->scalars : NULL, n);
    assert_true(!back->colors == !(keeps & CW_KEEPS_COLORS));
    assert_true(!back->labels == !(keeps & CW_KEEPS_LABELS));
    const bool is_opaque =
        !(keeps & (CW_KEEPS_SCALARS | CW_KEEPS_PLACES)) && keeps & CW_KEEPS_PARTS; /* OBJ */
    for (size_t i = 0; back->colors && i < 4 * n; i++)
        if (back->colors[i] != (is_opaque && i % 4 == 3 ? 255 : mesh->colors[i]))
            fail_msg("colour %zu is %d, not %d", i, back->colors[i], mesh->colors[i]);
    if (back->labels)
        assert_memory_equal(back->labels, mesh->labels, 4 * n);
}

static void local_files_come_back_to_the_bit(void **state)
{
    (void)state;
    const char *name;
    const cw_format *format;
    cw_mesh mesh = {0}, back = {0};
    cw_mesh_file file;
    make_full_mesh(&mesh);
    for (size_t i = 0; (format = written(i, &name)); i++) {
        if (!(format->keeps & CW_KEEPS_SHARING))
            continue; /* welds in another order */
        read_written(name, &mesh, true, &back, &file);
        assert_string_equal(file.format, format->name);
        check_same_origin(&back, &mesh);
        check_positions(&back, mesh.vertex_count, mesh.positions);
        check_triangles(&back, mesh.triangle_count, mesh.triangles);
        check_arrays(&back, &mesh, format->keeps);
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

/* World coordinates are rounded to single precision in PLY, and to ten digits in OBJ. */
static void files_of_the_world_come_back_where_they_were(void **state)
{
    (void)state;
    const char *name;
    const cw_format *format;
    double low[3], high[3], low_back[3], high_back[3];
    cw_mesh mesh = {0}, back = {0};
    cw_mesh_file file;
    make_full_mesh(&mesh);
    cw_mesh_bounds(&mesh, low, high);
    for (size_t i = 0; (format = written(i, &name)); i++) {
        const bool apart = format->keeps & CW_KEEPS_PLACES;
        read_written(name, &mesh, false, &back, &file);
        assert_int_equal(back.vertex_count, mesh.vertex_count);
        assert_int_equal(back.triangle_count, mesh.triangle_count);
        cw_mesh_bounds(&back, low_back, high_back);
        for (int a = 0; a < 3; a++) {
            assert_true(back.origin[a] == (apart ? mesh.origin[a] : 0));
            assert_near(low_back[a], low[a], 3e-5);
            assert_near(high_back[a], high[a], 3e-5);
        }
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

/* The corners of STL are welded in the order in which they come. */
static void a_local_stl_file_keeps_every_corner(void **state)
{
    (void)state;
    cw_mesh mesh = {0}, back = {0};
    cw_mesh_file file;
    make_full_mesh(&mesh);
    for (int a = 0; a < 3; a++)
        mesh.origin[a] = 1000.25 * (a + 1); /* short: it must fit into the header */
    read_written("a.stl", &mesh, true, &back, &file);
    check_same_origin(&back, &mesh);
    assert_int_equal(back.vertex_count, mesh.vertex_count);
    assert_int_equal(back.triangle_count, mesh.triangle_count);
    for (size_t i = 0; i < 3 * mesh.triangle_count; i++)
        for (size_t a = 0; a < 3; a++)
            assert_true(back.positions[3 * (size_t)back.triangles[i] + a] ==
                        mesh.positions[3 * (size_t)mesh.triangles[i] + a]);
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

/* A kilometre from zero the text of OBJ still holds the places: the reader finds an origin. */
static void a_far_obj_file_keeps_its_shape(void **state)
{
    (void)state;
    cw_mesh mesh = {0}, back = {0};
    cw_mesh_file file;
    test_make_far_sphere(&mesh);
    read_written("a.obj", &mesh, false, &back, &file);
    assert_int_equal(back.vertex_count, mesh.vertex_count);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        assert_near(back.origin[i % 3] + (double)back.positions[i],
                    mesh.origin[i % 3] + (double)mesh.positions[i], 1e-5);
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

static void content_decides_then_the_extension(void **state)
{
    (void)state;
    static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char off[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const cw_mesh_read_desc named = {.reader = "off"}, unknown = {.reader = "xyz"};
    cw_mesh mesh = {0};
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_text("a.stl", off, &mesh, &file, &err), err);
    assert_string_equal(file.format, "off");
    cw_mesh_free(&mesh);
    assert_ok(read_text("a.OBJ", triangle, &mesh, &file, &err), err);
    assert_string_equal(file.format, "obj");
    cw_mesh_free(&mesh);
    assert_fails(read_text("a.txt", triangle, &mesh, &file, &err), CW_ERR_FORMAT,
                 "neither content nor extension", err);
    assert_fails(cw_mesh_read(test_path("a.OBJ"), &named, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "the first word is 'v'", err);
    assert_fails(cw_mesh_read(test_path("a.OBJ"), &unknown, &mesh, NULL, &err), CW_ERR_ARGUMENT,
                 "no mesh reader 'xyz'", err);
    assert_fails(cw_mesh_read(test_path("none.obj"), NULL, &mesh, NULL, &err), CW_ERR_IO,
                 "none.obj", err);
    assert_fails(cw_mesh_read(test_path("."), NULL, &mesh, NULL, &err), CW_ERR_IO, "a folder",
                 err);
}

/* Text with its line ends replaced by others; free it. */
static char *replace_line_ends(const char *text, size_t size, const char *end, size_t *length)
{
    char *out = malloc(2 * size + 1);
    assert_non_null(out);
    *length = 0;
    for (size_t i = 0; i < size; i++) {
        const bool ends = text[i] == '\n';
        memcpy(out + *length, ends ? end : text + i, ends ? strlen(end) : 1);
        *length += ends ? strlen(end) : 1;
    }
    return out;
}

/* Files of more than a buffer, with line feeds, both, and carriage returns alone. */
static void line_ends_of_every_kind_are_read(void **state)
{
    (void)state;
    static const char *const names[] = {"a.obj", "a.off", "a.stl", "a.ply"};
    static const char *const ends[] = {"\r", "\r\n"};
    const cw_write_desc desc = {.text = true};
    cw_mesh mesh = {0};
    cw_error err = {0};
    make_full_mesh(&mesh);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        cw_mesh plain = {0};
        size_t size, length;
        assert_ok(cw_mesh_write(test_path(names[i]), &mesh, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path(names[i]), NULL, &plain, NULL, &err), err);
        char *text = test_file_read(test_path(names[i]), &size);
        for (size_t e = 0; e < 2; e++) {
            cw_mesh back = {0};
            cw_mesh_file file;
            char *other = replace_line_ends(text, size, ends[e], &length);
            assert_ok(read_bytes(names[i], other, length, &back, &file, &err), err);
            assert_int_equal(file.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
            check_positions(&back, plain.vertex_count, plain.positions);
            check_triangles(&back, plain.triangle_count, plain.triangles);
            check_same_floats(back.normals, plain.normals, 3 * plain.vertex_count);
            cw_mesh_free(&back);
            free(other);
        }
        free(text);
        cw_mesh_free(&plain);
    }
    cw_mesh_free(&mesh);
}

/* Behind a carriage return the bytes begin at once, even with one that would be a line feed. */
static void a_binary_file_may_have_an_old_header(void **state)
{
    (void)state;
    static const char header[] =
        "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty float x\r"
        "property float y\rproperty float z\relement face 1\r"
        "property list uchar uchar vertex_indices\rend_header\r";
    static const unsigned char first[4] = {'\n', 0, 0x80, 0x3f};
    static const unsigned char face[4] = {3, 0, 1, 2};
    float points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    char file[sizeof header + sizeof points + sizeof face];
    cw_mesh mesh = {0};
    cw_error err = {0};
    memcpy(points, first, sizeof first);
    memcpy(file, header, sizeof header - 1);
    memcpy(file + sizeof header - 1, points, sizeof points);
    memcpy(file + sizeof header - 1 + sizeof points, face, sizeof face);
    assert_ok(read_bytes("a.ply", file, sizeof file - 1, &mesh, NULL, &err), err);
    check_positions(&mesh, 3, points);
    cw_mesh_free(&mesh);
}

static void limits_hold(void **state)
{
    (void)state;
    const char *name;
    cw_mesh mesh = {0}, back = {0};
    cw_error err = {0};
    make_full_mesh(&mesh);
    for (size_t i = 0; written(i, &name); i++) {
        const cw_mesh_read_desc few = {.max_triangles = mesh.triangle_count - 1};
        const cw_mesh_read_desc enough = {.max_triangles = mesh.triangle_count,
                                          .max_bytes = 1 << 20};
        const cw_mesh_read_desc small = {.max_bytes = 10000};
        assert_ok(cw_mesh_write(test_path(name), &mesh, NULL, &err), err);
        assert_fails(cw_mesh_read(test_path(name), &few, &back, NULL, &err), CW_ERR_LIMIT,
                     "triangles, the most allowed", err);
        assert_fails(cw_mesh_read(test_path(name), &small, &back, NULL, &err), CW_ERR_LIMIT,
                     "the 9.77 KiB allowed", err);
        assert_ok(cw_mesh_read(test_path(name), &enough, &back, NULL, &err), err);
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

static void reading_may_be_stopped(void **state)
{
    (void)state;
    const char *name;
    cw_mesh mesh = {0}, back = {0};
    cw_error err = {0};
    make_full_mesh(&mesh);
    for (size_t i = 0; written(i, &name); i++) {
        int polls = 0;
        const cw_mesh_read_desc desc = {.progress = {test_stop_after, &polls}};
        assert_ok(cw_mesh_write(test_path(name), &mesh, NULL, &err), err);
        assert_fails(cw_mesh_read(test_path(name), &desc, &back, NULL, &err), CW_ERR_CANCELLED,
                     "", err);
    }
    cw_mesh_free(&mesh);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    const char *name;
    cw_mesh mesh = {0};
    cw_error err = {0};
    make_full_mesh(&mesh);
    for (size_t i = 0; written(i, &name); i++) {
        assert_ok(cw_mesh_write(test_path(name), &mesh, NULL, &err), err);
        check_starved_mesh_reads(name);
    }
    cw_mesh_free(&mesh);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(local_files_come_back_to_the_bit),
        TEST(files_of_the_world_come_back_where_they_were),
        TEST(a_local_stl_file_keeps_every_corner),
        TEST(a_far_obj_file_keeps_its_shape),
        TEST(content_decides_then_the_extension),
        TEST(line_ends_of_every_kind_are_read),
        TEST(a_binary_file_may_have_an_old_header),
        TEST(limits_hold),
        TEST(reading_may_be_stopped),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
