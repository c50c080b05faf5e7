/* The view of three dimensions: its meshes as text of base64, and what chooses between them.
 * The script view3d.js draws it; without it the view stays hidden. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

void cli_put_view_begin(FILE *out)
{
    fputs("<section class=\"turns\">\n<h2 id=\"view\">In three dimensions</h2>\n<p "
          "class=\"quiet\">Drag to turn, use the "
          "wheel or two fingers to zoom, Shift and drag to move. With the keyboard: arrow "
          "keys, + "
          "and -, and 0 to reset.</p>\n<div class=\"view3d\" hidden=\"\" data-colors=\"",
          out);
}

void cli_put_view_mesh(FILE *out, const cli_packed *p, const char *name, const char *words)
{
    if (!p->bytes)
        return;
    fputs("<script type=\"text/plain\" data-name=\"", out);
    cli_put_html(out, name);
    fputs("\" data-words=\"", out);
    cli_put_html(out, words);
    fprintf(
        out,
        "\" data-vertices=\"%zu\" data-triangles=\"%zu\" data-levels=\"%d\" data-box=\"%.9g "
        "%.9g %.9g %.9g %.9g %.9g\">",
        p->vertices, p->triangles, p->has_bytes, p->low[0], p->low[1], p->low[2], p->high[0],
        p->high[1], p->high[2]);
    cli_put_base64(out, p->bytes, p->size);
    fputs("</script>\n", out);
}

void cli_put_view_end(FILE *out, const char *about)
{
    fputs("<canvas tabindex=\"0\" role=\"application\" aria-label=\"the mesh in three "
          "dimensions\">"
          "</canvas>\n<p class=\"quiet words\" aria-live=\"polite\"></p>\n",
          out);
    if (about)
        fprintf(out, "<p class=\"quiet\">%s</p>\n", about);
    fputs("</div>\n</section>\n", out);
}

static void put_tools(FILE *out, const cli_study *s)
{
    fputs("\">\n<div class=\"tools\"><label>Mesh <select class=\"mesh\">", out);
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].packed.bytes) {
            fputs("<option>", out);
            cli_put_html(out, s->points[n].name);
            fputs("</option>", out);
        }
    fputs("</select></label><label><input type=\"checkbox\" checked=\"\"/> Colours of the error"
          "</label><button type=\"button\">Reset</button></div>\n",
          out);
}

static void tell_mesh(const cli_study *s, const cli_point *p, char *words, size_t size)
{
    const cli_packed *m = &p->packed;
    const char *of = s->is_of_mesh                                   ? "all that is in the file"
                     : *s->part_words && p->family != CLI_EXTRACTION ? "a box of the object"
                                                                     : "the whole object";
    size_t end = (size_t)snprintf(words, size, "%s: %s triangles of %s", p->name,
                                  cli_count(m->triangles), of);
    if (m->made_of && end < size)
        end += (size_t)snprintf(words + end, size - end, ", thinned for this page from %s",
                                cli_count(m->made_of));
    if (end < size)
        snprintf(words + end, size - end, ".%s",
                 m->has_bytes
                     ? m->made_of ? " Colours are the errors of the full mesh." : ""
                     : " No distance to this kind of grid is measured, so it is plain.");
}

static void put_left_out(FILE *out, const cli_study *s)
{
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (!*p->packed.why)
            continue;
        fputs("<p class=\"quiet\">", out);
        cli_put_html(out, p->name);
        fprintf(out, " is not in the view: %s.</p>\n", p->packed.why);
    }
}

void cli_put_view(FILE *out, const cli_study *s)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++)
        count += s->points[n].packed.bytes != NULL;
    if (count) {
        cli_put_view_begin(out);
        cli_put_error_colors(out, 256);
        put_tools(out, s);
        for (size_t n = 0; n < s->point_count; n++) {
            char words[512];
            tell_mesh(s, &s->points[n], words, sizeof words);
            cli_put_view_mesh(out, &s->points[n].packed, s->points[n].name, words);
        }
        cli_put_ramp(out, s);
        cli_put_view_end(out,
                         "Positions are rounded to 1/65535 of the box, colours to 1/255 of "
                         "the scale.");
    }
    put_left_out(out, s);
}
