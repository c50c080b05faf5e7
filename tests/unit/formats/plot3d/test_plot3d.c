/* PLOT3D: every way to write it, and what is not it. */
#include "support/support.h"

#include <stdlib.h>
#include <string.h>

enum { NX = 4, NY = 3, NZ = 2, POINTS = NX * NY * NZ };

/* How a file is written. */
typedef struct dialect {
    bool big_endian, counted, marked, doubles;
} dialect;

typedef struct output {
    unsigned char bytes[8192];
    size_t size, record; /* where the record that is open begins */
    dialect d;
} output;

static void put_bytes(output *o, const void *from, size_t size)
{
    for (size_t n = 0; n < size; n++)
        o->bytes[o->size + n] =
            ((const unsigned char *)from)[o->d.big_endian ? size - 1 - n : n];
    o->size += size;
}

static void put_integer(output *o, int32_t n)
{
    put_bytes(o, &n, sizeof n);
}

static void put_number(output *o, double x)
{
    const float f = (float)x;
    put_bytes(o, o->d.doubles ? (const void *)&x : &f, o->d.doubles ? 8 : 4);
}

static void begin(output *o)
{
    o->record = o->size;
    if (o->d.marked)
        put_integer(o, 0);
}

static void end(output *o)
{
    const size_t size = o->size;
    if (!o->d.marked)
        return;
    o->size = o->record;
    put_integer(o, (int32_t)(size - o->record - 4));
    o->size = size;
    put_integer(o, (int32_t)(size - o->record - 4));
}

static output start(dialect d, const int32_t dims[3])
{
    output o = {.d = d};
    if (d.counted) {
        begin(&o);
        put_integer(&o, 1);
        end(&o);
    }
    begin(&o);
    for (int a = 0; a < 3; a++)
        put_integer(&o, dims[a]);
    end(&o);
    return o;
}

static double coordinate_of(size_t n, int a)
{
    const size_t at[3] = {n % NX, n / NX % NY, n / (NX * NY)};
    return (double)at[a] + 0.1 * (double)at[(a + 1) % 3];
}

static double value(size_t n, int quantity)
{
    return 100 * quantity + (double)n * 0.5;
}

static const int32_t dims[3] = {NX, NY, NZ};

static output make_points(dialect d)
{
    output o = start(d, dims);
    begin(&o);
    for (int a = 0; a < 3; a++)
        for (size_t n = 0; n < POINTS; n++)
            put_number(&o, coordinate_of(n, a));
    end(&o);
    return o;
}

static output make_solution(dialect d)
{
    output o = start(d, dims);
    begin(&o);
    for (int n = 0; n < 4; n++)
        put_number(&o, 1e9);
    end(&o);
    begin(&o);
    for (int q = 0; q < 5; q++)
        for (size_t n = 0; n < POINTS; n++)
            put_number(&o, value(n, q));
    end(&o);
    return o;
}

static void write_both(dialect points, dialect solution)
{
    const output p = make_points(points), s = make_solution(solution);
    test_file_write(test_path("g.xyz"), p.bytes, p.size);
    test_file_write(test_path("s.q"), s.bytes, s.size);
}

static cw_status read_both(const char *array, cw_volume *v, cw_error *err)
{
    const cw_read_desc desc = {.points = test_path("g.xyz"), .array = array};
    const char *format;
    cw_status st = cw_volume_read(test_path("s.q"), &desc, v, &format, err);
    assert_string_equal(format, "plot3d");
    return st;
}

static void check(const cw_volume *v, int quantity)
{
    assert_int_equal(v->dim[0], POINTS);
    assert_int_equal(v->cells->count, (NX - 1) * (NY - 1) * (NZ - 1));
    for (size_t n = 0; n < POINTS; n++) {
        assert_near(cw_volume_value(v, n, 0, 0), value(n, quantity), 1e-6);
        for (int a = 0; a < 3; a++)
            assert_near(v->cells->points[3 * n + (size_t)a], coordinate_of(n, a), 1e-6);
    }
}

