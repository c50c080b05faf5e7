/* Pieces of solids: volumes that add up, sections in every position, pegs that stay inside, plates, and pieces that
 * go together again. */
#include "support/solids.h"

#include "core/base/memory.h"
#include "core/geometry/box.h"

#include <cubewright/field.h>
#include <cubewright/pieces.h>
#include <cubewright/quality.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh make_box(double x, double y, double z)
{
    cw_mesh m = test_make_boxes(1);
    test_add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){x, y, z}, false);
    return m;
}

static cw_cut_desc plane_at(int axis, double at)
{
    cw_cut_desc p = {.point = {0, 0, 0}};
    p.normal[axis] = 1;
    p.point[axis] = at;
    return p;
}

/* Cuts, and checks that all pieces are sound and add up to the whole, but for the gaps around pegs. */
static cw_pieces check_cut(const cw_mesh *mesh, const cw_cut_desc *planes, size_t count,
                           const cw_pieces_desc *desc)
{
    cw_pieces p = {0};
    cw_error err = {0};
    double sum = 0;
    assert_ok(cw_pieces_cut(mesh, planes, count, desc, &p, &err), err);
    for (size_t n = 0; n < p.count; n++) {
        test_check_solid(&p.pieces[n].mesh);
        assert_true(p.pieces[n].volume_mm3 > 0);
        assert_within(test_measure(&p.pieces[n].mesh).volume_mm3, p.pieces[n].volume_mm3, 1e-5);
        sum += p.pieces[n].volume_mm3;
    }
    assert_within(sum, p.pieces_mm3, 1e-12);
    if (!p.peg_count)
        assert_within(p.pieces_mm3, p.whole_mm3, 1e-5);
    return p;
}

/* Puts pieces together again: nothing overlaps, and what is missing is the gaps alone. */
static void check_assembled(const cw_pieces *p, const cw_mesh *whole)
{
    cw_assembled a = {0};
    cw_error err = {0};
    double low[3], high[3];
    assert_ok(cw_pieces_assemble(p, whole, 0, NULL, &a, &err), err);
    cw_mesh_bounds(whole, low, high);
    assert_within(a.whole_mm3, p->whole_mm3, 0.01);
    assert_true(a.overlap_mm3 <= 1e-5 * p->whole_mm3);
    assert_true(a.beyond_mm3 <= 1e-5 * p->whole_mm3);
    assert_true(fabs(a.missing_mm3 - p->gaps_mm3) <= 1e-5 * p->whole_mm3 + 0.1 * p->gaps_mm3);
    assert_true(a.farthest_mm <= 4e-6 * cwi_box_diagonal(low, high));
}

/* Planes through a cube of 4: at a face, in the middle, along a diagonal of faces, through corners of a
 * triangle, and through one corner. */
static void cubes_are_cut_in_every_position(void **state)
{
    (void)state;
    static const struct {
        cw_cut_desc plane;
        size_t count;
        double first; /* the volume of the first piece, of 64 */
    } rows[] = {
        {{.point = {0, 0, 4}, .normal = {0, 0, 1}}, 1, 64},
        {{.point = {0, 0, 0}, .normal = {0, 0, 1}}, 1, 64},
        {{.point = {0, 0, 2}, .normal = {0, 0, 1}}, 2, 32},
        {{.point = {0, 0, 1}, .normal = {0, 0, -1}}, 2, 48},
        {{.point = {0, 0, 0}, .normal = {1, -1, 0}}, 2, 32},
        {{.point = {4, 0, 0}, .normal = {1, 1, 1}}, 2, 64.0 / 6},
        {{.point = {0, 0, 0}, .normal = {1, 1, 1}}, 1, 64},
        {{.point = {2, 2, 2}, .normal = {1, 2, 3}}, 2, 32},
    };
    static const double scales[] = {1, 2.5e-5, 2500, 0.3};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        for (int s = 0; s < 4; s++) {
            const double k = scales[s];
            cw_mesh box = make_box(4 * k, 4 * k, 4 * k);
            cw_cut_desc plane = rows[n].plane;
            for (int a = 0; a < 3; a++)
                plane.point[a] *= k;
            cw_pieces p = check_cut(&box, &plane, 1, NULL);
            assert_int_equal(p.count, rows[n].count);
            assert_within(p.pieces[0].volume_mm3, rows[n].first * k * k * k, 1e-5);
            assert_int_equal(p.section_count, rows[n].count - 1);
            check_assembled(&p, &box);
            cw_pieces_free(&p);
            cw_mesh_free(&box);
        }
}

