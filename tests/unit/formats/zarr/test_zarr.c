/* Tests the reader of Zarr arrays on stores that the test writes: every number against the function
 * that made it, as a whole and in boxes. */
#include "formats/zarr/zarr.h"
#include "support/files/reading.h"
#include "support/files/regions.h"
#include "support/files/zarr_store.h"

#include <math.h>

static const char *const kinds[] = {"u1", "i1", "u2", "i2", "u4", "i4",
                                    "f4", "f8", "b1", "u8", "i8", "f2"};
static const char *const codecs[] = {NULL, "zlib", "gzip", "zstd", "lz4", "blosc"};
enum { KINDS = sizeof kinds / sizeof *kinds, CODECS = sizeof codecs / sizeof *codecs };

static size_t pick(size_t count)
{
    return (size_t)rand() % count;
}

/* Makes a random array whose shape may have up to four components. */
static zarr_made make_random(const char *name)
{
    zarr_made m = {.name = name,
                   .version = 2 + (int)pick(2),
                   .kind = kinds[pick(KINDS)],
                   .big_endian = pick(2),
                   .rank = 1 + pick(ZARR_MAX_RANK),
                   .has_crc = pick(2),
                   .index_at_start = pick(2),
                   .separator = pick(2) ? '.' : '/',
                   .keys_of_v2 = pick(4) == 0,
                   .left_out = pick(3) ? 0 : 3,
                   .fill = "1",
                   .fill_value = 1,
                   .value = zarr_mixed};
    const bool falls = pick(2), sharded = m.version == 3 && pick(2);
    do
        m.codec = codecs[pick(CODECS)];
    while (!zarr_can_write(m.codec));
    for (size_t d = 0; d < m.rank; d++) {
        m.shape[d] = 1 + pick(m.rank - d > 3 ? 4 : 13);
        m.inner[d] = sharded ? 1 + pick(4) : 0;
        m.chunk[d] = sharded ? m.inner[d] * (1 + pick(3)) : 1 + pick(m.shape[d] + 2);
        m.order[d] = falls ? m.rank - 1 - d : d;
    }
    for (size_t d = 0; m.version == 3 && d < m.rank; d++) {
        const size_t other = pick(m.rank), kept = m.order[d];
        m.order[d] = m.order[other];
        m.order[other] = kept;
    }
    return m;
}

/* Returns the number at a place by role: the last dimension is x. */
static double find_value(const zarr_made *m, const size_t by_role[5])
{
    size_t at[ZARR_MAX_RANK] = {0};
    for (size_t r = 0; r < m->rank; r++)
        at[m->rank - 1 - r] = by_role[r];
    return zarr_value(m, at);
}

static double number_at(cw_type type, const void *voxels, size_t n)
{
    const cw_volume v = {.data = voxels, .type = type, .dim = {n + 1, 1, 1}};
    cw_volume resolved;
    assert_int_equal(cw_volume_resolve(&v, &resolved, NULL), CW_OK);
    return cw_volume_value(&resolved, n, 0, 0);
}

/* Compares packed voxels with the array; the box may be NULL: all. */
static void check_voxels(const zarr_made *m, const cw_volume *shape, const cwi_zarr_box *box,
                         const void *voxels)
{
    const size_t all[5] = {shape->dim[0], shape->dim[1], shape->dim[2], shape->components,
                           shape->steps};
    size_t count[5], n = 0, i[5];
    for (int r = 0; r < 5; r++)
        count[r] = box ? (box->count[r] - 1) / (box->every[r] ? box->every[r] : 1) + 1 : all[r];
    for (i[4] = 0; i[4] < count[4]; i[4]++)
        for (i[3] = 0; i[3] < count[3]; i[3]++)
            for (i[2] = 0; i[2] < count[2]; i[2]++)
                for (i[1] = 0; i[1] < count[1]; i[1]++)
                    for (i[0] = 0; i[0] < count[0]; i[0]++, n++) {
                        size_t at[5];
                        for (int r = 0; r < 5; r++)
                            at[r] =
                                box ? box->first[r] + i[r] * (box->every[r] ? box->every[r] : 1)
                                    : i[r];
                        const double got = number_at(shape->type, voxels, n);
                        if (got != find_value(m, at))
                            fail_msg("%s: voxel %zu is %g, not %g", m->name, n, got,
                                     find_value(m, at));
                    }
}

