/* The eight corners of a cell, in single precision and as rows of a transfer function's
 * table. */
#ifndef VIEWER_RAYS_CELL_CORNERS_H
#define VIEWER_RAYS_CELL_CORNERS_H

#include "viewer/rays/lanes.h"
#include "viewer/scene/transfer_table.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_cell_corners cwi_cell_corners;

/* Fetches the corners of even and those of odd number; bit a of a number is the place along
 * axis a. Returns false if one has no value. */
typedef bool cwi_cell_corners_fetch(const cwi_cell_corners *corners, const char *first,
                                    cwi_lanes *even, cwi_lanes *odd);

struct cwi_cell_corners {
    const cw_volume *volume;
    cwi_cell_corners_fetch *fetch;
    ptrdiff_t side[3];          /* to the next corner along each axis; 0: the same again */
    double row_scale, row_bias; /* from a number of the volume to its row */
};

/* Prepares for a resolved, evenly spaced volume, which stays borrowed. */
void cwi_cell_corners_make(const cw_volume *volume, const cwi_table *table,
                           cwi_cell_corners *corners);

/* Interpolates the field at four places of a cell, 0 to 1 along each axis. */
static inline cwi_lanes cwi_cell_corners_at(cwi_lanes even, cwi_lanes odd,
                                            const cwi_lanes at[3])
{
    const cwi_lanes rise = odd - even;
    const cwi_lanes e0 = even[0] + rise[0] * at[0], e1 = even[1] + rise[1] * at[0];
    const cwi_lanes e2 = even[2] + rise[2] * at[0], e3 = even[3] + rise[3] * at[0];
    const cwi_lanes q0 = e0 + (e1 - e0) * at[1], q1 = e2 + (e3 - e2) * at[1];
    return q0 + (q1 - q0) * at[2];
}

#ifdef __cplusplus
}
#endif

#endif
