/* Tests the writer of PLY: all arrays of a mesh, the header, text, and origins. */
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A PLY file read the simple way: property lines in order, then fixed records. */
typedef struct ply {
    char *bytes;
    size_t size, vertex_count, face_count, stride;
    char header[1024];
    const unsigned char *vertices, *faces;
} ply;

static size_t number_after(const char *text, const char *words)
{
    const char *at = strstr(text, words);
    assert_non_null(at);
    return strtoull(at + strlen(words), NULL, 10);
}

static size_t stride_of(const char *header)
{
    size_t bytes = 0;
    for (const char *at = strstr(header, "\nproperty "); at; at = strstr(at + 1, "\nproperty "))
        bytes += strncmp(at, "\nproperty list", 14) == 0    ? 0
                 : strncmp(at, "\nproperty uchar", 15) == 0 ? 1
                                                            : 4;
    return bytes;
}

static void ply_read(ply *p, const char *path)
{
    size_t size;
    char *bytes = test_file_read(path, &size);
    *p = (ply){.bytes = bytes, .size = size};
    const char *end = strstr(p->bytes, "end_header\n");
    assert_non_null(end);
    const size_t length = (size_t)(end - p->bytes) + strlen("end_header\n");
    assert_true(length < sizeof p->header);
    memcpy(p->header, p->bytes, length);
    p->vertex_count = number_after(p->header, "\nelement vertex ");
    p->face_count = number_after(p->header, "\nelement face ");
    p->stride = stride_of(p->header);
    p->vertices = (unsigned char *)p->bytes + length;
    p->faces = p->vertices + p->vertex_count * p->stride;
    assert_int_equal(length + p->vertex_count * p->stride + p->face_count * 13, p->size);
}

