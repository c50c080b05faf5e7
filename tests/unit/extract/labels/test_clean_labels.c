/* Small components of labels go to their largest neighbour, and voids are filled, as a search by hand does. */
#include "support/support.h"

#include <cubewright/labels.h>

#include <stdlib.h>
#include <string.h>

enum { SIDE = 9, VOXELS = SIDE * SIDE * SIDE };

static size_t at(int x, int y, int z)
{
    return (size_t)((z * SIDE + y) * SIDE + x);
}

/* Floods the component of a voxel; returns its voxels. */
static size_t flood_component(const uint8_t *map, size_t start, int *component, int number)
{
    size_t stack[VOXELS], depth = 0, count = 0;
    stack[depth++] = start;
    component[start] = number;
    while (depth > 0) {
        const size_t n = stack[--depth];
        const int x = (int)(n % SIDE), y = (int)(n / SIDE % SIDE), z = (int)(n / SIDE / SIDE);
        count++;
        for (int way = -1; way <= 1; way += 2)
            for (int step = 1; step < 8; step++) {
                const int a = x + way * (step & 1), b = y + way * (step >> 1 & 1),
                          c = z + way * (step >> 2);
                if (a < 0 || b < 0 || c < 0 || a >= SIDE || b >= SIDE || c >= SIDE)
                    continue;
                const size_t m = at(a, b, c);
                if (map[m] == map[n] && component[m] < 0) {
                    component[m] = number;
                    stack[depth++] = m;
                }
            }
    }
    return count;
}

static int find_components(const uint8_t *map, int *component, size_t *sizes)
{
    int count = 0;
    for (size_t n = 0; n < VOXELS; n++)
        component[n] = -1;
    for (size_t n = 0; n < VOXELS; n++)
        if (component[n] < 0) {
            sizes[count] = flood_component(map, n, component, count);
            count++;
        }
    return count;
}

/* Gives small components away by hand, round by round. */
static void clean_by_hand(uint8_t *map, size_t least)
{
    int component[VOXELS];
    size_t sizes[VOXELS];
    bool gone[VOXELS] = {false};
    const int count = find_components(map, component, sizes);
    for (size_t n = 0; n < VOXELS; n++)
        gone[component[n]] = gone[component[n]] || (map[n] != 0 && sizes[component[n]] < least);
    for (bool moved = true; moved;) {
        size_t faces[VOXELS][4] = {{0}};
        uint8_t next[VOXELS];
        moved = false;
        memcpy(next, map, VOXELS);
        for (size_t n = 0; n < VOXELS; n++) {
            const int p[3] = {(int)(n % SIDE), (int)(n / SIDE % SIDE), (int)(n / SIDE / SIDE)};
            for (int side = 0; side < 6 && gone[component[n]]; side++) {
                int q[3] = {p[0], p[1], p[2]};
                q[side / 2] += side % 2 ? 1 : -1;
                if (q[side / 2] < 0 || q[side / 2] >= SIDE)
                    continue;
                const size_t m = at(q[0], q[1], q[2]);
                if (component[m] != component[n] && !gone[component[m]])
                    faces[component[n]][map[m]]++;
            }
        }
        bool goes[VOXELS] = {false};
        for (size_t n = 0; n < VOXELS; n++) {
            const size_t *f = faces[component[n]];
            int best = 0;
            for (int label = 1; label < 4; label++)
                best = f[label] > f[best] ? label : best;
            if (!gone[component[n]] || f[best] == 0)
                continue;
            next[n] = (uint8_t)best;
            goes[component[n]] = moved = true;
        }
        memcpy(map, next, VOXELS);
        for (int k = 0; k < count; k++)
            gone[k] = gone[k] && !goes[k];
    }
    for (size_t n = 0; n < VOXELS; n++)
        map[n] = gone[component[n]] ? 0 : map[n];
}

