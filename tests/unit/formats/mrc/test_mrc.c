/* Tests the reader of MRC maps: modes, orders of axes, origins, oblique cells, and damaged
 * headers. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

enum { HEADER = 1024, MAXIMUM = HEADER + 400 };

/* A map in memory, little end first until it is saved. */
typedef struct map {
    unsigned char bytes[MAXIMUM];
    size_t size;
    size_t voxel; /* bytes */
} map;

static void put_word(map *m, size_t at, int32_t value)
{
    for (int i = 0; i < 4; i++)
        m->bytes[at + (size_t)i] = (unsigned char)((uint32_t)value >> (8 * i));
}

static void put_float(map *m, size_t at, float value)
{
    int32_t bits;
    memcpy(&bits, &value, 4);
    put_word(m, at, bits);
}

/* 2 x 3 x 2 voxels -3, -2 ... 8, of 2 x 3 x 4 Angstrom. */
static map make_map(int mode, size_t voxel)
{
    map m = {.size = HEADER + 12 * voxel, .voxel = voxel};
    const int32_t sizes[3] = {2, 3, 2};
    put_word(&m, 12, mode);
    for (size_t a = 0; a < 3; a++) {
        put_word(&m, 4 * a, sizes[a]);
        put_word(&m, 28 + 4 * a, 10);
        put_float(&m, 40 + 4 * a, 10 * (2 + (float)a));
        put_float(&m, 52 + 4 * a, 90);
        put_word(&m, 64 + 4 * a, 1 + (int32_t)a);
    }
    put_word(&m, 88, 1);
    memcpy(m.bytes + 208, "MAP \x44\x44", 6);
    for (size_t i = 0; i < 12; i++) {
        const float f = (float)i - 3;
        int32_t number = (int32_t)i - 3;
        if (mode == 2)
            memcpy(&number, &f, 4);
        for (size_t b = 0; b < voxel; b++)
            m.bytes[HEADER + i * voxel + b] = (unsigned char)((uint32_t)number >> (8 * b));
    }
    return m;
}

static void reverse(unsigned char *p, size_t count, size_t size)
{
    for (size_t i = 0; i < count; i++, p += size)
        for (size_t b = 0; b < size / 2; b++) {
            const unsigned char kept = p[b];
            p[b] = p[size - 1 - b];
            p[size - 1 - b] = kept;
        }
}

/* The same map as the other kind of machine writes it; texts stay. */
static void turn_bytes(map *m)
{
    reverse(m->bytes, 52, 4);
    memcpy(m->bytes + 212, "\x11\x11", 2);
    reverse(m->bytes + HEADER, (m->size - HEADER) / m->voxel, m->voxel);
}

static void save(const map *m, const char *name)
{
    put_file(name, "", m->bytes, m->size);
}

static void read_made(const map *m, cw_volume *v)
{
    cw_error err = {0};
    save(m, "a.map");
    assert_ok(read_back("a.map", v, &err), err);
}

static void check_near(const cw_volume *v, const double *expected)
{
    for (int i = 0; i < 12; i++)
        assert_near(v->affine[i / 4][i % 4], expected[i], 1e-14);
}

static const struct {
    int mode;
    size_t voxel;
    cw_type type;
} kinds[] = {{0, 1, CW_I8}, {1, 2, CW_I16}, {2, 4, CW_F32}, {6, 2, CW_U16}};

static void modes_byte_orders_and_packings_give_the_same_numbers(void **state)
{
    (void)state;
    for (size_t way = 0; way < 16; way++) {
        map m = make_map(kinds[way % 4].mode, kinds[way % 4].voxel);
        const char *format = NULL;
        cw_volume v;
        cw_error err = {0};
        size_t packed_size;
        if (way & 4)
            turn_bytes(&m);
        unsigned char *packed = pack_bytes(m.bytes, m.size, true, &packed_size);
        if (way & 8)
            put_file("a.bin", "", packed, packed_size);
        else
            save(&m, "a.bin");
        assert_ok(cw_volume_read(test_path("a.bin"), NULL, &v, &format, &err), err);
        assert_string_equal(format, "mrc");
        assert_int_equal(v.type, kinds[way % 4].type);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        check_near(&v, (const double[12]){2e-7, 0, 0, 0, 0, 3e-7, 0, 0, 0, 0, 4e-7, 0});
        for (size_t i = 0; i < 12; i++) {
            const double expected = (double)i - 3 + (v.type == CW_U16 && i < 3 ? 65536 : 0);
            assert_true(cw_volume_value(&v, i % 2, i / 2 % 3, i / 6) == expected);
        }
        check_regions("a.bin", NULL);
        cw_volume_free(&v);
        free(packed);
    }
}

/* Columns, rows and sections may run along any axes of the cell: the voxels stay where they
 * are, and x is the cell's in any case. */
