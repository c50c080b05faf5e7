/* The state of a smoothing, which its steps share. */
#ifndef SIMPLIFY_SMOOTHING_MESH_SMOOTH_H
#define SIMPLIFY_SMOOTHING_MESH_SMOOTH_H

#include "simplify/smoothing/kept_volumes.h"
#include "simplify/smoothing/vertex_rings.h"

#include <cubewright/smooth.h>

typedef struct cwi_smoother {
    const cw_mesh *mesh; /* as it was before */
    cw_smooth_desc desc; /* with its defaults */
    cwi_rings rings;
    cwi_kept_volumes volumes;
    double *from, *to; /* vertices x 3; from has the positions so far */
    double limit;      /* max_move_mm, less what rounding may add to a distance */
    float *rounded;    /* vertices x 3: the result */
} cwi_smoother;

/* Returns true if a vertex is not to move: at a rim that stays or ends there, or with too few
 * neighbours. */
bool cwi_smooth_is_fixed(const cwi_smoother *s, size_t v);

/* Moves the positions by CW_SMOOTH_TAUBIN or CW_SMOOTH_HC.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_smooth_average(cwi_smoother *s, const cw_progress *progress,
                                          cw_error *err);

/* Moves the positions by CW_SMOOTH_FAIR. Returns the same */
CW_NODISCARD cw_status cwi_smooth_fair(cwi_smoother *s, const cw_progress *progress,
                                       cw_error *err);

/* Puts vertices back to their first positions until no triangles meet that did not meet before, and
 * none has lost its area.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_smooth_undo_crossings(cwi_smoother *s, cw_smooth_facts *facts,
                                                 const cw_progress *progress, cw_error *err);

#endif
