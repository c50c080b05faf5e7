/* Colours of STL facets: two conventions in the same 16 bits, and words that are no colours. */
#include "support/meshes.h"

#include <stdio.h>

enum { FACETS = 3, SIZE = 84 + 50 * FACETS };

/* A strip of three facets, whose words are given. */
static void make_strip(const char *header, size_t header_size, const uint16_t words[FACETS],
                       unsigned char bytes[SIZE])
{
    memset(bytes, 0, SIZE);
    memcpy(bytes, header, header_size);
    bytes[80] = FACETS;
    for (size_t t = 0; t < FACETS; t++) {
        float corners[9];
        for (size_t k = 0; k < 3; k++) {
            corners[3 * k] = (float)(t + k);
            corners[3 * k + 1] = (float)((t + k) % 2);
            corners[3 * k + 2] = 0;
        }
        unsigned char *at = bytes + 84 + 50 * t;
        memcpy(at + 12, corners, sizeof corners);
        at[48] = (unsigned char)words[t];
        at[49] = (unsigned char)(words[t] >> 8);
    }
}

static const uint8_t *face_colors(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_FACE_COLORS);
    return row ? row->data : NULL;
}

typedef struct row {
    const char *header;
    size_t header_size;
    uint16_t words[FACETS];
    uint8_t colors[4 * FACETS];
    const char *left_out;
} row;

static void check_row(const row *r, bool has_colors)
{
    unsigned char bytes[SIZE];
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    make_strip(r->header, r->header_size, r->words, bytes);
    assert_ok(read_bytes("a.stl", bytes, sizeof bytes, &mesh, &file, &err), err);
    assert_int_equal(mesh.triangle_count, FACETS);
    assert_true((face_colors(&mesh) != NULL) == has_colors);
    if (has_colors)
        assert_memory_equal(face_colors(&mesh), r->colors, sizeof r->colors);
    assert_string_equal(file.left_out, r->left_out ? r->left_out : "");
    assert_null(mesh.colors);
    cw_mesh_free(&mesh);
}

