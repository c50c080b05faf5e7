/* glTF written: arrays to the bit, frames and units, colours, provenance, sizes. */
#define _GNU_SOURCE /* fork, setrlimit */
#include "support/support.h"

#include "core/base/module.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/mesh/mesh_writer.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* A GLB taken apart: header, JSON chunk, binary chunk. JSON is searched as text: tinygltf sorts
 * its keys, so what we look for has one spelling. */
typedef struct glb {
    char *bytes;
    size_t size;
    char *json; /* own copy, ended with a zero */
    const unsigned char *bin;
    size_t bin_size;
} glb;

static uint32_t u32_at(const void *bytes)
{
    const unsigned char *b = bytes;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static float f32_at(const void *bytes)
{
    const uint32_t bits = u32_at(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void glb_read(glb *g, const char *path)
{
    size_t size;
    char *bytes = test_file_read(path, &size);
    *g = (glb){.bytes = bytes, .size = size};
    assert_memory_equal(bytes, "glTF", 4);
    assert_int_equal(u32_at(bytes + 4), 2);
    assert_int_equal(u32_at(bytes + 8), size);
    const size_t json_size = u32_at(bytes + 12);
    assert_memory_equal(bytes + 16, "JSON", 4);
    assert_int_equal(json_size % 4, 0);
    g->json = calloc(json_size + 1, 1);
    assert_non_null(g->json);
    memcpy(g->json, bytes + 20, json_size);
    g->bin_size = u32_at(bytes + 20 + json_size);
    assert_memory_equal(bytes + 24 + json_size, "BIN\0", 4);
    g->bin = (unsigned char *)bytes + 28 + json_size;
    assert_int_equal(28 + json_size + g->bin_size, size);
}

static void glb_free(glb *g)
{
    free(g->bytes);
    free(g->json);
}

/* The numbers of the first array called key behind the first occurrence of the words. */
static void json_numbers(const char *json, const char *words, const char *key, int count,
                         double *numbers)
{
    char name[32];
    snprintf(name, sizeof name, "\"%s\":[", key);
    const char *at = strstr(json, words);
    assert_non_null(at);
    at = strstr(at, name);
    assert_non_null(at);
    at += strlen(name);
    for (int i = 0; i < count; i++) {
        char *end;
        numbers[i] = strtod(at, &end);
        assert_true(end != at && *end == (i + 1 < count ? ',' : ']'));
        at = end + 1;
    }
}

/* y = q x conj(q), for a unit quaternion x y z w. */
static void rotate(const double q[4], const double x[3], double y[3])
{
    double t[3];
    for (int a = 0; a < 3; a++)
        t[a] = 2 * (q[(a + 1) % 3] * x[(a + 2) % 3] - q[(a + 2) % 3] * x[(a + 1) % 3]);
    for (int a = 0; a < 3; a++)
        y[a] = x[a] + q[3] * t[a] + q[(a + 1) % 3] * t[(a + 2) % 3] -
               q[(a + 2) % 3] * t[(a + 1) % 3];
}

static void write_glb_as(const cw_mesh *mesh, const cw_write_desc *desc, glb *g)
{
    cw_error err = {0};
    assert_ok(cw_mesh_write(test_path("a.glb"), mesh, desc, &err), err);
    glb_read(g, test_path("a.glb"));
}

static void write_glb(const cw_mesh *mesh, glb *g)
{
    write_glb_as(mesh, NULL, g);
}

static void arrays_come_back_to_the_bit(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    glb g;
    test_make_cube(&mesh);
    for (size_t i = 0; i < 24; i++)
        mesh.positions[i] = 0.1f * (float)(i + 1);
    write_glb(&mesh, &g);
    assert_int_equal(g.bin_size, 36 * 2 + 96 + 96);
    for (size_t i = 0; i < 36; i++)
        assert_int_equal(g.bin[2 * i] | g.bin[2 * i + 1] << 8, mesh.triangles[i]);
    for (size_t i = 0; i < 24; i++) {
        assert_true(f32_at(g.bin + 72 + 4 * i) == mesh.positions[i]);
        assert_true(f32_at(g.bin + 72 + 96 + 4 * i) == mesh.normals[i]);
    }
    glb_free(&g);
    cw_mesh_free(&mesh);
}

static void bounds_are_the_stored_floats_exactly(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    double low[3], high[3];
    glb g;
    test_make_cube(&mesh);
    for (size_t i = 0; i < 24; i++)
        mesh.positions[i] = (mesh.positions[i] - 0.3f) * (1.0f / 3.0f);
    write_glb(&mesh, &g);
    json_numbers(g.json, "\"accessors\"", "min", 3, low);
    json_numbers(g.json, "\"accessors\"", "max", 3, high);
    for (int a = 0; a < 3; a++) {
        assert_true(low[a] == (double)mesh.positions[a]);
        assert_true(high[a] == (double)mesh.positions[21 + a]);
    }
    glb_free(&g);
    cw_mesh_free(&mesh);
}

/* Head up is +Y, the face looks along +Z, the patient's left is +X; metres. */
static void the_node_turns_lps_millimetres_into_gltf_metres(void **state)
{
    (void)state;
    static const double lps[3][3] = {{1000, 0, 0}, {0, -1000, 0}, {0, 0, 1000}};
    static const double gltf[3][3] = {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
    cw_mesh mesh = {0};
    double rotation[4], scale[3], move[3];
    glb g;
    test_make_cube(&mesh);
    mesh.origin[0] = 1e6 + 0.125;
    mesh.origin[1] = 2e6 + 0.0625;
    mesh.origin[2] = -3e6;
    write_glb(&mesh, &g);
    json_numbers(g.json, "\"nodes\"", "rotation", 4, rotation);
    json_numbers(g.json, "\"nodes\"", "scale", 3, scale);
    json_numbers(g.json, "\"nodes\"", "translation", 3, move);
    for (int i = 0; i < 3; i++) {
        double turned[3];
        rotate(rotation, lps[i], turned);
        for (int a = 0; a < 3; a++)
            assert_near(scale[a] * turned[a], gltf[i][a], 1e-12);
    }
    assert_true(move[0] == 0.001 * mesh.origin[0]);
    assert_true(move[1] == 0.001 * mesh.origin[2]);
    assert_true(move[2] == -0.001 * mesh.origin[1]);
    glb_free(&g);
    cw_mesh_free(&mesh);
}

/* POSITION and indices as a reader has them make the mesh again, however far it stands. */
static void a_far_mesh_loses_nothing(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    cw_write_loss loss;
    glb g;
    test_make_far_sphere(&mesh);
    assert_ok(cw_mesh_write_loss(test_path("a.glb"), &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.merged_vertices + loss.flat_triangles, 0);
    write_glb(&mesh, &g);
    const size_t indices = 3 * mesh.triangle_count;
    assert_true(mesh.vertex_count <= 65535 && indices % 2 == 0);
    cw_mesh back = {.vertex_count = mesh.vertex_count, .triangle_count = mesh.triangle_count};
    back.positions = malloc(12 * mesh.vertex_count);
    back.triangles = malloc(4 * indices);
    assert_true(back.positions && back.triangles);
    for (size_t i = 0; i < indices; i++)
        back.triangles[i] = g.bin[2 * i] | (uint32_t)g.bin[2 * i + 1] << 8;
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        back.positions[i] = f32_at(g.bin + 2 * indices + 4 * i);
    assert_memory_equal(back.positions, mesh.positions, 12 * mesh.vertex_count);
    assert_ok(cw_quality_measure(&back, &(cw_quality_desc){.weld = CW_WELD_WORLD}, &q, &err),
              err);
    assert_true(cw_quality_is_closed_manifold(&q));
    assert_int_equal(q.degenerate, 0);
    assert_int_equal(q.unused_vertices + q.merged_vertices, 0);
    glb_free(&g);
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

static void a_local_scene_is_not_moved_but_tells_its_origin(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    double origin[3];
    glb g;
    test_make_cube(&mesh);
    for (int a = 0; a < 3; a++)
        mesh.origin[a] = 1e6 / (a + 3);
    write_glb_as(&mesh, &(cw_write_desc){.local = true}, &g);
    assert_null(strstr(g.json, "translation"));
    json_numbers(g.json, "\"extras\"", "origin", 3, origin);
    assert_memory_equal(origin, mesh.origin, sizeof origin);
    glb_free(&g);
    write_glb(&mesh, &g);
    assert_null(strstr(g.json, "\"origin\""));
    glb_free(&g);
    cw_mesh_free(&mesh);
}

static void indices_are_short_as_long_as_they_may_be(void **state)
{
    (void)state;
    for (size_t count = 65535; count <= 65536; count++) {
        cw_mesh mesh = {.vertex_count = count, .triangle_count = 1};
        glb g;
        mesh.positions = calloc(count, 12);
        mesh.triangles = calloc(1, 12);
        assert_true(mesh.positions && mesh.triangles);
        mesh.triangles[1] = 1;
        mesh.triangles[2] = (uint32_t)count - 1;
        write_glb(&mesh, &g);
        const bool is_short = count == 65535;
        assert_non_null(strstr(g.json, is_short ? "\"componentType\":5123,\"count\":3,"
                                                : "\"componentType\":5125,\"count\":3,"));
        assert_int_equal(g.bin_size, (is_short ? 8 : 12) + 12 * count);
        assert_int_equal(is_short ? g.bin[4] | g.bin[5] << 8 : (int)u32_at(g.bin + 8),
                         count - 1);
        glb_free(&g);
        cw_mesh_free(&mesh);
    }
}

/* Eight bits are enough for these, so that more would be waste. */
static void colours_become_linear_and_translucent_ones_blend(void **state)
{
    (void)state;
    static const uint8_t srgb[4][4] = {
        {0, 255, 128, 255}, {99, 200, 158, 255}, {188, 200, 158, 255}, {99, 98, 96, 255}};
    static const uint8_t linear[4][4] = {
        {0, 255, 55, 255}, {32, 147, 87, 255}, {128, 147, 87, 255}, {32, 31, 30, 255}};
    cw_mesh mesh = {0};
    glb g;
    test_make_tetrahedron(&mesh);
    mesh.colors = malloc(16);
    assert_non_null(mesh.colors);
    memcpy(mesh.colors, srgb, 16);
    write_glb(&mesh, &g);
    assert_memory_equal(g.bin + g.bin_size - 16, linear, 16);
    assert_non_null(strstr(g.json, "\"componentType\":5121,\"count\":4,\"normalized\":true"));
    assert_null(strstr(g.json, "alphaMode"));
    glb_free(&g);
    mesh.colors[7] = 100;
    write_glb(&mesh, &g);
    assert_int_equal(g.bin[g.bin_size - 16 + 7], 100);
    assert_non_null(strstr(g.json, "\"alphaMode\":\"BLEND\""));
    glb_free(&g);
    cw_mesh_free(&mesh);
}

/* 8 bits of linear light have one step for the sRGB bytes 7 to 18. */
static void dark_colours_take_sixteen_bits(void **state)
{
    (void)state;
    static const uint8_t srgb[4][4] = {
        {0, 1, 2, 255}, {3, 5, 8, 254}, {10, 13, 14, 255}, {20, 255, 61, 0}};
    cw_mesh mesh = {0}, back;
    cw_error err = {0};
    glb g;
    test_make_tetrahedron(&mesh);
    mesh.colors = malloc(16);
    assert_non_null(mesh.colors);
    memcpy(mesh.colors, srgb, 16);
    write_glb(&mesh, &g);
    assert_non_null(strstr(g.json, "\"componentType\":5123,\"count\":4,\"normalized\":true"));
    assert_int_equal(g.bin[g.bin_size - 8] | g.bin[g.bin_size - 7] << 8, 458); /* of 20 */
    glb_free(&g);
    for (int way = 0; way <= CW_COMPRESS_MESHOPT; way += CW_COMPRESS_MESHOPT) {
        const cw_write_desc desc = {.compression = (cw_compression)way};
        assert_ok(cw_mesh_write(test_path("dark.glb"), &mesh, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path("dark.glb"), NULL, &back, NULL, &err), err);
        for (size_t v = 0; v < 4; v++) {
            bool found = false;
            for (size_t n = 0; n < 4; n++)
                found = found || memcmp(back.colors + 4 * n, srgb[v], 4) == 0;
            assert_true(found);
        }
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

static void provenance_stands_in_the_asset(void **state)
{
    (void)state;
    const cw_provenance lines[] = {{"isovalue", "50"}, {"quote", "a \"b\" \\ c"}};
    cw_mesh mesh = {0};
    glb g;
    test_make_cube(&mesh);
    write_glb_as(&mesh, &(cw_write_desc){.provenance = lines, .provenance_count = 2}, &g);
    assert_non_null(
        strstr(g.json, "\"extras\":{\"isovalue\":\"50\",\"quote\":\"a \\\"b\\\" \\\\ c\"}"));
    glb_free(&g);
    cw_mesh_free(&mesh);
}

static void extras_name_frame_unit_and_affine(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    double affine[12];
    glb g;
    test_make_cube(&mesh);
    write_glb(&mesh, &g);
    assert_non_null(strstr(g.json, "\"extras\":{\"frame\":\"LPS\",\"unit\":\"mm\"}"));
    assert_non_null(strstr(g.json, "\"generator\":\"cubewright " CW_VERSION "\""));
    glb_free(&g);
    for (int i = 0; i < 12; i++)
        mesh.affine[i / 4][i % 4] = 1.0 / (i + 7);
    write_glb(&mesh, &g);
    json_numbers(g.json, "\"extras\"", "affine", 12, affine);
    for (int i = 0; i < 12; i++)
        assert_true(affine[i] == 1.0 / (i + 7));
    glb_free(&g);
    cw_mesh_free(&mesh);
}

static void the_same_mesh_gives_the_same_bytes(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    glb first, second;
    test_make_cube(&mesh);
    write_glb(&mesh, &first);
    write_glb(&mesh, &second);
    assert_int_equal(first.size, second.size);
    assert_memory_equal(first.bytes, second.bytes, first.size);
    glb_free(&first);
    glb_free(&second);
    cw_mesh_free(&mesh);
}

static int base64_digit(char c)
{
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = strchr(digits, c);
    return c && at ? (int)(at - digits) : -1;
}

static void text_gltf_embeds_the_buffer_of_the_glb(void **state)
{
    (void)state;
    static const char head[] = "data:application/octet-stream;base64,";
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size, n = 0;
    glb g;
    test_make_cube(&mesh);
    write_glb(&mesh, &g);
    assert_ok(cw_mesh_write(test_path("a.gltf"), &mesh, NULL, &err), err);
    char *text = test_file_read(test_path("a.gltf"), &size);
    const char *at = strstr(text, head);
    assert_non_null(at);
    uint32_t bits = 0;
    int have = 0;
    for (at += strlen(head); base64_digit(*at) >= 0; at++) {
        bits = bits << 6 | (uint32_t)base64_digit(*at);
        have += 6;
        if (have >= 8) {
            have -= 8;
            assert_true(n < g.bin_size);
            assert_int_equal(bits >> have & 255, g.bin[n++]);
        }
    }
    assert_int_equal(n, g.bin_size);
    assert_int_equal(test_folder_entries(), 2); /* no .bin beside them */
    free(text);
    glb_free(&g);
    cw_mesh_free(&mesh);
}

/* Counted before any array is touched, so the test needs no 4 GiB. */
static void a_mesh_over_four_gigabytes_is_refused(void **state)
{
    (void)state;
    cwi_part part = {.mesh = {.vertex_count = 400000000, .triangle_count = 1}};
    const cwi_parts parts = {.items = &part, .count = 1};
    cwi_mesh_output out = {.desc = &(cw_write_desc){0}};
    cw_error err = {0};
    assert_fails(cwi_glb_write(&parts, &out, &err), CW_ERR_LIMIT, "needs 4.5 GiB", err);
    assert_fails(cwi_gltf_write(&parts, &out, &err), CW_ERR_LIMIT, "at most 4 GiB", err);
}

static int write_to_full_disk(const cw_mesh *mesh, const char *path)
{
    const struct rlimit limit = {100000, 100000};
    cw_error err = {0};
    signal(SIGXFSZ, SIG_IGN);
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0)
        return 1;
    if (cw_mesh_write(path, mesh, NULL, &err) != CW_ERR_OUTPUT)
        return 2;
    return strstr(err.message, "File too large") ? 0 : 3;
}

/* A full disk is played by a limit on the size of files, in a process of its own. */
static void a_full_disk_leaves_the_old_file_and_says_why(void **state)
{
    (void)state;
    static const char *const names[] = {"full.glb", "full.gltf"};
    cw_mesh mesh = {.vertex_count = 100000, .triangle_count = 1};
    mesh.positions = calloc(mesh.vertex_count, 12);
    mesh.triangles = calloc(1, 12);
    assert_true(mesh.positions && mesh.triangles);
    for (size_t i = 0; i < 2; i++) {
        int status;
        size_t size;
        test_file_write(test_path(names[i]), "old", 3);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0)
            _exit(write_to_full_disk(&mesh, test_path(names[i])));
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
        char *old = test_file_read(test_path(names[i]), &size);
        assert_string_equal(old, "old");
        free(old);
    }
    assert_int_equal(test_folder_entries(), 2);
    cw_mesh_free(&mesh);
}

static void a_build_without_the_module_names_the_option(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    test_make_cube(&mesh);
    assert_fails(cw_mesh_write(test_path("a.glb"), &mesh, NULL, &err), CW_ERR_UNSUPPORTED,
                 "a.glb: the gltf module is not in this build (", err);
    assert_fails(
        cw_mesh_write(test_path("a.glb"), &mesh, NULL, &err), CW_ERR_UNSUPPORTED,
        "); configure with -DCUBEWRIGHT_GLTF=ON and the Debian package libtinygltf-dev", err);
    assert_int_equal(test_folder_entries(), 0);
    cw_mesh_free(&mesh);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest without[] = {CASE(a_build_without_the_module_names_the_option)};
    const struct CMUnitTest with[] = {
        CASE(arrays_come_back_to_the_bit),
        CASE(bounds_are_the_stored_floats_exactly),
        CASE(the_node_turns_lps_millimetres_into_gltf_metres),
        CASE(a_far_mesh_loses_nothing),
        CASE(a_local_scene_is_not_moved_but_tells_its_origin),
        CASE(indices_are_short_as_long_as_they_may_be),
        CASE(colours_become_linear_and_translucent_ones_blend),
        CASE(dark_colours_take_sixteen_bits),
        CASE(provenance_stands_in_the_asset),
        CASE(extras_name_frame_unit_and_affine),
        CASE(the_same_mesh_gives_the_same_bytes),
        CASE(text_gltf_embeds_the_buffer_of_the_glb),
        CASE(a_mesh_over_four_gigabytes_is_refused),
        CASE(a_full_disk_leaves_the_old_file_and_says_why),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(with, NULL, NULL)
                                      : cmocka_run_group_tests(without, NULL, NULL);
}
