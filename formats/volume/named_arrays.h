/* The list of a file's arrays, which its reader fills while it reads. */
#ifndef FORMATS_VOLUME_NAMED_ARRAYS_H
#define FORMATS_VOLUME_NAMED_ARRAYS_H

#include <cubewright/formats.h>

/* A list of arrays. A zeroed list is empty. Free it with cwi_array_list_free(). */
typedef struct cwi_array_list {
    cw_array *items;
    size_t count, capacity;
    bool starved; /* there was no memory for one of them */
} cwi_array_list;

/* Adds an array once, since pieces of a file have the same arrays. list may be NULL. */
void cwi_array_list_add(cwi_array_list *list, const char *name, const char *type,
                        size_t components, bool of_cells, bool is_read);

/* Marks the array that is read where the caller names none. */
void cwi_array_list_choose(cwi_array_list *list, const char *name, bool of_cells);

/* Prints "the array 'p' is taken; --array takes 'u', 'v'", with as many names as fit; returns
 * false when there is no other array. */
bool cwi_array_list_tell(const cwi_array_list *list, char *text, size_t size);

void cwi_array_list_free(cwi_array_list *list);

#endif
