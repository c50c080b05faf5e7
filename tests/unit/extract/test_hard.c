/* Tests the hard cases: the promise on any input with every setting, the topology of the
 * trilinear field, and, where the surface is known, how far from it vertices may be. */
#include "support/surface.h"
#include "support/truth.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS = 32 };

typedef enum judge {
    NOBODY, /* some samples are not finite, or too many decades apart */
    PICTURES,
    TIES,   /* samples or saddles stand on the isovalue */
    COUNT,  /* saddles too many or too close to it for pictures */
    FLAT,   /* too many equal samples for counting: see flat_truth() */
    TUNNELS /* so close inside that the count does not either: see near_tunnels() */
} judge;

/* From the middle, as the cases have it. */
typedef struct point {
    double p[3], reach;
} point;

static double ball(const point *at)
{
    return at->reach / 1.5 - hypot(hypot(at->p[0], at->p[1]), at->p[2]);
}

static double tilt(const point *at)
{
    return (at->p[0] + sqrt(3.0) * at->p[1] + sqrt(7.0) * at->p[2]) / sqrt(11.0);
}

static double sheet(const point *at)
{
    return 0.5 - fabs(at->p[2]);
}

static double wire(const point *at)
{
    return 0.5 - hypot(at->p[0], at->p[1]);
}

static double tilted_sheet(const point *at)
{
    return 0.5 - fabs(tilt(at));
}

static double thinner_sheet(const point *at)
{
    return 0.1 - fabs(tilt(at));
}

static double tilted_wire(const point *at)
{
    const double *p = at->p, along = tilt(at);
    return 0.5 - sqrt(fmax(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - along * along, 0));
}

static double cube(const point *at)
{
    const double *p = at->p, a = fabs(p[0] + p[1] + p[2]) / sqrt(3.0),
                 b = fabs(p[0] - p[1]) / sqrt(2.0),
                 c = fabs(p[0] + p[1] - 2 * p[2]) / sqrt(6.0);
    return at->reach / 2 - fmax(a, fmax(b, c));
}

static double spike(const point *at)
{
    const double h = 0.8 * at->reach;
    return fmin((h - at->p[2]) / 8 - hypot(at->p[0], at->p[1]), h + at->p[2]);
}

/* Half a voxel holds of any distance: what has slope 1 cannot leave the line between two
 * samples a voxel apart by more. Of a ball the second derivative along an edge is at most one
 * over the distance to its middle, and the line is off by an eighth of that. Both as long as
 * samples are right: half a step of theirs comes on top. A sample in the middle is less than a voxel
 * from the middle. */
static const double ANY = 0.5 + 1e-3, ROUND = 1 / (8 * (8 / 3.0 - 1)) + 1e-3, MIDDLE = 1;

/* In which unit differences from the isovalue are handed to the judge, so that floats hold them
 * and ties are whole numbers; 0 stands for 1. */
typedef struct row {
    const char *name;
    judge judge;
    double unit;
    double (*distance)(const point *at);
    double bound; /* in voxels; without a distance: of nothing */
} row;

#define JUDGED(name, judge)                                                                    \
    {                                                                                          \
        "hard/" name, judge, 0, NULL, 0                                                        \
    }