/* --- several planes ----------------------------------------------------------------------- */

/* Three planes across a box give eight pieces, in order: below the first comes first. */
static void cells_have_an_order(void **state)
{
    (void)state;
    cw_mesh box = make_box(6, 4, 2);
    const cw_cut_desc planes[3] = {plane_at(0, 1), plane_at(1, 3), plane_at(2, 0.5)};
    static const double volumes[8] = {1.5, 4.5, 0.5, 1.5, 7.5, 22.5, 2.5, 7.5};
    cw_pieces p = check_cut(&box, planes, 3, NULL);
    assert_int_equal(p.count, 8);
    assert_int_equal(p.section_count, 12);
    for (size_t n = 0; n < 8; n++) {
        char name[32];
        snprintf(name, sizeof name, "piece-%zu", n + 1);
        assert_string_equal(p.pieces[n].name, name);
        assert_within(p.pieces[n].volume_mm3, volumes[n], 1e-6);
    }
    for (size_t n = 0; n < p.section_count; n++) {
        const cw_piece_section *s = &p.sections[n];
        assert_int_equal(s->above - s->below, s->plane == 0 ? 4 : s->plane == 1 ? 2 : 1);
    }
    check_assembled(&p, &box);
    cw_pieces_free(&p);
    cw_mesh_free(&box);
}

/* Fields with a surface known on paper, cut by planes across and aslant. */
static void solids_of_every_kind_are_cut(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    for (size_t f = 0; f < sizeof fields / sizeof *fields; f++) {
        cw_mesh mesh = test_extract_field(fields[f], 28);
        double low[3], high[3];
        cw_mesh_bounds(&mesh, low, high);
        cw_cut_desc planes[3] = {
            {.normal = {0.2, 0.5, 1}}, {.normal = {1, 0, 0}}, {.normal = {1, 1, -1}}};
        for (int n = 0; n < 3; n++)
            for (int a = 0; a < 3; a++)
                planes[n].point[a] = low[a] + (high[a] - low[a]) * (0.4 + 0.1 * n);
        cw_pieces p = check_cut(&mesh, planes, 3, NULL);
        assert_in_range(p.count, 5, 8);
        check_assembled(&p, &mesh);
        cw_pieces_free(&p);
        cw_mesh_free(&mesh);
    }
}

/* --- pegs --------------------------------------------------------------------------------- */

/* Returns the volume of a prism of 48 sides. */
static double find_prism(double radius, double length)
{
    return 24 * sin(2 * 3.14159265358979323846 / 48) * radius * radius * length;
}

/* A box of 40 x 30 x 60 gets pegs whose holes are as large as they are said to be. */
static void pegs_fit_their_holes(void **state)
{
    (void)state;
    cw_mesh box = make_box(40, 30, 60);
    const cw_cut_desc planes[1] = {plane_at(2, 25)};
    for (size_t pegs = 1; pegs <= 5; pegs++)
        for (int dowels = 0; dowels < 2; dowels++) {
            const cw_pieces_desc desc = {.pegs = pegs,
                                         .dowels = dowels,
                                         .peg_diameter_mm = 6,
                                         .peg_length_mm = 10,
                                         .clearance_mm = 0.25};
            cw_pieces p = check_cut(&box, planes, 1, &desc);
            assert_int_equal(p.peg_count, pegs);
            assert_int_equal(p.count, 2 + (dowels ? pegs : 0));
            assert_int_equal(p.pieces[0].pegs, dowels ? 0 : pegs);
            assert_int_equal(p.pieces[0].holes, dowels ? pegs : 0);
            assert_int_equal(p.pieces[1].holes, pegs);
            const double hole = find_prism(3.25, dowels ? 5.25 : 10.25);
            assert_within(p.pieces[1].volume_mm3, 40 * 30 * 35 - (double)pegs * hole, 1e-6);
            assert_true(p.gaps_mm3 > 0);
            for (size_t n = 0; n < pegs; n++) {
                const double *c = p.pegs[n].center;
                const double room = fmin(fmin(c[0], 40 - c[0]), fmin(c[1], 30 - c[1]));
                assert_true(room >= 3.25 + 1.5);
                assert_true(fabs(c[2] - 25) < 1e-9);
                for (size_t m = 0; m < n; m++)
                    assert_true(hypot(c[0] - p.pegs[m].center[0], c[1] - p.pegs[m].center[1]) >=
                                2 * 3.25 + 1.5);
            }
            check_assembled(&p, &box);
            cw_pieces_free(&p);
        }
    cw_mesh_free(&box);
}

