/* Evaluates the hard cases, one function and one row each. Values at or above the isovalue are
 * inside. */
#include "core/synthetic/stress_fields.h"

#include "core/geometry/vec3.h"
#include "core/synthetic/random_fill.h"

#include <float.h>
#include <math.h>

typedef struct cwi_hard_sample sample;

static uint64_t number_place(const size_t at[3])
{
    return at[0] + UINT64_C(0x10000) * (at[1] + UINT64_C(0x10000) * at[2]);
}

static double draw_chance(const sample *s, uint64_t stream)
{
    return cwi_chance(s->seed + 977 * stream, number_place(s->at));
}

/* Returns one of -n, ..., n. */
static double draw_whole_number(const sample *s, int n)
{
    return floor((2 * n + 1) * draw_chance(s, 1)) - n;
}

/* Returns the distance from a sample in the middle, along one axis. */
static double from_sample(const sample *s, int axis)
{
    return (double)s->at[axis] - (double)(s->dim[axis] / 2);
}

/* Returns the distance from the middle of a cell in the middle: never 0. */
static double from_cell(const sample *s, int axis)
{
    return from_sample(s, axis) + 0.5;
}

/* Computes the position relative to the middle, off any sample and cell's middle. */
static void from_middle(const sample *s, double p[3])
{
    static const double off[3] = {0.13, -0.08, 0.21};
    for (int a = 0; a < 3; a++)
        p[a] = (double)s->at[a] - 0.5 * (double)(s->dim[a] - 1) + off[a];
}

static double vector_length(double x, double y, double z)
{
    return sqrt(x * x + y * y + z * z);
}

/* Returns half the shortest side, in voxels. */
static double half_extent(const sample *s)
{
    size_t n = s->dim[0] < s->dim[1] ? s->dim[0] : s->dim[1];
    n = n < s->dim[2] ? n : s->dim[2];
    return 0.5 * (double)(n - 1);
}

/* Returns the distance to a sphere of 2/3 of that, positive inside. */
static double evaluate_ball(const sample *s)
{
    double p[3];
    from_middle(s, p);
    return half_extent(s) / 1.5 - vector_length(p[0], p[1], p[2]);
}

/* Samples on the isovalue. */

static double plane_on_samples(const sample *s)
{
    return from_sample(s, 0);
}

static double two_planes_on_samples(const sample *s)
{
    const double x = from_sample(s, 0);
    return x < 0 ? -1 : x < 2 ? 0 : 1;
}

static bool on_border(const sample *s)
{
    for (int a = 0; a < 3; a++)
        if (s->at[a] == 0 || s->at[a] + 1 == s->dim[a])
            return true;
    return false;
}

static double block_on_samples(const sample *s)
{
    bool block = true;
    for (int a = 0; a < 3; a++)
        block = block && s->at[a] >= s->dim[a] / 4 && s->at[a] < s->dim[a] - s->dim[a] / 4;
    return on_border(s) ? -1 : block ? 0 : s->parameter;
}

static double mostly_on_samples(const sample *s)
{
    const double kind = draw_chance(s, 2);
    return kind < 0.2 ? -1 : kind < 0.25 ? 1 : 0;
}

/* Numbers that are often equal. */

static double evaluate_ties(const sample *s)
{
    return draw_whole_number(s, 2);
}

static double evaluate_plateaus(const sample *s)
{
    const size_t brick[3] = {s->at[0] / 3, s->at[1] / 3, s->at[2] / 3};
    return floor(3 * cwi_chance(s->seed, number_place(brick))) - 1;
}

static double evaluate_terraces(const sample *s)
{
    return floor(2 * evaluate_ball(s));
}

static double evaluate_checkerboard(const sample *s)
{
    return (s->at[0] + s->at[1] + s->at[2]) % 2 ? s->parameter : -1;
}

static double evaluate_columns(const sample *s)
{
    return (s->at[0] + s->at[1]) % 2 ? 1 : -1;
}

/* Saddles. */

static double every_case(const sample *s)
{
    size_t cell;
    unsigned corner;
    if (!cwi_hard_cell(s, &cell, &corner))
        return -1;
    return cwi_hard_corner(cell % CWI_HARD_CELLS, corner);
}