static const row rows[] = {
    JUDGED("plane-on-samples", TIES),
    JUDGED("two-planes-on-samples", TIES),
    JUDGED("block-in-lower", TIES),
    JUDGED("block-in-higher", TIES),
    {"hard/mostly-on-samples", FLAT, 0, NULL, 0},
    JUDGED("ties", TIES),
    JUDGED("plateaus", TIES),
    {"hard/terraces", TIES, 0, ball, 0.5 + 0.076},
    {"hard/checkerboard", FLAT, 0, NULL, 0},
    JUDGED("uneven-checkerboard", TIES),
    JUDGED("columns", TIES),
    JUDGED("mc33", PICTURES),
    JUDGED("saddle-line", TIES),
    JUDGED("saddle-point", TIES),
    JUDGED("monkey-saddle", TIES),
    JUDGED("double-cone", TIES),
    JUDGED("near-saddle-face", COUNT),
    {"hard/near-saddle-inside", TUNNELS, 0, NULL, 0},
    {"hard/sheet", TIES, 0, sheet, MIDDLE},
    JUDGED("sheet-askew", TIES),
    {"hard/wire", TIES, 0, wire, MIDDLE},
    JUDGED("wire-askew", TIES),
    {"hard/tilted-sheet", PICTURES, 0, tilted_sheet, ANY},
    {"hard/thinner-sheet", PICTURES, 0, thinner_sheet, ANY},
    {"hard/tilted-wire", PICTURES, 0, tilted_wire, ANY},
    JUDGED("lone-samples", TIES),
    JUDGED("astroid", PICTURES),
    {"hard/corners", PICTURES, 0, cube, ANY},
    {"hard/spike", PICTURES, 0, spike, 1.01 * ANY},
    JUDGED("near-nyquist", PICTURES),
    JUDGED("zone-plate", COUNT),
    {"hard/nanometres", PICTURES, 0, ball, ROUND},
    {"hard/kilometres", PICTURES, 0, ball, ROUND},
    {"hard/far-away", PICTURES, 0, ball, ROUND},
    {"hard/huge-values", PICTURES, 0x1p-120, ball, ROUND},
    {"hard/denormal-values", TIES, 0x1p149, ball, ROUND + 0.125},
    {"hard/offset-values", TIES, 0, ball, ROUND + 0.03125},
    {"hard/last-digits", TIES, 0x1p24, NULL, 0},
    JUDGED("decades", NOBODY),
    JUDGED("nan-islands", NOBODY),
    JUDGED("nan-checkerboard", NOBODY),
    JUDGED("nan-blocks", NOBODY),
    JUDGED("nan-around", NOBODY),
    JUDGED("inf-islands", NOBODY),
    JUDGED("noise", PICTURES),
    JUDGED("snr-20", PICTURES),
    JUDGED("snr-10", PICTURES),
    JUDGED("snr-0", PICTURES),
    JUDGED("spheres-0.5", PICTURES),
    JUDGED("spheres-0.75", PICTURES),
    JUDGED("spheres-1", PICTURES),
    JUDGED("spheres-1.5", PICTURES),
    JUDGED("spheres-2", PICTURES),
};

enum { ROWS = sizeof rows / sizeof *rows, X = 11, Y = 10, Z = 9, SAMPLES = X * Y * Z };

static cw_volume make(size_t n, cw_type type, size_t x, size_t y, size_t z)
{
    const cw_hard_desc desc = {.number = n, .dim = {x, y, z}, .type = type};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_hard_sample(&desc, &v, &err), err);
    return v;
}

static bool fits(size_t n, cw_type type)
{
    return cw_hard_at(n)->scale != 0 || type == CW_F32 || type == CW_F64;
}

static void every_case_has_a_row(void **state)
{
    (void)state;
    for (size_t n = 0; n < ROWS; n++)
        assert_string_equal(cw_hard_at(n)->name, rows[n].name);
    assert_null(cw_hard_at(ROWS));
}

static bool keeps_promise(size_t n, cw_type type, unsigned setting)
{
    cw_volume v = make(n, type, X, Y, Z);
    const cw_extract_desc d = {.isovalue = cw_hard_stored(n, type, cw_hard_at(n)->isovalue),
                               .leave_open = setting & 1,
                               .inside_is_low = setting & 2,
                               .simple_topology = setting & 4,
                               .cubic_placement = setting & 8,
                               .snap = setting & 16 ? 0.3 : 0,
                               .threads = 1};
    cw_mesh mesh = test_extract(&v, &d, NULL);
    memset(mesh.origin, 0, sizeof mesh.origin); /* far away points have no digits left */
    cw_quality q = {0};
    const char *fault = test_mesh_fault(&mesh, d.leave_open, &q);
    if (!fault && mesh.triangle_count == 0 && !d.leave_open && rows[n].judge != PICTURES)
        fault = "no triangle";
    if (!fault && !d.leave_open && mesh.triangle_count > 0 && !(q.volume_mm3 > 0))
        fault = "its outside inside";
    if (!fault && type == CW_F32 && setting == 0 && test_count_crossings(&mesh) > 0)
        fault = "triangles that cross";
    if (fault)
        print_message("%s, %s, setting %u: the mesh has %s\n", rows[n].name, cw_type_name(type),
                      setting, fault);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
    return fault == NULL;
}

