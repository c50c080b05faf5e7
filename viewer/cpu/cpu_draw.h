/* Draws pictures on the CPU. */
#ifndef VIEWER_CPU_CPU_DRAW_H
#define VIEWER_CPU_CPU_DRAW_H

#include "viewer/projection/cell_color.h"
#include "viewer/rays/cell_tree.h"
#include "viewer/scene/block_ranges.h"
#include "viewer/scene/frame_setup.h"
#include "viewer/scene/mean_cells.h"

#ifdef __cplusplus
extern "C" {
#endif

/* State kept for the next picture of the same volume. Zeroed: nothing is kept. */
typedef struct cwi_cpu {
    cw_volume key;
    cw_cells cells;          /* those of key, if it has them */
    size_t gradient_version; /* of the tree's gradients */
    cwi_ranges ranges;       /* of key, when it has blocks */
    cwi_mean_cells means;    /* of key, when it has levels */
    cwi_cell_tree tree;      /* of key, when it has kinds */
    cwi_cell_tables cell_tables;
} cwi_cpu;

bool cwi_cpu_draws(cw_mode mode);

/* Draws every sample of a frame into a zeroed picture. Returns CW_ERR_UNSUPPORTED for a mode,
 * or a way to draw meshes, that only GL has */
CW_NODISCARD cw_status cwi_cpu_draw(cwi_cpu *cpu, const cwi_frame *frame, cw_picture *picture,
                                    cw_error *err);
void cwi_cpu_forget(cwi_cpu *cpu);

#ifdef __cplusplus
}
#endif

#endif
