/* Counts by 64-bit keys above 0: labels plus 1, or pairs of labels. */
#ifndef EXTRACT_LABELS_LABEL_TABLE_H
#define EXTRACT_LABELS_LABEL_TABLE_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_label_entry {
    uint64_t key; /* 0: free */
    size_t count;
} cwi_label_entry;

/* Zeroed: empty. */
typedef struct cwi_label_table {
    size_t size, used; /* size: a power of two, or 0 */
    cwi_label_entry *entries;
} cwi_label_table;

/* Finds the entry of a key, or makes one with a count of 0; valid until the next call. NULL when
 * memory is out. */
cwi_label_entry *cwi_label_table_need(cwi_label_table *table, uint64_t key);
/* Returns true if there is an entry of the key. */
bool cwi_label_table_has(const cwi_label_table *table, uint64_t key);
void cwi_label_table_free(cwi_label_table *table);

#ifdef __cplusplus
}
#endif

#endif