static void viscam_sets_bit_15_of_colours(void **state)
{
    (void)state;
    static const row rows[] = {
        {"",
         0,
         {0xfc00, 0x83e0, 0x801f},
         {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255},
         NULL},
        {"solid viscam",
         12,
         {0, 0x8000, 0x8421}, /* the first has none */
         {255, 255, 255, 255, 0, 0, 0, 255, 8, 8, 8, 255},
         NULL},
        {"COLOR",
         5,
         {0xc210, 0xc210, 0xc210},
         {132, 132, 132, 255, 132, 132, 132, 255, 132, 132, 132, 255},
         NULL},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        check_row(&rows[n], true);
}

static void magics_states_the_colour_of_the_object(void **state)
{
    (void)state;
    static const row rows[] = {
        {"COLOR=\x0a\x14\x1e\xff",
         10,
         {0x001f, 0x7c00, 0xffff},
         {255, 0, 0, 255, 0, 0, 255, 255, 10, 20, 30, 255},
         NULL},
        {"made by hand COLOR=\xff\xff\xff\x80,MATERIAL=",
         33,
         {0x8000, 0x03e0, 0},
         {255, 255, 255, 128, 0, 255, 0, 128, 0, 0, 0, 128},
         NULL},
        {"COLOR=\x01\x02\x03\x00",
         10,
         {0, 0, 0}, /* no facet has one; nothing is invisible */
         {1, 2, 3, 255, 1, 2, 3, 255, 1, 2, 3, 255},
         NULL},
        {"COLOR=\x01\x02\x03\xff",
         10,
         {0x8000, 0x8000, 0xffff},
         {1, 2, 3, 255, 1, 2, 3, 255, 1, 2, 3, 255},
         NULL},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        check_row(&rows[n], true);
    /* at the end of the header there is no room for the colour */
    row cut = {.header_size = 80};
    char header[80] = "";
    memcpy(header + 71, "COLOR=\1\2\3", 9);
    cut.header = header;
    check_row(&cut, false);
}

static void other_words_are_no_colours(void **state)
{
    (void)state;
    static const row rows[] = {
        {"", 0, {1, 2, 3}, {0}, "attributes of facets"}, /* numbers of regions */
        {"", 0, {0x8001, 0x7fff, 0}, {0}, "attributes of facets"},
        {"", 0, {0x1234, 0xabcd, 0xffff}, {0}, "attributes of facets"},
        {"", 0, {0xffff, 0xffff, 0xffff}, {0}, NULL}, /* white: as good as none */
        {"", 0, {0, 0, 0}, {0}, NULL},
        {"COLOR=\xff\xff\xff\xff", 10, {0xffff, 0x8000, 0xffff}, {0}, NULL},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        check_row(&rows[n], false);
}

static uint8_t *add_face_colors(cw_mesh *mesh)
{
    static const cw_attribute like = {.name = CW_FACE_COLORS,
                                      .on = CW_ON_TRIANGLES,
                                      .type = CW_U8,
                                      .components = 4,
                                      .interpolation = CW_INTERPOLATE_COLOR};
    cw_attribute *added = NULL;
    cw_error err = {0};
    assert_ok(cw_mesh_attribute_add(mesh, &like, &added, &err), err);
    return added->data;
}

/* All 32 levels come back to the bit, the first time and after that. */
static void written_colours_come_back(void **state)
{
    (void)state;
    for (unsigned first = 0; first < 32; first += 5) {
        cw_mesh mesh, back;
        cw_error err = {0};
        cw_write_loss loss;
        test_make_cube(&mesh);
        uint8_t *colors = add_face_colors(&mesh);
        for (size_t i = 0; i < 4 * mesh.triangle_count; i++)
            colors[i] = i % 4 == 3 ? 255 : (uint8_t)(((first + i) % 32 * 255 + 15) / 31);
        assert_ok(cw_mesh_write_loss("a.stl", &mesh, NULL, &loss, &err), err);
        assert_int_equal(loss.dropped, CW_KEEPS_SHARING | CW_KEEPS_NORMALS);
        assert_int_equal(loss.rounded_colors, 0);
        assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, NULL, &err), err);
        assert_ok(cw_mesh_read(test_path("a.stl"), NULL, &back, NULL, &err), err);
        assert_non_null(face_colors(&back));
        assert_memory_equal(face_colors(&back), colors, 4 * mesh.triangle_count);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

static void colours_that_are_rounded_or_lost_are_told(void **state)
{
    (void)state;
    cw_mesh mesh, back;
    cw_error err = {0};
    cw_write_loss loss;
    const cw_write_desc text = {.text = true};
    const unsigned always = CW_KEEPS_SHARING | CW_KEEPS_NORMALS;
    test_make_cube(&mesh);
    uint8_t *colors = add_face_colors(&mesh);
    memset(colors, 255, 4 * mesh.triangle_count);
    memcpy(colors, (uint8_t[8]){1, 0, 0, 255, 255, 200, 100, 99}, 8);
    assert_ok(cw_mesh_write_loss("a.stl", &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.rounded_colors, 2);
    assert_int_equal(loss.dropped, always | CW_KEEPS_OPACITY);
    assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, NULL, &err), err);
    assert_ok(cw_mesh_read(test_path("a.stl"), NULL, &back, NULL, &err), err);
    assert_memory_equal(face_colors(&back), ((uint8_t[8]){0, 0, 0, 255, 255, 197, 99, 255}), 8);
    cw_mesh_free(&back);
    assert_ok(cw_mesh_write_loss("a.stl", &mesh, &text, &loss, &err), err);
    assert_int_equal(loss.dropped, always | CW_KEEPS_FACE_COLORS);
    assert_int_equal(loss.rounded_colors, 0);
    assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, &text, &err), err);
    assert_ok(cw_mesh_read(test_path("a.stl"), NULL, &back, NULL, &err), err);
    assert_null(face_colors(&back));
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

/* Without colours of faces the words are 0, also where vertices have colours. */
static void meshes_without_colours_have_no_words(void **state)
{
    (void)state;
    for (int colored = 0; colored < 2; colored++) {
        cw_mesh mesh;
        cw_error err = {0};
        size_t size;
        test_make_cube(&mesh);
        mesh.colors = colored ? calloc(4, mesh.vertex_count) : NULL;
        assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, NULL, &err), err);
        char *bytes = test_file_read(test_path("a.stl"), &size);
        for (size_t t = 0; t < mesh.triangle_count; t++)
            assert_int_equal(bytes[84 + 50 * t + 48] | bytes[84 + 50 * t + 49], 0);
        free(bytes);
        cw_mesh_free(&mesh);
    }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const uint16_t words[FACETS] = {0x8001, 0, 0x9234};
    unsigned char bytes[SIZE];
    make_strip("", 0, words, bytes);
    test_file_write(test_path("a.stl"), bytes, sizeof bytes);
    check_starved_mesh_reads("a.stl");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(viscam_sets_bit_15_of_colours),
        TEST(magics_states_the_colour_of_the_object),
        TEST(other_words_are_no_colours),
        TEST(written_colours_come_back),
        TEST(colours_that_are_rounded_or_lost_are_told),
        TEST(meshes_without_colours_have_no_words),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