static uint32_t u32_at(const unsigned char *b)
{
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static float f32_at(const unsigned char *b)
{
    const uint32_t bits = u32_at(b);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void give_attributes(cw_mesh *mesh)
{
    const size_t n = mesh->vertex_count;
    mesh->scalars = malloc(n * sizeof *mesh->scalars);
    mesh->labels = malloc(n * sizeof *mesh->labels);
    mesh->colors = malloc(4 * n);
    assert_true(mesh->scalars && mesh->labels && mesh->colors);
    for (size_t v = 0; v < n; v++) {
        mesh->scalars[v] = (float)v / 3.0f;
        mesh->labels[v] = 4000000000u + (uint32_t)v;
        for (size_t c = 0; c < 4; c++)
            mesh->colors[4 * v + c] = (uint8_t)(60 * c + v);
    }
}

static void everything_a_mesh_holds_comes_back(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    ply p;
    test_make_cube(&mesh);
    give_attributes(&mesh);
    mesh.origin[2] = 0.1;
    assert_ok(cw_mesh_write(test_path("a.ply"), &mesh, NULL, &err), err);
    ply_read(&p, test_path("a.ply"));
    assert_int_equal(p.vertex_count, 8);
    assert_int_equal(p.face_count, 12);
    assert_int_equal(p.stride, 12 + 12 + 4 + 4 + 4);
    for (size_t v = 0; v < 8; v++) {
        const unsigned char *b = p.vertices + v * p.stride;
        for (size_t a = 0; a < 3; a++) {
            const float coordinate =
                (float)(mesh.origin[a] + (double)mesh.positions[3 * v + a]);
            assert_true(f32_at(b + 4 * a) == coordinate);
            assert_true(f32_at(b + 12 + 4 * a) == mesh.normals[3 * v + a]);
        }
        assert_memory_equal(b + 24, mesh.colors + 4 * v, 4);
        assert_true(f32_at(b + 28) == mesh.scalars[v]);
        assert_int_equal(u32_at(b + 32), mesh.labels[v]);
    }
    for (size_t t = 0; t < 12; t++) {
        assert_int_equal(p.faces[13 * t], 3);
        for (size_t c = 0; c < 3; c++)
            assert_int_equal(u32_at(p.faces + 13 * t + 1 + 4 * c), mesh.triangles[3 * t + c]);
    }
    free(p.bytes);
    cw_mesh_free(&mesh);
}

static void only_what_is_there_is_written(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    ply p;
    test_make_tetrahedron(&mesh);
    free(mesh.normals);
    mesh.normals = NULL;
    assert_ok(cw_mesh_write(test_path("a.ply"), &mesh, NULL, &err), err);
    ply_read(&p, test_path("a.ply"));
    assert_int_equal(p.stride, 12);
    assert_null(strstr(p.header, "nx"));
    assert_null(strstr(p.header, "red"));
    assert_null(strstr(p.header, "scalar"));
    free(p.bytes);
    cw_mesh_free(&mesh);
}

static void the_header_is_as_the_format_wants_it(void **state)
{
    (void)state;
    static const char expected[] =
        "ply\nformat binary_little_endian 1.0\n"
        "comment cubewright " CW_VERSION "\ncomment object skull\ncomment unit mm\n"
        "comment frame LPS\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    cw_mesh mesh = {0};
    cw_error err = {0};
    ply p;
    test_make_tetrahedron(&mesh);
    const cw_write_desc desc = {.name = "skull"};
    assert_ok(cw_mesh_write(test_path("a.ply"), &mesh, &desc, &err), err);
    ply_read(&p, test_path("a.ply"));
    assert_string_equal(p.header, expected);
    free(p.bytes);
    cw_mesh_free(&mesh);
}

static void a_local_file_holds_positions_and_names_the_origin(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    ply p;
    test_make_far_sphere(&mesh);
    assert_ok(cw_mesh_write(test_path("a.ply"), &mesh, &(cw_write_desc){.local = true}, &err),
              err);
    ply_read(&p, test_path("a.ply"));
    assert_non_null(strstr(
        p.header, "\ncomment frame LPS\ncomment origin 1000003.2 1000003.2 1000160\nelement"));
    assert_int_equal(p.vertex_count, mesh.vertex_count);
    for (size_t i = 0; i < 3 * p.vertex_count; i++)
        assert_true(f32_at(p.vertices + i / 3 * p.stride + i % 3 * 4) == mesh.positions[i]);
    free(p.bytes);
    cw_mesh_free(&mesh);
}

static void text_holds_the_same_numbers(void **state)
{
    (void)state;
    const cw_write_desc desc = {.text = true};
    cw_mesh mesh = {0}, back;
    cw_error err = {0};
    size_t size;
    test_make_cube(&mesh);
    give_attributes(&mesh);
    for (size_t i = 0; i < 24; i++)
        mesh.positions[i] = 1.0f / (float)(i + 3) - 0.1f * (float)i;
    mesh.scalars[3] = NAN;
    assert_ok(cw_mesh_write(test_path("a.ply"), &mesh, &desc, &err), err);
    char *text = test_file_read(test_path("a.ply"), &size);
    assert_memory_equal(text, "ply\nformat ascii 1.0\n", 21);
    free(text);
    assert_ok(cw_mesh_read(test_path("a.ply"), NULL, &back, NULL, &err), err);
    assert_memory_equal(back.positions, mesh.positions, 24 * sizeof(float));
    assert_memory_equal(back.normals, mesh.normals, 24 * sizeof(float));
    assert_memory_equal(back.colors, mesh.colors, 32);
    assert_memory_equal(back.labels, mesh.labels, 32);
    assert_memory_equal(back.triangles, mesh.triangles, 144);
    for (size_t v = 0; v < 8; v++)
        assert_true(back.scalars[v] == mesh.scalars[v] || (v == 3 && isnan(back.scalars[v])));
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(everything_a_mesh_holds_comes_back),
        CASE(only_what_is_there_is_written),
        CASE(the_header_is_as_the_format_wants_it),
        CASE(text_holds_the_same_numbers),
        CASE(a_local_file_holds_positions_and_names_the_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
