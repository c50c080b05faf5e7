/* OpenVDB files to be read, written by OpenVDB. */
#ifndef TESTS_VDBS_H
#define TESTS_VDBS_H

#ifdef __cplusplus
extern "C" {
#endif

/* Writes one:
 * "sphere"   a level set of radius 20, centre (3, -5, 200000), voxels of 0.5; "half": saved so;
 *            "stream": without places of grids
 * "double", "int32", "bool", "mask": 1 (of int32 -7) in a ball of 20 voxels around (10, 0, -10)
 *            and 0 elsewhere, dense parts as tiles
 * "sheared"  the sphere, mirrored and sheared in its transform
 * "frustum"  with a transform that is not linear
 * "vec3"     of vectors; "empty": of nothing; "none": no grid at all
 * "several"  vec3 "v", fog "density", level set "surface", and "copy", which shares its tree
 * 0: not a file of this list. */
int test_vdb_write(const char *kind, const char *path);

#ifdef __cplusplus
}
#endif

#endif
