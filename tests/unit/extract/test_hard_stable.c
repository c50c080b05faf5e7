/* The hard cases again: what must not change a bit of their surfaces, and what may change them
 * only as much as it says itself. */
#include "support/sparse.h"
#include "support/surface.h"

#include "extract/dense/isa_dispatch.h"
#include "extract/extract_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_volume make(size_t n, size_t x, size_t y, size_t z)
{
    const cw_hard_desc desc = {.number = n, .dim = {x, y, z}, .type = CW_F32};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_hard_sample(&desc, &v, &err), err);
    return v;
}

static cw_extract_desc level_of(size_t n)
{
    return (cw_extract_desc){.isovalue = cw_hard_at(n)->isovalue, .threads = 1};
}

/* Rows longer than a word of 64 bits, of every engine. */
static void engines_and_threads_do_not_change_a_bit(void **state)
{
    (void)state;
    for (size_t n = 0; cw_hard_at(n); n++) {
        cw_volume v = make(n, 131, 11, 10);
        cw_extract_desc d = level_of(n);
        cw_error err = {0};
        for (int open = test_is_short() ? n % 2 : 0; open < 2;
             open += test_is_short() ? 2 : 1) {
            cw_mesh plain = {0}, other = {0};
            d.leave_open = open;
            d.threads = 1;
            assert_ok(cwi_extract_with(cwi_engine_at(0), &v, &d, &plain, NULL, &err), err);
            for (size_t e = 0; cwi_engine_at(e); e++) {
                d.threads = 1 + (int)(e + n) % 5;
                assert_ok(cwi_extract_with(cwi_engine_at(e), &v, &d, &other, NULL, &err), err);
                test_assert_same_mesh(&plain, &other);
                cw_mesh_free(&other);
            }
            cw_mesh_free(&plain);
        }
        cw_volume_free(&v);
    }
}

/* Bricks of 8 cells, those alone that the isovalue passes through, after another surface. */
static void bricks_do_not_change_a_bit(void **state)
{
    (void)state;
    for (size_t n = 0; cw_hard_at(n); n++) {
        cw_volume v = make(n, 37, 26, 19);
        const cw_extract_desc d = level_of(n), first = {.isovalue = d.isovalue + 1};
        cw_extractor *extractor;
        cw_mesh one = {0}, other = {0};
        cw_error err = {0};
        assert_ok(cwi_extractor_new_with(cwi_engine_best(), 0, &v, &extractor, &err), err);
        assert_ok(cw_extractor_extract(extractor, &first, &other, NULL, &err), err);
        cw_mesh_free(&other);
        assert_ok(cw_extractor_extract(extractor, &d, &other, NULL, &err), err);
        one = test_extract(&v, &d, NULL);
        test_assert_same_mesh(&one, &other);
        cw_mesh_free(&one);
        cw_mesh_free(&other);
        cw_extractor_free(extractor);
        cw_volume_free(&v);
    }
}

typedef struct taken {
    const cw_mesh *whole;
    size_t slabs, triangles;
    bool same;
} taken;

static cw_status take(void *user, const cw_slab *slab, cw_error *err)
{
    taken *t = user;
    const cw_mesh *m = slab->mesh, *w = t->whole;
    (void)err;
    t->slabs++;
    for (size_t c = 0; c < 3 * m->triangle_count && t->same; c++)
        t->same = t->triangles + m->triangle_count <= w->triangle_count &&
                  memcmp(m->positions + 3 * (size_t)m->triangles[c],
                         w->positions + 3 * (size_t)w->triangles[3 * t->triangles + c],
                         3 * sizeof(float)) == 0;
    t->triangles += m->triangle_count;
    return CW_OK;
}

static void slabs_do_not_change_a_bit(void **state)
{
    (void)state;
    size_t most = 0;
    for (size_t n = 0; cw_hard_at(n); n++) {
        cw_volume v = make(n, 12, 11, 50);
        cw_extract_desc d = level_of(n);
        cw_error err = {0};
        d.no_normals = true;
        cw_mesh whole = test_extract(&v, &d, NULL);
        taken t = {.whole = &whole, .same = true};
        assert_ok(cw_extract_slabs(&v, &d, 1, (cw_slab_sink){take, &t}, NULL, &err), err);
        assert_true(t.same);
        assert_int_equal(t.triangles, whole.triangle_count);
        most = t.slabs > most ? t.slabs : most;
        cw_mesh_free(&whole);
        cw_volume_free(&v);
    }
    assert_true(most >= 3);
}

