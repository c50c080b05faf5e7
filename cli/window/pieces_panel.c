/* The panel's section of pieces for a printer: planes and pegs, shown before anything is written. */
#include "cli/window/panels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_PEGS = 16 };

/* Asks for the pieces that the fields describe. */
static void ask_pieces(view *v, const view_cutting *c)
{
    char options[512];
    int used = 0;
    if (c->planes[0])
        used += snprintf(options, sizeof options, " --plane '%s'", c->planes);
    if (c->plate[0])
        used +=
            snprintf(options + used, sizeof options - (size_t)used, " --plate '%s'", c->plate);
    if (c->pegs > 0)
        snprintf(options + used, sizeof options - (size_t)used, " --pegs %.0f%s", c->pegs,
                 c->dowels ? " --peg-kind dowel" : "");
    view_ask(v, "pieces%s", options);
}

static void show_fields(view *v, view_cutting *c)
{
    v->ui->input(v->window, "Planes", c->planes, sizeof c->planes);
    v->ui->tip(v->window, "Planes that cut: z=5mm, z=50% of the box, x=10mm,z=5mm, ...");
    v->ui->input(v->window, "Plate", c->plate, sizeof c->plate);
    v->ui->tip(v->window,
               "Plate of the printer that each piece must fit, such as 220x220x250mm");
    v->ui->slider(v->window, "Pegs", &c->pegs, 0, MAX_PEGS, "%.0f");
    v->ui->tip(v->window, "Pegs for each region of a section");
    c->pegs = round(c->pegs);
    v->ui->check(v->window, "Dowels", &c->dowels);
    v->ui->tip(v->window, "Dowels of their own, which go into both pieces, in place of pegs");
}

void view_show_pieces_section(view *v)
{
    view_cutting *c = &v->widgets->cutting;
    const bool are_shown = v->document.pieces.are_shown;
    if (!view_has_mesh(v) || view_shows_surfaces(v) ||
        !v->ui->section(v->window, "Pieces to print", are_shown))
        return;
    show_fields(v, c);
    const bool are_quoted = strchr(c->planes, '\'') || strchr(c->plate, '\'');
    if ((c->planes[0] || c->plate[0]) && !are_quoted &&
        v->ui->button(v->window, "Show the pieces"))
        ask_pieces(v, c);
    if (!are_shown)
        return;
    if (v->ui->button(v->window, "Show the whole"))
        view_ask(v, "pieces off");
    v->ui->same_line(v->window);
    if (v->ui->button(v->window, "Copy the command"))
        view_ask(v, "copy-pieces");
    v->ui->tip(v->window, v->document.pieces.command);
}
