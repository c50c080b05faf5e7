/* The panel's section of measurements: the tools, and the values with their removal. */
#include "cli/session/view_measure.h"
#include "cli/window/panels.h"

#include <stdio.h>

static void show_tools(view *v)
{
    static const struct {
        view_measure_kind kind;
        const char *label, *tip;
    } tools[] = {
        {VIEW_MEASURE_DISTANCE, "Distance", "Click two points in slices or on the scene"},
        {VIEW_MEASURE_ANGLE, "Angle", "Click three points; the second is the corner"},
        {VIEW_MEASURE_AREA, "Area",
         "Click points around an area of a slice; Enter or a double click ends it.\n"
         "On a surface it is the area of the polygon between the points, not of the surface"}};
    for (size_t n = 0; n < sizeof tools / sizeof *tools; n++) {
        char label[32];
        const bool on = v->measuring.tool == tools[n].kind;
        snprintf(label, sizeof label, "%s%s", on ? "Stop " : "", tools[n].label);
        if (n)
            v->ui->same_line(v->window);
        if (v->ui->button(v->window, label))
            view_ask(v, "measure-tool %s", view_measure_name(tools[n].kind));
        v->ui->tip(v->window, tools[n].tip);
    }
}

void view_show_measure_section(view *v)
{
    char value[96], line[128];
    const size_t count = v->state.measure_count;
    if (!v->ui->section(v->window, "Measurements", count > 0))
        return;
    show_tools(v);
    for (size_t n = 0; n < count; n++) {
        const view_measure *m = &v->state.measures[n];
        view_measure_value(v, m, value, sizeof value);
        snprintf(line, sizeof line, "Remove %zu", n + 1);
        if (v->ui->button(v->window, line))
            view_ask(v, "measure off %zu", n + 1);
        v->ui->same_line(v->window);
        snprintf(line, sizeof line, "%s %s", view_measure_name(m->kind), value);
        v->ui->text(v->window, line);
    }
    if (count && v->ui->button(v->window, "Copy the values"))
        view_ask(v, "copy-measurements");
    if (count)
        v->ui->same_line(v->window);
    if (count && v->ui->button(v->window, "Remove all"))
        view_ask(v, "measure off");
}