/* The case in the middle of a larger volume below the isovalue, so that no border is near. */
static cw_volume surround(const cw_volume *v, double background)
{
    cw_volume out;
    cw_error err = {0};
    const size_t dim[3] = {48, 32, 32};
    assert_ok(cw_volume_alloc(&out, CW_F32, dim, 1, 1, &err), err);
    float *to = cw_volume_voxels(&out);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const size_t i = n % dim[0] - 8, j = n / dim[0] % dim[1] - 8,
                     k = n / dim[0] / dim[1] - 8; /* below 0 they wrap around */
        const bool in = i < v->dim[0] && j < v->dim[1] && k < v->dim[2];
        to[n] = (float)(in ? cw_volume_value(v, i, j, k) : background);
    }
    return out;
}

static void leaves_and_tiles_do_not_change_a_bit(void **state)
{
    (void)state;
    size_t crossed = 0;
    for (size_t n = 0; cw_hard_at(n); n++) {
        const cw_extract_desc d = level_of(n);
        cw_volume v = make(n, 24, 16, 16), dense = surround(&v, d.isovalue - 1),
                  sparse = test_sparse_of(&dense, d.isovalue - 1);
        assert_true(sparse.sparse->leaf_count > 0);
        cw_mesh a = test_extract(&dense, &d, NULL), b = test_extract(&sparse, &d, NULL);
        if (a.triangle_count + b.triangle_count > 0)
            test_assert_same_triangles(&a, &b);
        crossed += a.triangle_count > 0;
        cw_mesh_free(&a);
        cw_mesh_free(&b);
        cw_volume_free(&sparse);
        cw_volume_free(&dense);
        cw_volume_free(&v);
    }
    print_message("  %zu cases have a surface\n", crossed);
    assert_true(crossed > 45);
}

enum { MOTIONS = 48 };

/* Axis a of what is turned is order[a] of the original, reversed where bit a of the motion is
 * set. */
static const int *order_of(int motion)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    return orders[motion / 8];
}

/* The voxels in another order in memory: fastest along order[0]. */
static cw_volume turn(const cw_volume *v, int motion)
{
    const int *order = order_of(motion);
    cw_volume out;
    cw_error err = {0};
    const size_t dim[3] = {v->dim[order[0]], v->dim[order[1]], v->dim[order[2]]};
    assert_ok(cw_volume_alloc(&out, CW_F32, dim, 1, 1, &err), err);
    float *to = cw_volume_voxels(&out);
    size_t at[3];
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const size_t turned[3] = {n % dim[0], n / dim[0] % dim[1], n / dim[0] / dim[1]};
        for (int a = 0; a < 3; a++)
            at[order[a]] = motion >> a & 1 ? dim[a] - 1 - turned[a] : turned[a];
        to[n] = (float)cw_volume_value(v, at[0], at[1], at[2]);
    }
    return out;
}

/* The turned voxels, seen through strides as the volume they were. */
static cw_volume turned_back(const cw_volume *turned, const cw_volume *v, int motion)
{
    const int *order = order_of(motion);
    cw_volume view = *turned;
    ptrdiff_t stride = sizeof(float);
    const char *data = turned->data;
    for (int a = 0; a < 3; a++) {
        const ptrdiff_t steps = (ptrdiff_t)turned->dim[a] - 1;
        view.stride[order[a]] = motion >> a & 1 ? -stride : stride;
        data += motion >> a & 1 ? stride * steps : 0;
        stride *= (ptrdiff_t)turned->dim[a];
    }
    memcpy(view.dim, v->dim, sizeof view.dim);
    memcpy(view.affine, v->affine, sizeof view.affine);
    view.data = data;
    view.owned = NULL;
    return view;
}

