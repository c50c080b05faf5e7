/* Computes volumes that extractors break on: samples on the isovalue, noise, thin sheets and
 * wires, NaN, infinity. */
#include "support/hostile.h"

#include <float.h>
#include <math.h>

typedef struct test_hostile hostile;

/* SplitMix64 of a sample's place: 0 <= x < 1, the same everywhere. */
static double chance(const size_t at[3], uint64_t seed)
{
    uint64_t z = seed + (at[0] + 1000 * (at[1] + 1000 * at[2]) + 1) * 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* One of -n, ..., n. */
static double whole(const size_t at[3], int n)
{
    return floor((2 * n + 1) * chance(at, 1)) - n;
}

static bool is_signed(const hostile *h)
{
    return h->type != CW_U8 && h->type != CW_U16 && h->type != CW_U32;
}

static bool is_float(const hostile *h)
{
    return h->type == CW_F32 || h->type == CW_F64;
}

/* Returns the coordinate along the axis that the parameter names, for planes, rods and
 * others. */
static size_t along(const hostile *h, const size_t at[3])
{
    return at[(size_t)h->parameter];
}

static size_t sum(const size_t at[3])
{
    return at[0] + at[1] + at[2];
}

/* Samples on the isovalue. */

static double plane_at_level(const hostile *h, const size_t at[3])
{
    return (double)along(h, at) - 3;
}

static double block_at_level(const hostile *h, const size_t at[3])
{
    bool block = true, border = false;
    for (int a = 0; a < 3; a++) {
        block = block && at[a] >= 2 && at[a] <= 4;
        border = border || at[a] == 0 || at[a] + 1 == h->dim[a];
    }
    return block ? 0 : border ? -h->parameter : h->parameter;
}

static double two_planes_at_level(const hostile *h, const size_t at[3])
{
    return along(h, at) < 3 ? -1 : along(h, at) < 5 ? 0 : 1;
}

static double mostly_at_level(const hostile *h, const size_t at[3])
{
    const double kind = chance(at, 2);
    return kind < 0.2 ? h->parameter : kind < 0.25 ? -h->parameter : 0;
}

static double level_within_border(const hostile *h, const size_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] == 0 || at[a] + 1 == h->dim[a])
            return -1;
    return 0;
}

/* Numbers that are often equal. */

static double whole_numbers(const hostile *h, const size_t at[3])
{
    return whole(at, (int)h->parameter) + (is_signed(h) ? 0 : h->parameter);
}

static double bricks(const hostile *h, const size_t at[3])
{
    const size_t edge = (size_t)h->parameter;
    const size_t brick[3] = {at[0] / edge, at[1] / edge, at[2] / edge};
    return whole(brick, 1);
}

static double terraces(const hostile *h, const size_t at[3])
{
    const double x = (double)at[0] - 3.7, y = (double)at[1] - 4.1, z = (double)at[2] - 3.9;
    return floor(h->parameter * (3.2 - sqrt(x * x + y * y + z * z)));
}

static double checkerboard(const hostile *h, const size_t at[3])
{
    return sum(at) % 2 ? h->parameter : -1;
}

static double columns(const hostile *h, const size_t at[3])
{
    return (sum(at) - along(h, at)) % 2 ? 1 : -1;
}

static double stripes(const hostile *h, const size_t at[3])
{
    return along(h, at) % 2 ? 1 : -1;
}

/* Noise. */

static double even_noise(const hostile *h, const size_t at[3])
{
    return h->parameter * (is_signed(h) ? 2 * chance(at, 3) - 1 : chance(at, 3));
}

static double decades(const hostile *h, const size_t at[3])
{
    const double magnitude = pow(10, h->parameter * (2 * chance(at, 4) - 1));
    return chance(at, 5) < 0.5 ? magnitude : -magnitude;
}

static double last_digits(const hostile *h, const size_t at[3])
{
    return 1 + h->parameter * whole(at, 2);
}

static double smallest(const hostile *h, const size_t at[3])
{
    return whole(at, 3) * (h->type == CW_F32 ? (double)FLT_TRUE_MIN : DBL_TRUE_MIN);
}

static double small_beside_large(const hostile *h, const size_t at[3])
{
    return chance(at, 6) < 0.5 ? smallest(h, at) : whole(at, 1);
}

