/* Helpers that tests share. Include it instead of cmocka.h: cmocka wants its headers in one
 * order. */
#ifndef TESTS_SUPPORT_H
#define TESTS_SUPPORT_H

/* clang-format off */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
/* clang-format on */

#include <cubewright/cubewright.h>

#define PI 3.14159265358979323846

/* Returns true unless CUBEWRIGHT_TEST_LONG is 1 or more: then tests try all that they can. */
bool test_is_short(void);

/* How many of `count` cases a test tries, where each proves the same on other numbers: an eighth in
 * a short run, and under sanitizers, where all takes seven times as long, a quarter of that. With
 * CUBEWRIGHT_TEST_LONG=10 it is ten times the count. */
int test_some(int count);

/* Returns the seconds after which something hangs: no machine is so slow. CUBEWRIGHT_TEST_SLOW=10
 * makes them ten times as many. */
unsigned test_limit_s(void);

/* Seeds rand() and prints the seed, which ctest shows of a test that fails. The seed is `own`,
 * plus CUBEWRIGHT_TEST_SEED where that is set: other random cases of the same test. */
unsigned test_seed(unsigned own);

/* Returns true if CUBEWRIGHT_TEST_SEED asks for other cases than those of the tests' own seeds. */
bool test_seed_is_other(void);

/* The call succeeded; else the test fails with its message. */
#define assert_ok(call, err)                                                                   \
    do {                                                                                       \
        if ((call) != CW_OK)                                                                   \
            fail_msg("%s: %s", #call, (err).message);                                          \
    } while (0)

/* The call failed with this status and a message that holds these words. */
#define assert_fails(call, expected, words, err)                                               \
    test_assert_fails((call), (expected), (words), &(err), #call, __FILE__, __LINE__)

/* |value - truth| <= share * |truth|. */
#define assert_within(value, truth, share)                                                     \
    test_assert_near((value), (truth), (share) * ((truth) < 0 ? -(truth) : (truth)), #value,   \
                     __FILE__, __LINE__)
#define assert_near(value, truth, margin)                                                      \
    test_assert_near((value), (truth), (margin), #value, __FILE__, __LINE__)

void test_assert_fails(cw_status got, cw_status expected, const char *words,
                       const cw_error *err, const char *call, const char *file, int line);
void test_assert_near(double value, double truth, double margin, const char *what,
                      const char *file, int line);

/* Setup and teardown of tests that need an empty folder. */
int test_folder_make(void **state);
int test_folder_remove(void **state);

/* "FOLDER/name" in static memory (four results are kept). */
const char *test_path(const char *name);

/* A whole file in memory (free it), and bytes to a file. Both fail the test on any error. */
char *test_file_read(const char *path, size_t *size);
void test_file_write(const char *path, const void *bytes, size_t size);

/* How many entries the test's folder holds: for "nothing was left behind". */
size_t test_folder_entries(void);

/* A unit tetrahedron and a unit cube (12 triangles, shared vertices, normals),
 * outward wound. */
void test_make_tetrahedron(cw_mesh *mesh);
void test_make_cube(cw_mesh *mesh);

/* A kilometre from zero and thin: a sphere of 24 voxels' radius, 0.1 x 0.1 x 5 mm each, whose
 * first voxel stands at 1e6 mm along each axis. Closed and manifold, without flat triangles. */
void test_make_far_sphere(cw_mesh *mesh);

/* A progress report that goes on for *(int *)polls more polls, then cancels. */
bool test_stop_after(void *polls, const char *step, double done);

#endif