static double saddle_line(const sample *s)
{
    return from_cell(s, 0) * from_cell(s, 1);
}

static double saddle_point(const sample *s)
{
    return from_cell(s, 0) * from_cell(s, 1) * from_cell(s, 2);
}

static double monkey_saddle(const sample *s)
{
    const double x = from_sample(s, 0), y = from_sample(s, 1);
    return x * (x * x - 3 * y * y);
}

static double double_cone(const sample *s)
{
    const double x = from_sample(s, 0), y = from_sample(s, 1), z = from_sample(s, 2);
    return x * x + y * y - z * z;
}

/* Moves a number by some steps of its type's precision, up or down. */
static double nudge_number(const sample *s, double x, int steps)
{
    const double to = steps < 0 ? -DBL_MAX : DBL_MAX;
    for (; steps != 0; steps += steps < 0 ? 1 : -1)
        x = s->type == CW_F32 ? (double)nextafterf((float)x, steps < 0 ? -FLT_MAX : FLT_MAX)
                              : nextafter(x, to);
    return x;
}

/* Returns -1, 0 or 1 alternately: a number below the saddle, on it, or above it. */
static int shift_of(size_t cell)
{
    return (int)(cell % 3) - 1;
}

/* Samples the face of corners 0 to 3, turned with the cell's number: a b against 1 a b. a and b
 * have 12 bits each, so that the product is exact in any type. */
static double near_saddle_face(const sample *s)
{
    size_t cell;
    unsigned corner;
    if (!cwi_hard_cell(s, &cell, &corner))
        return -1;
    const size_t turn = cell / 3 % 3;
    const unsigned c = (corner >> turn | corner << (3 - turn)) & 7;
    const double sign = cell / 9 % 2 ? -1 : 1;
    const double a = 1 + floor(2048 * cwi_chance(s->seed, 2 * cell)) / 2048;
    const double b = 1 + floor(2048 * cwi_chance(s->seed, 2 * cell + 1)) / 2048;
    const double face[4] = {1, -a, -b, nudge_number(s, a * b, shift_of(cell))};
    return c > 3 ? -1 : sign * face[c];
}

/* Samples two corners of 3 across a cell of -1: the saddle is at (3 + 3 - 6) / 8 on the
 * diagonal. */
static double near_saddle_inside(const sample *s)
{
    size_t cell;
    unsigned corner;
    if (!cwi_hard_cell(s, &cell, &corner))
        return -1;
    const unsigned first = cell / 3 % 4;
    const double sign = cell / 12 % 2 ? -1 : 1;
    return sign * (corner == first       ? 3
                   : corner == 7 - first ? nudge_number(s, 3, shift_of(cell))
                                         : -1);
}

/* Thin things. */

static double evaluate_sheet(const sample *s)
{
    return s->at[2] == s->dim[2] / 2 ? 1 : -1;
}

static double sheet_askew(const sample *s)
{
    return from_sample(s, 0) + from_sample(s, 1) + from_sample(s, 2) == 0 ? 1 : -1;
}

static double evaluate_wire(const sample *s)
{
    return from_sample(s, 0) == 0 && from_sample(s, 1) == 0 ? 1 : -1;
}

static double wire_askew(const sample *s)
{
    const double x = from_sample(s, 0);
    return x == from_sample(s, 1) && x == from_sample(s, 2) ? 1 : -1;
}

/* Returns the position along a direction without whole numbers: no two rows of samples have
 * equal distances. */
static double along_tilt(const double p[3])
{
    return (p[0] + sqrt(3.0) * p[1] + sqrt(7.0) * p[2]) / sqrt(11.0);
}

static double tilted_sheet(const sample *s)
{
    double p[3];
    from_middle(s, p);
    return 0.5 * s->parameter - fabs(along_tilt(p));
}

static double tilted_wire(const sample *s)
{
    double p[3];
    from_middle(s, p);
    const double along = along_tilt(p);
    const double distance_sq = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - along * along;
    return 0.5 * s->parameter - sqrt(fmax(distance_sq, 0));
}

static double lone_samples(const sample *s)
{
    return draw_chance(s, 3) < 0.1 ? 1 : -1;
}

