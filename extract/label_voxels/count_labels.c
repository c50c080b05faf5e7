/* Counts the voxels of each label. */
#include <cubewright/labels.h>

#include "core/volume/key_counts.h"
#include "extract/labels/label_layers.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <stdlib.h>

static int compare_counts(const void *a, const void *b)
{
    const uint32_t x = ((const cw_label_count *)a)->label;
    const uint32_t y = ((const cw_label_count *)b)->label;
    return (x > y) - (x < y);
}

static cw_status list_counts(const cwi_key_counts *table, cw_label_count **counts,
                             size_t *count, cw_error *err)
{
    *counts = cwi_alloc_array(table->used, sizeof **counts);
    if (!*counts)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < table->size; n++)
        if (table->entries[n].key)
            (*counts)[(*count)++] = (cw_label_count){(uint32_t)(table->entries[n].key - 1),
                                                     table->entries[n].count};
    qsort(*counts, *count, sizeof **counts, compare_counts);
    return CW_OK;
}

cw_status cw_label_counts(const cw_volume *volume, uint32_t background, cw_label_count **counts,
                          size_t *count, cw_error *err)
{
    CWI_REQUIRE(err, volume, counts, count);
    cw_volume v;
    cwi_key_counts table = {0};
    *counts = NULL;
    *count = 0;
    cw_status st = cw_volume_resolve(volume, &v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&v, "counting labels", err);
    if (st != CW_OK)
        return st;
    const cwi_label_layers layers = {.volume = &v,
                                     .background = background,
                                     .width = v.dim[0] + 2,
                                     .height = v.dim[1] + 2,
                                     .count = v.dim[2] + 2};
    uint32_t *labels = cwi_alloc_array(layers.width, layers.height * sizeof *labels);
    bool is_whole = labels != NULL;
    for (size_t k = 1; k + 1 < layers.count && st == CW_OK && is_whole; k++) {
        size_t bad[3];
        if (!cwi_label_layer_load(&layers, k, labels, bad))
            st = cwi_label_fail_voxel(&layers, bad, err);
        else
            is_whole = cwi_label_layer_count(&layers, labels, &table);
    }
    if (st == CW_OK)
        st = is_whole ? list_counts(&table, counts, count, err) : cwi_fail_memory(err);
    cwi_free(labels);
    cwi_key_counts_free(&table);
    return st;
}

void cw_label_counts_free(cw_label_count *counts)
{
    cwi_free(counts);
}