static void read_random_boxes(const zarr_made *m, int threads, size_t cache_bytes)
{
    const cwi_zarr_desc desc = {.threads = threads, .cache_bytes = cache_bytes};
    cw_error err = {0};
    cwi_zarr *zarr;
    assert_ok(cwi_zarr_open(test_path(m->name), &desc, &zarr, &err), err);
    const cw_volume *v = cwi_zarr_shape(zarr);
    const size_t all[5] = {v->dim[0], v->dim[1], v->dim[2], v->components, v->steps};
    for (int round = 0; round < 6; round++) {
        cwi_zarr_box box;
        size_t voxels = 1;
        for (int r = 0; r < 5; r++) {
            box.first[r] = pick(all[r]);
            box.count[r] = 1 + pick(all[r] - box.first[r]);
            box.every[r] = pick(3);
            voxels *= box.count[r];
        }
        void *to = malloc(voxels * 8);
        assert_ok(cwi_zarr_read_box(zarr, &box, to, NULL, &err), err);
        check_voxels(m, v, &box, to);
        free(to);
    }
    cwi_zarr_close(zarr);
}

static void every_kind_of_array_is_read_voxel_for_voxel(void **state)
{
    (void)state;
    char names[160][16];
    const int rounds = test_some(160);
    test_seed(7);
    for (int n = 0; n < rounds; n++) {
        cw_volume v;
        cw_error err = {0};
        const char *format;
        snprintf(names[n], sizeof names[n], "a%d", n);
        const zarr_made m = make_random(names[n]);
        zarr_write(&m);
        assert_ok(cw_volume_read(test_path(m.name), NULL, &v, &format, &err), err);
        assert_string_equal(format, "zarr");
        for (size_t r = 0; r < 3 && r < m.rank; r++)
            assert_int_equal(v.dim[r], m.shape[m.rank - 1 - r]);
        check_voxels(&m, &v, NULL, v.data);
        cw_volume_free(&v);
        read_random_boxes(&m, 1 + n % 3, n % 4 ? 0 : 64);
    }
}

static void regions_are_parts_of_the_whole(void **state)
{
    (void)state;
    const zarr_made m = {.name = "regions",
                         .version = 3,
                         .kind = "i2",
                         .rank = 4,
                         .shape = {2, 4, 5, 6},
                         .chunk = {2, 4, 4, 4},
                         .inner = {1, 2, 2, 4},
                         .order = {1, 0, 3, 2},
                         .codec = "gzip",
                         .separator = '/',
                         .value = zarr_mixed};
    zarr_write(&m);
    check_regions("regions", NULL);
}

/* --- the cache ---------------------------------------------------------------------------- */

static zarr_made make_slabs(const char *name, bool sharded)
{
    zarr_made m = {.name = name,
                   .version = 3,
                   .kind = "u2",
                   .rank = 3,
                   .shape = {24, 20, 18},
                   .chunk = {8, 8, 8},
                   .order = {0, 1, 2},
                   .codec = "gzip",
                   .has_crc = true,
                   .separator = '/',
                   .value = zarr_mixed};
    for (int d = 0; d < 3 && sharded; d++)
        m.inner[d] = 4;
    return m;
}

/* Reads slabs of `depth` planes and `shared` planes of the next one, and returns the chunks that
 * were decoded. */
static uint64_t read_slabs(const zarr_made *m, size_t depth, size_t shared, size_t cache_bytes)
{
    const cwi_zarr_desc desc = {.cache_bytes = cache_bytes, .threads = 2};
    uint16_t slab[20 * 18 * 24];
    cw_error err = {0};
    cwi_zarr *zarr;
    assert_ok(cwi_zarr_open(test_path(m->name), &desc, &zarr, &err), err);
    for (size_t z = 0; z < 24; z += depth) {
        const size_t planes = z + depth + shared <= 24 ? depth + shared : 24 - z;
        const cwi_zarr_box box =
            cwi_zarr_make_box(zarr, &(cw_box){{0, 0, z}, {18, 20, planes}}, 0, 0);
        assert_ok(cwi_zarr_read_box(zarr, &box, slab, NULL, &err), err);
        check_voxels(m, cwi_zarr_shape(zarr), &box, slab);
    }
    const uint64_t decoded = cwi_zarr_decoded(zarr);
    cwi_zarr_close(zarr);
    return decoded;
}

