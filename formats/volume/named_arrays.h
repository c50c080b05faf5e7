/* The arrays that a file has, listed by its reader as it meets them. */
#ifndef FORMATS_VOLUME_NAMED_ARRAYS_H
#define FORMATS_VOLUME_NAMED_ARRAYS_H

#include <cubewright/formats.h>

/* A zeroed list is empty. Free it with cwi_array_list_free(). */
typedef struct cwi_array_list {
    cw_array *items;
    size_t count, capacity;
    bool starved; /* there was no memory for one of them */
} cwi_array_list;

/* Adds an array, once: pieces of a file have the same ones. list may be NULL. */
void cwi_array_list_add(cwi_array_list *list, const char *name, const char *type,
                        size_t components, bool of_cells, bool is_read);

/* Marks the array that is read where none is named. */
void cwi_array_list_choose(cwi_array_list *list, const char *name, bool of_cells);

/* "the array 'p' is taken; --array takes 'u', 'v'", as far as there is room for names; false
 * when there is no other to tell of. */
bool cwi_array_list_tell(const cwi_array_list *list, char *text, size_t size);

void cwi_array_list_free(cwi_array_list *list);

#endif
