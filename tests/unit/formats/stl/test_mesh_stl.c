/* STL read: both forms, and what is neither. */
#include "support/meshes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A facet's 50 bytes: its corners, and a normal that is wrong. */
static void put_facet(char *to, const float corners[9])
{
    const float normal[3] = {NAN, 7, 0};
    memcpy(to, normal, 12);
    memcpy(to + 12, corners, 36);
    memset(to + 48, 0, 2);
}

static const float two_facets[2][9] = {{0, 0, 0, 1, 0, 0, 0, 1, 0},
                                       {1, 0, 0, 1, 1, 0, 0, 1, 0}};
static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
static const uint32_t triangles[6] = {0, 1, 2, 1, 3, 2};

/* A binary file of two facets that share an edge; the count is as told. */
static size_t make_binary(char bytes[200], const char *header, unsigned count)
{
    memset(bytes, 0, 200);
    memcpy(bytes, header, strlen(header));
    bytes[80] = (char)(count & 255);
    bytes[83] = (char)(count >> 24);
    for (size_t t = 0; t < 2; t++)
        put_facet(bytes + 84 + 50 * t, two_facets[t]);
    return 184;
}

static void corners_at_one_place_become_one_vertex(void **state)
{
    (void)state;
    static const char *const headers[] = {"made by hand", "solid, but binary", ""};
    for (size_t i = 0; i < 3; i++) {
        char bytes[200];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        const size_t size = make_binary(bytes, headers[i], 2);
        assert_ok(read_bytes("a.bin", bytes, size, &mesh, &file, &err), err);
        assert_string_equal(file.format, "stl");
        assert_int_equal(file.known, 0);
        check_positions(&mesh, 4, points);
        check_triangles(&mesh, 2, triangles);
        assert_null(mesh.normals);
        cw_mesh_free(&mesh);
    }
}

/* -0 and 0 are one place; a facet without area stays, and so does one that is there twice. */
static void flat_facets_are_kept(void **state)
{
    (void)state;
    static const float facets[2][9] = {{0, 0, 0, -0.0f, 0, 0, 0, 1, 0},
                                       {0, 0, 0, -0.0f, 0, 0, 0, 1, 0}};
    static const uint32_t wanted[6] = {0, 0, 1, 0, 0, 1};
    char bytes[200];
    cw_mesh mesh;
    cw_error err = {0};
    const size_t size = make_binary(bytes, "flat", 2);
    for (size_t t = 0; t < 2; t++)
        put_facet(bytes + 84 + 50 * t, facets[t]);
    assert_ok(read_bytes("a.stl", bytes, size, &mesh, NULL, &err), err);
    assert_int_equal(mesh.vertex_count, 2);
    check_triangles(&mesh, 2, wanted);
    cw_mesh_free(&mesh);
}

