/* The page of a label map: a row, and for the largest a picture, of each label. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"
#include "cli/study/label_study.h"

#include <math.h>

static void put_intro(FILE *out, const cli_label_study *l)
{
    size_t open = 0;
    for (size_t n = 0; n < l->scene.shown.count; n++)
        open += !l->rows[n].closed;
    fputs("<h1>", out);
    cli_put_html(out, l->study.title);
    fputs("</h1>\n<p>A label map: ", out);
    cli_put_html(out, cli_describe(l->study.volume));
    fprintf(out,
            ". %s label%s in %s triangles, extracted together in %s: neighbours share their "
            "interface. ",
            cli_count(l->scene.shown.count), l->scene.shown.count == 1 ? "" : "s",
            cli_count(l->triangles), cli_seconds_text(l->extract_seconds));
    if (open)
        fprintf(out, "%zu of the surfaces are not closed manifolds.</p>\n", open);
    else
        fputs("All surfaces are closed manifolds.</p>\n", out);
}

static void put_swatch(FILE *out, const cw_label *label)
{
    fprintf(out, "<i class=\"swatch\" style=\"background:rgb(%d,%d,%d)\"></i>", label->color[0],
            label->color[1], label->color[2]);
}

/* Colours of all rows; the scale has as many places as a byte has values. */
static void put_colors(FILE *out, const cli_label_study *l)
{
    const size_t count = l->scene.shown.count;
    for (size_t n = 0; n < CLI_LABEL_COLORS; n++) {
        const uint8_t *c = l->scene.shown.labels[n < count ? n : count - 1].color;
        fprintf(out, "%s%d,%d,%d", n ? " " : "", c[0], c[1], c[2]);
    }
}

static void put_view(FILE *out, const cli_label_study *l)
{
    const cli_packed *p = &l->packed;
    char words[256];
    if (!p->bytes) {
        fprintf(out, "<p class=\"quiet\">There is no view of three dimensions: %s.</p>\n",
                p->why);
        return;
    }
    const size_t end = (size_t)snprintf(words, sizeof words, "All labels: %s triangles",
                                        cli_count(p->triangles));
    if (p->made_of && end < sizeof words)
        snprintf(words + end, sizeof words - end, ", simplified for this page from %s",
                 cli_count(p->made_of));
    cli_put_view_begin(out);
    put_colors(out, l);
    fputs("\">\n<div class=\"tools\"><label>Mesh <select class=\"mesh\"><option>all labels"
          "</option></select></label><label><input type=\"checkbox\" checked=\"\"/> Colours of "
          "labels</label><button type=\"button\">Reset</button></div>\n",
          out);
    cli_put_view_mesh(out, p, "all labels", words);
    cli_put_view_end(out, NULL);
}

static void put_row(FILE *out, const cli_label_row *r, size_t number)
{
    const double excess = r->voxels_mm3 > 0 ? 100 * (r->mesh_mm3 / r->voxels_mm3 - 1) : NAN;
    fprintf(out,
            "<tbody data-point=\"label-%zu\"><tr><td data-v=\"%u\">%u</td><td class=\"w\">",
            number, (unsigned)r->label->value, (unsigned)r->label->value);
    put_swatch(out, r->label);
    cli_put_html(out, r->label->name);
    fprintf(out, "</td><td data-v=\"%zu\">%s</td>", r->voxels, cli_count(r->voxels));
    fprintf(out, "<td data-v=\"%.9g\">%.4g</td>", r->voxels_mm3, r->voxels_mm3 / 1000);
    if (r->closed)
        fprintf(out, "<td data-v=\"%.9g\">%.4g</td><td data-v=\"%.9g\">%+.3f</td>", r->mesh_mm3,
                r->mesh_mm3 / 1000, excess, excess);
    else
        fputs("<td data-v=\"nan\">\xe2\x80\x93</td><td data-v=\"nan\">\xe2\x80\x93</td>", out);
    fprintf(out, "<td data-v=\"%.9g\">%.4g</td><td data-v=\"%zu\">%s</td>", r->area_mm2,
            r->area_mm2 / 100, r->triangles, cli_count(r->triangles));
    fprintf(out, "<td data-v=\"%zu\">%zu</td><td class=\"w\">%s</td></tr></tbody>\n",
            r->components, r->components, r->closed ? "yes" : "no");
}

static void put_rows(FILE *out, const cli_label_study *l)
{
    fputs(
        "<h2>Labels</h2>\n<p>The truth for a volume is that of a label's voxels: the surface is "
        "smoothed so that it encloses as much. The difference is what is left of that.</p>\n"
        "<div class=\"wide\"><table class=\"sorts\"><thead><tr><th aria-sort=\"ascending\">"
        "label</th><th class=\"w\">name</th><th>voxels</th><th>voxels,<br/>cm\xc2\xb3</th>"
        "<th>surface,<br/>cm\xc2\xb3</th><th>difference,<br/>%</th><th>area,<br/>cm\xc2\xb2"
        "</th><th>triangles</th><th>components</th><th class=\"w\">closed</th></tr></thead>\n",
        out);
    for (size_t n = 0; n < l->scene.shown.count; n++)
        put_row(out, &l->rows[n], n);
    fputs("</table></div>\n", out);
}

static void put_picture(FILE *out, const cli_label_row *r, size_t number)
{
    char alt[320];
    snprintf(alt, sizeof alt, "The surface of label %u, %s, from the front",
             (unsigned)r->label->value, r->label->name);
    fprintf(out, "<figure data-point=\"label-%zu\">", number);
    cli_put_image(out, &r->drawn, alt);
    fprintf(out, "<figcaption><strong>%u. ", (unsigned)r->label->value);
    cli_put_html(out, r->label->name);
    fprintf(out, "</strong>%.4g cm\xc2\xb3, %s triangles</figcaption></figure>\n",
            r->mesh_mm3 / 1000, cli_count(r->triangles));
}

static void put_all(FILE *out, const cli_label_study *l)
{
    fputs("<div class=\"pictures\">\n", out);
    if (l->all.bytes) {
        fputs("<figure>", out);
        cli_put_image(out, &l->all, "All labels, from the front");
        fputs("<figcaption><strong>All labels</strong>from the front</figcaption></figure>\n",
              out);
    }
    fputs("</div>\n", out);
}

static void put_each(FILE *out, const cli_label_study *l)
{
    fputs("<h2>Each label</h2>\n", out);
    if (l->scene.shown.count > CLI_LABEL_PICTURES)
        fprintf(out, "<p class=\"quiet\">The %d of %zu labels with the most voxels.</p>\n",
                CLI_LABEL_PICTURES, l->scene.shown.count);
    fputs("<div class=\"pictures\">\n", out);
    for (size_t n = 0; n < l->scene.shown.count; n++)
        if (l->rows[n].drawn.bytes)
            put_picture(out, &l->rows[n], n);
    fputs("</div>\n", out);
}

void cli_put_label_page(FILE *out, const void *study)
{
    const cli_label_study *l = study;
    cli_put_page_begin(out, l->study.title);
    put_intro(out, l);
    put_all(out, l);
    put_view(out, l);
    put_rows(out, l);
    put_each(out, l);
    cli_put_page_end(out);
}