/* Cusps, corners and tips. */

static double evaluate_astroid(const sample *s)
{
    double p[3];
    from_middle(s, p);
    return cbrt(half_extent(s) * half_extent(s)) - cbrt(p[0] * p[0]) - cbrt(p[1] * p[1]) -
           cbrt(p[2] * p[2]);
}

/* Samples a cube on its tip: three directions at right angles. */
static double evaluate_corners(const sample *s)
{
    static const double axis[3][3] = {{1, 1, 1}, {1, -1, 0}, {1, 1, -2}};
    double p[3], largest = 0;
    from_middle(s, p);
    for (int n = 0; n < 3; n++) {
        const double *d = axis[n];
        const double along = d[0] * p[0] + d[1] * p[1] + d[2] * p[2];
        largest = fmax(largest, fabs(along) / vector_length(d[0], d[1], d[2]));
    }
    return half_extent(s) / 2 - largest;
}

/* Samples a needle that is a quarter as wide as it is long, its tip at the top. */
static double evaluate_spike(const sample *s)
{
    double p[3];
    from_middle(s, p);
    const double h = 0.8 * half_extent(s);
    return fmin((h - p[2]) / 8 - hypot(p[0], p[1]), h + p[2]);
}

/* Frequencies. */

static double near_nyquist(const sample *s)
{
    double p[3];
    from_middle(s, p);
    const double k = 0.93 * CWI_PI;
    return sin(k * p[0]) + sin(k * p[1]) + sin(k * p[2]);
}

/* Samples waves whose frequency grows with the distance, to half a wave a voxel at the nearest
 * border. */
static double zone_plate(const sample *s)
{
    double p[3];
    from_middle(s, p);
    const double distance_sq = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    return cos(CWI_PI / 2 * distance_sq / half_extent(s)) - 0.1;
}

/* Ends of the number line. */

static double huge_values(const sample *s)
{
    double far = 0;
    for (int a = 0; a < 3; a++)
        far += (double)s->dim[a];
    return evaluate_ball(s) / far * (s->type == CW_F32 ? (double)FLT_MAX : DBL_MAX);
}

static double denormal_values(const sample *s)
{
    return rint(4 * evaluate_ball(s)) *
           (s->type == CW_F32 ? (double)FLT_TRUE_MIN : DBL_TRUE_MIN);
}

static double offset_values(const sample *s)
{
    return 1e6 + evaluate_ball(s);
}

static double last_digits(const sample *s)
{
    return nudge_number(s, 1, (int)draw_whole_number(s, 2));
}

static double evaluate_decades(const sample *s)
{
    const double magnitude = pow(10, 30 * (2 * draw_chance(s, 4) - 1));
    return draw_chance(s, 5) < 0.5 ? magnitude : -magnitude;
}

/* Samples without a value, or an infinite one. */

static bool on_island(const sample *s, uint64_t stream)
{
    const size_t block[3] = {s->at[0] / 2, s->at[1] / 2, s->at[2] / 2};
    return cwi_chance(s->seed + stream, number_place(block)) < s->parameter;
}

static double nan_islands(const sample *s)
{
    return on_island(s, 6) ? (double)NAN : evaluate_ball(s);
}

static double nan_checkerboard(const sample *s)
{
    return (s->at[0] + s->at[1] + s->at[2]) % 2 ? (double)NAN : draw_whole_number(s, 2);
}

static double nan_blocks(const sample *s)
{
    return (s->at[0] / 3 + s->at[1] / 3 + s->at[2] / 3) % 2 ? (double)NAN
                                                            : draw_whole_number(s, 2);
}

static double nan_around(const sample *s)
{
    const double d = evaluate_ball(s);
    return d < -0.5 ? (double)NAN : d + 0.7 * draw_whole_number(s, 1);
}

static double inf_islands(const sample *s)
{
    return on_island(s, 7)   ? (double)INFINITY
           : on_island(s, 8) ? -(double)INFINITY
                             : evaluate_ball(s);
}

/* Noise: alone, and on a ball whose values end at -1 and 1, with a signal-to-noise ratio in
 * decibels. */