static void axes_may_come_in_any_order(void **state)
{
    (void)state;
    map m = make_map(0, 1);
    cw_volume v;
    const int32_t order[3] = {3, 1, 2};
    for (size_t a = 0; a < 3; a++) {
        put_word(&m, 64 + 4 * a, order[a]);
        put_word(&m, 16 + 4 * a, 10 * (1 + (int32_t)a)); /* the first column is the 10th */
    }
    read_made(&m, &v);
    assert_int_equal(v.dim[0], 3);
    assert_int_equal(v.dim[1], 2);
    assert_int_equal(v.dim[2], 2);
    check_near(&v, (const double[12]){2e-7, 0, 0, 40e-7, 0, 3e-7, 0, 90e-7, 0, 0, 4e-7, 40e-7});
    assert_true(cw_volume_value(&v, 1, 0, 0) == -1); /* the second row: two columns on */
    assert_true(cw_volume_value(&v, 0, 1, 0) == 3);  /* the second section */
    assert_true(cw_volume_value(&v, 0, 0, 1) == -2); /* the second column */
    cw_volume_free(&v);
}

static void regions_are_crops_in_every_order_of_axes(void **state)
{
    (void)state;
    for (int32_t n = 0; n < 6; n++) {
        map m = make_map(1, 2);
        const int32_t first = n / 2, second = (first + 1 + n % 2) % 3;
        const int32_t order[3] = {first, second, 3 - first - second};
        for (size_t a = 0; a < 3; a++)
            put_word(&m, 64 + 4 * a, order[a] + 1);
        save(&m, "a.map");
        check_regions("a.map", NULL);
    }
}

static void places_are_origin_words_else_start_words(void **state)
{
    (void)state;
    const struct {
        float origin;
        bool imod;
        int flags;
        double x;
    } cases[] = {
        {0, false, 0, 10e-7},
        {7, false, 0, 7e-7},
        {7, true, 1 | 4, 7e-7},
        {7, true, 1, -7e-7},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        map m = make_map(1, 2);
        cw_volume v;
        put_word(&m, 16, 5); /* NXSTART */
        put_float(&m, 196, cases[i].origin);
        put_word(&m, 152, cases[i].imod ? 1146047817 : 0);
        put_word(&m, 156, cases[i].flags);
        read_made(&m, &v);
        assert_near(v.affine[0][3], cases[i].x, 1e-14);
        cw_volume_free(&v);
    }
}

static void imod_says_whether_bytes_are_signed(void **state)
{
    (void)state;
    for (int flags = 0; flags < 2; flags++) {
        map m = make_map(0, 1);
        cw_volume v;
        put_word(&m, 152, 1146047817);
        put_word(&m, 156, flags);
        read_made(&m, &v);
        assert_int_equal(v.type, flags ? CW_I8 : CW_U8);
        cw_volume_free(&v);
    }
}

/* b leans by 30 degrees, c stands upright on both. */
static void cells_may_be_oblique(void **state)
{
    (void)state;
    map m = make_map(2, 4);
    cw_volume v;
    put_float(&m, 60, 60);
    read_made(&m, &v);
    check_near(&v, (const double[12]){2e-7, 1.5e-7, 0, 0, 0, 3e-7 * 0.866025403784, 0, 0, 0, 0,
                                      4e-7, 0});
    cw_volume_free(&v);
}

/* All edges at 60 degrees to each other: those of a regular tetrahedron. */
static void all_angles_of_a_cell_may_be_oblique(void **state)
{
    (void)state;
    map m = make_map(2, 4);
    cw_volume v;
    for (size_t a = 0; a < 3; a++)
        put_float(&m, 52 + 4 * a, 60);
    read_made(&m, &v);
    check_near(&v,
               (const double[12]){2e-7, 1.5e-7, 2e-7, 0, 0, 3e-7 * 0.866025403784,
                                  4e-7 * 0.288675134595, 0, 0, 0, 4e-7 * 0.816496580928, 0});
    cw_volume_free(&v);
}

static void without_a_cell_nothing_is_known(void **state)
{
    (void)state;
    map m = make_map(2, 4);
    cw_volume v;
    for (size_t at = 28; at < 76; at += 4)
        put_word(&m, at, 0);
    read_made(&m, &v);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
}

static void old_files_have_neither_name_nor_stamp(void **state)
{
    (void)state;
    for (int turned = 0; turned < 2; turned++) {
        map m = make_map(1, 2);
        cw_volume v;
        if (turned)
            turn_bytes(&m);
        memset(m.bytes + 208, 0, 8);
        read_made(&m, &v);
        assert_true(cw_volume_value(&v, 0, 0, 0) == -3);
        cw_volume_free(&v);
    }
}

