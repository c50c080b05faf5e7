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

/* Fetches the gradients at the corners of a cell, per voxel, of even and of odd number, along
 * each axis: by the cells on both sides, which must be there. Returns false if one has no
 * value. */
typedef bool cwi_cell_corners_gradients(const cwi_cell_corners *corners, const char *first,
                                        cwi_lanes gradients[3][2]);

struct cwi_cell_corners {
    const cw_volume *volume;
    cwi_cell_corners_fetch *fetch;
    cwi_cell_corners_gradients *gradients;
    ptrdiff_t side[3];          /* to the next corner along each axis; 0: the same again */
    double row_scale, row_bias; /* from a number of the volume to its row */
    /* The same for numbers of few bits: (number - origin) * scale + rest. */
    float origin, scale, rest, nodata;
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

/* Interpolates two fields at the second and third of four places: the first field at both, the
 * second at both. */
static inline cwi_lanes cwi_cell_corners_pair(const cwi_lanes a[2], const cwi_lanes b[2],
                                              const cwi_lanes at[3])
{
#define BOTH(v, w, n) __builtin_shufflevector(v, w, n, n, 4 + n, 4 + n)
    cwi_lanes x[3], line[4];
    const cwi_lanes rise_a = a[1] - a[0], rise_b = b[1] - b[0];
    for (int n = 0; n < 3; n++)
        x[n] = __builtin_shufflevector(at[n], at[n], 1, 2, 1, 2);
    line[0] = BOTH(a[0], b[0], 0) + BOTH(rise_a, rise_b, 0) * x[0];
    line[1] = BOTH(a[0], b[0], 1) + BOTH(rise_a, rise_b, 1) * x[0];
    line[2] = BOTH(a[0], b[0], 2) + BOTH(rise_a, rise_b, 2) * x[0];
    line[3] = BOTH(a[0], b[0], 3) + BOTH(rise_a, rise_b, 3) * x[0];
#undef BOTH
    const cwi_lanes low = line[0] + (line[1] - line[0]) * x[1],
                    high = line[2] + (line[3] - line[2]) * x[1];
    return low + (high - low) * x[2];
}

#ifdef __cplusplus
}
#endif

#endif
