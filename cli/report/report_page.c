/* The page: one file of HTML that needs no other, and is well-formed XML as well. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

#include <string.h>

static void put_facts(FILE *out, const cli_study *s)
{
    char text[128];
    const cw_volume *v = &s->volume->view;
    fputs("<dl class=\"facts\">", out);
    snprintf(text, sizeof text, "%zu \xc3\x97 %zu \xc3\x97 %zu %s", v->dim[0], v->dim[1],
             v->dim[2], cw_type_name(v->type));
    cli_put_fact(out, s->coarsen > 1 ? "voxels studied" : "voxels", text);
    snprintf(text, sizeof text, "%.4g \xc3\x97 %.4g \xc3\x97 %.4g mm", s->volume->spacing[0],
             s->volume->spacing[1], s->volume->spacing[2]);
    cli_put_fact(out, "spacing", text);
    snprintf(text, sizeof text, "%s (%s)", cli_number_text(s->iso), s->level);
    cli_put_fact(out, "level", text);
    snprintf(text, sizeof text, "%s triangles", cli_count(s->full.triangle_count));
    cli_put_fact(out, "plain surface", text);
    snprintf(text, sizeof text, "%.3g s of %.3g s", s->seconds, s->budget_s);
    cli_put_fact(out, "time spent", text);
    snprintf(text, sizeof text, "cubewright %s", cw_version());
    cli_put_fact(out, "made by", text);
    fputs("</dl>\n", out);
}

static size_t count_points(const cli_study *s, bool done)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++)
        count += s->points[n].done == done;
    return count;
}

static void put_intro(FILE *out, const cli_study *s)
{
    char left_out[64] = "none was left out";
    if (count_points(s, false))
        snprintf(left_out, sizeof left_out, "%zu were left out, each with its reason",
                 count_points(s, false));
    fputs("<h1>", out);
    cli_put_html(out, s->title);
    fputs("</h1>\n<p>Speed against error: ", out);
    fprintf(out, "%zu settings were tried on ", count_points(s, true));
    if (s->is_field) {
        fputs("a field whose surface is known exactly: ", out);
        cli_put_html(out, cw_field_about(s->field));
    } else {
        cli_put_html(out, cli_describe(s->volume));
    }
    fprintf(out,
            "; %s. In every plot left is cheaper and down "
            "is closer to the truth. Full dots, on the dashed line, are worth choosing: no "
            "other point is both cheaper and closer. They form the Pareto front. Each row has "
            "its command, to copy.</p>\n",
            left_out);
    if (s->coarsen > 1)
        fprintf(out,
                "<p>The volume is large: for meshes only every %zu%s voxel along each axis is "
                "looked at, which is the truth that they are measured against.</p>\n",
                s->coarsen,
                s->coarsen == 2   ? "nd"
                : s->coarsen == 3 ? "rd"
                                  : "th");
    if (s->make_words) {
        fputs("<p>The file that commands read is made by ", out);
        cli_put_code(out, s->make_words);
        fputs("</p>\n", out);
    }
    put_facts(out, s);
}

/* A script; XML would take some of its signs for its own. */
static void put_script(FILE *out, const char *text)
{
    fprintf(out, "<script>//<![CDATA[\n%s//]]></script>\n", text);
}

void cli_put_page_begin(FILE *out, const char *title)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
          "data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\"/><title>",
          out);
    cli_put_html(out, title);
    fprintf(out, "</title>\n<style>\n%s</style></head>\n<body><main>\n",
            cli_report_style_style);
}

void cli_put_page_end(FILE *out)
{
    fputs("</main>\n", out);
    put_script(out, cli_report_script_tables);
    put_script(out, cli_report_script_view3d);
    fputs("</body></html>\n", out);
}

void cli_put_page(FILE *out, const void *study)
{
    const cli_study *s = study;
    cli_put_page_begin(out, s->title);
    put_intro(out, s);
    cli_put_advice(out, s);
    cli_put_overview(out, s);
    cli_put_view(out, s);
    cli_put_pictures(out, s);
    for (int f = 0; f < CLI_FAMILY_COUNT; f++)
        cli_put_family(out, s, (cli_family)f);
    cli_put_quality(out, s);
    cli_put_print(out, s);
    cli_put_page_end(out);
}