static void small_components_go_to_the_largest_neighbour(void **state)
{
    (void)state;
    for (int round = 0; round < 300; round++) {
        uint8_t map[VOXELS], expected[VOXELS];
        const size_t least = (size_t)(1 + round % 12);
        const int labels = 2 + round % 3;
        srand((unsigned)round);
        for (size_t n = 0; n < VOXELS; n++)
            map[n] = (uint8_t)(n > 0 && rand() % 4 ? map[n - 1] : rand() % labels);
        memcpy(expected, map, VOXELS);
        clean_by_hand(expected, least);
        const cw_volume v = {.data = map, .dim = {SIDE, SIDE, SIDE}};
        const cw_label_clean_desc desc = {.min_voxels = least};
        cw_volume cleaned;
        cw_label_change *changes;
        size_t count, before = 0, now = 0, background = 0;
        cw_error err = {0};
        assert_ok(cw_labels_clean(&v, &desc, &cleaned, &changes, &count, &err), err);
        for (size_t n = 0; n < VOXELS; n++) {
            assert_int_equal(((const uint32_t *)cleaned.data)[n], expected[n]);
            background += map[n] == 0;
            now += expected[n] != 0;
        }
        for (size_t n = 0; n < count; n++) {
            assert_int_equal(changes[n].voxels, changes[n].voxels_before +
                                                    changes[n].voxels_added -
                                                    changes[n].voxels_removed);
            before += changes[n].voxels_before;
            now -= changes[n].voxels;
        }
        assert_int_equal(before + background, VOXELS);
        assert_int_equal(now, 0);
        cw_label_changes_free(changes);
        cw_volume_free(&cleaned);
    }
}

static void the_largest_stay_and_voids_are_filled(void **state)
{
    uint8_t map[VOXELS] = {0};
    (void)state;
    for (int z = 1; z < 6; z++)
        for (int y = 1; y < 6; y++)
            for (int x = 1; x < 6; x++)
                map[at(x, y, z)] = 1;
    map[at(3, 3, 3)] = 0;                    /* a void */
    map[at(2, 2, 2)] = 2;                    /* another label inside */
    map[at(7, 7, 7)] = map[at(7, 7, 8)] = 1; /* a second component */
    map[at(1, 1, 8)] = map[at(7, 1, 1)] = 2; /* single voxels */
    const cw_volume v = {.data = map, .dim = {SIDE, SIDE, SIDE}};
    cw_volume cleaned;
    cw_label_change *changes;
    size_t count;
    cw_error err = {0};
    cw_label_clean_desc desc = {.fill_voids = true};
    assert_ok(cw_labels_clean(&v, &desc, &cleaned, &changes, &count, &err), err);
    const uint32_t *to = cleaned.data;
    assert_int_equal(to[at(3, 3, 3)], 1);
    assert_int_equal(to[at(2, 2, 2)], 2);
    assert_int_equal(to[at(7, 7, 7)], 1);
    assert_int_equal(count, 2);
    assert_int_equal(changes[0].voxels_added, 1);
    assert_int_equal(changes[0].components_removed, 0);
    cw_label_changes_free(changes);
    cw_volume_free(&cleaned);
    desc = (cw_label_clean_desc){.largest = 1};
    assert_ok(cw_labels_clean(&v, &desc, &cleaned, &changes, &count, &err), err);
    to = cleaned.data;
    assert_int_equal(to[at(3, 3, 3)], 0);
    assert_int_equal(to[at(7, 7, 7)], 0);
    assert_int_equal(changes[0].components_removed, 1);
    assert_int_equal(changes[1].components_removed, 2);
    assert_int_equal(changes[1].voxels, 1);
    cw_label_changes_free(changes);
    cw_volume_free(&cleaned);
    map[0] = 9;
    const float bad[8] = {0, 1, 1, 0.5f, 0, 0, 0, 0};
    const cw_volume half = {.data = bad, .type = CW_F32, .dim = {2, 2, 2}};
    assert_int_equal(cw_labels_clean(&half, &desc, &cleaned, NULL, NULL, &err),
                     CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "voxel 1, 1, 0 is 0.5"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_components_go_to_the_largest_neighbour),
        cmocka_unit_test(the_largest_stay_and_voids_are_filled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
