/* Meshes packed for a page: a decoder that knows only the description in the header gets them
 * back. */
#include "cli/study/packed_mesh.h"
#include "core/base/memory.h"
#include "support/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct decoded {
    double *grid_points;
    uint8_t *bytes;
    uint32_t *corners;
} decoded;

static uint32_t read_integer(const cli_packed *p, size_t *at)
{
    uint32_t value = 0;
    for (int shift = 0;; shift += 7) {
        assert_true(*at < p->size);
        const uint8_t byte = (uint8_t)p->bytes[(*at)++];
        value |= (uint32_t)(byte & 127) << shift;
        if (byte < 128)
            return value;
    }
}

static decoded unpack(const cli_packed *p)
{
    size_t at = 0;
    int32_t here[3] = {0};
    uint32_t next = 0;
    decoded d = {calloc(3 * p->vertices + 1, sizeof(double)), calloc(p->vertices + 1, 1),
                 calloc(3 * p->triangles + 1, sizeof(uint32_t))};
    assert_true(d.grid_points && d.bytes && d.corners);
    for (size_t n = 0; n < 3 * p->vertices; n++) {
        const uint32_t code = read_integer(p, &at);
        here[n % 3] += code % 2 ? -(int32_t)(code / 2) - 1 : (int32_t)(code / 2);
        assert_in_range(here[n % 3], 0, CLI_PACKED_STEPS);
        d.grid_points[n] =
            p->low[n % 3] + here[n % 3] * (p->high[n % 3] - p->low[n % 3]) / CLI_PACKED_STEPS;
    }
    for (size_t n = 0; n < p->vertices && p->has_bytes; n++)
        d.bytes[n] = (uint8_t)p->bytes[at++];
    for (size_t n = 0; n < 3 * p->triangles; n++) {
        const uint32_t below = read_integer(p, &at);
        assert_true(below <= next);
        d.corners[n] = next - below;
        next += below == 0;
    }
    assert_int_equal(at, p->size);
    assert_int_equal(next, p->vertices);
    return d;
}

static void free_decoded(decoded *d)
{
    free(d->grid_points);
    free(d->bytes);
    free(d->corners);
}

/* Triangle by triangle, each corner within half a step of where it was, with its byte. */
static void assert_same(const cw_mesh *mesh, const uint8_t *values, const cli_packed *p)
{
    decoded d = unpack(p);
    assert_int_equal(p->triangles, mesh->triangle_count);
    for (size_t c = 0; c < 3 * p->triangles; c++) {
        const size_t was = mesh->triangles[c], is = d.corners[c];
        for (size_t a = 0; a < 3; a++) {
            const double coordinate = mesh->origin[a] + (double)mesh->positions[3 * was + a],
                         half = 0.5 * (p->high[a] - p->low[a]) / CLI_PACKED_STEPS;
            assert_true(fabs(d.grid_points[3 * is + a] - coordinate) <= 1.001 * half + 1e-9);
        }
        if (values)
            assert_int_equal(d.bytes[is], values[was]);
    }
    free_decoded(&d);
}

/* Vertices anywhere, in no order, some in no triangle. */
static cw_mesh make_random(size_t vertices, size_t triangles, float *positions,
                           uint32_t *corners)
{
    unsigned seed = 11;
    for (size_t n = 0; n < 3 * vertices; n++) {
        seed = seed * 1664525u + 1013904223u;
        positions[n] = (float)(seed >> 8) / 4096.0f - 2000;
    }
    for (size_t n = 0; n < 3 * triangles; n++) {
        seed = seed * 1664525u + 1013904223u;
        corners[n] = (seed >> 8) % (uint32_t)vertices;
    }
    return (cw_mesh){.origin = {100, -250.5, 1e4},
                     .vertex_count = vertices,
                     .triangle_count = triangles,
                     .positions = positions,
                     .triangles = corners};
}

static void meshes_come_back_within_half_a_step(void **state)
{
    enum { VERTICES = 3000, TRIANGLES = 2500 };
    (void)state;
    static float positions[3 * VERTICES];
    static uint32_t corners[3 * TRIANGLES];
    static uint8_t values[VERTICES];
    const cw_mesh mesh = make_random(VERTICES, TRIANGLES, positions, corners);
    cli_packed p;
    cw_error err = {0};
    for (size_t n = 0; n < VERTICES; n++)
        values[n] = (uint8_t)(n * 7);
    assert_ok(cli_pack_mesh(&mesh, values, &p, &err), err);
    assert_true(p.vertices < VERTICES); /* some are in no triangle */
    assert_same(&mesh, values, &p);
    cli_free_packed(&p);
    assert_ok(cli_pack_mesh(&mesh, NULL, &p, &err), err);
    assert_same(&mesh, NULL, &p);
    cli_free_packed(&p);
}

/* Rows of a surface take about two bytes a corner, not twelve. */
static void surfaces_are_small(void **state)
{
    enum { EDGE = 100, VERTICES = EDGE * EDGE, TRIANGLES = 2 * (EDGE - 1) * (EDGE - 1) };
    (void)state;
    static float positions[3 * VERTICES];
    static uint32_t corners[3 * TRIANGLES];
    size_t t = 0;
    for (size_t n = 0; n < VERTICES; n++) {
        positions[3 * n] = (float)(n % EDGE);
        positions[3 * n + 1] = (float)(n / EDGE);
        positions[3 * n + 2] = 0; /* a flat box */
    }
    for (uint32_t y = 0; y + 1 < EDGE; y++)
        for (uint32_t x = 0; x + 1 < EDGE; x++) {
            const uint32_t a = y * EDGE + x,
                           quad[6] = {a, a + 1, a + EDGE, a + 1, a + EDGE + 1, a + EDGE};
            memcpy(corners + 3 * t, quad, sizeof quad);
            t += 2;
        }
    const cw_mesh mesh = {.vertex_count = VERTICES,
                          .triangle_count = TRIANGLES,
                          .positions = positions,
                          .triangles = corners};
    cli_packed p;
    cw_error err = {0};
    assert_ok(cli_pack_mesh(&mesh, NULL, &p, &err), err);
    assert_same(&mesh, NULL, &p);
    assert_true(p.size < 3 * VERTICES * 3 + 2 * 3 * TRIANGLES);
    cli_free_packed(&p);
    assert_null(p.bytes);
    cli_free_packed(&p); /* harmless again */
}

static void failing_memory_is_told(void **state)
{
    (void)state;
    float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t corners[3] = {0, 1, 2};
    const cw_mesh mesh = {
        .vertex_count = 3, .triangle_count = 1, .positions = positions, .triangles = corners};
    for (long n = 0; n < 2; n++) {
        cli_packed p;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        assert_int_equal(cli_pack_mesh(&mesh, NULL, &p, &err), CW_ERR_NO_MEMORY);
        cwi_alloc_fail_after(-1);
        assert_null(p.bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_come_back_within_half_a_step),
        cmocka_unit_test(surfaces_are_small),
        cmocka_unit_test(failing_memory_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