static double even_noise(const sample *s)
{
    return 2 * draw_chance(s, 9) - 1;
}

static double noisy_ball(const sample *s)
{
    const double signal = fmin(fmax(evaluate_ball(s) / 2, -1), 1);
    return signal + pow(10, -s->parameter / 20) * cwi_gaussian(s->seed, number_place(s->at));
}

/* Samples small spheres, eight voxels apart, each off its block's middle by up to half a
 * voxel. */
static double small_spheres(const sample *s)
{
    double p[3];
    const size_t block[3] = {s->at[0] / 8, s->at[1] / 8, s->at[2] / 8};
    for (uint64_t a = 0; a < 3; a++)
        p[a] = (double)(s->at[a] % 8) - 3 - cwi_chance(s->seed + a, number_place(block));
    return s->parameter - vector_length(p[0], p[1], p[2]);
}

/* The end of a row: isovalue, scale, spacing, first sample; and the parameter. */
#define AT(iso, scale)    (iso), (scale), 1, 0
#define CASE(name, about) "hard/" name, about

static const cwi_hard_row rows[] = {
    {{CASE("plane-on-samples", "a plane of samples on the isovalue"), AT(0, 1)},
     0,
     plane_on_samples},
    {{CASE("two-planes-on-samples", "two planes of samples on the isovalue"), AT(0, 1)},
     0,
     two_planes_on_samples},
    {{CASE("block-in-lower", "a block on the isovalue, lower around it"), AT(0, 1)},
     -1,
     block_on_samples},
    {{CASE("block-in-higher", "a block on the isovalue, higher around it"), AT(0, 1)},
     1,
     block_on_samples},
    {{CASE("mostly-on-samples", "three quarters of the samples on the isovalue"), AT(0, 1)},
     0,
     mostly_on_samples},
    {{CASE("ties", "whole numbers from -2 to 2"), AT(0, 1)}, 0, evaluate_ties},
    {{CASE("plateaus", "bricks of 3 voxels, of -1, 0 or 1"), AT(0, 1)}, 0, evaluate_plateaus},
    {{CASE("terraces", "a ball in steps of half a voxel"), AT(0, 1)}, 0, evaluate_terraces},
    {{CASE("checkerboard", "alternating 1 and -1: every face a tie"), AT(0, 1)},
     1,
     evaluate_checkerboard},
    {{CASE("uneven-checkerboard", "alternating 100 and -1"), AT(0, 1)},
     100,
     evaluate_checkerboard},
    {{CASE("columns", "alternating 1 and -1 in x and y"), AT(0, 1)}, 0, evaluate_columns},
    {{CASE("mc33", "every case of marching cubes, its faces and inside in every way"),
      AT(0, 1)},
     0,
     every_case},
    {{CASE("saddle-line", "x y: saddles of faces on the isovalue, in a line"), AT(0, 4)},
     0,
     saddle_line},
    {{CASE("saddle-point", "x y z: a saddle inside a cell, on the isovalue"), AT(0, 8)},
     0,
     saddle_point},
    {{CASE("monkey-saddle", "x^3 - 3 x y^2: six sheets in a line of samples"), AT(0, 1)},
     0,
     monkey_saddle},
    {{CASE("double-cone", "x^2 + y^2 - z^2: two tips in a sample"), AT(0, 1)}, 0, double_cone},
    {{CASE("near-saddle-face", "faces tied, and a last digit above and below"), AT(0, 0)},
     0,
     near_saddle_face},
    {{CASE("near-saddle-inside", "tunnels tied, and a last digit above and below"), AT(0, 0)},
     0,
     near_saddle_inside},
    {{CASE("sheet", "a sheet one sample thin"), AT(0, 1)}, 0, evaluate_sheet},
    {{CASE("sheet-askew", "a sheet one sample thin, along the diagonals of faces"), AT(0, 1)},
     0,
     sheet_askew},
    {{CASE("wire", "a wire one sample thin"), AT(0, 1)}, 0, evaluate_wire},
    {{CASE("wire-askew", "samples in a row along the cell's diagonal"), AT(0, 1)},
     0,
     wire_askew},
    {{CASE("tilted-sheet", "the distance to a tilted sheet one voxel thick"), AT(0, 16)},
     1,
     tilted_sheet},
    {{CASE("thinner-sheet", "the same, a fifth of a voxel thick"), AT(0, 16)},
     0.2,
     tilted_sheet},
    {{CASE("tilted-wire", "the distance to a tilted wire one voxel thick"), AT(0, 16)},
     1,
     tilted_wire},
    {{CASE("lone-samples", "one sample of ten inside"), AT(0, 1)}, 0, lone_samples},
    {{CASE("astroid", "six cusps"), AT(0, 4)}, 0, evaluate_astroid},
    {{CASE("corners", "a cube on its tip: edges and corners"), AT(0, 4)}, 0, evaluate_corners},
    {{CASE("spike", "a needle with a tip"), AT(0, 4)}, 0, evaluate_spike},
    {{CASE("near-nyquist", "waves of 2.15 voxels"), AT(0, 40)}, 0, near_nyquist},
    {{CASE("zone-plate", "waves, shorter and shorter, to two voxels"), AT(0, 100)},
     0,
     zone_plate},
    {{CASE("nanometres", "a ball, voxels of 1e-6 mm"), 0, 4, 1e-6, 0}, 0, evaluate_ball},
    {{CASE("kilometres", "a ball, voxels of 1e6 mm"), 0, 4, 1e6, 0}, 0, evaluate_ball},
    {{CASE("far-away", "a ball, voxels of a micrometre, a kilometre from zero"), 0, 4, 1e-3,
      1e6},
     0,
     evaluate_ball},
    {{CASE("huge-values", "a ball, values up to the largest floats"), AT(0, 0)},
     0,
     huge_values},
    {{CASE("denormal-values", "a ball, values of the smallest floats"), AT(0, 0)},
     0,
     denormal_values},
    {{CASE("offset-values", "a ball, values from a million up: steps in f32"), AT(1e6, 0)},
     0,
     offset_values},
    {{CASE("last-digits", "1 and the two numbers above and below it"), AT(1, 0)},
     0,
     last_digits},
    {{CASE("decades", "noise over 60 decades"), AT(0, 0)}, 0, evaluate_decades},
    {{CASE("nan-islands", "a ball, NaN in a tenth of the blocks of 2"), AT(0, 0)},
     0.1,
     nan_islands},
    {{CASE("nan-checkerboard", "NaN in every other sample: no cell is whole"), AT(0, 0)},
     0,
     nan_checkerboard},
    {{CASE("nan-blocks", "blocks of 3, every other one NaN"), AT(0, 0)}, 0, nan_blocks},
    {{CASE("nan-around", "a rough ball, NaN around it"), AT(0, 0)}, 0, nan_around},
    {{CASE("inf-islands", "a ball, blocks of 2 at infinity of either sign"), AT(0, 0)},
     0.05,
     inf_islands},
    {{CASE("noise", "noise alone, even from -1 to 1"), AT(0, 100)}, 0, even_noise},
    {{CASE("snr-20", "a ball in Gaussian noise of 20 dB less"), AT(0, 32)}, 20, noisy_ball},
    {{CASE("snr-10", "a ball in Gaussian noise of 10 dB less"), AT(0, 32)}, 10, noisy_ball},
    {{CASE("snr-0", "a ball in as much Gaussian noise"), AT(0, 32)}, 0, noisy_ball},
    {{CASE("spheres-0.5", "spheres of radius 0.5 voxels, at any place"), AT(0, 16)},
     0.5,
     small_spheres},
    {{CASE("spheres-0.75", "spheres of radius 0.75 voxels"), AT(0, 16)}, 0.75, small_spheres},
    {{CASE("spheres-1", "spheres of radius 1 voxel"), AT(0, 16)}, 1, small_spheres},
    {{CASE("spheres-1.5", "spheres of radius 1.5 voxels"), AT(0, 16)}, 1.5, small_spheres},
    {{CASE("spheres-2", "spheres of radius 2 voxels"), AT(0, 16)}, 2, small_spheres},
};

const cwi_hard_row *cwi_hard_row_at(size_t n)
{
    return n < sizeof rows / sizeof *rows ? &rows[n] : NULL;
}