static double largest(const hostile *h)
{
    if (is_float(h))
        return h->type == CW_F32 ? (double)FLT_MAX : DBL_MAX;
    return ldexp(1, 8 * (int)cw_type_size(h->type) - is_signed(h)) - 1;
}

static double extremes(const hostile *h, const size_t at[3])
{
    const double low = is_float(h) ? -largest(h) : is_signed(h) ? -largest(h) - 1 : 0;
    return chance(at, 7) < 0.5 ? low : largest(h);
}

static double near_extremes(const hostile *h, const size_t at[3])
{
    return (2 * chance(at, 8) - 1) * largest(h);
}

/* Things one sample thin, of a field that is below elsewhere. */

static double sheet(const hostile *h, const size_t at[3])
{
    return along(h, at) == 3 ? 1 : -1;
}

static double face_diagonal_sheet(const hostile *h, const size_t at[3])
{
    return sum(at) - along(h, at) == 6 ? 1 : -1;
}

static double other_diagonal_sheet(const hostile *h, const size_t at[3])
{
    const size_t a = (size_t)h->parameter;
    return at[(a + 1) % 3] == at[(a + 2) % 3] ? 1 : -1;
}

static double diagonal_sheet(const hostile *h, const size_t at[3])
{
    return sum(at) == (size_t)h->parameter ? 1 : -1;
}

static double wire(const hostile *h, const size_t at[3])
{
    const size_t a = (size_t)h->parameter;
    return at[(a + 1) % 3] == 3 && at[(a + 2) % 3] == 2 ? 1 : -1;
}

static double face_diagonal_wire(const hostile *h, const size_t at[3])
{
    return along(h, at) == 3 ? other_diagonal_sheet(h, at) : -1;
}

static double diagonal_wire(const hostile *h, const size_t at[3])
{
    return at[0] == at[1] && at[1] == at[2] ? h->parameter : -1;
}

static double crossing_wires(const hostile *h, const size_t at[3])
{
    return (at[0] == 3) + (at[1] == 3) + (at[2] == 3) >= h->parameter ? 1 : -1;
}

static double lone_samples(const hostile *h, const size_t at[3])
{
    return chance(at, 9) < h->parameter ? 1 : -1;
}

/* Samples without a value, or an infinite one. */

static double with_nan(const hostile *h, const size_t at[3])
{
    return chance(at, 10) < h->parameter ? (double)NAN : 2 * chance(at, 11) - 1;
}

static double half_nan(const hostile *h, const size_t at[3])
{
    return along(h, at) > 3 ? (double)NAN : whole(at, 2);
}

static double ball_in_nan(const hostile *h, const size_t at[3])
{
    const double d = terraces(h, at);
    return d < -1 ? (double)NAN : d + whole(at, 1);
}

static double nan_planes(const hostile *h, const size_t at[3])
{
    return along(h, at) % 3 == 2 ? (double)NAN : whole(at, 2);
}

static double nan_checkerboard(const hostile *h, const size_t at[3])
{
    const size_t edge = (size_t)h->parameter;
    return (at[0] / edge + at[1] / edge + at[2] / edge) % 2 ? (double)NAN : whole(at, 2);
}

static double with_infinity(const hostile *h, const size_t at[3])
{
    const double kind = chance(at, 12);
    return kind < h->parameter       ? (double)INFINITY
           : kind < 2 * h->parameter ? -(double)INFINITY
                                     : whole(at, 2);
}

/* clang-format off */
#define CUBE  {7, 7, 7}
#define BRICK {8, 7, 6}
/* clang-format on */

/* Fields that may follow in a row: isovalue and parameter; and the number for no value. */
#define AT(level, with) .isovalue = (level), .parameter = (with)
#define WITHOUT(number) .has_nodata = true, .nodata = (number)

