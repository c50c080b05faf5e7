/* Pictures of the object of a study: the object, a slice with its contour, the histogram. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

static void put_object(FILE *out, const cli_study *s)
{
    if (!s->overview.object.bytes)
        return;
    fputs("<figure>", out);
    cli_put_image(out, &s->overview.object,
                  s->is_of_mesh ? "The mesh, from the front"
                                : "The plain surface of the whole object, from the front");
    if (s->is_of_mesh)
        fputs("<figcaption><strong>The mesh</strong>as it is, from the front: ", out);
    else
        fprintf(
            out,
            "<figcaption><strong>The object</strong>the plain surface at the level %s, whole, "
            "from the front: ",
            cli_number_text(s->iso));
    fprintf(out, "%s triangles</figcaption></figure>\n", cli_count(s->full.triangle_count));
}

static void put_slice(FILE *out, const cli_study *s)
{
    if (!s->overview.slice.bytes)
        return;
    fputs("<figure>", out);
    cli_put_image(out, &s->overview.slice,
                  "A slice of the volume in grey, the contour of the surface in orange");
    fprintf(
        out,
        "<figcaption><strong>A slice</strong>%s, through the middle of the object; orange: the "
        "contour at %s</figcaption></figure>\n",
        s->overview.slice_words, cli_number_text(s->iso));
}

static void put_values(FILE *out, const cli_study *s)
{
    const cw_statistics *v = &s->overview.values;
    if (!v->bin_count || !v->finite)
        return;
    fputs("<figure>", out);
    cli_put_histogram(out, v, s->iso);
    fprintf(out,
            "<figcaption><strong>The values</strong>%s voxels, by the logarithm of their "
            "number; red: "
            "the level %s (%s)</figcaption></figure>\n",
            cli_count(v->finite), cli_number_text(s->iso), s->level);
}

void cli_put_overview(FILE *out, const cli_study *s)
{
    fprintf(out, "<h2 id=\"object\">%s</h2>\n",
            s->is_of_mesh ? "The mesh and its source" : "What is studied");
    fputs("<div class=\"pictures\">\n", out);
    put_object(out, s);
    put_slice(out, s);
    put_values(out, s);
    fputs("</div>\n", out);
    if (*s->overview.why) {
        fputs("<p class=\"quiet\">Left out: ", out);
        cli_put_html(out, s->overview.why);
        fputs(".</p>\n", out);
    }
}
