/* The settings of bakes, and the checks of what goes in. */
#ifndef SIMPLIFY_BAKE_BAKE_INPUT_H
#define SIMPLIFY_BAKE_BAKE_INPUT_H

#include <cubewright/bake.h>

/* The default reach, as a part of the box's diagonal. */
#define CWI_BAKE_REACH 0.04

/* Fills in the defaults of settings, which may be NULL. */
cw_bake_desc cwi_bake_defaults(const cw_bake_desc *desc);

/* Sums over a row of texels. */
typedef struct cwi_bake_row {
    size_t texels, missed;
    double max_mm, sum_mm, sum_deg;
} cwi_bake_row;

/* Adds up rows. facts: set, but for the settings */
void cwi_bake_sum(const cwi_bake_row *rows, uint32_t count, cw_bake_facts *facts);

/* Checks both meshes and the settings. Returns CW_ERR_ARGUMENT, or as cw_mesh_check() */
CW_NODISCARD cw_status cwi_bake_check(const cw_mesh *mesh, const cw_mesh *full,
                                      const cw_bake_desc *desc, cw_error *err);

#endif
