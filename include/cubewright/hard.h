/* Hard cases by name: fields on which extractors fail, sampled into volumes. The result of each
 * case, and its reason, are in extract/hard-cases.md. */
#ifndef CUBEWRIGHT_HARD_H
#define CUBEWRIGHT_HARD_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A hard case: a field, and how it is sampled. */
typedef struct cw_hard {
    const char *name, *about; /* the name begins with "hard/" */
    double isovalue;          /* of its surface */
    double scale;             /* integer types store the value times this; 0: floats only */
    double spacing_mm;        /* between samples */
    double first_mm; /* place of the first sample along each axis; 0: the volume is centred on
                        zero */
} cw_hard;

/* Returns the n-th case; NULL after the last. */
CW_API const cw_hard *cw_hard_at(size_t n);

/* Finds a case by its name. Returns false if none has it.
 * n  set to its number on success */
CW_API bool cw_hard_find(const char *name, size_t *n);

/* Returns the voxel value that stores a value of the n-th case in a volume of a type. Floats
 * keep it, integers hold it times the scale, and unsigned integers add 128. */
CW_API double cw_hard_stored(size_t n, cw_type type, double value);

/* Options of cw_hard_sample(). Zero fields mean the default named beside them. */
typedef struct cw_hard_desc {
    uint32_t version; /* 0: the first version of this struct */
    size_t number;    /* number of the case */
    size_t dim[3];    /* voxels; default 64 each, enough to show all parts of a case */
    cw_type type;     /* CW_U8 first: name it */
    double noise;  /* standard deviation of Gaussian noise, in the case's unit; default none */
    uint64_t seed; /* seed of the noise and of the random parts of a case */
    int threads;   /* default: all */
    cw_progress progress; /* default: none */
} cw_hard_desc;

/* Samples a case into a new volume; integer types are rounded and clamped to 8 or 16 bits.
 * Returns CW_ERR_ARGUMENT for an unknown case or type, an integer type where the case needs
 * floats, and noise below 0; CW_ERR_LIMIT, CW_ERR_NO_MEMORY, CW_ERR_CANCELLED.
 * The same bytes for the same desc, for any number of threads. */
CW_NODISCARD CW_API cw_status cw_hard_sample(const cw_hard_desc *desc, cw_volume *volume,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