static const hostile table[] = {
    {"a plane on the isovalue, x", plane_at_level, CW_F32, CUBE, AT(0, 0)},
    {"a plane on the isovalue, y", plane_at_level, CW_I16, CUBE, AT(0, 1)},
    {"a plane on the isovalue, z", plane_at_level, CW_F64, CUBE, AT(0, 2)},
    {"a block on the isovalue within lower ones", block_at_level, CW_F32, CUBE, AT(0, -1)},
    {"a block on the isovalue within higher ones", block_at_level, CW_I8, CUBE, AT(0, 1)},
    {"two planes on the isovalue", two_planes_at_level, CW_F32, CUBE, AT(0, 2)},
    {"on the isovalue, some below", mostly_at_level, CW_F32, BRICK, AT(0, -1)},
    {"on the isovalue, some above", mostly_at_level, CW_F32, BRICK, AT(0, 1)},
    {"on the isovalue but for the border", level_within_border, CW_F32, BRICK, AT(0, 0)},
#define ROW(name, ctype, text)                                                                 \
    {"whole numbers in " text, whole_numbers, name, BRICK, AT(2, 2)},                          \
        {"extremes of " text, extremes, name, BRICK, AT(1, 0)},
    CW_TYPE_TABLE(ROW)
#undef ROW
        {"whole numbers around 0", whole_numbers, CW_I32, BRICK, AT(0, 2)},
    {"zeros and ones, at 1", whole_numbers, CW_U8, BRICK, AT(1, 1)},
    {"whole numbers, between", whole_numbers, CW_I16, BRICK, AT(0.5, 2)},
    {"a row longer than a word", whole_numbers, CW_I8, {131, 4, 3}, AT(0, 1)},
    {"bricks of 2", bricks, CW_I8, {8, 8, 8}, AT(0, 2)},
    {"bricks of 3", bricks, CW_F32, {9, 9, 9}, AT(0, 3)},
    {"terraces", terraces, CW_F32, {8, 9, 8}, AT(0, 1)},
    {"narrow terraces", terraces, CW_F32, {8, 9, 8}, AT(0, 2)},
    {"a checkerboard", checkerboard, CW_F32, BRICK, AT(0, 1)},
    {"a checkerboard at a corner's value", checkerboard, CW_I8, BRICK, AT(1, 1)},
    {"an uneven checkerboard", checkerboard, CW_F64, BRICK, AT(0, 5000)},
    {"columns along x", columns, CW_F32, BRICK, AT(0, 0)},
    {"columns along y", columns, CW_I8, BRICK, AT(0, 1)},
    {"columns along z", columns, CW_F64, BRICK, AT(0, 2)},
    {"stripes along x", stripes, CW_F32, BRICK, AT(0, 0)},
    {"stripes along z", stripes, CW_F32, BRICK, AT(0, 2)},
    {"noise in bytes", even_noise, CW_U8, {11, 10, 9}, AT(128, 256)},
    {"noise in floats", even_noise, CW_F32, {11, 10, 9}, AT(0, 1)},
    {"noise in doubles", even_noise, CW_F64, {9, 10, 11}, AT(0, 1)},
    {"noise over 6 decades", decades, CW_F32, BRICK, AT(0, 3)},
    {"noise over 60 decades", decades, CW_F32, BRICK, AT(0, 30)},
    {"noise over 600 decades", decades, CW_F64, BRICK, AT(0, 300)},
    {"last digits of floats, at 1", last_digits, CW_F32, BRICK, AT(1, 0x1p-23)},
    {"last digits of floats, above 1", last_digits, CW_F32, BRICK, AT(1 + 0x1p-52, 0x1p-23)},
    {"last digits of floats, below 1", last_digits, CW_F32, BRICK, AT(1 - 0x1p-53, 0x1p-23)},
    {"last digits of floats, a float above 1", last_digits, CW_F32, BRICK,
     AT(1 + 0x1p-23, 0x1p-23)},
    {"last digits of doubles, at 1", last_digits, CW_F64, BRICK, AT(1, 0x1p-52)},
    {"last digits of doubles, above 1", last_digits, CW_F64, BRICK, AT(1 + 0x1p-52, 0x1p-52)},
    {"last digits of doubles, below 1", last_digits, CW_F64, BRICK, AT(1 - 0x1p-53, 0x1p-52)},
    {"whole numbers, just above 1", whole_numbers, CW_I32, BRICK, AT(1 + 0x1p-52, 2)},
    {"whole numbers, just below 1", whole_numbers, CW_U32, BRICK, AT(1 - 0x1p-53, 2)},
    {"denormal floats", smallest, CW_F32, BRICK, AT(0, 0)},
    {"denormal doubles", smallest, CW_F64, BRICK, AT(0, 0)},
    {"denormal floats beside 1", small_beside_large, CW_F32, BRICK, AT(0, 0)},
    {"denormal doubles beside 1", small_beside_large, CW_F64, BRICK, AT(0, 0)},
    {"floats up to the largest", near_extremes, CW_F32, BRICK, AT(0, 0)},
    {"doubles up to the largest", near_extremes, CW_F64, BRICK, AT(0, 0)},
    {"the largest floats, at the largest", extremes, CW_F32, BRICK, AT((double)FLT_MAX, 0)},
    {"the largest doubles, at the largest", extremes, CW_F64, BRICK, AT(DBL_MAX, 0)},
    {"the largest floats, past the smallest", extremes, CW_F32, BRICK, AT(-0x1.fffffdp127, 0)},
    {"the largest doubles, past the smallest", extremes, CW_F64, BRICK,
     AT(-0x1.ffffffffffffep1023, 0)},
    {"a sheet across x", sheet, CW_F32, CUBE, AT(0, 0)},
    {"a sheet across y", sheet, CW_I8, CUBE, AT(0, 1)},
    {"a sheet across z", sheet, CW_F64, CUBE, AT(0, 2)},
    {"a sheet along x, askew", face_diagonal_sheet, CW_F32, CUBE, AT(0, 0)},
    {"a sheet along y, askew", face_diagonal_sheet, CW_F32, CUBE, AT(0, 1)},
    {"a sheet along z, askew", face_diagonal_sheet, CW_F32, CUBE, AT(0, 2)},
    {"a sheet along x, the other way", other_diagonal_sheet, CW_F32, CUBE, AT(0, 0)},
    {"a sheet along z, the other way", other_diagonal_sheet, CW_F32, CUBE, AT(0, 2)},
    {"a sheet across the diagonal", diagonal_sheet, CW_F32, CUBE, AT(0, 9)},
    {"a sheet off the middle", diagonal_sheet, CW_F32, CUBE, AT(0, 8)},
    {"a wire along x", wire, CW_F32, CUBE, AT(0, 0)},
    {"a wire along y", wire, CW_F32, CUBE, AT(0, 1)},
    {"a wire along z", wire, CW_F32, CUBE, AT(0, 2)},
    {"a wire askew in a plane", face_diagonal_wire, CW_F32, CUBE, AT(0, 1)},
    {"a wire along the diagonal", diagonal_wire, CW_F32, CUBE, AT(0, 1)},
    {"a faint wire along the diagonal", diagonal_wire, CW_F32, CUBE, AT(0, 1e-6)},
    {"a strong wire along the diagonal", diagonal_wire, CW_F32, CUBE, AT(0, 1e6)},
    {"crossing wires", crossing_wires, CW_F32, CUBE, AT(0, 2)},
    {"crossing sheets", crossing_wires, CW_F32, CUBE, AT(0, 1)},
    {"few lone samples", lone_samples, CW_F32, BRICK, AT(0, 0.1)},
    {"many lone samples", lone_samples, CW_F32, BRICK, AT(0, 0.4)},
    {"2 samples along x", whole_numbers, CW_I8, {2, 9, 8}, AT(0, 2)},
    {"2 samples along y", whole_numbers, CW_I8, {9, 2, 8}, AT(0, 2)},
    {"2 samples along z", whole_numbers, CW_I8, {9, 8, 2}, AT(0, 2)},
    {"2 x 2 samples along x", whole_numbers, CW_I8, {40, 2, 2}, AT(0, 2)},
    {"2 x 2 samples along z", whole_numbers, CW_I8, {2, 2, 40}, AT(0, 2)},
    {"one cell", whole_numbers, CW_F32, {2, 2, 2}, AT(0, 2)},
    {"one cell of noise", even_noise, CW_F32, {2, 2, 2}, AT(0, 1)},
    {"one cell of a checkerboard", checkerboard, CW_F32, {2, 2, 2}, AT(0, 1)},
    {"a thin checkerboard", checkerboard, CW_F32, {9, 2, 8}, AT(0, 1)},
    {"a thin volume with gaps", with_nan, CW_F32, {9, 8, 2}, AT(0, 0.1)},
    {"some NaN", with_nan, CW_F32, {9, 8, 9}, AT(0, 0.05)},
    {"much NaN", with_nan, CW_F64, {9, 8, 9}, AT(0, 0.4)},
    {"almost all NaN", with_nan, CW_F32, {9, 8, 9}, AT(0, 0.8)},
    {"NaN beyond a plane", half_nan, CW_F32, BRICK, AT(0, 0)},
    {"NaN around a ball", ball_in_nan, CW_F32, {8, 9, 8}, AT(0, 1)},
    {"planes of NaN", nan_planes, CW_F64, BRICK, AT(0, 1)},
    {"a checkerboard of NaN", nan_checkerboard, CW_F32, BRICK, AT(0, 1)},
    {"a checkerboard of blocks of NaN", nan_checkerboard, CW_F32, {9, 9, 9}, AT(0, 3)},
    {"no-data that is above", whole_numbers, CW_I16, {9, 8, 9}, AT(0, 2), WITHOUT(2)},
    {"no-data that is below", whole_numbers, CW_U8, {9, 8, 9}, AT(2, 3), WITHOUT(1)},
    {"no-data on the isovalue", whole_numbers, CW_F32, {9, 8, 9}, AT(0, 2), WITHOUT(0)},
    {"no-data beside NaN", nan_planes, CW_F64, {9, 8, 9}, AT(0, 2), WITHOUT(-1)},
    {"some infinite samples", with_infinity, CW_F32, BRICK, AT(0, 0.05)},
    {"many infinite samples", with_infinity, CW_F64, BRICK, AT(0, 0.3)},
    {"nothing but infinite samples", with_infinity, CW_F32, BRICK, AT(0, 0.5)},
};

