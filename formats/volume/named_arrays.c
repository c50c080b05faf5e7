/* Collects the names of a file's arrays for lists and messages. */
#include "formats/volume/named_arrays.h"

#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

static cw_array *find_array(cwi_array_list *list, const char *name, bool of_cells)
{
    for (size_t n = 0; n < list->count; n++)
        if (list->items[n].of_cells == of_cells && strcmp(list->items[n].name, name) == 0)
            return &list->items[n];
    return NULL;
}

static cw_array *grow_list(cwi_array_list *list)
{
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 8;
        cw_array *items = cwi_realloc_array(list->items, capacity, sizeof *items);
        list->starved = list->starved || !items;
        if (!items)
            return NULL;
        list->items = items;
        list->capacity = capacity;
    }
    return &list->items[list->count++];
}

void cwi_array_list_add(cwi_array_list *list, const char *name, const char *type,
                        size_t components, bool of_cells, bool is_read)
{
    if (!list || find_array(list, name, of_cells))
        return;
    cw_array *array = grow_list(list);
    if (!array)
        return;
    *array = (cw_array){.components = components, .of_cells = of_cells, .is_read = is_read};
    snprintf(array->name, sizeof array->name, "%s", name);
    snprintf(array->type, sizeof array->type, "%s", type);
}

void cwi_array_list_choose(cwi_array_list *list, const char *name, bool of_cells)
{
    cw_array *array = list ? find_array(list, name, of_cells) : NULL;
    if (array)
        array->is_default = true;
}

bool cwi_array_list_tell(const cwi_array_list *list, char *text, size_t size)
{
    const char *taken = NULL;
    size_t others = 0, listed = 0;
    for (size_t n = 0; n < list->count; n++)
        if (list->items[n].is_default)
            taken = list->items[n].name;
        else
            others += list->items[n].is_read;
    if (!taken || !others)
        return false;
    size_t used =
        (size_t)snprintf(text, size, "the array '%s' is taken; desc->array takes", taken);
    for (size_t n = 0; n < list->count && used < size; n++) {
        const cw_array *a = &list->items[n];
        if (a->is_default || !a->is_read)
            continue;
        if (used + strlen(a->name) + sizeof " and 12345 more" > size) {
            snprintf(text + used, size - used, " and %zu more", others - listed);
            break;
        }
        used +=
            (size_t)snprintf(text + used, size - used, "%s '%s'", listed++ ? "," : "", a->name);
    }
    return true;
}

void cwi_array_list_free(cwi_array_list *list)
{
    cwi_free(list->items);
    *list = (cwi_array_list){0};
}