/* Every setting in floats, and one in each other type. */
static void surfaces_keep_the_promise(void **state)
{
    (void)state;
    int broken = 0;
    for (size_t n = 0; n < ROWS; n++) {
        for (unsigned s = test_is_short() ? n % 9 : 0; s < SETTINGS;
             s += test_is_short() ? 9 : 1)
            broken += !keeps_promise(n, CW_F32, s);
        for (unsigned type = 0; type < CW_TYPE_COUNT; type++)
            if (type != CW_F32 && fits(n, (cw_type)type))
                broken += !keeps_promise(n, (cw_type)type, (unsigned)(5 * n + type) % SETTINGS);
    }
    assert_int_equal(broken, 0);
}

/* Counts the topology of a mesh. */
static test_truth topology_of(const cw_volume *v, double isovalue)
{
    const cw_extract_desc d = {.isovalue = isovalue, .threads = 1};
    cw_mesh mesh = test_extract(v, &d, NULL);
    memset(mesh.origin, 0, sizeof mesh.origin);
    const cw_quality q = test_measure(&mesh);
    cw_mesh_free(&mesh);
    return (test_truth){true, q.components, (long)q.euler};
}

/* By the corner that stands out: two of 3 in -1 are joined where the saddle between them is at
 * the isovalue or above; two of -3 in 1 leave a ball, with a hole where it is below. */
static test_truth near_tunnels(const size_t dim[3])
{
    test_truth t = {.decidable = true};
    const size_t cells = (dim[0] + 1) / 3 * ((dim[1] + 1) / 3) * ((dim[2] + 1) / 3);
    for (size_t n = 0; n < cells; n++) {
        const bool negated = n / 12 % 2, below = negated ? n % 3 == 2 : n % 3 == 0;
        t.components += negated || !below ? 1 : 2;
        t.euler += negated ? (below ? 0 : 2) : below ? 4 : 2;
    }
    return t;
}

/* Critical points that coincide cannot be counted, but seen: a tenth below the isovalue, and
 * twice as fine. */
static test_truth flat_truth(const float *voxels, const size_t dim[3])
{
    test_truth t = test_topology_pictured(voxels, dim, -0.1f, 24);
    const test_truth finer = test_topology_pictured(voxels, dim, -0.1f, 48);
    t.decidable = t.components == finer.components && t.euler == finer.euler;
    return t;
}

static test_truth truth_of(const row *r, const cw_volume *v, double isovalue)
{
    static float voxels[SAMPLES];
    const double unit = r->unit > 0 ? r->unit : 1;
    for (size_t n = 0; n < SAMPLES; n++) {
        const double value = cw_volume_value(v, n % X, n / X % Y, n / X / Y);
        voxels[n] = (float)((value - isovalue) * unit);
    }
    const bool floats = v->type == CW_F32;
    return r->judge == TUNNELS              ? near_tunnels(v->dim)
           : r->judge == FLAT               ? flat_truth(voxels, v->dim)
           : r->judge == COUNT              ? test_topology_counted(voxels, v->dim, 0)
           : r->judge == PICTURES && floats ? test_topology_of(voxels, v->dim, 0)
                                            : test_topology_tied(voxels, v->dim, 0, 0.01f);
}

