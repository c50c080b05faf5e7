/* Tests the reader of INR: types, byte orders, gzip, long or damaged headers, cuts and
 * tails. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

static const uint8_t counting[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

/* A header filled up with newlines to a multiple of 256 bytes, in static memory. */
static const char *fill(const char *lines)
{
    static char text[2048];
    const size_t used = (size_t)snprintf(text, sizeof text, "#INRIMAGE-4#{\n%s", lines);
    const size_t size = (used + 4 + 255) / 256 * 256;
    assert_true(size < sizeof text);
    memset(text + used, '\n', size - used);
    memcpy(text + size - 4, "##}\n", 5);
    return text;
}

#define SIZES "XDIM=2\nYDIM=3\nZDIM=2\nVDIM=1\n"
#define U8    SIZES "TYPE=unsigned fixed\nPIXSIZE=8 bits\n"
#define CPU   "CPU=decm\n"

static void a_plain_header_gives_its_voxels(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const char *format = NULL;
    put_file("a.bin",
             fill(U8 "SCALE=2**0\n" CPU "VX=2\nVY=3\nVZ=4.5\nTX=5\nTY=6\nTZ=-7\nRX=0\nXO=9\n"
                     "# a remark\n"),
             counting, sizeof counting);
    assert_ok(cw_volume_read(test_path("a.bin"), NULL, &v, &format, &err), err);
    assert_string_equal(format, "inr");
    assert_int_equal(v.known, 0);
    assert_memory_equal(v.data, counting, sizeof counting);
    check_affine(&v, (const double[12]){2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 4.5, -7});
    cw_volume_free(&v);
}

