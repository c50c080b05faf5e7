/* Pressures that give labels the volumes of their voxels. */
#ifndef EXTRACT_LABELS_LABEL_PRESSURES_H
#define EXTRACT_LABELS_LABEL_PRESSURES_H

#include "extract/labels/label_moves.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Set the moves' first block, and zero the rest. */
typedef struct cwi_label_pressures {
    cwi_label_moves moves;

    size_t labels;
    uint32_t (*sides)[2]; /* numbers of a patch's labels; `labels`: the background */
    double *deficits;     /* labels + 1: volumes that labels lack, in voxels */
    bool *are_active;     /* labels + 1: those that lack too much */
    uint32_t *active;     /* patches of those */
    size_t active_count;
    double *weights;   /* of patches: how volumes change with pressures */
    double *pressures; /* 4 x (labels + 1) numbers to solve with; these come first */
} cwi_label_pressures;

/* Returns false when memory is out; free them either way. */
CW_NODISCARD bool cwi_label_pressures_init(cwi_label_pressures *p);
void cwi_label_pressures_free(cwi_label_pressures *p);

/* Moves vertices between two rounds of smoothing, once: labels get most of the volume that they lack.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_label_pressures_set(cwi_label_pressures *p,
                                               const cw_labels_desc *desc, cw_error *err);

/* Moves vertices, counted in voxels, until no label lacks more than a fraction of the volume of its
 * voxels: each interface along its normal, by the difference of its two labels' pressures. Labels
 * that lack less have no pressure. No vertex moves farther than the bound from its first place along
 * an axis.
 * full_rounds  in which all labels have pressures
 * rounds   at most
 * is_kept  set to true if there was nothing to do
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_label_pressures_keep(cwi_label_pressures *p, double max_deficit,
                                                int full_rounds, int rounds, bool *is_kept,
                                                const cw_labels_desc *desc, cw_error *err);

/* Keeps volumes after smoothing, and does not smooth the labels of a few voxels that cannot. */
CW_NODISCARD cw_status cwi_label_pressures_keep_first(cwi_label_pressures *p,
                                                      const cw_labels_desc *desc,
                                                      cw_error *err);

/* Puts vertices of labels of a few voxels that lack more than a fraction back to where they were:
 * there they have their volume. Smoothing had made them flat. */
void cwi_label_pressures_restore_small(cwi_label_pressures *p, double max_deficit);

#ifdef __cplusplus
}
#endif

#endif
