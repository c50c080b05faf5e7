/* Facts of a VTKHDF file, which the module "hdf5" (libhdf5, in a sandboxed process) puts into the shared
 * memory, and how both sides count the rows of its arrays. Nothing in here has been checked. */
#ifndef FORMATS_VTKHDF_VTKHDF_H
#define FORMATS_VTKHDF_VTKHDF_H

#include "formats/volume/sandboxed_planes.h"

enum {
    CWI_VTKHDF_ARRAYS = 512,
    CWI_VTKHDF_NAME = 160,
    CWI_VTKHDF_RANK = 5,
    CWI_VTKHDF_TEXT = 64,
    CWI_VTKHDF_REFUSAL = 120
};

typedef enum cwi_vtkhdf_number {
    CWI_VTKHDF_UNKNOWN,
    CWI_VTKHDF_I8,
    CWI_VTKHDF_U8,
    CWI_VTKHDF_I16,
    CWI_VTKHDF_U16,
    CWI_VTKHDF_I32,
    CWI_VTKHDF_U32,
    CWI_VTKHDF_I64,
    CWI_VTKHDF_U64,
    CWI_VTKHDF_F32,
    CWI_VTKHDF_F64,
    CWI_VTKHDF_NUMBERS
} cwi_vtkhdf_number;

/* A dataset. */
typedef struct cwi_vtkhdf_array {
    char name[CWI_VTKHDF_NAME]; /* below the group VTKHDF: "PointData/p" */
    uint32_t number;            /* cwi_vtkhdf_number of its values as they are returned */
    uint32_t rank;
    uint64_t dim[CWI_VTKHDF_RANK]; /* the slowest first */
    uint64_t stored_bytes;         /* in the file */
    uint64_t offset;               /* in the file; UINT64_MAX: not in one piece, or converted */
    uint32_t big_endian;           /* of those at the offset */
    char refusal[CWI_VTKHDF_REFUSAL]; /* why it cannot be read; empty: it can */
} cwi_vtkhdf_array;

/* Attributes of PointData and CellData that name arrays. */
typedef enum cwi_vtkhdf_attribute {
    CWI_VTKHDF_SCALARS,
    CWI_VTKHDF_NORMALS,
    CWI_VTKHDF_IDS,
    CWI_VTKHDF_ATTRIBUTES
} cwi_vtkhdf_attribute;

typedef struct cwi_vtkhdf_facts {
    char type[CWI_VTKHDF_TEXT]; /* the attribute Type */
    int64_t version[2];
    uint32_t has_extent, has_steps;
    int64_t extent[6], steps; /* WholeExtent; number of time steps */
    double origin[3], spacing[3], direction[9];
    char names[2][CWI_VTKHDF_ATTRIBUTES][CWI_VTKHDF_NAME]; /* of PointData, of CellData */
    uint32_t array_count;
    cwi_vtkhdf_array arrays[CWI_VTKHDF_ARRAYS];
} cwi_vtkhdf_facts;

/* Returns the bytes of a number. */
static inline size_t cwi_vtkhdf_number_bytes(uint32_t number)
{
    static const uint8_t bytes[CWI_VTKHDF_NUMBERS] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return number < CWI_VTKHDF_NUMBERS ? bytes[number] : 0;
}

/* Returns how many of the slowest dimensions number the rows of an array in requests. A row has
 * 1 MiB at most, unless its numbers are more. The array must have a rank of 1 or more. */
static inline uint32_t cwi_vtkhdf_row_rank(const cwi_vtkhdf_array *a)
{
    const uint64_t max = 1 << 20;
    uint64_t bytes = cwi_vtkhdf_number_bytes(a->number);
    uint32_t rank = a->rank;
    while (rank > 1 && !__builtin_mul_overflow(bytes, a->dim[rank - 1], &bytes) && bytes <= max)
        rank--;
    return rank;
}

extern CW_API const cwi_plane_functions cwi_module_hdf5;

#endif