static void types_and_byte_orders_are_told_by_their_names(void **state)
{
    (void)state;
    const struct {
        const char *lines;
        cw_type type;
        const char *bytes;
        double value;
    } cases[] = {
        {"TYPE=unsigned fixed\nPIXSIZE=8 bits\n", CW_U8, "\xfe", 254},
        {"TYPE=signed fixed\nPIXSIZE=8 bits\nCPU=pc\n", CW_I8, "\xfe", -2},
        {"TYPE=unsigned fixed\nPIXSIZE=16 bits\nCPU=decm\n", CW_U16, "\xfe\xff", 65534},
        {"TYPE=signed fixed\nPIXSIZE=16 bits\nCPU=sun\n", CW_I16, "\xff\xfe", -2},
        {"TYPE=unsigned fixed\nPIXSIZE=32 bits\nCPU=alpha\n", CW_U32, "\0\1\0\0", 256},
        {"TYPE=signed fixed\nPIXSIZE=32\nCPU=sgi\n", CW_I32, "\xff\xff\xff\xfe", -2},
        {"TYPE=float\nPIXSIZE=32 bits\nCPU=sun\n", CW_F32, "\x3f\xc0\0\0", 1.5},
        {"TYPE = float\nPIXSIZE = 64 bits \nCPU = decm\r\n", CW_F64, "\0\0\0\0\0\0\xf8\x3f",
         1.5},
        {"TYPE=signed fixed\nPIXSIZE=8 bits\nSCALE=2**-3\n", CW_I8, "\xfe", -0.25},
        {"TYPE=float\nPIXSIZE=32 bits\nCPU=sun\nSCALE=2**-3\n", CW_F32, "\x3f\xc0\0\0", 1.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char lines[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(lines, sizeof lines, "XDIM=1\nYDIM=1\nZDIM=1\n%s", cases[i].lines);
        put_file("a.inr", fill(lines), cases[i].bytes, cw_type_size(cases[i].type));
        assert_ok(read_back("a.inr", &v, &err), err);
        assert_int_equal(v.type, cases[i].type);
        assert_true(cw_volume_value(&v, 0, 0, 0) == cases[i].value);
        cw_volume_free(&v);
    }
}

static void values_of_a_voxel_are_interleaved(void **state)
{
    (void)state;
    cw_volume v, third;
    cw_error err = {0};
    put_file("a.inr",
             fill("XDIM=2\nYDIM=2\nZDIM=1\nVDIM=3\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n"),
             counting, sizeof counting);
    assert_ok(read_back("a.inr", &v, &err), err);
    assert_int_equal(v.components, 3);
    assert_ok(cw_volume_select(&v, 2, 0, &third, &err), err);
    assert_true(cw_volume_value(&third, 1, 1, 0) == 11);
    cw_volume_free(&v);
}

static void gzip_lines(const char *name, const char *lines)
{
    unsigned char all[2048];
    const char *header = fill(lines);
    const size_t length = strlen(header);
    size_t size;
    memcpy(all, header, length);
    memcpy(all + length, counting, sizeof counting);
    unsigned char *packed = pack_bytes(all, length + sizeof counting, true, &size);
    put_file(name, "", packed, size);
    free(packed);
}

static void gzipped(const char *name)
{
    gzip_lines(name, U8);
}

static void gzip_files_are_found_by_what_is_in_them(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const char *format = NULL;
    gzipped("a.bin");
    assert_ok(cw_volume_read(test_path("a.bin"), NULL, &v, &format, &err), err);
    assert_string_equal(format, "inr");
    assert_memory_equal(v.data, counting, sizeof counting);
    check_regions("a.bin", NULL);
    cw_volume_free(&v);
}

/* More than 256 bytes of lines, a multiple of it in all. */
static void headers_may_be_long(void **state)
{
    (void)state;
    char lines[1500];
    cw_volume v;
    cw_error err = {0};
    memset(lines, '#', 1000);
    snprintf(lines + 1000, 500, "\n%s", U8);
    put_file("a.inr", fill(lines), counting, sizeof counting);
    assert_ok(read_back("a.inr", &v, &err), err);
    assert_memory_equal(v.data, counting, sizeof counting);
    cw_volume_free(&v);
}

static void damaged_headers_are_told_key_by_key(void **state)
{
    (void)state;
    const struct {
        const char *lines, *words;
    } cases[] = {
        {"hello\n", "'hello' holds no 'KEY=value'"},
        {"", "'TYPE' is missing"},
        {SIZES "TYPE=float\n", "'PIXSIZE' is missing"},
        {SIZES "TYPE=packed\nPIXSIZE=8 bits\n", "'TYPE' is packed of 8 bits; the types"},
        {SIZES "TYPE=float\nPIXSIZE=16 bits\n", "'TYPE' is float of 16 bits; the types"},
        {SIZES "TYPE=signed fixed\nPIXSIZE=64 bits\n", "'TYPE' is signed fixed of 64 bits"},
        {SIZES "TYPE=float\nPIXSIZE=many\n", "'PIXSIZE' is 'many'"},
        {SIZES "TYPE=float\nPIXSIZE=4 bytes\n", "'PIXSIZE' is '4 bytes'; '8 bits' or the like"},
        {SIZES "TYPE=float\nPIXSIZE=32 bits\n", "'CPU' is missing; f32 voxels need it"},
        {U8 "CPU=vax\n", "'CPU' is 'vax'"},
        {U8 "XDIM=2\n", "'XDIM' was given before"},
        {"XDIM=2\nZDIM=2\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n", "'YDIM' is missing"},
        {"XDIM=2\nYDIM=0\nZDIM=2\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n", "'YDIM' is '0'"},
        {"XDIM=2\nYDIM=2\nZDIM=2\nVDIM=17\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n",
         "asks for 17 values per voxel"},
        {U8 "SCALE=10\n", "'SCALE' is '10'"},
        {U8 "SCALE=2**999\n", "'SCALE' is '999'"},
        {U8 "VX=x\n", "'VX' holds 'x'"},
        {U8 "VX=0\n", "gives axis 0 no length"},
        {U8 "TZ=nan\n", "not finite"},
        {U8 "RY=0.5\n", "'RX', 'RY', 'RZ' are 0 0.5 0; rotated images are not read"},
        {"XDIM=2147483647\nYDIM=2147483647\nZDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n",
         "asks for 4611686014132420609 bytes of voxels; the file holds 12"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put_file("a.inr", fill(cases[i].lines), counting, sizeof counting);
        check_told("a.inr", i, cases[i].words);
    }
    put_file("a.inr", "#INRIMAGE-5#{\n", counting, sizeof counting);
    check_told("a.inr", 100, "the first line is not '#INRIMAGE-4#{'");
    put_file("a.inr", "#INRIMAGE-4#{\nXDIM=2\n##}\n", counting, sizeof counting);
    check_told("a.inr", 101, "does not end with '##}' at a multiple of 256 bytes");
    gzip_lines("a.inr.gz", "XDIM=2147483647\nYDIM=2147483647\nZDIM=1\nTYPE=unsigned fixed\n"
                           "PIXSIZE=8 bits\n");
    check_told("a.inr.gz", 102, "asks for 4611686014132420609 bytes of voxels, encoded");
    put_file("a.inr",
             fill("XDIM=2147483647\nYDIM=2147483647\nZDIM=9\nTYPE=unsigned fixed\n"
                  "PIXSIZE=8 bits\n"),
             counting, 12);
    check_told("a.inr", 103, "more voxels than an address space holds");
}

static void endless_headers_are_cut_off(void **state)
{
    (void)state;
    enum { SIZE = 3 << 20 };
    char *lines = malloc(SIZE);
    assert_non_null(lines);
    memset(lines, '#', SIZE);
    for (size_t i = 99; i < SIZE; i += 100)
        lines[i] = '\n';
    put_file("a.inr", "#INRIMAGE-4#{\n", lines, SIZE);
    check_told("a.inr", 0, "does not end with '##}' at a multiple of 256 bytes");
    free(lines);
}

static void a_zero_in_the_header_is_named(void **state)
{
    (void)state;
    char text[257] = "#INRIMAGE-4#{";
    memset(text + 13, '\n', 239);
    memcpy(text + 252, "##}\n", 5);
    text[20] = '\0';
    put_file("a.inr", "", text, 256);
    check_told("a.inr", 0, "the header holds a zero byte");
}

static void neither_a_cut_nor_a_tail_is_a_volume(void **state)
{
    (void)state;
    put_file("a.inr", fill(U8), counting, sizeof counting);
    check_every_cut("a.inr");
    gzipped("a.inr.gz");
    check_every_cut("a.inr.gz");
    check_tail("a.inr.gz", "a.inr.gz");
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    gzipped("a.inr.gz");
    check_starved_reads("a.inr.gz");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(a_plain_header_gives_its_voxels),
        TEST(types_and_byte_orders_are_told_by_their_names),
        TEST(values_of_a_voxel_are_interleaved),
        TEST(gzip_files_are_found_by_what_is_in_them),
        TEST(headers_may_be_long),
        TEST(damaged_headers_are_told_key_by_key),
        TEST(endless_headers_are_cut_off),
        TEST(a_zero_in_the_header_is_named),
        TEST(neither_a_cut_nor_a_tail_is_a_volume),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
