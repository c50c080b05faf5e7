/* Extracts the labels of the largest fields, with vertices where fields are equal. */
#include "extract/label_scores/field_places.h"

#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

cw_status cw_extract_label_scores(const cw_label_scores *fields, const cw_labels_desc *desc,
                                  cw_label_surfaces *surfaces, cw_error *err)
{
    const cw_labels_desc none = {0};
    cwi_label_scores f;
    CWI_REQUIRE(err, fields, surfaces);
    CWI_REQUIRE_VERSION(err, fields, 0);
    CWI_REQUIRE_VERSION(err, desc, 0);
    memset(surfaces, 0, sizeof *surfaces);
    const cw_labels_desc *d = desc ? desc : &none;
    const cwi_label_smoother smoother = {cwi_label_scores_place, &f};
    cw_status st =
        cwi_label_scores_open(&f, fields, d->background, d->threads, &d->progress, err);
    if (st == CW_OK)
        st = cwi_extract_labels_with(&f.map, d, &smoother, surfaces, err);
    cwi_label_scores_close(&f);
    return st;
}

cw_status cw_label_scores_largest(const cw_label_scores *fields, uint32_t background,
                                  int threads, cw_volume *map, cw_error *err)
{
    const cw_progress silent = {0};
    cwi_label_scores f;
    CWI_REQUIRE(err, fields, map);
    CWI_REQUIRE_VERSION(err, fields, 0);
    *map = (cw_volume){0};
    cw_status st = cwi_label_scores_open(&f, fields, background, threads, &silent, err);
    if (st == CW_OK)
        st = cwi_volume_own_coordinates(&f.map, err);
    if (st == CW_OK) {
        *map = f.map;
        f.map = (cw_volume){0};
    }
    cwi_label_scores_close(&f);
    return st;
}