/* Space groups 401 to 630, and no others. */
static void stacks_of_volumes_are_steps(void **state)
{
    (void)state;
    const struct {
        int32_t group;
        size_t steps;
    } cases[] = {{400, 1}, {401, 2}, {630, 2}, {631, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        map m = make_map(1, 2);
        cw_volume v, last;
        cw_error err = {0};
        put_word(&m, 88, cases[i].group);
        put_word(&m, 36, 1); /* MZ: sections of each */
        read_made(&m, &v);
        assert_int_equal(v.steps, cases[i].steps);
        assert_int_equal(v.dim[2], 2 / cases[i].steps);
        assert_ok(cw_volume_select(&v, 0, v.steps - 1, &last, &err), err);
        assert_true(cw_volume_value(&last, 0, 0, v.dim[2] - 1) == 3);
        cw_volume_free(&v);
    }
}

/* Symmetry or whatever else stands between header and voxels. */
static void extended_headers_are_left_out(void **state)
{
    (void)state;
    map m = make_map(1, 2);
    cw_volume v;
    memmove(m.bytes + HEADER + 80, m.bytes + HEADER, 24);
    m.size += 80;
    put_word(&m, 92, 80);
    read_made(&m, &v);
    assert_true(cw_volume_value(&v, 1, 2, 1) == 8);
    cw_volume_free(&v);
}

static void damaged_headers_are_told_field_by_field(void **state)
{
    (void)state;
    const struct {
        size_t at;
        int32_t value;
        const char *words;
    } cases[] = {
        {0, 0, "are those of no MRC file"},
        {4, -3, "are those of no MRC file"},
        {64, 2, "are those of no MRC file"},
        {212, 0x1111, "are those of no MRC file"},
        {12, 3, "'MODE' is 3 (complex int16); the types"},
        {12, 4, "'MODE' is 4 (complex float32); the types"},
        {12, 16, "'MODE' is 16 (RGB bytes); the types"},
        {12, 101, "'MODE' is 101 (4 bits); the types"},
        {12, 7, "'MODE' is 7; the types"},
        {88, 402, "'ISPG' is 402, a stack of volumes; 'NZ' is 2, which is no multiple of 'MZ'"},
        {92, -1, "'NSYMBT' is -1"},
        {92, 0x7fffffff, "'NX, NY, NZ' asks for 24 bytes of voxels; the file holds 0"},
        {0, 0x7fffffff, "bytes of voxels; the file holds 24"},
        {28, 0, "'CELLA' and 'MX' give axis 0 20 Angstrom in 0 intervals"},
        {44, 0, "'CELLA' and 'MY' give axis 1 0 Angstrom in 10 intervals"},
        {44, 0x7fc00000, "'CELLA' and 'MY' give axis 1 nan"},
        {60, 0x43340000, "'CELLB' is 90 90 180; these are not the angles"},
        {196, 0x7fc00000, "'CELLA, ORIGIN' has numbers that are not finite"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        map m = make_map(1, 2);
        put_word(&m, cases[i].at, cases[i].value);
        save(&m, "a.map");
        check_told("a.map", i, cases[i].words);
    }
}

/* A small gzip file cannot hold many voxels, whatever its header says. */
static void bombs_are_refused_before_memory_is_taken(void **state)
{
    (void)state;
    map m = make_map(1, 2);
    size_t size;
    for (size_t at = 0; at < 8; at += 4)
        put_word(&m, at, 0x7fffffff);
    put_word(&m, 8, 1);
    unsigned char *packed = pack_bytes(m.bytes, m.size, true, &size);
    put_file("a.map.gz", "", packed, size);
    check_told("a.map.gz", 0, "asks for 9223372028264841218 bytes of voxels, encoded");
    put_word(&m, 8, 0x7fffffff);
    save(&m, "a.map");
    check_told("a.map", 1, "more voxels than an address space holds");
    free(packed);
}

static void neither_a_cut_nor_a_tail_is_a_volume(void **state)
{
    (void)state;
    map m = make_map(1, 2);
    size_t size;
    unsigned char *packed = pack_bytes(m.bytes, m.size, true, &size);
    save(&m, "a.mrc");
    check_every_cut("a.mrc");
    put_file("a.map.gz", "", packed, size);
    check_every_cut("a.map.gz");
    check_tail("a.map.gz", "a.map.gz");
    free(packed);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    map m = make_map(1, 2);
    size_t size;
    unsigned char *packed = pack_bytes(m.bytes, m.size, true, &size);
    put_file("a.bin", "", packed, size);
    check_starved_reads("a.bin");
    free(packed);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(modes_byte_orders_and_packings_give_the_same_numbers),
        TEST(axes_may_come_in_any_order),
        TEST(regions_are_crops_in_every_order_of_axes),
        TEST(places_are_origin_words_else_start_words),
        TEST(imod_says_whether_bytes_are_signed),
        TEST(cells_may_be_oblique),
        TEST(all_angles_of_a_cell_may_be_oblique),
        TEST(without_a_cell_nothing_is_known),
        TEST(old_files_have_neither_name_nor_stamp),
        TEST(stacks_of_volumes_are_steps),
        TEST(extended_headers_are_left_out),
        TEST(damaged_headers_are_told_field_by_field),
        TEST(bombs_are_refused_before_memory_is_taken),
        TEST(neither_a_cut_nor_a_tail_is_a_volume),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
