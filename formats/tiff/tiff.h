/* Facts of a TIFF file, which the module "tiff" (libtiff, in a sandboxed process) puts into the
 * shared memory. Nothing in here has been checked. */
#ifndef FORMATS_TIFF_TIFF_H
#define FORMATS_TIFF_TIFF_H

#include "formats/volume/sandboxed_planes.h"

enum { CWI_TIFF_MAX_PAGES = 65536 };

typedef struct cwi_tiff_facts {
    uint32_t columns, rows, samples;
    uint32_t bits;       /* of a stored sample */
    cw_type type;        /* of samples as they are returned */
    uint32_t compressed; /* 0: no */
    uint32_t turned;     /* 0: no; else white was 0, and values are inverted */
    uint32_t page_count; /* of full resolution, in the file */
    uint32_t slices, channels, steps;
    double spacing[3]; /* along x, y and z; 0: not stated */
    double unit_mm[3]; /* millimetres of their unit; 0: not stated */
    double pixel_mm
        [2]; /* by the tags of resolution alone, which scans and screens state, too; 0: no */
    double step_seconds; /* 0: not stated */
    double slope, intercept;
    char note[160]; /* a decision to report; empty: none */
} cwi_tiff_facts;   /* slices * channels * steps numbers of pages (uint32_t) follow: slices vary
                       fastest, then channels, then steps */

extern CW_API const cwi_plane_functions cwi_module_tiff;

#endif
