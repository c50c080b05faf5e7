/* Compressed glTF: what comes back is what went in, as near as was asked for, and whole. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "formats/codec/draco_wrap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* meshopt has two: integers, and the exponential filter where 16 bits are not enough. */
static const struct {
    cw_compression kind;
    int bits;
} ways[] = {{CW_COMPRESS_QUANTIZE, 0},
            {CW_COMPRESS_DRACO, 0},
            {CW_COMPRESS_MESHOPT, 0},
            {CW_COMPRESS_MESHOPT, 20}};
enum { WAYS = sizeof ways / sizeof *ways };

static bool is_there(cw_compression kind)
{
    return kind == CW_COMPRESS_DRACO     ? cwi_module_present("draco")
           : kind == CW_COMPRESS_MESHOPT ? cwi_module_present("meshopt")
                                         : true;
}

/* A coloured gyroid, far from zero; free it. */
static cw_mesh make_gyroid(size_t n)
{
    cw_volume v = test_sample(CW_FIELD_GYROID, n, CW_F32);
    for (int r = 0; r < 3; r++)
        v.affine[r][3] += 1000 * (r + 1);
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 0}, NULL);
    mesh.colors = cwi_alloc_array(mesh.vertex_count, 4);
    assert_non_null(mesh.colors);
    for (size_t i = 0; i < 4 * mesh.vertex_count; i++)
        mesh.colors[i] = (uint8_t)(i % 4 == 3 ? 255 : 40 + i / 4 % 200);
    cw_volume_free(&v);
    return mesh;
}

static cw_mesh write_and_read(const cw_mesh *mesh, cw_write_desc desc, cw_compressed *told,
                              const char *name)
{
    cw_mesh back;
    cw_error err = {0};
    desc.compressed = told;
    assert_ok(cw_mesh_write(test_path(name), mesh, &desc, &err), err);
    assert_ok(cw_mesh_read(test_path(name), NULL, &back, NULL, &err), err);
    return back;
}

/* How far each is from the other at most. */
static double distance_between(const cw_mesh *a, const cw_mesh *b)
{
    double most = 0;
    cw_error err = {0};
    for (int way = 0; way < 2; way++) {
        cw_distance d;
        assert_ok(cw_distance_to_mesh(way ? a : b, way ? b : a, NULL, &d, NULL, &err), err);
        most = fmax(most, d.max_mm);
    }
    return most;
}

static void every_kind_keeps_the_mesh(void **state)
{
    (void)state;
    static const char *const names[] = {"a.glb", "a.gltf"};
    cw_mesh mesh = make_gyroid(test_is_short() ? 12 : 20);
    const cw_quality was = test_check_promise(&mesh, false);
    for (int k = 0; k < WAYS; k++)
        for (int n = 0; n < 2 && is_there(ways[k].kind); n++) {
            cw_compressed told = {0};
            cw_mesh back = write_and_read(
                &mesh, (cw_write_desc){.compression = ways[k].kind, .bits = ways[k].bits},
                &told, names[n]);
            const cw_quality is = test_check_promise(&back, false);
            assert_int_equal(is.triangles, was.triangles);
            assert_int_equal(is.euler, was.euler);
            assert_int_equal(is.components, was.components);
            assert_true(told.bits > 8 && told.merged == 0 && told.flat == 0);
            assert_true(told.error_mm > 0 && told.error_mm <= 0.8661 * told.step_mm);
            assert_true(distance_between(&mesh, &back) <= told.error_mm * 1.01 + 1e-4);
            assert_true(told.normal_degrees > 0 && told.normal_degrees < 0.7);
            assert_non_null(back.colors);
            assert_int_equal(test_normals_agree(&back), test_normals_agree(&mesh));
            cw_mesh_free(&back);
        }
    cw_mesh_free(&mesh);
}