static void test_dialects(void **state)
{
    (void)state;
    for (unsigned n = 0; n < 256; n++) {
        const dialect a = {n & 1, n & 2, n & 4, n & 8}, b = {n & 16, n & 32, n & 64, n & 128};
        cw_error err = {0};
        cw_volume v;
        write_both(a, b);
        assert_ok(read_both(NULL, &v, &err), err);
        assert_int_equal(v.type, b.doubles ? CW_F64 : CW_F32);
        check(&v, 0);
        cw_volume_free(&v);
    }
}

static void test_arrays(void **state)
{
    static const char *const names[] = {"Density", "MomentumX", "MomentumY", "MomentumZ",
                                        "StagnationEnergy"};
    cw_error err = {0};
    cw_volume v;
    (void)state;
    write_both((dialect){.big_endian = true}, (dialect){.marked = true});
    for (int q = 0; q < 5; q++) {
        assert_ok(read_both(names[q], &v, &err), err);
        check(&v, q);
        cw_volume_free(&v);
    }
    assert_fails(read_both("Pressure", &v, &err), CW_ERR_ARGUMENT,
                 "'Pressure'; a PLOT3D solution has Density", err);
}

static void test_refusals(void **state)
{
    cw_error err = {0};
    cw_volume v;
    (void)state;
    const char *solution = test_path("s.q"), *points = test_path("g.xyz");
    const dialect plain = {0};
    write_both(plain, plain);
    assert_fails(cw_volume_read(solution, &(cw_read_desc){.reader = "plot3d"}, &v, NULL, &err),
                 CW_ERR_ARGUMENT, "desc->points", err);
    assert_fails(
        cw_volume_read(solution, &(cw_read_desc){.points = "none.xyz"}, &v, NULL, &err),
        CW_ERR_IO, "none.xyz", err);
    assert_fails(cw_volume_read(solution, &(cw_read_desc){.points = solution}, &v, NULL, &err),
                 CW_ERR_FORMAT, "PLOT3D grid", err);
    assert_fails(cw_volume_read(points, &(cw_read_desc){.points = points}, &v, NULL, &err),
                 CW_ERR_FORMAT, "PLOT3D solution", err);
    output o = make_solution(plain);
    const int32_t other[3] = {NY, NX, NZ};
    memcpy(o.bytes, other, sizeof other);
    test_file_write(solution, o.bytes, o.size);
    assert_fails(read_both(NULL, &v, &err), CW_ERR_FORMAT, "it is of 3 x 4 x 2 points", err);
    for (size_t size = 1; size < o.size; size += 7) {
        test_file_write(test_path("s.q"), o.bytes, size);
        assert_fails(read_both(NULL, &v, &err), CW_ERR_FORMAT, "PLOT3D solution", err);
    }
}

/* Sizes that lie, whatever their product. */
static void test_lying_sizes(void **state)
{
    (void)state;
    uint32_t random = 7;
    for (int round = 0; round < 2000; round++) {
        cw_error err = {0};
        cw_volume v;
        output o = make_points((dialect){.big_endian = round & 1});
        for (int a = 0; a < 3; a++) {
            random = random * 1664525 + 1013904223;
            const int32_t n = (int32_t)(random >> (random >> 8 & 31));
            memcpy(o.bytes + 4 * a, &n, sizeof n);
        }
        test_file_write(test_path("g.xyz"), o.bytes, o.size);
        if (round == 0)
            write_both((dialect){0}, (dialect){0});
        if (read_both(NULL, &v, &err) == CW_OK)
            cw_volume_free(&v);
    }
}

int main(void)
{
#define IN_FOLDER(test)                                                                        \
    cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {IN_FOLDER(test_dialects), IN_FOLDER(test_arrays),
                                       IN_FOLDER(test_refusals), IN_FOLDER(test_lying_sizes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
