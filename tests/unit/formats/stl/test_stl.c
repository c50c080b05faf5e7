/* Tests the writer of STL: facets, normals, origins, reported loss, and text. */
#include "support/support.h"

#include "formats/mesh/mesh_writer.h"
#include "formats/stl/stl_format.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float f32_at(const char *bytes)
{
    const unsigned char *b = (const unsigned char *)bytes;
    const uint32_t bits =
        b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Corner c of facet t in a whole file; c = -1 is the normal. */
static void read_vector(const char *bytes, size_t t, int c, float vector[3])
{
    for (int a = 0; a < 3; a++)
        vector[a] = f32_at(bytes + 84 + 50 * t + 12 * (size_t)(c + 1) + 4 * (size_t)a);
}

static size_t facet_count(const char *bytes)
{
    const unsigned char *b = (const unsigned char *)bytes + 80;
    return b[0] | (size_t)b[1] << 8 | (size_t)b[2] << 16 | (size_t)b[3] << 24;
}

static void every_facet_comes_back_to_the_bit(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_cube(&mesh);
    for (int a = 0; a < 3; a++)
        mesh.origin[a] = 10.25 * (a + 1);
    assert_ok(cw_mesh_write(test_path("cube.stl"), &mesh, NULL, &err), err);
    char *bytes = test_file_read(test_path("cube.stl"), &size);
    assert_int_equal(size, 84 + 50 * 12);
    assert_int_equal(facet_count(bytes), 12);
    for (size_t t = 0; t < 12; t++)
        for (int c = 0; c < 3; c++) {
            float p[3];
            read_vector(bytes, t, c, p);
            const float *q = mesh.positions + 3 * mesh.triangles[3 * t + (size_t)c];
            for (int a = 0; a < 3; a++)
                assert_true(p[a] == (float)(mesh.origin[a] + (double)q[a]));
        }
    free(bytes);
    cw_mesh_free(&mesh);
}

static void the_header_names_frame_and_unit_and_is_not_text(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_tetrahedron(&mesh);
    assert_ok(cw_mesh_write(test_path("a.STL"), &mesh, NULL, &err), err);
    char *bytes = test_file_read(test_path("a.STL"), &size);
    assert_string_equal(bytes, "cubewright, LPS, mm");
    for (size_t t = 0; t < 4; t++)
        assert_memory_equal(bytes + 84 + 50 * t + 48, "\0\0", 2);
    free(bytes);
    cw_mesh_free(&mesh);
}

/* Right-hand rule and unit length, for the corners as written: far from zero they are on a
 * coarse grid. */
static void facet_normals_agree_with_the_corners_however_far_away(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_cube(&mesh);
    for (size_t i = 0; i < 24; i++) /* places that rounding moves */
        mesh.positions[i] *= 0.987654f;
    for (mesh.origin[1] = 0; mesh.origin[1] <= 1e6; mesh.origin[1] += 5e5) {
        assert_ok(cw_mesh_write(test_path("far.stl"), &mesh, NULL, &err), err);
        char *bytes = test_file_read(test_path("far.stl"), &size);
        for (size_t t = 0; t < 12; t++) {
            float n[3], p[3][3];
            read_vector(bytes, t, -1, n);
            for (int c = 0; c < 3; c++)
                read_vector(bytes, t, c, p[c]);
            double along[2] = {0}, out = 0, length = 0;
            for (int a = 0; a < 3; a++) {
                for (int e = 0; e < 2; e++)
                    along[e] += (double)n[a] * ((double)p[e + 1][a] - (double)p[0][a]);
                out += (double)n[a] * ((double)p[0][a] - mesh.origin[a] - 0.49);
                length += (double)n[a] * (double)n[a];
            }
            assert_near(length, 1, 1e-6);
            assert_near(fabs(along[0]) + fabs(along[1]), 0, 1e-6);
            assert_true(out > 0);
        }
        free(bytes);
    }
    cw_mesh_free(&mesh);
}

static void a_facet_without_area_has_no_normal(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    float n[3];
    test_make_tetrahedron(&mesh);
    mesh.triangles[1] = mesh.triangles[0];
    assert_ok(cw_mesh_write(test_path("flat.stl"), &mesh, NULL, &err), err);
    char *bytes = test_file_read(test_path("flat.stl"), &size);
    read_vector(bytes, 0, -1, n);
    assert_true(n[0] == 0 && n[1] == 0 && n[2] == 0);
    free(bytes);
    cw_mesh_free(&mesh);
}

/* Every directed edge, named by the bytes of its corners, has its opposite once. */
static void a_closed_mesh_stays_closed(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size, matches = 0;
    test_make_cube(&mesh);
    mesh.origin[0] = -123.456;
    assert_ok(cw_mesh_write(test_path("c.stl"), &mesh, NULL, &err), err);
    char *bytes = test_file_read(test_path("c.stl"), &size);
    for (size_t i = 0; i < 36; i++)
        for (size_t j = 0; j < 36; j++) {
            const char *a = bytes + 84 + 50 * (i / 3) + 12, *b = bytes + 84 + 50 * (j / 3) + 12;
            matches += memcmp(a + 12 * (i % 3), b + 12 * ((j + 1) % 3), 12) == 0 &&
                       memcmp(a + 12 * ((i + 1) % 3), b + 12 * (j % 3), 12) == 0;
        }
    assert_int_equal(matches, 36);
    free(bytes);
    cw_mesh_free(&mesh);
}

/* Makes a mesh of a file as a reader does: three vertices a facet, and those at one place
 * merged. */
static cw_quality read_and_weld(const char *path)
{
    cw_quality q;
    cw_error err = {0};
    size_t size;
    char *bytes = test_file_read(path, &size);
    const size_t count = facet_count(bytes);
    cw_mesh mesh = {.vertex_count = 3 * count, .triangle_count = count};
    mesh.positions = malloc(9 * count * sizeof(float));
    mesh.triangles = malloc(3 * count * sizeof(uint32_t));
    assert_true(mesh.positions && mesh.triangles);
    for (size_t i = 0; i < 3 * count; i++) {
        read_vector(bytes, i / 3, (int)(i % 3), mesh.positions + 3 * i);
        mesh.triangles[i] = (uint32_t)i;
    }
    assert_ok(cw_quality_measure(&mesh, &(cw_quality_desc){.weld = CW_WELD_WORLD}, &q, &err),
              err);
    free(bytes);
    cw_mesh_free(&mesh);
    return q;
}

static void far_from_zero_the_loss_is_told_and_true(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    cw_write_loss loss;
    test_make_far_sphere(&mesh);
    assert_ok(cw_mesh_write_loss(test_path("a.stl"), &mesh, NULL, &loss, &err), err);
    assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, NULL, &err), err);
    const cw_quality q = read_and_weld(test_path("a.stl"));
    assert_true(loss.step_mm == 0.0625);
    assert_true(loss.merged_vertices > 0 && loss.flat_triangles > 0);
    assert_int_equal(loss.flat_triangles, q.degenerate);
    assert_int_equal(loss.merged_vertices,
                     mesh.vertex_count - (q.vertices - q.unused_vertices - q.merged_vertices));
    cw_mesh_free(&mesh);
}