static void slab_after_slab_decodes_each_chunk_once(void **state)
{
    (void)state;
    const zarr_made plain = make_slabs("plain", false), sharded = make_slabs("sharded", true);
    const size_t chunk = 8 * 8 * 8 * 2, row = 9 * chunk;
    size_t size[3];
    cwi_zarr *zarr;
    zarr_write(&plain);
    zarr_write(&sharded);
    assert_int_equal(read_slabs(&plain, 1, 0, row), 27);
    assert_int_equal(read_slabs(&plain, 5, 0, 2 * row), 27);
    assert_int_equal(read_slabs(&plain, 1, 1, 2 * row), 27);
    assert_int_equal(read_slabs(&plain, 8, 0, 1), 27);
    assert_int_equal(read_slabs(&sharded, 2, 1, 2 * 5 * 5 * 4 * 4 * 4 * 2), 5 * 5 * 6);
    assert_true(read_slabs(&plain, 1, 0, chunk) > 27);
    assert_int_equal(cwi_zarr_open(test_path("sharded"), NULL, &zarr, NULL), CW_OK);
    cwi_zarr_chunk_size(zarr, size);
    assert_int_equal(size[0] * size[1] * size[2], 64);
    cwi_zarr_close(zarr);
}

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    const zarr_made m = make_slabs("memory", true);
    bool failed = true;
    zarr_write(&m);
    for (long n = 0; failed; n++) {
        cw_volume v;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_volume_read(test_path("memory"), NULL, &v, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        cw_volume_free(&v);
    }
}

/* --- numbers ------------------------------------------------------------------------------ */

static double big_value(const zarr_made *m, const size_t at[ZARR_MAX_RANK])
{
    (void)m;
    return at[0] == 2 ? 4294967296.0 : (double)at[0];
}

static void integers_of_64_bits_must_fit_32(void **state)
{
    (void)state;
    zarr_made m = {.name = "wide",
                   .version = 2,
                   .kind = "u8",
                   .rank = 1,
                   .shape = {3},
                   .chunk = {4},
                   .separator = '.',
                   .value = big_value};
    cw_volume v;
    cw_error err = {0};
    zarr_write(&m);
    assert_fails(read_back("wide", &v, &err), CW_ERR_FORMAT,
                 "'dtype' is <u8, and a number is 4294967296", err);
    m.shape[0] = 2;
    zarr_write(&m);
    assert_ok(read_back("wide", &v, &err), err);
    assert_int_equal(v.type, CW_U32);
    cw_volume_free(&v);
}

static const struct {
    const char *kind, *fill;
    double value; /* 1e300: refused; NAN: not a number */
} fills[] = {
    {"f4", "\"NaN\"", NAN},
    {"f8", "\"NaN\"", NAN},
    {"f4", "\"Infinity\"", INFINITY},
    {"f8", "\"-Infinity\"", -INFINITY},
    {"f4", "\"0x3fc00000\"", 1.5},
    {"f8", "\"0xc004000000000000\"", -2.5},
    {"f4", "\"0x3fc0\"", 1e300},
    {"f4", "\"AAA=\"", 1e300},
    {"f4", "null", 0},
    {"u1", "null", 0},
    {"u1", "255", 255},
    {"u1", "256", 1e300},
    {"u1", "-1", 1e300},
    {"i1", "-128", -128},
    {"i2", "1.5", 1e300},
    {"i4", "2147483647", 2147483647},
    {"i4", "2147483648", 1e300},
    {"b1", "true", 1},
    {"b1", "2", 1e300},
    {"u8", "18446744073709551615", 1e299},
    {"i8", "-5", -5},
    {"u2", "\"7\"", 1e300},
    {"f4", "[1]", 1e300},
    {"f8", "-0.25", -0.25},
    {"f2", "-0.25", -0.25},
    {"f2", "\"NaN\"", NAN},
    {"f2", "\"0x3e00\"", 1.5},
};

