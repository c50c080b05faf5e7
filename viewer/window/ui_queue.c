/* Queues input with its time, until frames take it. */
#include "core/base/memory.h"
#include "viewer/window/ui_internal.h"

#include <string.h>

static bool ensure_capacity(cwi_ui_queue *q)
{
    if (q->count < q->capacity)
        return true;
    const size_t capacity = q->capacity ? 2 * q->capacity : 32;
    cwi_ui_event *items = cwi_realloc_array(q->items, capacity, sizeof *items);
    if (items)
        q->items = items;
    double *times = items ? cwi_realloc_array(q->times, capacity, sizeof *times) : NULL;
    if (!times)
        return false;
    q->times = times;
    q->capacity = capacity;
    return true;
}

static bool has_to_wait(const cwi_ui_queue *q, const cwi_ui_event *event)
{
    for (size_t n = q->first; n < q->count; n++)
        if (q->items[n].kind == event->kind && strcmp(q->items[n].text, event->text) == 0)
            return true;
    return false;
}

bool cwi_ui_queue_put(cwi_ui *ui, const cwi_ui_event *event, double seconds, bool repeats)
{
    cwi_ui_queue *q = &ui->queue;
    if (repeats && event->kind == CWI_UI_KEY && has_to_wait(q, event))
        return true;
    cwi_ui_event copy = *event;
    copy.text = event->text ? cwi_strdup(event->text) : NULL;
    if ((event->text && !copy.text) || !ensure_capacity(q)) {
        cwi_free((char *)copy.text);
        return false;
    }
    q->items[q->count] = copy;
    q->times[q->count++] = seconds;
    return true;
}
