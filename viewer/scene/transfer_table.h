/* A transfer function as tables, for the texture unit and for fast loops on the CPU. */
#ifndef VIEWER_SCENE_TRANSFER_TABLE_H
#define VIEWER_SCENE_TRANSFER_TABLE_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Colours and extinction at evenly spaced values, the ends included. Beyond them a transfer
 * function is constant. */
typedef struct cwi_table {
    double low, high; /* values of the first and last row */
    size_t count;
    float *rows;       /* count x 4: red, green, blue, extinction per unit of eye space */
    uint16_t *visible; /* count: the first row from there on that is not fully transparent, or
                          count */
} cwi_table;

enum { CWI_TABLE_ROWS = 4096 };

/* Makes the table of a frame's transfer function. CW_ERR_NO_MEMORY. It may be freed twice. */
CW_NODISCARD cw_status cwi_table_make(const cwi_frame *frame, cwi_table *table, cw_error *err);
void cwi_table_free(cwi_table *table);

/* Returns true if something within a range of values is not fully transparent. */
bool cwi_table_is_visible(const cwi_table *table, double low, double high);

/* Returns true if the function has features so narrow that samples a few of them apart miss
 * some: averaged over an eighth of the table, extinction and glow change by more than a tenth.
 * Pre-integration pays for such functions alone. */
bool cwi_table_is_narrow(const cwi_table *table);

/* Returns the number of rows that a pre-integrated table needs: more for narrow peaks, 256 to
 * 1024. */
size_t cwi_table_segment_rows(const cwi_table *table, const cw_transfer *transfer);

/* Pre-integrates [Engel2001] segments of a length (units of eye space), along which the value
 * changes linearly from row x to row y. out is count x count x 4, y slowest: colour times
 * opacity, and opacity. Within a segment light is absorbed too: it is cut into pieces whose
 * depth and glow are exact. */
CW_NODISCARD cw_status cwi_table_preintegrate(const cwi_table *table, double length,
                                              size_t count, int threads,
                                              const cw_progress *progress, float *out,
                                              cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