static void a_local_file_keeps_a_far_mesh(void **state)
{
    (void)state;
    const cw_write_desc desc = {.local = true};
    cw_mesh mesh;
    cw_error err = {0};
    cw_write_loss loss;
    size_t size;
    test_make_far_sphere(&mesh);
    assert_ok(cw_mesh_write_loss(test_path("a.stl"), &mesh, &desc, &loss, &err), err);
    assert_int_equal(loss.merged_vertices + loss.flat_triangles, 0);
    assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, &desc, &err), err);
    const cw_quality q = read_and_weld(test_path("a.stl"));
    assert_true(cw_quality_is_closed_manifold(&q));
    assert_int_equal(q.degenerate, 0);
    assert_int_equal(q.vertices - q.unused_vertices - q.merged_vertices, mesh.vertex_count);
    assert_within(q.volume_mm3, 4.0 / 3 * PI * pow(24, 3) * 0.1 * 0.1 * 5, 0.005);
    char *bytes = test_file_read(test_path("a.stl"), &size);
    assert_string_equal(bytes, "cubewright, LPS, mm from 1000003.2 1000003.2 1000160");
    free(bytes);
    cw_mesh_free(&mesh);
}

/* The header has room for 55 bytes of origin. */
static void an_origin_too_long_for_the_header_is_only_hinted_at(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_tetrahedron(&mesh);
    for (int a = 0; a < 3; a++)
        mesh.origin[a] = -1e-100 / 3;
    assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, &(cw_write_desc){.local = true}, &err),
              err);
    char *bytes = test_file_read(test_path("a.stl"), &size);
    assert_string_equal(bytes, "cubewright, LPS, mm from an origin of its own");
    assert_int_equal(facet_count(bytes), 4);
    free(bytes);
    cw_mesh_free(&mesh);
}

/* The count is checked before a single triangle is read. */
static void more_triangles_than_stl_can_count_are_refused(void **state)
{
    (void)state;
    const cwi_parts parts = {.triangles = (uint64_t)UINT32_MAX + 1};
    cwi_mesh_output out = {0};
    cw_error err = {0};
    assert_fails(cwi_stl_write(&parts, &out, &err), CW_ERR_LIMIT,
                 "at most 4294967295 triangles", err);
}

static void text_is_one_solid_with_its_name(void **state)
{
    (void)state;
    static const char head[] = "solid two words cubewright, LPS, mm from 0.1 0 0\n"
                               "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\n"
                               "vertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n";
    const cw_write_desc desc = {.text = true, .local = true, .name = "two words"};
    cw_mesh mesh = {0}, back;
    cw_mesh_file file;
    cw_part *parts;
    cw_error err = {0};
    size_t size, count;
    test_make_tetrahedron(&mesh);
    mesh.origin[0] = 0.1;
    assert_ok(cw_mesh_write(test_path("a.stl"), &mesh, &desc, &err), err);
    char *text = test_file_read(test_path("a.stl"), &size);
    assert_memory_equal(text, head, strlen(head));
    assert_string_equal(text + size - 19, "endsolid two words\n");
    assert_ok(cw_mesh_read(test_path("a.stl"), NULL, &back, &file, &err), err);
    assert_int_equal(file.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
    assert_true(file.local && back.origin[0] == 0.1);
    assert_int_equal(back.triangle_count, 4);
    assert_ok(cw_parts_read(test_path("a.stl"), NULL, &parts, &count, NULL, &err), err);
    assert_string_equal(parts[0].name, "two words");
    cw_parts_free(parts, count);
    free(text);
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(every_facet_comes_back_to_the_bit),
        CASE(the_header_names_frame_and_unit_and_is_not_text),
        CASE(facet_normals_agree_with_the_corners_however_far_away),
        CASE(a_facet_without_area_has_no_normal),
        CASE(a_closed_mesh_stays_closed),
        CASE(far_from_zero_the_loss_is_told_and_true),
        CASE(a_local_file_keeps_a_far_mesh),
        CASE(an_origin_too_long_for_the_header_is_only_hinted_at),
        CASE(text_is_one_solid_with_its_name),
        CASE(more_triangles_than_stl_can_count_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
