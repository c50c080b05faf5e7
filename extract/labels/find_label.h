/* Finds a label among those of surfaces. */
#ifndef EXTRACT_LABELS_FIND_LABEL_H
#define EXTRACT_LABELS_FIND_LABEL_H

#include <cubewright/labels.h>

/* Returns a label's number; that of the background, and of one that is not there, is label_count. */
static inline size_t cwi_find_label(const cw_label_surfaces *s, uint32_t label)
{
    size_t low = 0, high = s->label_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (s->labels[middle].label < label)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->label_count && s->labels[low].label == label ? low : s->label_count;
}

#endif