static void missing_chunks_have_the_fill_value(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof fills / sizeof *fills; n++) {
        for (int version = 2; version <= 3; version++) {
            const zarr_made m = {.name = "fill",
                                 .version = version,
                                 .kind = fills[n].kind,
                                 .rank = 2,
                                 .shape = {3, 2},
                                 .chunk = {3, 2},
                                 .left_out = 1,
                                 .order = {0, 1},
                                 .separator = '/',
                                 .fill = fills[n].fill,
                                 .value = zarr_mixed};
            cw_volume v;
            cw_error err = {0};
            test_folder_remove(NULL);
            test_folder_make(NULL);
            zarr_write(&m);
            if (fills[n].value >= 1e299 && isfinite(fills[n].value)) {
                assert_fails(read_back("fill", &v, &err), CW_ERR_FORMAT,
                             fills[n].value == 1e300 ? "'fill_value' is" : "a number is", err);
                continue;
            }
            assert_ok(read_back("fill", &v, &err), err);
            const double got = cw_volume_value(&v, 1, 2, 0);
            assert_true(isnan(fills[n].value) ? isnan(got) : got == fills[n].value);
            cw_volume_free(&v);
        }
    }
}

/* --- dimensions --------------------------------------------------------------------------- */

static void names_of_dimensions_place_them(void **state)
{
    (void)state;
    for (int version = 2; version <= 3; version++) {
        const zarr_made m = {.name = "named",
                             .version = version,
                             .kind = "u1",
                             .rank = 5,
                             .shape = {6, 2, 5, 3, 4},
                             .chunk = {6, 2, 5, 3, 4},
                             .order = {0, 1, 2, 3, 4},
                             .separator = '.',
                             .names = "[\"X\", \"c\", \"y\", \"time\", \"z\"]",
                             .value = zarr_mixed};
        cw_volume v, one;
        cw_error err = {0};
        zarr_write(&m);
        assert_ok(read_back("named", &v, &err), err);
        assert_int_equal(v.dim[0], 6);
        assert_int_equal(v.dim[1], 5);
        assert_int_equal(v.dim[2], 4);
        assert_int_equal(v.components, 2);
        assert_int_equal(v.steps, 3);
        assert_ok(cw_volume_select(&v, 1, 2, &one, &err), err);
        assert_true(cw_volume_value(&one, 5, 3, 1) ==
                    zarr_value(&m, (const size_t[5]){5, 1, 3, 2, 1}));
        cw_volume_free(&v);
    }
}

/* Two streams of bzip2 in a row, as another program wrote them. */
static void chunks_of_bz2_are_read(void **state)
{
    (void)state;
    static const char bytes[] =
        "BZh91AY&SY\x0a\xb1\x93\x99\0\0\x05\xc0\0\x70\0\x20\0\x20\xa5\x34\x19\x8c\x58\xb0\xbc"
        "\x5d\xc9\x14\xe1\x42\x40\x2a\xc6\x4e\x64"
        "BZh91AY&SY\x0a\xb1\x93\x99\0\0\x05\xc0\0\x70\0\x20\0\x20\xa5\x34\x19\x8c\x58\xb0\xbc"
        "\x5d\xc9\x14\xe1\x42\x40\x2a\xc6\x4e\x64";
    cw_volume v;
    cw_error err = {0};
    zarr_put_text(
        "bz2/.zarray",
        "{\"zarr_format\": 2, \"shape\": [3, 4, 4], \"chunks\": [3, 4, 4], \"dtype\": "
        "\">u2\", \"order\": \"C\", \"fill_value\": 0, \"filters\": null, "
        "\"compressor\": {\"id\": \"bz2\", \"level\": 9}}");
    zarr_put("bz2/0.0.0", bytes, sizeof bytes - 1);
    const cw_status st = read_back("bz2", &v, &err);
    if (st == CW_ERR_UNSUPPORTED)
        return; /* this build lacks it */
    assert_ok(st, err);
    for (size_t n = 0; n < 48; n++)
        assert_int_equal(((const uint16_t *)v.data)[n], 1 + n % 2);
    cw_volume_free(&v);
    zarr_put("bz2/0.0.0", bytes, sizeof bytes - 9);
    assert_fails(read_back("bz2", &v, &err), CW_ERR_FORMAT,
                 "0.0.0: a chunk is damaged, or has more than its 96 bytes (bz2)", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_array_is_read_voxel_for_voxel),
        cmocka_unit_test(regions_are_parts_of_the_whole),
        cmocka_unit_test(slab_after_slab_decodes_each_chunk_once),
        cmocka_unit_test(running_out_of_memory_is_an_error),
        cmocka_unit_test(integers_of_64_bits_must_fit_32),
        cmocka_unit_test(missing_chunks_have_the_fill_value),
        cmocka_unit_test(names_of_dimensions_place_them),
        cmocka_unit_test(chunks_of_bz2_are_read),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