static void binary_files_must_hold_what_they_count(void **state)
{
    (void)state;
    char bytes[200];
    cw_mesh mesh;
    cw_error err = {0};
    size_t size = make_binary(bytes, "cut", 3);
    assert_fails(read_bytes("a.stl", bytes, size + 1, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "the header counts 3 facets; the file has room for 2", err);
    size = make_binary(bytes, "huge", 0xff000000u);
    assert_fails(read_bytes("a.stl", bytes, size + 1, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "counts 4278190080 facets", err);
    assert_fails(read_bytes("a.stl", bytes, 50, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "the file ends within the header", err);
    size = make_binary(bytes, "nan", 2);
    const float broken = -INFINITY;
    memcpy(bytes + 84 + 50 + 12 + 16, &broken, 4);
    assert_fails(read_bytes("a.stl", bytes, size, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "'y' of corner 1 of facet 1 is -inf", err);
}

/* Whole facets behind the header count more than it does, one way or the other. */
static void the_size_decides_where_the_header_counts_wrong(void **state)
{
    (void)state;
    static const uint32_t counts[] = {0, 1, 3, 200, 0xff0000ffu};
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        char bytes[200];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        const size_t size = make_binary(bytes, "wrong", counts[n]);
        assert_ok(read_bytes("a.stl", bytes, size, &mesh, &file, &err), err);
        assert_int_equal(mesh.triangle_count, 2);
        assert_true(file.miscounted && !file.truncated);
        assert_int_equal(file.expected_triangles, counts[n]);
        cw_mesh_free(&mesh);
    }
}

/* Bytes behind each facet, as many as it states; a tail that is no facet belongs to none. */
static void attributes_behind_facets_are_left_out(void **state)
{
    (void)state;
    for (int more = 1; more < 60; more += 7) {
        char bytes[400], plain[200];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_binary(plain, "attributes", 2);
        memset(bytes, 0x7f, sizeof bytes);
        memcpy(bytes, plain, 84);
        size_t at = 84;
        for (int t = 0; t < 2; t++) {
            memcpy(bytes + at, plain + 84 + 50 * t, 50);
            bytes[at + 48] = (char)(more * (t + 1));
            at += 50 + (size_t)more * (size_t)(t + 1);
        }
        assert_ok(read_bytes("a.stl", bytes, at, &mesh, &file, &err), err);
        assert_int_equal(mesh.triangle_count, 2);
        assert_int_equal(file.attribute_bytes, 3 * more);
        assert_true(mesh.vertex_count >= 3 && fabsf(mesh.positions[0]) < 1e6f);
        cw_mesh_free(&mesh);
    }
}

/* Reads a file with `truncated`, and checks the facets and what the file tells. */
static void check_cut(const char *bytes, size_t size, size_t facets, size_t expected)
{
    const cw_mesh_read_desc desc = {.truncated = true};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    test_file_write(test_path("a.stl"), bytes, size);
    assert_ok(cw_mesh_read(test_path("a.stl"), &desc, &mesh, &file, &err), err);
    assert_int_equal(mesh.triangle_count, facets);
    assert_true(file.truncated == (expected != facets));
    assert_int_equal(file.expected_triangles, file.truncated ? expected : 0);
    cw_mesh_free(&mesh);
}

static void whole_facets_of_a_binary_file_that_breaks_off_are_taken(void **state)
{
    (void)state;
    char bytes[200];
    cw_mesh mesh;
    cw_error err = {0};
    static const char *const headers[] = {"cut", "solid cut"};
    for (int n = 0; n < 2; n++) {
        const size_t size = make_binary(bytes, headers[n], 2);
        check_cut(bytes, size, 2, 2);
        check_cut(bytes, size - 1, 1, 2);
        check_cut(bytes, size - 50, 1, 2);
        assert_fails(read_bytes("a.stl", bytes, size - 1, &mesh, NULL, &err), CW_ERR_FORMAT,
                     "room for 1; desc->truncated takes those", err);
        assert_fails(read_bytes("a.stl", bytes, size - 51, &mesh, NULL, &err), CW_ERR_FORMAT,
                     "room for 0", err);
        assert_null(strstr(err.message, "truncated"));
    }
}

/* Wherever a text ends. */
static void whole_facets_of_a_text_that_breaks_off_are_taken(void **state)
{
    (void)state;
    static const char facet[] =
        "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n"
        "  vertex 0 1 0\n endloop\nendfacet\n";
    const size_t length = sizeof facet - 1, first = strlen("solid a\n");
    char text[1024];
    cw_error err = {0};
    const size_t size =
        (size_t)snprintf(text, sizeof text, "solid a\n%s%s%sendsolid a\n", facet, facet, facet);
    for (size_t cut = first; cut < size; cut++) {
        const cw_mesh_read_desc desc = {.truncated = true};
        /* a facet is whole with its last word, though its line does not end */
        const size_t whole = (cut - first + 1) / length;
        const bool ends = cut >= first + 3 * length + strlen("endsolid");
        cw_mesh mesh;
        cw_mesh_file file;
        test_file_write(test_path("a.stl"), text, cut);
        if (whole == 0) {
            assert_fails(cw_mesh_read(test_path("a.stl"), &desc, &mesh, NULL, &err),
                         CW_ERR_FORMAT, "line", err);
            continue;
        }
        assert_ok(cw_mesh_read(test_path("a.stl"), &desc, &mesh, &file, &err), err);
        if (mesh.triangle_count != (whole < 3 ? whole : 3) || file.truncated == ends)
            fail_msg("cut at %zu: %zu facets, truncated %d", cut, mesh.triangle_count,
                     file.truncated);
        cw_mesh_free(&mesh);
        if (!ends)
            assert_fails(cw_mesh_read(test_path("a.stl"), NULL, &mesh, NULL, &err),
                         CW_ERR_FORMAT, "desc->truncated takes the", err);
    }
    text[first + length + 2] =
        'x'; /* takes a word that is wrong in the middle, which is refused all the same */
    test_file_write(test_path("a.stl"), text, size);
    cw_mesh mesh;
    assert_fails(cw_mesh_read(test_path("a.stl"), &(cw_mesh_read_desc){.truncated = true},
                              &mesh, NULL, &err),
                 CW_ERR_FORMAT, "facet or endsolid", err);
    assert_null(strstr(err.message, "truncated"));
}

/* Bytes behind the last facet, which some programs leave, are left alone. */
static void no_facets_and_a_tail_are_allowed(void **state)
{
    (void)state;
    char bytes[200];
    cw_mesh mesh;
    cw_error err = {0};
    make_binary(bytes, "none", 0);
    assert_ok(read_bytes("a.stl", bytes, 84, &mesh, NULL, &err), err);
    assert_int_equal(mesh.vertex_count + mesh.triangle_count, 0);
    assert_usable(&mesh);
    cw_mesh_free(&mesh);
    make_binary(bytes, "one, and a tail", 1);
    memset(bytes + 134, 0xff, 50);
    assert_ok(read_bytes("a.stl", bytes, 184, &mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, 1);
    cw_mesh_free(&mesh);
}

#define FACET(normal, p, q, r)                                                                 \
    "facet normal " normal "\n outer loop\n  vertex " p "\n  vertex " q "\n  vertex " r        \
    "\n endloop\nendfacet\n"
#define ONE FACET("0 0 1", "0 0 0", "1 0 0", "0 1 0")
#define TWO FACET("nan nan nan", "1 0 0", "1 1.0e0 -0", "0 +1 .0")

static void text_is_read_in_every_shape(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "solid a name of words\n" ONE TWO "endsolid a name of words\n",
        "  solid\n" ONE "endsolid\n\n solid\n" TWO "endsolid",
        "SOLID x\r\n" ONE "\r\n\tFACET NORMAL 0 0 1 OUTER LOOP VERTEX 1 0 0 Vertex 1 1 0\r\n"
        "VERTEX 0 1 0 ENDLOOP ENDFACET EndSolid\r\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        assert_ok(read_text("a.txt", texts[i], &mesh, &file, &err), err);
        assert_string_equal(file.format, "stl");
        check_positions(&mesh, 4, points);
        check_triangles(&mesh, 2, triangles);
        cw_mesh_free(&mesh);
    }
}

static void broken_text_is_told_by_line(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"solid\n", "the file ends before the next word; facet or endsolid was expected"},
        {"solid\n" ONE, "the file ends before the next word"},
        {"solid\nfacet normal 0 0\nouter loop", "outer was expected"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n",
         "line 4: a coordinate is 'x'; a number was expected"},
        {"solid\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 1e39 0"), "'y' of corner 2 of facet 0"},
        {"solid\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 nan 0"), "is nan; it must be finite"},
        {"solid\n" FACET("0 0 1", "0 0 0", "1 0 0", "0 1 0\n vertex 1 1 1"),
         "line 7: the next word is 'vertex'; endloop was expected"},
        {"solid\n" ONE "endsolid\njunk",
         "line 10: the next word is 'junk'; solid was expected"},
        {"solid\n" ONE "endfacet\n", "facet or endsolid was expected"},
        {"solid\nfacet normal "
         "1111111111111111111111111111111111111111111111111111111111111111111"
         "1111111111111111111111111111111111111111111111111111111111111111111111111111111111111"
         "1"
         "1111111111111111111111111111111111111111111111111111111111111111111111111111111111111"
         "1"
         "11111111111111111111111111111111111111111111111111111",
         "a word of more than 255 bytes"},
    };
    check_refused("a.stl", rows, sizeof rows / sizeof *rows);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(corners_at_one_place_become_one_vertex),
        TEST(flat_facets_are_kept),
        TEST(binary_files_must_hold_what_they_count),
        TEST(the_size_decides_where_the_header_counts_wrong),
        TEST(attributes_behind_facets_are_left_out),
        TEST(whole_facets_of_a_binary_file_that_breaks_off_are_taken),
        TEST(whole_facets_of_a_text_that_breaks_off_are_taken),
        TEST(no_facets_and_a_tail_are_allowed),
        TEST(text_is_read_in_every_shape),
        TEST(broken_text_is_told_by_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
