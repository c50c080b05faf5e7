/* Turns the options of writing a mesh into settings of the library, and into JSON. */
#include "cli/results/mesh_write_options.h"

enum { KEEP_FRAME, LPS, RAS };
static const char *const frames[] = {"keep", "lps", "ras"};

cw_write_desc cli_written_desc(const cli_written *w, const cli_compress *compress,
                               const cli_mesh *input)
{
    const bool ras = w->frame == KEEP_FRAME ? input->file.axes.ras : w->frame == RAS;
    return (cw_write_desc){
        .format = w->format,
        .name = w->name,
        .no_clobber = w->no_clobber,
        .local = w->local,
        .text = w->ascii,
        .compression = (cw_compression)compress->kind,
        .bits = (int)compress->bits,
        .axes = {.unit = (cw_unit)w->unit, .ras = ras, .y_up = w->up},
    };
}

void cli_json_written(cli_json *j, const cli_written *w, const char *path)
{
    const cw_format *format = cw_mesh_format(path, w->format);
    cli_json_text(j, "format", format ? format->name : "");
    cli_json_bool(j, "ascii", w->ascii);
    cli_json_text(j, "unit", cw_unit_name((cw_unit)w->unit));
    cli_json_text(j, "up", w->up ? "y" : "z");
    cli_json_text(j, "frame", frames[w->frame]);
    cli_json_bool(j, "local", w->local);
}
