/* Stores where widgets are, for scripts that use them by name. */
#include "viewer/window/ui_internal.h"

#include <stdio.h>
#include <string.h>

void cwi_ui_label(char out[CWI_UI_NAME_SIZE], const char *label)
{
    const char *end = strstr(label, "##");
    const size_t length = end ? (size_t)(end - label) : strlen(label);
    snprintf(out, CWI_UI_NAME_SIZE, "%.*s",
             (int)(length < CWI_UI_NAME_SIZE ? length : CWI_UI_NAME_SIZE - 1), label);
}

void cwi_ui_widget_rects_add(cwi_ui *ui, const char *label, const cwi_ui_rect *rect)
{
    cwi_ui_widget_rects *p = &ui->now;
    void *grown = cwi_grow_array(p->items, p->count, &p->capacity, sizeof *p->items);
    if (!grown)
        return; /* then it is not found */
    p->items = grown;
    cwi_ui_widget_rect *item = &p->items[p->count++];
    snprintf(item->panel, sizeof item->panel, "%s",
             ui->depth > 0 ? ui->panel[cwi_ui_panel_at(ui)] : "");
    cwi_ui_label(item->label, label);
    item->rect = *rect;
}

void cwi_ui_widget_rects_turn(cwi_ui *ui)
{
    const cwi_ui_widget_rects old = ui->last;
    ui->last = ui->now;
    ui->now = old;
    ui->now.count = 0;
}

static bool is_named(const cwi_ui_widget_rect *item, const char *name)
{
    const size_t length = strlen(item->panel);
    return strncmp(item->label, name, CWI_UI_NAME_SIZE - 1) == 0 ||
           (strncmp(item->panel, name, length) == 0 && name[length] == '/' &&
            strncmp(item->label, name + length + 1, CWI_UI_NAME_SIZE - 1) == 0);
}

bool cwi_ui_widget_rects_find(const cwi_ui *ui, const char *label, cwi_ui_rect *rect)
{
    for (size_t n = 0; n < ui->last.count; n++)
        if (is_named(&ui->last.items[n], label)) {
            *rect = ui->last.items[n].rect;
            return true;
        }
    return false;
}

/* Enters a panel. Panels nested deeper than CWI_UI_DEPTH share the last one's name. */
void cwi_ui_panel_enter(cwi_ui *ui, const char *title, unsigned flags)
{
    const int at = ui->depth < CWI_UI_DEPTH ? ui->depth : CWI_UI_DEPTH - 1;
    cwi_ui_label(ui->panel[at], title);
    ui->panel_flags[at] = flags;
    ui->in_section[at] = false;
    ui->depth++;
}

void cwi_ui_panel_leave(cwi_ui *ui)
{
    ui->depth--;
}

int cwi_ui_panel_at(const cwi_ui *ui)
{
    return ui->depth < CWI_UI_DEPTH ? ui->depth - 1 : CWI_UI_DEPTH - 1;
}