static bool has_its_topology(size_t n, cw_type type)
{
    cw_volume v = make(n, type, X, Y, Z);
    const double isovalue = cw_hard_stored(n, type, cw_hard_at(n)->isovalue);
    const test_truth truth = truth_of(&rows[n], &v, isovalue);
    const test_truth mesh = topology_of(&v, isovalue);
    cw_volume_free(&v);
    if (truth.decidable && truth.components == mesh.components && truth.euler == mesh.euler)
        return true;
    print_message("%s, %s: %s%zu components, Euler number %ld; the mesh has %zu, %ld\n",
                  rows[n].name, cw_type_name(type), truth.decidable ? "" : "not sure of ",
                  truth.components, truth.euler, mesh.components, mesh.euler);
    return false;
}

static void surfaces_have_the_topology_of_their_field(void **state)
{
    (void)state;
    int wrong = 0;
    for (size_t n = 0; n < ROWS; n += test_is_short() ? 5 : 1) {
        if (rows[n].judge == NOBODY)
            continue;
        wrong += !has_its_topology(n, CW_F32);
        if (fits(n, CW_U8))
            wrong += !has_its_topology(n, n % 2 ? CW_U8 : CW_I16);
    }
    assert_int_equal(wrong, 0);
}

/* Numbers of 12 bits, whose products both types hold: a last digit of a double tells as much.
 * Inside, differences of doubles do, which take a wider type. */
static void near_saddles_are_as_near_in_doubles(void **state)
{
    (void)state;
    for (size_t n = 0; n < ROWS; n++)
        if (strcmp(rows[n].name, "hard/near-saddle-face") == 0 ||
            (rows[n].judge == TUNNELS && LDBL_MANT_DIG > DBL_MANT_DIG)) {
            cw_volume f = make(n, CW_F32, 24, 25, 26), d = make(n, CW_F64, 24, 25, 26);
            const test_truth a = topology_of(&f, 0), b = topology_of(&d, 0);
            assert_int_equal(a.components, b.components);
            assert_int_equal(a.euler, b.euler);
            cw_volume_free(&f);
            cw_volume_free(&d);
        }
}

/* Largest value of the true field at a vertex that is no cap's. */
static double largest_error(const row *r, const cw_volume *v, const cw_mesh *mesh)
{
    static const double off[3] = {0.13, -0.08, 0.21};
    double largest = 0;
    for (size_t n = 0; n < mesh->vertex_count; n++) {
        double world[3], index[3];
        bool cap = false;
        point at = {.reach = 0.5 * (Z - 1)};
        for (size_t a = 0; a < 3; a++)
            world[a] = mesh->origin[a] + (double)mesh->positions[3 * n + a];
        assert_int_equal(cw_volume_to_index(v, world, index, NULL), CW_OK);
        for (int a = 0; a < 3; a++) {
            cap = cap || index[a] < 0 || index[a] > (double)(v->dim[a] - 1);
            at.p[a] = index[a] - 0.5 * (double)(v->dim[a] - 1) + off[a];
        }
        largest = cap ? largest : fmax(largest, fabs(r->distance(&at)));
    }
    return largest;
}

