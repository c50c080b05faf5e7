/* Lists the files of a folder of slices that cannot be read, notes them, or fails with one. */
#include "formats/volume/damaged_files.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/volume/volume_reader.h"

#include <stdio.h>
#include <string.h>

bool cwi_is_damage(cw_status status)
{
    return status != CW_OK && status != CW_ERR_CANCELLED && status != CW_ERR_NO_MEMORY;
}

cw_status cwi_damaged_add(cwi_damaged *list, const char *name, const char *owner,
                          const cw_error *reason, cw_error *err)
{
    cwi_damaged_file *more = cwi_realloc_array(list->items, list->count + 1, sizeof *more);
    if (!more)
        return cwi_fail_memory(err);
    list->items = more;
    cwi_damaged_file *file = &more[list->count++];
    *file = (cwi_damaged_file){.status = reason->status};
    snprintf(file->name, sizeof file->name, "%s", name);
    snprintf(file->reason, sizeof file->reason, "%.199s", reason->message);
    snprintf(file->owner, sizeof file->owner, "%s", owner);
    return CW_OK;
}

void cwi_damaged_free(cwi_damaged *list)
{
    cwi_free(list->items);
    *list = (cwi_damaged){0};
}

void cwi_damaged_note(const cwi_damaged *list, const char *words, const cw_read_desc *desc)
{
    enum { LINE = 120 }; /* bytes of names */
    char names[LINE + sizeof list->items->name] = "", more[40] = "";
    size_t used = 0, n = 0;
    for (; n < list->count && used < LINE; n++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", n ? ", " : "",
                                 list->items[n].name);
    if (n < list->count)
        snprintf(more, sizeof more, " and %zu more", list->count - n);
    if (n)
        cwi_note(desc, "%s: %s%s; %s", words, names, more, list->items[0].reason);
}

cw_status cwi_damaged_fail(const cwi_damaged_file *file, cw_error *err)
{
    cwi_fail(err, file->status, "%s", file->reason);
    return cwi_fail_in_damaged(err, file->status, file->name);
}

cw_status cwi_fail_in_damaged(cw_error *err, cw_status status, const char *name)
{
    const cw_error inner = err ? *err : (cw_error){0};
    return cwi_fail(err, status, "%s: %s; desc->skip_damaged leaves such files out", name,
                    inner.message);
}
