/* Counts by 64-bit keys above 0: labels plus 1, or pairs of labels. */
#ifndef CORE_VOLUME_KEY_COUNTS_H
#define CORE_VOLUME_KEY_COUNTS_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_key_count {
    uint64_t key; /* 0: free */
    size_t count;
} cwi_key_count;

/* Zeroed: empty. */
typedef struct cwi_key_counts {
    size_t size, used; /* size: a power of two, or 0 */
    cwi_key_count *entries;
} cwi_key_counts;

/* Finds the entry of a key, or makes one with a count of 0; valid until the next call. NULL when
 * memory is out. */
cwi_key_count *cwi_key_counts_need(cwi_key_counts *table, uint64_t key);
/* Finds the entry of a key; NULL: there is none. */
const cwi_key_count *cwi_key_counts_find(const cwi_key_counts *table, uint64_t key);
/* Returns true if there is an entry of the key. */
bool cwi_key_counts_has(const cwi_key_counts *table, uint64_t key);
void cwi_key_counts_free(cwi_key_counts *table);

#ifdef __cplusplus
}
#endif

#endif