static void vertices_are_near_surfaces_that_are_known(void **state)
{
    (void)state;
    for (size_t n = 0; n < ROWS; n++) {
        if (!rows[n].distance)
            continue;
        cw_volume v = make(n, CW_F32, X, Y, Z);
        const cw_extract_desc d = {.isovalue = cw_hard_at(n)->isovalue};
        cw_mesh mesh = test_extract(&v, &d, NULL);
        const double error = largest_error(&rows[n], &v, &mesh);
        print_message("  %s: %.3g of %.3g voxels\n", rows[n].name, error, rows[n].bound);
        assert_true(error <= rows[n].bound);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* A cell's signs, its joined faces, and the components and Euler number of its surface, from whole
 * numbers. 0: a face is tied, which lies between two cases, or the count cannot decide. */
static uint64_t cell_key(const float v[8])
{
    static const int faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    uint64_t key = 0;
    bool is_tied = false;
    for (int c = 0; c < 8; c++)
        key |= (uint64_t)(v[c] > 0) << c;
    for (int f = 0; f < 6; f++) {
        const float *a = &v[faces[f][0]], *b = &v[faces[f][1]], *c = &v[faces[f][2]],
                    *d = &v[faces[f][3]];
        const bool ambiguous =
            (*a > 0) == (*c > 0) && (*b > 0) == (*d > 0) && (*a > 0) != (*b > 0);
        const float product = *a * *c - *b * *d;
        is_tied = is_tied || (ambiguous && product == 0);
        key |= (uint64_t)(ambiguous ? 1 + (product > 0) : 0) << (8 + 2 * f);
    }
    const test_truth t = test_topology_counted(v, (const size_t[3]){2, 2, 2}, 0);
    return is_tied || !t.decidable
               ? 0
               : key | (uint64_t)t.components << 20 | (uint64_t)(t.euler + 16) << 28;
}

enum { KEYS = 4096 };

typedef struct keys {
    uint64_t at[KEYS]; /* by hash; 0: free */
    size_t count;
} keys;

/* Whether it is there now and was not. */
static bool add_key(keys *k, uint64_t key)
{
    size_t n = (size_t)(key * UINT64_C(0x9E3779B97F4A7C15) >> 52);
    for (; k->at[n]; n = (n + 1) % KEYS)
        if (k->at[n] == key)
            return false;
    assert_true(k->count + 1 < KEYS);
    k->at[n] = key;
    k->count++;
    return true;
}

static void add_cells_of_volume(keys *k, const cw_volume *v)
{
    for (size_t z = 0; z + 1 < v->dim[2]; z += 3)
        for (size_t y = 0; y + 1 < v->dim[1]; y += 3)
            for (size_t x = 0; x + 1 < v->dim[0]; x += 3) {
                float corners[8];
                for (size_t c = 0; c < 8; c++)
                    corners[c] =
                        (float)cw_volume_value(v, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
                add_key(k, cell_key(corners));
            }
}

/* Whatever turns up in cells at random is there. */
static void every_case_of_marching_cubes_is_there(void **state)
{
    (void)state;
    size_t n, missing = 0;
    keys *k = calloc(1, sizeof *k);
    assert_non_null(k);
    assert_true(cw_hard_find("hard/mc33", &n));
    cw_volume v = make(n, CW_I8, 44, 44, 44);
    add_cells_of_volume(k, &v);
    assert_int_equal(k->count, 766);
    test_seed(31);
    for (int r = 0; r < test_some(400000); r++) {
        float corners[8];
        bool in = false, out = false;
        for (int c = 0; c < 8; c++) {
            const float magnitude = (float)(1 + rand() % 997);
            corners[c] =
                (c ^ c >> 1 ^ c >> 2 ^ r) & 1 || rand() % 4 == 0 ? magnitude : -magnitude;
            corners[c] *= r % 3 == 0 && rand() % 2 ? -1 : 1;
            in = in || corners[c] > 0;
            out = out || corners[c] < 0;
        }
        const uint64_t key = in && out ? cell_key(corners) : 0;
        missing += key != 0 && add_key(k, key);
    }
    assert_int_equal(missing, 0);
    free(k);
    cw_volume_free(&v);
}

/* The same, each with outside around it: topologies of cells add up to that of all. */
static void all_cells_together_have_the_topology_of_each(void **state)
{
    (void)state;
    size_t n;
    assert_true(cw_hard_find("hard/mc33", &n));
    cw_volume v = make(n, CW_F32, 44, 44, 44);
    test_truth sum = {.decidable = true};
    for (size_t cell = 0; cell < 15 * 15 * 15; cell++) {
        const size_t at[3] = {cell % 15 * 3, cell / 15 % 15 * 3, cell / 225 * 3};
        float padded[64];
        for (size_t i = 0; i < 64; i++) {
            const size_t x = i % 4, y = i / 4 % 4, z = i / 16;
            const bool corner = x % 3 && y % 3 && z % 3;
            padded[i] =
                corner ? (float)cw_volume_value(&v, at[0] + x - 1, at[1] + y - 1, at[2] + z - 1)
                       : -1;
        }
        const test_truth t = test_topology_counted(padded, (const size_t[3]){4, 4, 4}, 0);
        sum.decidable = sum.decidable && t.decidable;
        sum.components += t.components;
        sum.euler += t.euler;
    }
    assert_true(sum.decidable);
    const test_truth all = topology_of(&v, 0);
    assert_int_equal(all.components, sum.components);
    assert_int_equal(all.euler, sum.euler);
    cw_volume_free(&v);
}

/* Which are found, of those that there are: a sphere no wider than a voxel may hide between
 * samples, one wider than a voxel's diagonal cannot. */
static void small_spheres_are_found_or_not_as_their_radius_says(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t least, most; /* of 512 */
    } found[] = {{"hard/spheres-0.5", 200, 350},
                 {"hard/spheres-0.75", 450, 511},
                 {"hard/spheres-1", 512, 512},
                 {"hard/spheres-1.5", 512, 512},
                 {"hard/spheres-2", 512, 512}};
    for (size_t r = 0; r < sizeof found / sizeof *found; r++) {
        size_t n;
        assert_true(cw_hard_find(found[r].name, &n));
        cw_volume v = make(n, CW_F32, 64, 64, 64);
        const test_truth t = topology_of(&v, 0);
        print_message("  %s: %zu of 512\n", found[r].name, t.components);
        assert_in_range(t.components, found[r].least, found[r].most);
        assert_int_equal(t.euler, 2 * (long)t.components);
        cw_volume_free(&v);
    }
}

static void cases_are_the_same_bytes_for_any_number_of_threads(void **state)
{
    (void)state;
    for (size_t n = 0; n < ROWS; n++) {
        cw_hard_desc desc = {
            .number = n, .dim = {9, 10, 11}, .type = CW_F64, .noise = 0.1, .threads = 1};
        cw_volume one, four;
        cw_error err = {0};
        assert_ok(cw_hard_sample(&desc, &one, &err), err);
        desc.threads = 4;
        assert_ok(cw_hard_sample(&desc, &four, &err), err);
        assert_memory_equal(one.data, four.data, 990 * sizeof(double));
        cw_volume_free(&one);
        cw_volume_free(&four);
    }
}

static void what_cannot_be_made_is_refused_by_name(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    size_t n;
    assert_false(cw_hard_find("hard/nothing", &n));
    assert_fails(cw_hard_sample(&(cw_hard_desc){.number = 999}, &v, &err), CW_ERR_ARGUMENT,
                 "no hard case 999", err);
    assert_true(cw_hard_find("hard/nan-islands", &n));
    assert_fails(cw_hard_sample(&(cw_hard_desc){.number = n, .type = CW_I16}, &v, &err),
                 CW_ERR_ARGUMENT, "f32 or f64, not i16", err);
    const cw_hard_desc noisy = {.number = n, .type = CW_F32, .noise = -1};
    assert_fails(cw_hard_sample(&noisy, &v, &err), CW_ERR_ARGUMENT, "noise -1", err);
    const cw_hard_desc typeless = {.number = n, .type = (cw_type)99};
    assert_fails(cw_hard_sample(&typeless, &v, &err), CW_ERR_ARGUMENT, "type", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_case_has_a_row),
        cmocka_unit_test(surfaces_keep_the_promise),
        cmocka_unit_test(surfaces_have_the_topology_of_their_field),
        cmocka_unit_test(near_saddles_are_as_near_in_doubles),
        cmocka_unit_test(vertices_are_near_surfaces_that_are_known),
        cmocka_unit_test(every_case_of_marching_cubes_is_there),
        cmocka_unit_test(all_cells_together_have_the_topology_of_each),
        cmocka_unit_test(small_spheres_are_found_or_not_as_their_radius_says),
        cmocka_unit_test(cases_are_the_same_bytes_for_any_number_of_threads),
        cmocka_unit_test(what_cannot_be_made_is_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