/* Every vertex of a hole stays away from the outside: the surface of the whole. */
static void check_walls(const cw_pieces *p, const cw_mesh *whole)
{
    for (size_t n = 0; n < p->count; n++) {
        const cw_mesh *m = &p->pieces[n].mesh;
        for (size_t g = 0; g < p->peg_count; g++) {
            const cw_peg *peg = &p->pegs[g];
            const double least = p->settings.peg_diameter_mm / 2 + p->settings.clearance_mm;
            for (size_t v = 0; v < whole->vertex_count && n == 0; v++) {
                double d[3], side_sq = 0, along = 0;
                for (int k = 0; k < 3; k++)
                    d[k] = whole->origin[k] + (double)whole->positions[3 * v + (size_t)k] -
                           peg->center[k];
                for (int k = 0; k < 3; k++)
                    along += d[k] * peg->direction[k];
                for (int k = 0; k < 3; k++)
                    side_sq +=
                        (d[k] - along * peg->direction[k]) * (d[k] - along * peg->direction[k]);
                if (along > 0 && along < peg->length_mm / (p->settings.dowels ? 2 : 1))
                    assert_true(sqrt(side_sq) > least + 0.99 * p->settings.wall_mm);
            }
        }
        assert_true(m->triangle_count > 0);
    }
}

/* Round solids, cut aslant by two planes: pegs of both sections in one piece do not meet. */
static void pegs_stay_inside(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS};
    for (size_t f = 0; f < 2; f++)
        for (size_t pegs = 1; pegs < 4; pegs++) {
            cw_mesh mesh = test_extract_field(fields[f], 32);
            double low[3], high[3];
            cw_mesh_bounds(&mesh, low, high);
            cw_cut_desc planes[2] = {{.normal = {0, 0.3, 1}}, {.normal = {1, 0, 0.1}}};
            for (int n = 0; n < 2; n++)
                for (int a = 0; a < 3; a++)
                    planes[n].point[a] = low[a] + (high[a] - low[a]) * 0.47;
            const double size = cwi_box_diagonal(low, high);
            cw_pieces_desc desc = {
                .pegs = pegs, .clearance_mm = 0.003 * size, .max_automatic_mm = 0.05 * size};
            for (int dowels = 0; dowels < 2; dowels++) {
                desc.dowels = dowels;
                cw_pieces p = check_cut(&mesh, planes, 2, &desc);
                assert_true(p.peg_count > 0);
                check_walls(&p, &mesh);
                check_assembled(&p, &mesh);
                cw_pieces_free(&p);
            }
            cw_mesh_free(&mesh);
        }
}

/* --- plates ------------------------------------------------------------------------------- */

static void pieces_fit_and_lie_on_plates(void **state)
{
    (void)state;
    cw_mesh box = make_box(500, 180, 300);
    const cw_plate_desc plate = {.plate_mm = {220, 200, 180}, .reserve_mm = 12};
    cw_cut_desc *planes = NULL;
    cw_error err = {0};
    size_t count = 0, plates = 0;
    assert_ok(cw_plate_planes(&box, &plate, &planes, &count, &err), err);
    assert_int_equal(count, 3); /* three parts along x, two along z */
    const cw_pieces_desc desc = {.pegs = 2, .peg_diameter_mm = 8, .peg_length_mm = 12};
    cw_pieces p = check_cut(&box, planes, count, &desc);
    assert_int_equal(p.count, 6);
    cw_lay_desc lay = {0};
    memcpy(lay.plate_mm, plate.plate_mm, sizeof lay.plate_mm);
    assert_ok(cw_pieces_lay(&p, &lay, &plates, &err), err);
    assert_in_range(plates, 2, 6);
    for (size_t n = 0; n < p.count; n++) {
        double low[3], high[3];
        cw_mesh_bounds(&p.pieces[n].mesh, low, high);
        assert_true(fabs(low[2]) < 1e-4 && high[2] <= 180.01);
        assert_true(high[0] - low[0] <= 220.01 && low[1] > -0.001 && high[1] <= 200.01);
        assert_true(p.pieces[n].foot_mm2 > 1000);
        for (size_t m = 0; m < n; m++) {
            double l[3], h[3];
            cw_mesh_bounds(&p.pieces[m].mesh, l, h);
            assert_true(h[0] < low[0] || high[0] < l[0] || h[1] < low[1] || high[1] < l[1]);
        }
    }
    check_assembled(&p, &box);
    cw_pieces_free(&p);
    cw_planes_free(planes);
    cw_mesh_free(&box);
}

