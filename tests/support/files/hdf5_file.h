/* Helpers that write HDF5 files with the group VTKHDF, by the library itself. Where a build has none,
 * CW_TEST_HDF5 is 0. */
#ifndef TESTS_HDF5_FILE_H
#define TESTS_HDF5_FILE_H

#include "support/support.h"

#if CW_TEST_HDF5

#include <hdf5.h>
#include <string.h>

enum { HDF5_RANK = 6 };

typedef struct hdf5_file {
    hid_t file, group; /* group: VTKHDF */
    hid_t last;        /* the group that was opened last; 0: none */
} hdf5_file;

/* The place of a dataset: contiguous unless it has chunks. */
typedef struct hdf5_layout {
    bool compact, deflate, shuffle, checksum;
    hsize_t chunk[HDF5_RANK]; /* 0: contiguous */
    const char *external;     /* name of a file that has its numbers */
    int filter;               /* number of another filter, which is optional */
} hdf5_layout;

static inline void hdf5_put_wholes(hid_t object, const char *name, const long long *numbers,
                                   hsize_t count)
{
    const hid_t space = H5Screate_simple(1, &count, NULL);
    const hid_t a = H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(a >= 0 && H5Awrite(a, H5T_NATIVE_LLONG, numbers) >= 0);
    H5Aclose(a);
    H5Sclose(space);
}

static inline void hdf5_put_reals(hid_t object, const char *name, const double *numbers,
                                  hsize_t count)
{
    const hid_t space = H5Screate_simple(1, &count, NULL);
    const hid_t a = H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(a >= 0 && H5Awrite(a, H5T_NATIVE_DOUBLE, numbers) >= 0);
    H5Aclose(a);
    H5Sclose(space);
}

/* A text; varies: its length is not part of the type. */
static inline void hdf5_put_text(hid_t object, const char *name, const char *text, bool varies)
{
    const hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, varies ? H5T_VARIABLE : strlen(text));
    const hid_t a = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(a >= 0 && H5Awrite(a, type, varies ? (const void *)&text : text) >= 0);
    H5Aclose(a);
    H5Tclose(type);
    H5Sclose(space);
}

/* Begins a file with the group VTKHDF, of a type; NULL: without attributes. */
static inline void hdf5_start(hdf5_file *f, const char *name, const char *type)
{
    static const long long version[2] = {2, 2};
    *f = (hdf5_file){.last = 0};
    f->file = H5Fcreate(test_path(name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(f->file >= 0);
    f->group = H5Gcreate2(f->file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(f->group >= 0);
    if (!type)
        return;
    hdf5_put_wholes(f->group, "Version", version, 2);
    hdf5_put_text(f->group, "Type", type, strlen(type) % 2);
}

static inline void hdf5_end(hdf5_file *f)
{
    if (f->last > 0)
        H5Gclose(f->last);
    H5Gclose(f->group);
    assert_true(H5Fclose(f->file) >= 0);
}

static inline void hdf5_add_group(hdf5_file *f, const char *name)
{
    const hid_t group = H5Gcreate2(f->group, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(group >= 0);
    H5Gclose(group);
}

/* Returns an open group, until the next one is asked for. */
static inline hid_t hdf5_group_of(hdf5_file *f, const char *name)
{
    if (f->last > 0)
        H5Gclose(f->last);
    f->last = H5Gopen2(f->group, name, H5P_DEFAULT);
    assert_true(f->last >= 0);
    return f->last;
}

/* Writes a dataset below VTKHDF. */
static inline void hdf5_put(hdf5_file *f, const char *name, hid_t type, int rank,
                            const hsize_t *dim, const double *numbers, hdf5_layout layout)
{
    hsize_t all = 1, max[HDF5_RANK];
    for (int n = 0; n < rank; n++) {
        all *= dim[n];
        max[n] = layout.chunk[0] ? H5S_UNLIMITED : dim[n];
    }
    const hid_t space = H5Screate_simple(rank, dim, max), list = H5Pcreate(H5P_DATASET_CREATE);
    if (layout.chunk[0])
        H5Pset_chunk(list, rank, layout.chunk);
    if (layout.compact)
        H5Pset_layout(list, H5D_COMPACT);
    if (layout.external)
        H5Pset_external(list, layout.external, 0, H5F_UNLIMITED);
    if (layout.shuffle)
        H5Pset_shuffle(list);
    if (layout.deflate)
        H5Pset_deflate(list, 6);
    if (layout.checksum)
        H5Pset_fletcher32(list);
    if (layout.filter)
        H5Pset_filter(list, layout.filter, H5Z_FLAG_OPTIONAL, 0, NULL);
    const hid_t set = H5Dcreate2(f->group, name, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    assert_true(set >= 0);
    if (all && numbers)
        assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >=
                    0);
    H5Dclose(set);
    H5Pclose(list);
    H5Sclose(space);
}

#endif

#endif
