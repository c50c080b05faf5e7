/* Facts of a TIFF file, which the module "tiff" (libtiff, in a sandboxed process) puts into the
 * shared memory. Nothing in here has been checked. */
#ifndef FORMATS_TIFF_TIFF_H
#define FORMATS_TIFF_TIFF_H

#include "formats/volume/sandboxed_planes.h"

enum { CWI_TIFF_MAX_PAGES = 65536, CWI_TIFF_NAMES = 2048 };

typedef struct cwi_tiff_facts {
    uint32_t columns, rows, samples;
    uint32_t bits;        /* of a stored sample */
    cw_type type;         /* of samples as they are returned */
    uint32_t compressed;  /* 0: no */
    uint32_t turned;      /* 0: no; else white was 0, and values are inverted */
    uint32_t page_count;  /* of full resolution, in the file */
    uint32_t image_count; /* of an OME-TIFF, of which one is read; else 0 */
    uint32_t slices, channels, steps;
    double spacing[3]; /* along x, y and z; 0: not stated */
    double unit_mm[3]; /* millimetres of their unit; 0: not stated */
    double pixel_mm
        [2]; /* by the tags of resolution alone, which scans and screens state, too; 0: no */
    double step_seconds; /* 0: not stated */
    double slope, intercept;
    uint32_t has_nodata;
    double nodata;              /* of pixels as they are returned */
    char note[320];             /* decisions to report; empty: none */
    char names[CWI_TIFF_NAMES]; /* of the images, a line each, as far as there is room */
} cwi_tiff_facts; /* slices * channels * steps numbers of pages (uint32_t) follow: slices vary
                       fastest, then channels, then steps */

/* Returns the line behind one of text that need not end as it should. */
static inline const char *cwi_tiff_next_line(const char *line)
{
    while (*line && *line != '\n')
        line++;
    return *line ? line + 1 : line;
}

extern CW_API const cwi_plane_functions cwi_module_tiff;

#endif
