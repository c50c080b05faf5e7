/* The DICOM files of a folder: their facts, and the series they belong to. */
#ifndef FORMATS_DICOM_DICOM_SERIES_H
#define FORMATS_DICOM_DICOM_SERIES_H

#include "formats/bytes/input_file.h"
#include "formats/dcmtk/dicom.h"
#include "formats/volume/damaged_files.h"

/* One frame of one file. */
typedef struct cwi_dicom_plane {
    const cwi_dicom_facts *file; /* its facts */
    size_t index;                /* of the file */
    uint32_t number;             /* of the frame in the file */
    size_t series;
    double distance; /* along the normal, mm: set by cwi_dicom_stack() */
    size_t position_index, step;
    cwi_dicom_frame frame;
} cwi_dicom_plane;

/* Planes of one scanner series, of one size, type and direction. */
typedef struct cwi_dicom_series {
    char label[32]; /* SeriesNumber; with .1, .2 ... where several series have that number */
    const cwi_dicom_plane *sample;
    size_t count; /* number of planes */
} cwi_dicom_series;

/* A zeroed scan is empty. */
typedef struct cwi_dicom_scan {
    cwi_names files; /* files with images */
    cwi_dicom_facts **facts;
    cwi_dicom_segment **segments; /* of each file; NULL: none */
    cwi_dicom_plane *planes;
    size_t plane_count, plane_capacity;
    cwi_dicom_series *series;
    size_t series_count;
    size_t strangers; /* number of files that are no DICOM images */
    size_t copies;    /* number of copies of images */
    size_t links;     /* links beside the named file, left out */
    cwi_damaged damaged;
} cwi_dicom_scan;

/* Makes DCMTK read a file that has passed the checks. */
CW_NODISCARD cw_status cwi_dicom_facts_of(cwi_planes *planes, int fd, uint64_t size,
                                          const void **shared, cw_error *err);

/* Reads the facts of the files among names that are DICOM images, and sorts them into series.
 * Damaged files are listed.
 * only  NULL, or the facts of the file that was named: only its series, and images like it,
 *       are wanted
 * desc  with skip_damaged, compressed frames are decoded once, to find the damaged ones */
CW_NODISCARD cw_status cwi_dicom_scan_files(cwi_dicom_scan *scan, const cwi_input *in,
                                            cwi_names *names, const cwi_dicom_facts *only,
                                            const cw_read_desc *desc, cwi_planes *planes,
                                            cw_error *err);
void cwi_dicom_scan_free(cwi_dicom_scan *scan);

/* Finds a series by its label or UID; without a name the only one.
 * Returns CW_ERR_UNSAFE when there are several, CW_ERR_ARGUMENT when none has that name. */
CW_NODISCARD cw_status cwi_dicom_choose(const cwi_dicom_scan *scan, const char *name,
                                        size_t *series, cw_error *err);

/* Fails with a damaged file that may belong to the series.
 * chosen  the user chose the series: files whose series is not known belong to another */
CW_NODISCARD cw_status cwi_dicom_expect_whole(const cwi_dicom_scan *scan, size_t series,
                                              bool chosen, cw_error *err);

#endif
