/* Volumes that extractors break on, and frames to put them in. No cmocka: cgal/ uses it too. */
#ifndef TESTS_HOSTILE_H
#define TESTS_HOSTILE_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct test_hostile {
    const char *name;
    double (*value)(const struct test_hostile *h, const size_t at[3]); /* NaN: no value */
    cw_type type;
    size_t dim[3];
    double isovalue;
    double parameter; /* of the value: an axis, a share, a scale */
    bool has_nodata;
    double nodata;
} test_hostile;

/* The n-th row of the table; NULL after the last. */
const test_hostile *test_hostile_at(size_t n);

/* Its volume, the identity for affine; free it. */
cw_status test_hostile_make(const test_hostile *hostile, cw_volume *volume, cw_error *err);

/* Frames that volumes may stand in. far: the world's zero lies so far away that points there
 * have no digits left for voxels in single precision. */
typedef struct test_frame {
    const char *name;
    double affine[3][4];
    bool far;
} test_frame;

const test_frame *test_frame_at(size_t n);

/* Stores a number that the type can hold as the n-th of packed voxels. */
void test_store(cw_type type, void *voxels, size_t n, double value);

#ifdef __cplusplus
}
#endif

#endif