static void the_order_of_voxels_in_memory_does_not_change_a_bit(void **state)
{
    (void)state;
    for (size_t n = 0; cw_hard_at(n); n++) {
        cw_volume v = make(n, 11, 10, 9);
        const cw_extract_desc d = level_of(n);
        cw_mesh mesh = test_extract(&v, &d, NULL);
        for (int motion = 1; motion < MOTIONS; motion += test_is_short() ? 5 : 1) {
            cw_volume turned = turn(&v, motion), view = turned_back(&turned, &v, motion);
            cw_mesh other = test_extract(&view, &d, NULL);
            test_assert_same_mesh(&mesh, &other);
            cw_mesh_free(&other);
            cw_volume_free(&turned);
        }
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* Where the crossings of a grid's edges stand: as shares of the edge, from its low end, for
 * each axis and sample; negative where there is none. Inner vertices and caps are left out. */
typedef struct shares {
    size_t dim[3];
    double *at;
    size_t count;
} shares;

static void add_share(shares *s, const double p[3])
{
    int axis = -1;
    size_t low[3];
    for (int a = 0; a < 3; a++) {
        const double whole = rint(p[a]);
        const bool off = fabs(p[a] - whole) > 0.5 / 1024;
        if (p[a] < 0 || p[a] > (double)(s->dim[a] - 1) || (off && axis >= 0))
            return;
        axis = off ? a : axis;
        low[a] = (size_t)(off ? floor(p[a]) : whole);
    }
    assert_true(axis >= 0);
    const size_t n = (low[2] * s->dim[1] + low[1]) * s->dim[0] + low[0];
    s->at[3 * n + (size_t)axis] = p[axis] - (double)low[axis];
    s->count++;
}

/* Of a volume whose index is its world; turned back where it was turned. */
static shares find_shares(const cw_volume *v, const cw_extract_desc *d, int motion)
{
    const int *order = order_of(motion);
    const size_t count = 3 * v->dim[0] * v->dim[1] * v->dim[2];
    shares s = {.at = malloc(count * sizeof *s.at)};
    cw_volume plain = *v;
    memset(plain.affine, 0, sizeof plain.affine);
    for (int a = 0; a < 3; a++) {
        plain.affine[a][a] = 1;
        s.dim[order[a]] = v->dim[a];
    }
    assert_non_null(s.at);
    for (size_t n = 0; n < count; n++)
        s.at[n] = -1;
    cw_mesh mesh = test_extract(&plain, d, NULL);
    for (size_t n = 0; n < mesh.vertex_count; n++) {
        double p[3];
        for (size_t a = 0; a < 3; a++) {
            const double x = mesh.origin[a] + (double)mesh.positions[3 * n + a];
            p[order[a]] = motion >> a & 1 ? (double)(v->dim[a] - 1) - x : x;
        }
        add_share(&s, p);
    }
    cw_mesh_free(&mesh);
    return s;
}

/* Positions are floats, 16 voxels from their origin at most: to half of 2^-20, twice. */
#define ROUNDING 0x1p-20

/* Edges are crossed at the same places: to the bit when axes change their order, to rounding
 * when one is reversed, as the share from the other end is another number. */
static void turned_volumes_have_the_crossings_turned(void **state)
{
    (void)state;
    double largest = 0;
    for (size_t n = 0; cw_hard_at(n); n++) {
        cw_volume v = make(n, 11, 10, 9);
        const cw_extract_desc d = level_of(n);
        const shares plain = find_shares(&v, &d, 0);
        for (int motion = 1; motion < MOTIONS; motion += test_is_short() ? 5 : 1) {
            cw_volume turned = turn(&v, motion);
            const shares other = find_shares(&turned, &d, motion);
            assert_int_equal(plain.count, other.count);
            for (size_t e = 0; e < 3 * 11 * 10 * 9; e++) {
                const double moved = fabs(plain.at[e] - other.at[e]);
                largest = fmax(largest, moved);
                assert_true(moved <= (motion % 8 ? ROUNDING : 0));
            }
            free(other.at);
            cw_volume_free(&turned);
        }
        free(plain.at);
        cw_volume_free(&v);
    }
    print_message("  largest difference: %.3g voxels\n", largest);
}

/* Every sample nudged up, down or not at all, by a last digit or a share of what it is off the
 * isovalue; but not to the other side of it. */
static void nudge(cw_volume *v, double isovalue, double share)
{
    float *x = cw_volume_voxels(v);
    for (size_t n = 0; n < v->dim[0] * v->dim[1] * v->dim[2]; n++) {
        const int way = rand() % 3 - 1;
        const double off = (double)x[n] - isovalue;
        const float to = share > 0 ? (float)(isovalue + off * (1 + way * share))
                                   : nextafterf(x[n], way < 0    ? -FLT_MAX
                                                      : way == 0 ? x[n]
                                                                 : FLT_MAX);
        if (isfinite(x[n]) && isfinite(to) && ((double)to >= isovalue) == (off >= 0))
            x[n] = to;
    }
}

/* With a and b off the isovalue to either side the share is t = a / (a + b). Its derivatives
 * are b / (a + b)^2 and -a / (a + b)^2, so that when neither changes by more than d, t changes
 * by no more than d over the lesser a + b on the way, which is that at one of its ends. */
static double allowed(const cw_volume *before, const cw_volume *after, size_t n, int axis)
{
    const size_t *dim = before->dim;
    const size_t low[3] = {n % dim[0], n / dim[0] % dim[1], n / dim[0] / dim[1]};
    size_t high[3] = {low[0], low[1], low[2]};
    high[axis]++;
    const double a = cw_volume_value(before, low[0], low[1], low[2]),
                 b = cw_volume_value(before, high[0], high[1], high[2]),
                 c = cw_volume_value(after, low[0], low[1], low[2]),
                 d = cw_volume_value(after, high[0], high[1], high[2]);
    if (!isfinite(a) || !isfinite(b))
        return ROUNDING;
    return fmax(fabs(c - a), fabs(d - b)) / fmin(fabs(a - b), fabs(c - d)) + ROUNDING;
}

static void check_moves(size_t n, double share, double *largest)
{
    cw_volume before = make(n, 11, 10, 9), after = make(n, 11, 10, 9);
    const cw_extract_desc d = level_of(n);
    nudge(&after, d.isovalue, share);
    const shares s = find_shares(&before, &d, 0), t = find_shares(&after, &d, 0);
    assert_int_equal(s.count, t.count); /* the same edges, as no sample changes sides */
    for (size_t e = 0; e < 3 * 11 * 10 * 9; e++) {
        assert_int_equal(s.at[e] < 0, t.at[e] < 0);
        if (s.at[e] < 0)
            continue;
        const double moved = fabs(s.at[e] - t.at[e]);
        *largest = fmax(*largest, moved);
        if (!(moved <= allowed(&before, &after, e / 3, (int)(e % 3))))
            fail_msg("%s: a vertex moved by %g voxels where %g are allowed",
                     cw_hard_at(n)->name, moved, allowed(&before, &after, e / 3, (int)(e % 3)));
    }
    free(s.at);
    free(t.at);
    cw_volume_free(&before);
    cw_volume_free(&after);
}

static void small_changes_move_crossings_as_little_as_the_slope_says(void **state)
{
    (void)state;
    static const double changes[] = {0, 1e-3, 0.1}; /* 0: of last digits */
    test_seed(7);
    for (size_t c = 0; c < 3; c++) {
        double largest = 0;
        for (size_t n = 0; cw_hard_at(n); n++)
            check_moves(n, changes[c], &largest);
        print_message("  changes of %g: %.3g voxels at most\n", changes[c], largest);
    }
}

/* Saddles, or samples beside them, are tied or all but: there a last digit may decide otherwise
 * which corners are joined. */
static bool is_tied(const char *name)
{
    static const char *const tied[] = {
        "hard/mostly-on-samples", "hard/ties",         "hard/plateaus",
        "hard/terraces",          "hard/checkerboard", "hard/uneven-checkerboard",
        "hard/columns",           "hard/saddle-line",  "hard/saddle-point",
        "hard/monkey-saddle",     "hard/double-cone",  "hard/near-saddle-face",
        "hard/sheet-askew",       "hard/wire-askew",   "hard/near-saddle-inside",
        "hard/lone-samples",      "hard/last-digits",  "hard/denormal-values",
        "hard/nan-blocks",        "hard/decades"};
    for (size_t n = 0; n < sizeof tied / sizeof *tied; n++)
        if (strcmp(name, tied[n]) == 0)
            return true;
    return false;
}

static void last_digits_do_not_change_triangles_away_from_ties(void **state)
{
    (void)state;
    test_seed(11);
    int kept = 0;
    for (size_t n = 0; cw_hard_at(n); n++) {
        cw_volume before = make(n, 24, 23, 22), after = make(n, 24, 23, 22);
        const cw_extract_desc d = level_of(n);
        nudge(&after, d.isovalue, 0);
        cw_mesh a = test_extract(&before, &d, NULL), b = test_extract(&after, &d, NULL);
        const bool same = a.triangle_count == b.triangle_count &&
                          (a.triangle_count == 0 ||
                           memcmp(a.triangles, b.triangles, 12 * a.triangle_count) == 0);
        if (!same && !is_tied(cw_hard_at(n)->name))
            fail_msg("%s: other triangles", cw_hard_at(n)->name);
        kept += same;
        cw_mesh_free(&a);
        cw_mesh_free(&b);
        cw_volume_free(&before);
        cw_volume_free(&after);
    }
    print_message("  %d cases keep their triangles\n", kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_and_threads_do_not_change_a_bit),
        cmocka_unit_test(bricks_do_not_change_a_bit),
        cmocka_unit_test(slabs_do_not_change_a_bit),
        cmocka_unit_test(leaves_and_tiles_do_not_change_a_bit),
        cmocka_unit_test(the_order_of_voxels_in_memory_does_not_change_a_bit),
        cmocka_unit_test(turned_volumes_have_the_crossings_turned),
        cmocka_unit_test(small_changes_move_crossings_as_little_as_the_slope_says),
        cmocka_unit_test(last_digits_do_not_change_triangles_away_from_ties),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
