/* A volume put together from planes in files: which plane goes where, and the reading. */
#ifndef FORMATS_VOLUME_SLICE_STACK_H
#define FORMATS_VOLUME_SLICE_STACK_H

#include "formats/bytes/input_file.h"
#include "formats/volume/sandboxed_planes.h"

/* A plane of pixels in a file. */
typedef struct cwi_plane {
    size_t file; /* of the stack's */
    uint32_t number;
    double slope, intercept; /* of its pixels, where the stack is scaled */
} cwi_plane;

/* One plane of the result: (1 - t) low + t high. */
typedef struct cwi_slot {
    size_t place;     /* in the result, where planes lie one behind another: z varies fastest */
    size_t low, high; /* planes */
    double t;         /* 0: low as it is */
    uint32_t label;   /* not 0: stored where the plane's pixels are not 0 */
} cwi_slot;

/* A zeroed stack is empty. Free it with cwi_stack_free(). */
typedef struct cwi_stack {
    cw_volume shape;   /* all but the voxels; planes of dim[0] x dim[1] one behind another,
                          steps and components of the planes' own behind those */
    cw_type type;      /* of pixels as the module gives them */
    size_t samples;    /* ... and how many of them make a pixel */
    bool scaled;       /* the result is slope * pixel + intercept of each plane */
    bool has_padding;  /* pixels from low to high stand for no data */
    double padding[2]; /* ... and become shape.nodata */
    bool sparse;       /* places may have no slot: they are shape.nodata, else 0 */
    const char *size_field;
    cwi_names files; /* none: the one that is open */
    cwi_plane *planes;
    size_t plane_count;
    cwi_slot *slots;
    size_t slot_count;
} cwi_stack;

/* Checks limits, then reads (unless desc->header_only). As cwi_source_load(). */
CW_NODISCARD cw_status cwi_stack_load(const cwi_stack *stack, const cwi_input *in,
                                      cwi_planes *planes, const cw_read_desc *desc,
                                      cw_volume *volume, cw_error *err);

void cwi_stack_free(cwi_stack *stack);

#endif
