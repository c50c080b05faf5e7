/* Triangles that parts of a mesh share. */
#include "support/support.h"

#include <cubewright/check.h>

#include <stdlib.h>

enum { CUBE_VERTICES = 8, CUBE_TRIANGLES = 12 };

/* Adds a unit cube at a place; `inverted` turns it inside out. */
static void add_cube(cw_mesh *mesh, uint32_t *part_of, uint32_t part, float x, bool inverted)
{
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t c = 0; c < CUBE_VERTICES; c++)
        for (int a = 0; a < 3; a++)
            mesh->positions[3 * (first + c) + (size_t)a] =
                (float)(c >> a & 1) + (a == 0 ? x : 0);
    for (int q = 0; q < 6; q++)
        for (int h = 0; h < 2; h++) {
            uint32_t *t = mesh->triangles + 3 * mesh->triangle_count;
            const uint32_t *v = quads[q], corners[3] = {v[0], v[1 + h], v[2 + h]};
            for (int c = 0; c < 3; c++)
                t[c] = corners[c] + first;
            if (inverted) {
                const uint32_t kept = t[1];
                t[1] = t[2];
                t[2] = kept;
            }
            part_of[mesh->triangle_count++] = part;
        }
    mesh->vertex_count += CUBE_VERTICES;
}

static void interfaces_are_counted(void **state)
{
    /* places of three cubes, and which are inside out; what is expected */
    static const struct {
        float x[3];
        bool inverted[3];
        size_t shared, overlapping, neighbours, once;
    } cases[] = {
        {{0, 1, 2}, {false, false, false}, 4, 0, 2, 32},  /* a row */
        {{0, 1, 9}, {false, false, false}, 2, 0, 1, 34},  /* one apart */
        {{0, 5, 10}, {false, false, false}, 0, 0, 0, 36}, /* all apart */
        {{0, 0, 9}, {false, false, false}, 0, 12, 0, 24}, /* twice the same */
        {{0, 0, 9}, {false, true, false}, 12, 0, 1, 24},  /* one fills the other */
        {{0, 1, 9}, {false, true, false}, 0, 2, 0, 34},   /* one is inside out */
        {{0, 0, 0}, {false, true, false}, 0, 12, 0, 12},  /* three in one place */
    };
    float positions[3 * 3 * CUBE_VERTICES];
    uint32_t triangles[3 * 3 * CUBE_TRIANGLES], part_of[3 * CUBE_TRIANGLES];
    (void)state;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_mesh mesh = {.positions = positions, .triangles = triangles}, once;
        cw_contacts c;
        cw_error err = {0};
        for (uint32_t p = 0; p < 3; p++)
            add_cube(&mesh, part_of, p, cases[n].x[p], cases[n].inverted[p]);
        assert_ok(cw_contacts_find(&mesh, part_of, &c, &once, &err), err);
        assert_int_equal(c.triangles, 36);
        assert_int_equal(c.shared, cases[n].shared);
        assert_int_equal(c.overlapping, cases[n].overlapping);
        assert_int_equal(c.neighbours, cases[n].neighbours);
        assert_int_equal(once.triangle_count, cases[n].once);
        assert_ok(cw_mesh_check(&once, &err), err);
        cw_mesh_free(&once);
    }
}

static void nothing_has_no_contacts(void **state)
{
    cw_mesh mesh = {.vertex_count = 0};
    cw_contacts c;
    cw_error err = {0};
    (void)state;
    assert_ok(cw_contacts_find(&mesh, NULL, &c, NULL, &err), err);
    assert_int_equal(c.triangles, 0);
    float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t triangle[3] = {0, 1, 7}, part = 0;
    mesh = (cw_mesh){
        .vertex_count = 3, .triangle_count = 1, .positions = positions, .triangles = triangle};
    assert_int_equal(cw_contacts_find(&mesh, &part, &c, NULL, &err), CW_ERR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interfaces_are_counted),
        cmocka_unit_test(nothing_has_no_contacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