/* The colour of each vertex is that of the vertex at its place. */
static void colors_stay_with_their_vertices(void **state)
{
    (void)state;
    cw_mesh mesh = make_gyroid(12);
    for (int k = 0; k < WAYS; k++) {
        if (!is_there(ways[k].kind))
            continue;
        cw_compressed told;
        cw_mesh back = write_and_read(
            &mesh, (cw_write_desc){.compression = ways[k].kind, .bits = ways[k].bits}, &told,
            "a.glb");
        for (size_t v = 0; v < back.vertex_count; v += 7) {
            size_t nearest = 0;
            double least = INFINITY;
            for (size_t u = 0; u < mesh.vertex_count; u++) {
                double squares = 0;
                for (size_t a = 0; a < 3; a++) {
                    const double d = mesh.origin[a] + (double)mesh.positions[3 * u + a] -
                                     back.origin[a] - (double)back.positions[3 * v + a];
                    squares += d * d;
                }
                nearest = squares < least ? u : nearest;
                least = fmin(least, squares);
            }
            for (size_t c = 0; c < 4; c++) /* linear light in bytes is coarse in the dark */
                assert_near(back.colors[4 * v + c], mesh.colors[4 * nearest + c], 7);
        }
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

static void a_tolerance_is_kept(void **state)
{
    (void)state;
    static const double wanted[] = {0.1, 0.01, 0.0005, 0.00002};
    cw_mesh mesh = make_gyroid(20);
    for (int k = 0; k < WAYS; k++) {
        int bits = 0;
        for (size_t n = 0; n < sizeof wanted / sizeof *wanted; n++) {
            cw_compressed told;
            if (!is_there(ways[k].kind) || ways[k].kind == CW_COMPRESS_QUANTIZE)
                break;
            cw_mesh back = write_and_read(
                &mesh, (cw_write_desc){.compression = ways[k].kind, .tolerance_mm = wanted[n]},
                &told, "a.glb");
            assert_true(told.error_mm <= wanted[n] && told.step_mm <= 1.1548 * wanted[n]);
            assert_true(told.bits >= bits && told.merged == 0 && told.flat == 0);
            bits = told.bits;
            cw_mesh_free(&back);
        }
    }
    cw_mesh_free(&mesh);
}

/* An octahedron whose coordinates no grid holds, in any unit and anywhere. */
static void put_octahedron(cw_mesh *mesh, const float center[3], float scale,
                           float positions[18], uint32_t triangles[24])
{
    static const float off[18] = {1,     0.0123f, -0.3f,  -1.07f,  0.21f, 0.05f,
                                  0.02f, 0.93f,   0.011f, 0.1f,    -1.3f, -0.17f,
                                  0.03f, 0.07f,   1.09f,  -0.019f, 0.13f, -0.71f};
    for (size_t i = 0; i < 18; i++)
        positions[i] = (center[i % 3] + off[i]) * scale;
    for (uint32_t t = 0; t < 8; t++) { /* the corner of an octant */
        const uint32_t x = t & 1, y = 2 + (t >> 1 & 1), z = 4 + (t >> 2 & 1);
        const bool turned = (t & 1) ^ (t >> 1 & 1) ^ (t >> 2 & 1);
        memcpy(triangles + 3 * t, (uint32_t[]){x, turned ? z : y, turned ? y : z}, 12);
    }
    *mesh = (cw_mesh){
        .positions = positions, .vertex_count = 6, .triangles = triangles, .triangle_count = 8};
}

/* The most that a vertex of a is away from the nearest of b. */
static double farthest_vertex(const cw_mesh *a, const cw_mesh *b)
{
    double worst = 0;
    for (size_t v = 0; v < a->vertex_count; v++) {
        double least = INFINITY;
        for (size_t u = 0; u < b->vertex_count; u++) {
            double d[3];
            for (size_t k = 0; k < 3; k++)
                d[k] = a->origin[k] + (double)a->positions[3 * v + k] - b->origin[k] -
                       (double)b->positions[3 * u + k];
            least = fmin(least, hypot(hypot(d[0], d[1]), d[2]));
        }
        worst = fmax(worst, least);
    }
    return worst;
}

/* Draco passes options on as text of six decimals; grids must not depend on it. Farther from 0
 * than floats have digits for, vertices may merge, which is reported. */
static void draco_takes_any_unit_place_and_bits(void **state)
{
    (void)state;
    static const float scales[] = {1e-6f, 1e-4f, 0.0137f, 1, 431.7f, 1e7f};
    static const float centers[][3] = {
        {0, 0, 0}, {0.3f, -2.7f, 11.1f}, {1234.567f, -77.7f, 0.1f}};
    static const int bits[] = {0, 8, 11, 14, 16, 20, 22, 23, 24};
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s += test_is_short() ? 2 : 1)
        for (size_t c = 0; c < sizeof centers / sizeof *centers; c++)
            for (size_t b = 0; b < sizeof bits / sizeof *bits && is_there(CW_COMPRESS_DRACO);
                 b++) {
                cw_mesh mesh;
                float positions[18];
                uint32_t triangles[24];
                cw_compressed told = {0};
                put_octahedron(&mesh, centers[c], scales[s], positions, triangles);
                cw_mesh back = write_and_read(
                    &mesh, (cw_write_desc){.compression = CW_COMPRESS_DRACO, .bits = bits[b]},
                    &told, "a.glb");
                const double ulp =
                    1200 * (double)scales[s] * 0x1p-23; /* of millimetres read back */
                assert_int_equal(back.triangle_count, 8);
                assert_int_equal(told.merged, 0);
                assert_true(told.error_mm <= 0.8661 * told.step_mm + 4 * ulp);
                assert_true(farthest_vertex(&mesh, &back) <= told.error_mm + ulp);
                assert_true(farthest_vertex(&back, &mesh) <= told.error_mm + ulp);
                cw_mesh_free(&back);
            }
}

/* Floats far from 0 make corners meet, as in many an STL. */
static void draco_leaves_out_triangles_with_a_vertex_twice(void **state)
{
    (void)state;
    cw_mesh mesh, back;
    float positions[18];
    uint32_t triangles[30];
    cw_compressed told = {0};
    if (!is_there(CW_COMPRESS_DRACO))
        return;
    put_octahedron(&mesh, (float[3]){0, 0, 0}, 1, positions, triangles);
    memmove(triangles + 6, triangles, 96);
    memcpy(triangles, (uint32_t[]){0, 0, 2, 2, 4, 2}, 24);
    mesh.triangle_count = 10;
    back = write_and_read(&mesh, (cw_write_desc){.compression = CW_COMPRESS_DRACO}, &told,
                          "a.glb");
    assert_int_equal(back.triangle_count, 8);
    assert_int_equal(told.dropped, 2);
    assert_int_equal(test_check_promise(&back, false).euler, 2);
    assert_int_equal(mesh.triangle_count, 10); /* the caller's mesh is as it was */
    assert_int_equal(triangles[5], 2);
    cw_mesh_free(&back);
}

/* A Draco file by itself: all parts on one grid, with normals and colours, in a process of its
 * own or not. */
static void draco_files_keep_the_mesh(void **state)
{
    (void)state;
    cw_mesh mesh = make_gyroid(14), back;
    cw_compressed told = {0};
    cw_error err = {0};
    if (!is_there(CW_COMPRESS_DRACO)) {
        assert_fails(cw_mesh_write(test_path("a.drc"), &mesh, NULL, &err), CW_ERR_UNSUPPORTED,
                     "draco", err);
        cw_mesh_free(&mesh);
        return;
    }
    const cw_part parts[] = {{.mesh = &mesh, .name = "a"}, {.mesh = &mesh, .name = "b"}};
    for (size_t n = 1; n <= 2; n++)
        for (int inside = 0; inside < 2; inside++) {
            const cw_mesh_read_desc desc = {.no_sandbox = inside};
            cw_mesh_file file;
            assert_ok(cw_parts_write(test_path("a.drc"), parts, n,
                                     &(cw_write_desc){.compressed = &told}, &err),
                      err);
            assert_ok(cw_mesh_read(test_path("a.drc"), &desc, &back, &file, &err), err);
            assert_string_equal(file.format, "drc");
            assert_int_equal(back.triangle_count, n * mesh.triangle_count);
            assert_non_null(back.colors);
            assert_int_equal(test_normals_agree(&back), n * test_normals_agree(&mesh));
            assert_true(told.bits > 8 && told.error_mm > 0 && told.bytes > 1000);
            assert_true(distance_between(&mesh, &back) <= told.error_mm * 1.01 + 2e-4);
            cw_mesh_free(&back);
        }
    cw_mesh_file file;
    mesh.origin[1] = -7.25;
    assert_ok(cw_mesh_write(test_path("a.drc"), &mesh,
                            &(cw_write_desc){.local = true, .axes = {.unit = CW_UNIT_M}}, &err),
              err);
    assert_ok(cw_mesh_read(test_path("a.drc"), NULL, &back, &file, &err), err);
    assert_true(file.local && file.axes.unit == CW_UNIT_M);
    assert_true(back.origin[1] == -7.25);
    assert_true(distance_between(&mesh, &back) < 0.1);
    size_t size; /* of the file; its bytes count, too */
    free(test_file_read(test_path("a.drc"), &size));
    cw_mesh_read_desc exact = {.no_sandbox = true};
    exact.max_bytes = size + 28 * back.vertex_count + 12 * back.triangle_count;
    cw_mesh_free(&back);
    assert_ok(cw_mesh_read(test_path("a.drc"), &exact, &back, NULL, &err), err);
    cw_mesh_free(&back);
    exact.max_bytes--;
    assert_fails(cw_mesh_read(test_path("a.drc"), &exact, &back, NULL, &err), CW_ERR_LIMIT,
                 "(desc->max_bytes)", err);
    const cw_mesh_read_desc few = {.max_triangles = mesh.triangle_count - 1},
                            little = {.max_bytes = 20000};
    assert_fails(cw_mesh_read(test_path("a.drc"), &few, &back, NULL, &err), CW_ERR_LIMIT,
                 "the most allowed", err);
    assert_fails(cw_mesh_read(test_path("a.drc"), &little, &back, NULL, &err), CW_ERR_LIMIT,
                 "(desc->max_bytes)", err);
    assert_fails(cw_mesh_write(test_path("b.drc"), &mesh,
                               &(cw_write_desc){.compression = CW_COMPRESS_MESHOPT}, &err),
                 CW_ERR_ARGUMENT, "one form only", err);
    assert_fails(cw_mesh_write(test_path("b.drc"), &mesh, &(cw_write_desc){.bits = 31}, &err),
                 CW_ERR_ARGUMENT, "1 to 30", err);
    cw_mesh_free(&mesh);
}

/* Gives an attribute another number. It stands behind the kind of the attribute, the type of its
 * numbers, how many there are, and whether they are normalized. */
static void renumber_attribute(char *bytes, size_t size, const char head[4], int number)
{
    size_t found = 0;
    for (size_t i = 0; i + 5 <= size; i++)
        if (memcmp(bytes + i, head, 4) == 0) {
            bytes[i + 4] = (char)number;
            found++;
        }
    assert_int_equal(found, 1);
}

/* Draco's numbers of attributes are not their places: other programs leave numbers out, or write the
 * attributes in another order. */
static void draco_attributes_are_found_by_their_numbers(void **state)
{
    (void)state;
    static const char position[4] = {0, 9, 3, 0}, normal[4] = {1, 9, 3, 0},
                      color[4] = {2, 2, 4, 1};
    const cwi_draco_functions *draco;
    cw_mesh mesh = make_gyroid(6), before, after;
    cwi_arrays arrays = {0};
    cw_error err = {0};
    size_t size;
    if (is_there(CW_COMPRESS_DRACO)) {
        before = write_and_read(&mesh, (cw_write_desc){0}, NULL, "a.drc");
        char *bytes = test_file_read(test_path("a.drc"), &size);
        renumber_attribute(bytes, size, position, 2);
        renumber_attribute(bytes, size, normal, 7);
        renumber_attribute(bytes, size, color, 0);
        test_file_write(test_path("b.drc"), bytes, size);
        assert_ok(cw_mesh_read(test_path("b.drc"), NULL, &after, NULL, &err), err);
        assert_int_equal(after.vertex_count, before.vertex_count);
        const size_t count = before.vertex_count;
        assert_memory_equal(after.positions, before.positions, 12 * count);
        assert_memory_equal(after.normals, before.normals, 12 * count);
        assert_memory_equal(after.colors, before.colors, 4 * count);

        const cwi_draco_ids ids = {.position = 2, .normal = 7, .color = 0}; /* as in glTF */
        assert_ok(cwi_draco_functions_load(&draco, &err), err);
        assert_ok(draco->decode(bytes, size, &ids, SIZE_MAX, NULL, &arrays, &err), err);
        assert_int_equal(arrays.vertex_count, count);
        assert_non_null(arrays.positions);
        assert_memory_equal(arrays.normals, before.normals, 12 * count);
        cwi_arrays_free(&arrays);
        free(bytes);
        cw_mesh_free(&before);
        cw_mesh_free(&after);
    }
    cw_mesh_free(&mesh);
}

/* Every byte turned round, and every length: an error or a mesh. */
static void damaged_draco_files_are_an_error_or_a_mesh(void **state)
{
    (void)state;
    cw_mesh cube = {0}, back;
    cw_error err = {0};
    size_t size;
    if (!is_there(CW_COMPRESS_DRACO))
        return;
    test_make_cube(&cube);
    assert_ok(cw_mesh_write(test_path("a.drc"), &cube, NULL, &err), err);
    char *bytes = test_file_read(test_path("a.drc"), &size);
    for (size_t i = 0; i < 2 * size; i++) {
        const cw_mesh_read_desc desc = {
            .reader = "drc", .no_sandbox = i % 16 != 0, .max_bytes = 64 << 20};
        if (i < size)
            bytes[i] = (char)~bytes[i];
        test_file_write(test_path("b.drc"), bytes, i < size ? size : i - size);
        if (cw_mesh_read(test_path("b.drc"), &desc, &back, NULL, &err) == CW_OK) {
            assert_ok(cw_mesh_check(&back, &err), err);
            cw_mesh_free(&back);
        } else {
            assert_true(err.status == CW_ERR_FORMAT || err.status == CW_ERR_LIMIT ||
                        err.status == CW_ERR_NO_MEMORY || err.status == CW_ERR_BACKEND ||
                        err.status == CW_ERR_IO);
        }
        if (i < size)
            bytes[i] = (char)~bytes[i];
    }
    free(bytes);
    cw_mesh_free(&cube);
}

/* Two slivers, a thousandth of a millimetre high on a base as long as told. */
static void put_sliver(cw_mesh *mesh, float base, float positions[18], uint32_t triangles[12])
{
    static const uint32_t corners[12] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
    const float points[12] = {0, 0, 0, base, 0, 0, 0, base, 0, 0.001f, 0.001f, 0.001f};
    memcpy(positions, points, sizeof points);
    memcpy(triangles, corners, sizeof corners);
    *mesh = (cw_mesh){
        .positions = positions, .vertex_count = 4, .triangles = triangles, .triangle_count = 4};
}

static void what_cannot_be_kept_is_not_promised(void **state)
{
    (void)state;
    cw_mesh mesh;
    float positions[18];
    uint32_t triangles[12];
    cw_compressed told = {0};
    cw_error err = {0};
    put_sliver(&mesh, 1e5f, positions, triangles); /* 100 m */
    assert_fails(cw_mesh_write(test_path("a.glb"), &mesh,
                               &(cw_write_desc){.compression = CW_COMPRESS_QUANTIZE}, &err),
                 CW_ERR_CHECK, "1 vertices fall onto others", err);
    assert_int_equal(test_folder_entries(), 0); /* nothing is half-written */
    assert_fails(cw_mesh_write(test_path("a.glb"), &mesh,
                               &(cw_write_desc){.compression = CW_COMPRESS_QUANTIZE,
                                                .tolerance_mm = 1e-6},
                               &err),
                 CW_ERR_CHECK, "move vertices by up to", err);
    cw_mesh back =
        write_and_read(&mesh, (cw_write_desc){.compression = CW_COMPRESS_QUANTIZE, .bits = 12},
                       &told, "a.glb");
    assert_true(told.bits == 12 && told.merged == 1 && told.flat == 2);
    cw_mesh_free(&back);
    positions[4] = -3e38f;
    positions[7] = 3e38f;
    assert_fails(cw_mesh_write(test_path("a.glb"), &mesh,
                               &(cw_write_desc){.compression = CW_COMPRESS_QUANTIZE}, &err),
                 CW_ERR_LIMIT, "a.glb: the box is too large", err);
    put_sliver(&mesh, 1e5f, positions, triangles);
    static const struct {
        cw_compression kind;
        const char *name;
    } unchanged[] = {{CW_COMPRESS_MESHOPT, "a.glb"},
                     {CW_COMPRESS_DRACO, "a.glb"},
                     {CW_COMPRESS_DRACO, "a.drc"}};
    for (size_t n = 0; n < sizeof unchanged / sizeof *unchanged; n++) {
        if (!is_there(unchanged[n].kind))
            continue;
        back = write_and_read(&mesh, (cw_write_desc){.compression = unchanged[n].kind}, &told,
                              unchanged[n].name);
        assert_int_equal(told.bits, 0); /* as they were */
        assert_true(distance_between(&mesh, &back) < 1e-6);
        cw_mesh_free(&back);
    }
}

/* Draco's table of symbols doubles with each bit: more bits than memory has room for are refused
 * before it is made, and no bits are chosen that take more than 64 MiB. */
static void bits_are_bounded_by_memory(void **state)
{
    (void)state;
    enum { MIB = 1 << 20 };
    cw_mesh mesh;
    float positions[18];
    uint32_t triangles[12];
    cw_compressed told = {0};
    cw_error err = {0};
    if (!is_there(CW_COMPRESS_DRACO))
        return;
    put_sliver(&mesh, 100, positions, triangles);
    for (int n = 0; n < 2; n++) {
        cw_memory_limit(cw_memory_used() + 100 * (size_t)MIB);
        const cw_status st =
            cw_mesh_write(test_path(n ? "a.drc" : "a.glb"), &mesh,
                          &(cw_write_desc){.compression = CW_COMPRESS_DRACO, .bits = 30}, &err);
        cw_memory_limit(0);
        assert_fails(st, CW_ERR_LIMIT, "30 bits a coordinate take up to 4 GiB", err);
        assert_non_null(strstr(err.message, "; 24 bits fit"));
        assert_int_equal(test_folder_entries(), 0);
    }
    for (double tolerance = 1; tolerance > 1e-9; tolerance /= 4) {
        cw_mesh back = write_and_read(
            &mesh, (cw_write_desc){.compression = CW_COMPRESS_DRACO, .tolerance_mm = tolerance},
            &told, "a.glb");
        assert_true(told.bits <= 24 && told.error_mm <= tolerance);
        assert_true(distance_between(&mesh, &back) <= told.error_mm + 1e-6);
        cw_mesh_free(&back);
    }
    assert_int_equal(told.bits, 0);
}

static void read_three(const char *json, const char *key, double numbers[3])
{
    const char *at = strstr(json, key);
    assert_non_null(at);
    assert_int_equal(
        sscanf(at + strlen(key), "\":[%lf,%lf,%lf]", numbers, numbers + 1, numbers + 2), 3);
}

/* Where 16 bits are too few, meshopt's filter makes floats: no other extension is needed, steps
 * are powers of two, and the accessor's box is that of the floats. */
static void meshopt_has_more_than_16_bits(void **state)
{
    (void)state;
    cw_mesh mesh;
    float positions[18];
    uint32_t triangles[12];
    cw_compressed told;
    size_t size;
    int exponent;
    double low[3], high[3], to[3];
    if (!is_there(CW_COMPRESS_MESHOPT))
        return;
    put_sliver(&mesh, 5e3f, positions, triangles);
    cw_mesh back = write_and_read(&mesh, (cw_write_desc){.compression = CW_COMPRESS_MESHOPT},
                                  &told, "a.glb");
    assert_true(told.bits > 16 && told.merged == 0 && told.flat == 0);
    assert_true(frexp(told.step_mm, &exponent) == 0.5);
    assert_true(told.error_mm > 0 && told.error_mm <= 0.8661 * told.step_mm);
    assert_true(distance_between(&mesh, &back) <= told.error_mm + 1e-6);
    cw_mesh_free(&back);
    char *json = test_file_read(test_path("a.glb"), &size);
    memmove(json, json + 20, size - 20);
    assert_non_null(strstr(json, "\"filter\":\"EXPONENTIAL\""));
    assert_null(strstr(json, "KHR_mesh_quantization"));
    read_three(json, "min", low);
    read_three(json, "max", high);
    read_three(json, "translation", to); /* of metres, +Y up */
    free(json);
    assert_true(fabs(low[0] + 1000 * to[0]) < 1e-9 && fabs(low[2] + 1000 * to[1]) < 1e-9);
    assert_true(fabs(high[1] - 1000 * to[2] - 5000) <= told.error_mm);
    assert_true(fabs(high[2] + 1000 * to[1] - 0.001) <= told.error_mm);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    test_make_cube(&mesh);
    const cw_write_desc quantize = {.compression = CW_COMPRESS_QUANTIZE};
    assert_fails(cw_mesh_write(test_path("a.stl"), &mesh, &quantize, &err), CW_ERR_ARGUMENT,
                 "stl has no compressed form", err);
    static const struct {
        cw_write_desc desc;
        const char *words;
    } rows[] = {
        {{.compression = CW_COMPRESS_QUANTIZE, .bits = 17},
         "there may be 1 to 16 with quantize"},
        {{.compression = CW_COMPRESS_MESHOPT, .bits = 25}, "there may be 1 to 24 with meshopt"},
        {{.compression = CW_COMPRESS_DRACO, .bits = 31}, "there may be 1 to 30 with Draco"},
        {{.compression = CW_COMPRESS_DRACO, .bits = -1}, "-1 bits a coordinate"},
        {{.compression = CW_COMPRESS_MESHOPT + 1}, "4 is not a compression"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_fails(cw_mesh_write_check(test_path("a.glb"), &rows[i].desc, &err),
                     CW_ERR_ARGUMENT, rows[i].words, err);
        assert_fails(cw_mesh_write(test_path("a.glb"), &mesh, &rows[i].desc, &err),
                     CW_ERR_ARGUMENT, rows[i].words, err);
    }
    cw_mesh_free(&mesh);
}

/* Two cubes with a common face, each with an origin of its own: the face stays common. */
static void parts_share_a_grid(void **state)
{
    (void)state;
    cw_mesh a = {0}, b = {0};
    cw_error err = {0};
    test_make_cube(&a);
    test_make_cube(&b);
    for (size_t i = 0; i < 24; i++) {
        a.positions[i] =
            (i % 3 == 0 ? 0.7f : 0.5f) * a.positions[i] + (i % 3 == 0 ? 0.0f : 0.1f);
        b.positions[i] =
            (i % 3 == 0 ? 0.7f : 0.5f) * b.positions[i] + (i % 3 == 0 ? 0.7f : 0.1f);
    }
    b.origin[1] = 0.25;
    for (size_t i = 1; i < 24; i += 3)
        b.positions[i] -= 0.25f;
    const cw_part parts[] = {{.mesh = &a, .name = "left"}, {.mesh = &b, .name = "right"}};
    for (int k = 0; k < WAYS; k++) {
        if (!is_there(ways[k].kind))
            continue;
        cw_mesh back;
        cw_quality q;
        const cw_write_desc desc = {.compression = ways[k].kind,
                                    .bits = ways[k].bits ? ways[k].bits : 7};
        assert_ok(cw_parts_write(test_path("a.glb"), parts, 2, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &back, NULL, &err), err);
        const cw_quality_desc weld = {.weld = CW_WELD_LOCAL};
        assert_ok(cw_quality_measure(&back, &weld, &q, &err), err);
        assert_int_equal(q.components, 1); /* joined by the corners of the face */
        assert_int_equal(q.merged_vertices, 4);
        cw_mesh_free(&back);
    }
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

/* Any byte behind the JSON turned round: an error or a mesh, in a process of its own or not. */
static void damage_is_an_error_or_a_mesh(void **state)
{
    (void)state;
    cw_mesh mesh = make_gyroid(6);
    for (int k = 0; k < WAYS; k++) {
        cw_compressed told;
        if (!is_there(ways[k].kind))
            continue;
        cw_mesh back = write_and_read(
            &mesh, (cw_write_desc){.compression = ways[k].kind, .bits = ways[k].bits}, &told,
            "a.glb");
        size_t size;
        char *bytes = test_file_read(test_path("a.glb"), &size);
        cw_mesh_free(&back);
        for (size_t i = 20 + (unsigned char)bytes[12] + 256u * (unsigned char)bytes[13];
             i < size; i += test_is_short() ? 65 : 13) {
            const cw_mesh_read_desc desc = {.no_sandbox = i % 64 != 0, .max_bytes = 64 << 20};
            cw_error err = {0};
            bytes[i] = (char)~bytes[i];
            test_file_write(test_path("b.glb"), bytes, size);
            if (cw_mesh_read(test_path("b.glb"), &desc, &back, NULL, &err) == CW_OK) {
                assert_ok(cw_mesh_check(&back, &err), err);
                cw_mesh_free(&back);
            }
            bytes[i] = (char)~bytes[i];
        }
        free(bytes);
    }
    cw_mesh_free(&mesh);
}

/* The JSON may say what it likes of what comes out. */
static void claims_are_held_against_what_is_decoded(void **state)
{
    (void)state;
    static const struct {
        cw_compression kind;
        const char *from, *to, *words;
    } rows[] = {
        {CW_COMPRESS_DRACO, "\"count\":8,", "\"count\":9,", "their accessors say"},
        {CW_COMPRESS_DRACO, "\"count\":36,", "\"count\":99,", "their accessors say"},
        {CW_COMPRESS_DRACO, "\"POSITION\":0}", "\"POSITION\":7}", "lack an attribute"},
        {CW_COMPRESS_DRACO, "{\"POSITION\":0", "{\"POSITION\":7", "lack an attribute"},
        {CW_COMPRESS_MESHOPT, "\"byteStride\":8,\"count\"", "\"byteStride\":7,\"count\"",
         "a byteStride of 7"},
        {CW_COMPRESS_MESHOPT, "\"ATTRIBUTES\"", "\"TRIANGLES\" ", "a byteStride of"},
    };
    cw_mesh cube = {0};
    test_make_cube(&cube);
    size_t told = 0;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && is_there(rows[i].kind); i++) {
        cw_mesh back;
        cw_error err = {0};
        size_t size;
        const size_t length = strlen(rows[i].from);
        assert_ok(cw_mesh_write(test_path("a.glb"), &cube,
                                &(cw_write_desc){.compression = rows[i].kind}, &err),
                  err);
        char *bytes = test_file_read(test_path("a.glb"), &size), *at = NULL;
        for (size_t b = 0; b + length < size && !at; b++)
            at = memcmp(bytes + b, rows[i].from, length) == 0 ? bytes + b : NULL;
        if (at) {
            memcpy(at, rows[i].to, length);
            test_file_write(test_path("a.glb"), bytes, size);
            assert_fails(cw_mesh_read(test_path("a.glb"), NULL, &back, NULL, &err),
                         CW_ERR_FORMAT, rows[i].words, err);
            told++;
        }
        free(bytes);
    }
    assert_true(told >= 5 || !is_there(CW_COMPRESS_DRACO) || !is_there(CW_COMPRESS_MESHOPT));
    cw_mesh_free(&cube);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_kind_keeps_the_mesh),
        TEST(colors_stay_with_their_vertices),
        TEST(a_tolerance_is_kept),
        TEST(draco_takes_any_unit_place_and_bits),
        TEST(draco_leaves_out_triangles_with_a_vertex_twice),
        TEST(draco_files_keep_the_mesh),
        TEST(draco_attributes_are_found_by_their_numbers),
        TEST(damaged_draco_files_are_an_error_or_a_mesh),
        TEST(what_cannot_be_kept_is_not_promised),
        TEST(bits_are_bounded_by_memory),
        TEST(meshopt_has_more_than_16_bits),
        TEST(what_makes_no_sense_is_refused),
        TEST(parts_share_a_grid),
        TEST(damage_is_an_error_or_a_mesh),
        TEST(claims_are_held_against_what_is_decoded),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
