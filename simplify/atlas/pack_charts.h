/* Packs charts into a square. */
#ifndef SIMPLIFY_ATLAS_PACK_CHARTS_H
#define SIMPLIFY_ATLAS_PACK_CHARTS_H

#include "simplify/atlas/atlas_state.h"

/* The place of a chart: its points are turned, scaled, and moved. */
typedef struct cwi_chart_place {
    double turn[2];  /* cosine and sine */
    double shift[2]; /* texels */
} cwi_chart_place;

typedef struct cwi_atlas_packing {
    uint32_t size, margin; /* texels */
    double density;        /* texels per mm; 0: as many as fit; set */
    int threads;
    cwi_chart_place *places; /* charts; set */
} cwi_atlas_packing;

/* Finds places for charts so that margins are free between them. Charts come by size, each to the
 * lowest place in which the outline as it is, not its box, has room, in one of four directions.
 * Returns  CW_ERR_ARGUMENT  they do not fit, at the density that is asked for or at any
 *          CW_ERR_NO_MEMORY
 * Source   bottom-left placement of bitmaps, as in [Levy2002] */
CW_NODISCARD cw_status cwi_charts_pack(cwi_atlas_packing *packing, const cwi_chart *charts,
                                       size_t count, const cw_progress *progress,
                                       cw_error *err);

#endif