/* --- what cannot be done ------------------------------------------------------------------ */

static void what_cannot_be_cut_is_told(void **state)
{
    (void)state;
    cw_mesh box = make_box(10, 10, 10), open = make_box(10, 10, 10);
    cw_pieces p = {0};
    cw_error err = {0};
    cw_cut_desc plane = plane_at(2, 11);
    assert_int_equal(cw_pieces_cut(&box, &plane, 1, NULL, &p, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "from 0 to 10 mm"));
    plane.point[2] = 5;
    cw_pieces_desc desc = {.pegs = 2, .peg_diameter_mm = 9};
    assert_int_equal(cw_pieces_cut(&box, &plane, 1, &desc, &p, &err), CW_ERR_CHECK);
    assert_int_equal(p.count, 0);
    desc.peg_diameter_mm = 0;
    desc.clearance_mm = 6;
    assert_int_equal(cw_pieces_cut(&box, &plane, 1, &desc, &p, &err), CW_ERR_CHECK);
    assert_non_null(strstr(err.message, "clearance of 6 mm"));
    desc.clearance_mm = -1;
    assert_int_equal(cw_pieces_cut(&box, &plane, 1, &desc, &p, &err), CW_ERR_ARGUMENT);
    plane.normal[2] = 0;
    assert_int_equal(cw_pieces_cut(&box, &plane, 1, NULL, &p, &err), CW_ERR_ARGUMENT);
    open.triangle_count--;
    plane.normal[2] = 1;
    assert_int_equal(cw_pieces_cut(&open, &plane, 1, NULL, &p, &err), CW_ERR_CHECK);
    open.triangle_count = 0;
    assert_int_equal(cw_pieces_cut(&open, &plane, 1, NULL, &p, &err), CW_ERR_EMPTY);
    cw_mesh_free(&box);
    cw_mesh_free(&open);
}

static void failing_allocations_leave_nothing(void **state)
{
    (void)state;
    cw_mesh box = make_box(40, 30, 60);
    const cw_cut_desc planes[2] = {plane_at(2, 25), plane_at(0, 20)};
    const cw_pieces_desc desc = {.pegs = 1, .threads = 1};
    bool has_failed = true;
    for (long n = 0; has_failed; n += 1 + n / 8) {
        cw_pieces p = {0};
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_pieces_cut(&box, planes, 2, &desc, &p, &err);
        has_failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, has_failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(p.count > 0, !has_failed);
        cw_pieces_free(&p);
    }
    cw_mesh_free(&box);
}

/* The bytes do not depend on the number of threads. */
static void threads_give_the_same_pieces(void **state)
{
    (void)state;
    cw_mesh mesh = test_extract_field(CW_FIELD_TORUS, 40);
    double low[3], high[3];
    cw_mesh_bounds(&mesh, low, high);
    const cw_cut_desc plane = {
        .point_is_percent = true, .point = {40, 50, 60}, .normal = {1, 0.2, 0.4}};
    cw_pieces_desc desc = {
        .pegs = 2, .clearance_mm = 0.002 * cwi_box_diagonal(low, high), .threads = 1};
    cw_pieces one = check_cut(&mesh, &plane, 1, &desc);
    desc.threads = 4;
    cw_pieces four = check_cut(&mesh, &plane, 1, &desc);
    assert_int_equal(one.count, four.count);
    for (size_t n = 0; n < one.count; n++)
        test_assert_same_mesh(&one.pieces[n].mesh, &four.pieces[n].mesh);
    cw_pieces_free(&one);
    cw_pieces_free(&four);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_are_cut_in_every_position),
        cmocka_unit_test(cells_have_an_order),
        cmocka_unit_test(solids_of_every_kind_are_cut),
        cmocka_unit_test(pegs_fit_their_holes),
        cmocka_unit_test(pegs_stay_inside),
        cmocka_unit_test(pieces_fit_and_lie_on_plates),
        cmocka_unit_test(what_cannot_be_cut_is_told),
        cmocka_unit_test(failing_allocations_leave_nothing),
        cmocka_unit_test(threads_give_the_same_pieces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
