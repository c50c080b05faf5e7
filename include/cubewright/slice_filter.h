/* Filters of volumes larger than memory: slices are filtered as they are read. */
#ifndef CUBEWRIGHT_SLICE_FILTER_H
#define CUBEWRIGHT_SLICE_FILTER_H

#include <cubewright/filter.h>
#include <cubewright/stream.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Filters that see a few slices at a time. */
typedef enum cw_slice_filter_kind {
    CW_SLICE_GAUSS,  /* cw_volume_gauss() */
    CW_SLICE_MEDIAN, /* cw_volume_median() */
} cw_slice_filter_kind;

/* A filter of slices. Zero fields mean the default named beside them. */
typedef struct cw_slice_filter_desc {
    uint32_t version;          /* 0: the first version of this struct */
    cw_slice_filter_kind kind; /* default: CW_SLICE_GAUSS */
    double sigma_voxels[3];    /* of a Gaussian: as in cw_volume_gauss() */
    size_t radius;             /* of a median: as in cw_volume_median() */
    size_t slices; /* made together; default: up to 64, of 32 MiB in all, or as many as
                                    it looks ahead */
    int threads;   /* default: all */
} cw_slice_filter_desc;

/* A source whose slices are those of another one, filtered. */
typedef struct cw_slice_filter cw_slice_filter;

/* Returns the bytes that a filter takes at most, with the work on its slices: 0 for a shape or a
 * description that cw_slice_filter_new() refuses.
 * shape  of the source; borrowed
 * desc   borrowed. Fewer `slices` take less: 1 tells the least */
CW_API size_t cw_slice_filter_bytes(const cw_volume *shape, const cw_slice_filter_desc *desc);

/* Makes one; free it with cw_slice_filter_free(). Its slices are those of the filter on the whole
 * volume, to the bit, for any number of slices and threads.
 * source   copied; what it reads from must outlive the filter. Its first component is used
 * desc     borrowed
 * out      set on success
 * Returns  CW_ERR_ARGUMENT as the filter; CW_ERR_UNSUPPORTED for grids that are not even;
 *          CW_ERR_NO_MEMORY
 * Cost     the filter's, on a slab of `slices` and as many as it looks ahead at both sides: its voxels,
 *          the result, and the filter's work on them */
CW_NODISCARD CW_API cw_status cw_slice_filter_new(const cw_slice_source *source,
                                                  const cw_slice_filter_desc *desc,
                                                  cw_slice_filter **out, cw_error *err);

/* Returns the filtered source, for cw_extract_stream() and others. Reading from it returns what the
 * source below returned, or the filter.
 * filter  borrowed: it must outlive the source. NULL: a zeroed source */
CW_API cw_slice_source cw_slice_filter_source(cw_slice_filter *filter);

/* Frees a filter. Harmless on NULL. */
CW_API void cw_slice_filter_free(cw_slice_filter *filter);

#ifdef __cplusplus
}
#endif

#endif
