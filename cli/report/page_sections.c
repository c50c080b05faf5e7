/* Pictures of meshes in the colours of their errors, shapes of triangles, and the print. */
#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

#include <math.h>

static void put_gap_text(FILE *out, const cli_study *s, const cli_point *p)
{
    fprintf(out, "level %s, %s; ", cli_number_text(s->iso),
            s->is_of_mesh                                   ? "all of it"
            : *s->part_words && p->family != CLI_EXTRACTION ? "a box of the object"
                                                            : "the whole object");
    const double rms = cli_point_error(s, p);
    fprintf(out, "%s triangles, %s", cli_count(p->triangles), cli_bytes((double)p->file_bytes));
    if (isfinite(rms))
        fprintf(out, ", RMS error %.3g mm (%.3g voxels)", rms, rms / s->voxel_mm);
}

void cli_put_error_colors(FILE *out, int stops)
{
    for (int n = 0; n < stops; n++) {
        uint8_t c[3];
        cli_error_color((double)n / (stops - 1), c);
        fprintf(out, "%s%d,%d,%d", n ? " " : "", c[0], c[1], c[2]);
    }
}

/* A tick for each decade, in millimetres above and in voxels below. */
void cli_put_ramp(FILE *out, const cli_study *s)
{
    enum { STOPS = 13 };
    static const double ticks[] = {0.001, 0.01, 0.1, 1};
    enum { TICKS = sizeof ticks / sizeof *ticks };
    fputs("<div class=\"ramp\"><i style=\"background:linear-gradient(90deg", out);
    for (int n = 0; n < STOPS; n++) {
        uint8_t c[3];
        cli_error_color((double)n / (STOPS - 1), c);
        fprintf(out, ",rgb(%d,%d,%d)", c[0], c[1], c[2]);
    }
    fputs(")\"></i><ol>", out);
    for (int n = 0; n < TICKS; n++)
        fprintf(out, "<li><strong>%.2g mm</strong>%g voxel%s</li>", ticks[n] * s->voxel_mm,
                ticks[n], ticks[n] < 1 ? "s" : "");
    fputs("</ol></div>\n", out);
}

static void put_picture(FILE *out, const cli_study *s, const cli_point *p)
{
    char alt[CLI_NAME_CAPACITY + 64];
    snprintf(alt, sizeof alt, "The mesh of '%s' from the front, in the colours of its error",
             p->name);
    fputs("<figure>", out);
    cli_put_image(out, &p->drawn, alt);
    fputs("<figcaption><strong>", out);
    cli_put_html(out, p->name);
    fputs("</strong>", out);
    put_gap_text(out, s, p);
    fputs("</figcaption></figure>\n", out);
}

static void put_part(FILE *out, const cli_study *s)
{
    fputs("<figure>", out);
    cli_put_image(
        out, &s->part_drawn,
        "The plain surface of a box of the object, from the front, in the colours of its "
        "error");
    fprintf(out,
            "<figcaption><strong>linear, in the box</strong>level %s, a box of the object; %s "
            "triangles: the next ones are made of it</figcaption></figure>\n",
            cli_number_text(s->iso), cli_count(cli_part_mesh(s)->triangle_count));
}

static bool has_errors(const cli_point *p)
{
    return p->drawn.bytes && !cli_is_drawn(p->family);
}

void cli_put_pictures(FILE *out, const cli_study *s)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++)
        count += has_errors(&s->points[n]);
    if (!count)
        return;
    fputs("<h2>Where the error is</h2>\n<p>In the colour of the distance from the field's "
          "surface, as linear interpolation between voxels has it: the largest around each "
          "vertex; "
          "of large meshes the middles of triangles are looked at.</p>\n",
          out);
    cli_put_ramp(out, s);
    fputs("<div class=\"pictures\">\n", out);
    bool part = s->part_drawn.bytes; /* to be put before the first picture of the box */
    for (size_t n = 0; n < s->point_count; n++) {
        if (!has_errors(&s->points[n]))
            continue;
        if (part && s->points[n].family != CLI_EXTRACTION) {
            put_part(out, s);
            part = false;
        }
        put_picture(out, s, &s->points[n]);
    }
    fputs("</div>\n", out);
}

void cli_put_quality(FILE *out, const cli_study *s)
{
    fputs("<h2>Shapes of triangles</h2>\n<p>Small angles and large aspect ratios harm "
          "simulations and shading.</p>\n<div class=\"hists\">\n",
          out);
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (!p->done || !p->shown)
            continue;
        fputs("<figure><figcaption><strong>", out);
        cli_put_html(out, p->name);
        fprintf(out, "</strong>, angles from %.3g\xc2\xb0</figcaption>",
                p->shapes.min_angle_deg);
        cli_put_shapes(out, &p->shapes);
        fputs("</figure>\n", out);
    }
    fputs("</div>\n", out);
}

static void put_verdict(FILE *out, const cw_verdict *v)
{
    fputs("<tr><td>", out);
    cli_put_html(out, cw_grade_name(v->grade));
    fputs("</td><td class=\"w\">", out);
    cli_put_html(out, v->name);
    fputs("</td><td class=\"w\">", out);
    cli_put_html(out, v->text);
    if (v->advice && v->grade < CW_GRADE_OK) {
        fputs("<br/>\xe2\x86\x92 ", out);
        cli_put_html(out, cli_name_options(v->advice, (char[CLI_MESSAGE]){0}));
    }
    fputs("</td></tr>", out);
}

void cli_put_verdicts(FILE *out, const cw_verdict *verdicts, size_t count)
{
    fputs("<div class=\"wide\"><table><thead><tr><th>grade</th><th class=\"w\">of</th>"
          "<th class=\"w\">measured</th></tr></thead><tbody>",
          out);
    for (size_t n = 0; n < count; n++)
        put_verdict(out, &verdicts[n]);
    fputs("</tbody></table></div>\n", out);
}

void cli_put_print(FILE *out, const cli_study *s)
{
    const cli_print_study *p = &s->print;
    fputs("<section id=\"print\">\n<h2>As a print</h2>\n", out);
    if (*p->why) {
        fputs("<p class=\"quiet\">Left out: ", out);
        cli_put_html(out, p->why);
        fputs(".</p>\n</section>\n", out);
        return;
    }
    fputs("<p>The plain surface as <code>check --profile print</code> sees it, which takes the "
          "limits of a printer as well.</p>\n",
          out);
    cli_put_verdicts(out, p->seen.verdicts, p->seen.count);
    fputs("</section>\n", out);
}
