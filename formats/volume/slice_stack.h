/* A volume assembled from planes in files: the assignment of planes, and the reading. */
#ifndef FORMATS_VOLUME_SLICE_STACK_H
#define FORMATS_VOLUME_SLICE_STACK_H

#include "formats/bytes/input_file.h"
#include "formats/volume/sandboxed_planes.h"

/* A plane of pixels in a file. */
typedef struct cwi_plane {
    size_t file; /* index in the stack's files */
    uint32_t number;
    double slope, intercept; /* of its pixels, where the stack is scaled */
    cw_type type;      /* of its pixels, and those that are padding, from low to high, where the
                                stack is mixed */
    double padding[2]; /* low above high: none */
} cwi_plane;

/* A plane of the result: (1 - t) low + t high. */
typedef struct cwi_slot {
    size_t slice;     /* plane in the result, where planes are stored one after another: z
                         varies fastest */
    size_t low, high; /* planes */
    double t;         /* 0: low unchanged */
    uint32_t label;   /* not 0: stored where the plane's pixels are not 0 */
} cwi_slot;

/* The stack. A zeroed one is empty. Free it with cwi_stack_free(). */
typedef struct cwi_stack {
    cw_volume shape;   /* everything but the voxels; planes of dim[0] x dim[1] one after
                          another, then the planes' own steps and components */
    cw_type type;      /* of pixels as the module returns them */
    bool mixed;        /* planes have types and padding of their own */
    size_t samples;    /* ... and the number of them per pixel */
    bool scaled;       /* the result is slope * pixel + intercept of each plane */
    bool has_padding;  /* pixels from low to high stand for no data */
    double padding[2]; /* ... and become shape.nodata */
    bool sparse;       /* places may have no slot: they become shape.nodata, else 0 */
    const char *size_field;
    cwi_names files; /* none: the open file */
    cwi_plane *planes;
    size_t plane_count;
    cwi_slot *slots;
    size_t slot_count;
} cwi_stack;

/* Allocates planes and slots, all zero. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_stack_reserve(cwi_stack *stack, size_t planes, size_t slots,
                                         cw_error *err);

/* Checks limits, then reads (unless desc->header_only). Returns as cwi_source_load(). */
CW_NODISCARD cw_status cwi_stack_load(const cwi_stack *stack, const cwi_input *in,
                                      cwi_planes *planes, const cw_read_desc *desc,
                                      cw_volume *volume, cw_error *err);

/* Reads whole planes of a stack, as the module returns their pixels. Initialise `file` to
 * SIZE_MAX. */
typedef struct cwi_stack_reader {
    const cwi_stack *stack;
    const cwi_input *in;
    cwi_planes *planes;
    size_t file; /* the last file handed over; SIZE_MAX: none */
} cwi_stack_reader;

CW_NODISCARD cw_status cwi_stack_read_plane(cwi_stack_reader *reader, size_t plane, void *to,
                                            cw_error *err);

void cwi_stack_free(cwi_stack *stack);

#endif