const test_hostile *test_hostile_at(size_t n)
{
    return n < sizeof table / sizeof *table ? &table[n] : NULL;
}

void test_store(cw_type type, void *voxels, size_t n, double value)
{
    switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        ((ctype *)voxels)[n] = (ctype)value;                                                   \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
}

cw_status test_hostile_make(const test_hostile *h, cw_volume *volume, cw_error *err)
{
    const cw_status st = cw_volume_alloc(volume, h->type, h->dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    volume->has_nodata = h->has_nodata;
    volume->nodata = h->nodata;
    size_t at[3], n = 0;
    for (at[2] = 0; at[2] < h->dim[2]; at[2]++)
        for (at[1] = 0; at[1] < h->dim[1]; at[1]++)
            for (at[0] = 0; at[0] < h->dim[0]; at[0]++)
                test_store(h->type, cw_volume_voxels(volume), n++, h->value(h, at));
    return CW_OK;
}

static const test_frame frames[] = {
    {"identity", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, false},
    {"mirrored", {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, false},
    {"turned", {{0, 0, -1, 5}, {1, 0, 0, -7}, {0, -1, 0, 9}}, false},
    {"sheared", {{1, 0.7, -0.4, 0}, {0.2, 1.1, 0.6, 0}, {-0.3, 0.1, 0.9, 0}}, false},
    {"sheared and mirrored",
     {{1, 0.7, 1.4, 0}, {0.2, -1.1, 0.6, 0}, {0.3, 0.5, 0.9, 0}},
     false},
    {"flat", {{0.1, 0, 0, 0}, {0, 0.1, 0, 0}, {0, 0, 5, 0}}, false},
    {"thick and turned", {{0.4, 0.3, 0, 0}, {-0.18, 0.24, 4, 0}, {0.24, -0.32, 3, 0}}, false},
    {"tiny", {{1e-30, 0, 0, 0}, {0, 1e-30, 0, 0}, {0, 0, 1e-30, 0}}, false},
    {"huge", {{1e30, 0, 0, 0}, {0, 1e30, 0, 0}, {0, 0, 1e30, 0}}, false},
    {"a nanometre", {{1e-6, 0, 0, 0}, {0, 1e-6, 0, 0}, {0, 0, 1e-6, 0}}, false},
    {"a kilometre", {{1e6, 0, 0, 0}, {0, 1e6, 0, 0}, {0, 0, 1e6, 0}}, false},
    {"a kilometre away", {{0.3, 0, 0, 1e6}, {0, 0.3, 0, -1e6}, {0, 0, 0.3, 1e6}}, true},
};

const test_frame *test_frame_at(size_t n)
{
    return n < sizeof frames / sizeof *frames ? &frames[n] : NULL;
}
