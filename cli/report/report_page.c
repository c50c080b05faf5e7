/* The page: one file of HTML that needs no other, and is well-formed XML as well. */
#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "cli/report/study.h"

#include "core/base/text.h"

#include <math.h>
#include <string.h>

/* Bytes that are no text, and control characters, would be taken for something else. */
void cli_put_html(FILE *out, const char *text)
{
    while (*text) {
        const size_t n = cwi_utf8_length(text);
        const unsigned char byte = (unsigned char)*text;
        if (n == 0 || byte == 0x7f || (byte < 0x20 && byte != '\n'))
            fputs("\xef\xbf\xbd", out);
        else if (byte == '<' || byte == '>' || byte == '&' || byte == '"' || byte == '\'')
            fprintf(out, "&#%d;", byte);
        else
            fwrite(text, 1, n, out);
        text += n ? n : 1;
    }
}

static void put_base64(FILE *out, const char *bytes, size_t size)
{
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t n = 0; n < size; n += 3) {
        const size_t left = size - n;
        const unsigned a = (unsigned char)bytes[n],
                       b = left > 1 ? (unsigned char)bytes[n + 1] : 0,
                       c = left > 2 ? (unsigned char)bytes[n + 2] : 0;
        const unsigned word = a << 16 | b << 8 | c;
        fputc(digits[word >> 18], out);
        fputc(digits[word >> 12 & 63], out);
        fputc(left > 1 ? digits[word >> 6 & 63] : '=', out);
        fputc(left > 2 ? digits[word & 63] : '=', out);
    }
}

static void put_fact(FILE *out, const char *name, const char *value)
{
    fputs("<div><dt>", out);
    cli_put_html(out, name);
    fputs("</dt><dd>", out);
    cli_put_html(out, value);
    fputs("</dd></div>", out);
}

static const char *seconds_text(double seconds)
{
    static char text[4][32];
    static int turn;
    char *t = text[turn++ % 4];
    if (seconds < 1)
        snprintf(t, sizeof text[0], "%.3g ms", 1e3 * seconds);
    else
        snprintf(t, sizeof text[0], "%.3g s", seconds);
    return t;
}

static void put_facts(FILE *out, const cli_study *s)
{
    char text[128];
    const cw_volume *v = &s->volume->view;
    fputs("<dl class=\"facts\">", out);
    snprintf(text, sizeof text, "%zu \xc3\x97 %zu \xc3\x97 %zu %s", v->dim[0], v->dim[1],
             v->dim[2], cw_type_name(v->type));
    put_fact(out, s->coarsen > 1 ? "voxels studied" : "voxels", text);
    snprintf(text, sizeof text, "%.4g \xc3\x97 %.4g \xc3\x97 %.4g mm", s->volume->spacing[0],
             s->volume->spacing[1], s->volume->spacing[2]);
    put_fact(out, "spacing", text);
    snprintf(text, sizeof text, "%s (%s)", cli_number_text(s->iso), s->level);
    put_fact(out, "level", text);
    snprintf(text, sizeof text, "%s triangles", cli_count(s->full.triangle_count));
    put_fact(out, "plain surface", text);
    snprintf(text, sizeof text, "%.3g s of %.3g s", s->seconds, s->budget_s);
    put_fact(out, "time spent", text);
    snprintf(text, sizeof text, "cubewright %s", cw_version());
    put_fact(out, "made by", text);
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
            "; %zu were left out, each with its reason. In every plot left is cheaper and down "
            "is closer to the truth. Full dots, on the dashed line, are worth choosing: no "
            "other point is both cheaper and closer. They form the Pareto front. Each row has "
            "its command, to copy.</p>\n",
            count_points(s, false));
    if (s->coarsen > 1)
        fprintf(out,
                "<p>The volume is large: for meshes only every %zu%s voxel along each axis is "
                "looked at, which is the truth that they are measured against.</p>\n",
                s->coarsen,
                s->coarsen == 2   ? "nd"
                : s->coarsen == 3 ? "rd"
                                  : "th");
    if (s->make_words) {
        fputs("<p>The file that commands read is made by <code data-copy=\"\">", out);
        cli_put_html(out, s->make_words);
        fputs("</code></p>\n", out);
    }
    put_facts(out, s);
}

static void put_gap_text(FILE *out, const cli_study *s, const cli_point *p)
{
    const double rms = cli_point_error(s, p);
    fprintf(out, "%s triangles, %s", cli_count(p->triangles), cli_bytes((double)p->file_bytes));
    if (isfinite(rms))
        fprintf(out, ", RMS error %.3g mm (%.3g voxels)", rms, rms / s->voxel_mm);
}

static void put_ramp(FILE *out, const cli_study *s)
{
    enum { STOPS = 13 };
    fputs("<div class=\"ramp\"><span>0.001 voxels</span><i style=\"background:"
          "linear-gradient(90deg",
          out);
    for (int n = 0; n < STOPS; n++) {
        uint8_t c[3];
        cli_error_color((double)n / (STOPS - 1), c);
        fprintf(out, ",rgb(%d,%d,%d)", c[0], c[1], c[2]);
    }
    fprintf(out, ")\"></i><span>1 voxel, %.3g mm, by the logarithm</span></div>\n",
            s->voxel_mm);
}

static void put_picture(FILE *out, const cli_study *s, const cli_point *p)
{
    fputs("<figure><img alt=\"the mesh in the colours of its error\" "
          "src=\"data:image/png;base64,",
          out);
    put_base64(out, p->png, p->png_size);
    fputs("\"/><figcaption><strong>", out);
    cli_put_html(out, p->name);
    fprintf(out, "</strong>%s",
            *s->part_words && p->family != CLI_EXTRACTION ? "of a box: " : "");
    put_gap_text(out, s, p);
    fputs("</figcaption></figure>\n", out);
}

static void put_pictures(FILE *out, const cli_study *s)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++)
        count += s->points[n].png != NULL;
    if (!count)
        return;
    fputs("<h2>Where the error is</h2>\n<p>In the colour of the distance from the field's "
          "surface, as linear interpolation between voxels has it: the largest around each "
          "vertex; "
          "of large meshes the middles of triangles are looked at.</p>\n",
          out);
    put_ramp(out, s);
    fputs("<div class=\"pictures\">\n", out);
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].png)
            put_picture(out, s, &s->points[n]);
    fputs("</div>\n", out);
}

static void put_pick(FILE *out, const cli_study *s, const char *what, const cli_point *p)
{
    const cli_axis axis = cli_study_axis(s, p->family);
    fprintf(out, "<li>%s: <strong>", what);
    cli_put_html(out, p->name);
    if (p->family == CLI_COMPRESSION)
        fprintf(out, "</strong>, %s", cli_bytes(cli_point_cost(p)));
    else if (p->family == CLI_SIMPLIFICATION)
        fprintf(out, "</strong>, %s triangles", cli_count(p->triangles));
    else
        fprintf(out, "</strong>, %s", seconds_text(p->seconds));
    fprintf(out, ", error %.3g %s</li>", cli_point_error(s, p), axis.error_unit);
}

/* How far along a point is between the ends of the front, by the logarithm. */
static double position_along(double value, double low, double high)
{
    return high > low && low > 0 ? log(value / low) / log(high / low) : 0;
}

/* The cheapest and the closest, and that of the front which has most of both. */
static void put_picks(FILE *out, const cli_study *s, cli_family family)
{
    const cli_point *cheap = NULL, *close = NULL, *middle = NULL;
    double least = INFINITY;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family != family || !p->front)
            continue;
        if (!cheap || cli_point_cost(p) < cli_point_cost(cheap))
            cheap = p;
        if (!close || cli_point_error(s, p) < cli_point_error(s, close))
            close = p;
    }
    for (size_t n = 0; n < s->point_count && cheap; n++) {
        const cli_point *p = &s->points[n];
        const double cost = position_along(cli_point_cost(p), cli_point_cost(cheap),
                                           cli_point_cost(close)),
                     error = position_along(cli_point_error(s, p), cli_point_error(s, close),
                                            cli_point_error(s, cheap));
        if (p->family != family || !p->front || p == cheap || p == close ||
            cost + error >= least)
            continue;
        least = cost + error;
        middle = p;
    }
    if (!cheap)
        return;
    fputs("<ul class=\"picks\">", out);
    put_pick(out, s, cheap == close ? "cheapest and closest" : "cheapest", cheap);
    if (middle)
        put_pick(out, s, "between them", middle);
    if (close != cheap)
        put_pick(out, s, "closest", close);
    fputs("</ul>\n", out);
}

static void put_key(FILE *out, const cli_study *s, cli_family family)
{
    const char *groups[8];
    const size_t count = cli_family_groups(s, family, groups, 8);
    fputs("<div class=\"key\">", out);
    for (size_t n = 0; n < count; n++) {
        fprintf(out, "<span class=\"g%zu\"><i></i>", n);
        cli_put_html(out, groups[n]);
        fputs("</span>", out);
    }
    fputs("<span><em></em>Pareto front</span></div>\n", out);
}

static void put_cell(FILE *out, bool known, double value)
{
    char text[32];
    snprintf(text, sizeof text, value >= 1000 ? "%.0f" : "%.3g", value);
    fprintf(out, "<td>%s</td>", known ? text : "\xe2\x80\x93");
}

static void put_mesh_cells(FILE *out, const cli_study *s, const cli_point *p)
{
    fprintf(out, "<td>%s</td>", seconds_text(p->seconds));
    fprintf(out, "<td>%s</td>",
            p->peak_bytes ? cli_bytes((double)p->peak_bytes) : "\xe2\x80\x93");
    fprintf(out, "<td>%s</td><td>%s</td>", cli_count(p->triangles),
            cli_bytes((double)p->file_bytes));
    if (s->is_field) {
        put_cell(out, p->truth.known, p->truth.rms_mm);
        put_cell(out, p->truth.known, p->truth.max_mm);
    }
    put_cell(out, p->to_field.known, p->to_field.rms_mm);
    put_cell(out, p->to_field.known, p->to_field.p99_mm);
    put_cell(out, p->to_field.known, p->to_field.max_mm);
    put_cell(out, p->back.known, p->back.rms_mm);
    put_cell(out, p->back.known, p->back.max_mm);
}

static void put_picture_cells(FILE *out, const cli_point *p)
{
    put_cell(out, true, 1e3 * p->seconds);
    put_cell(out, true, p->picture.rmse);
    put_cell(out, true, p->picture.max);
    put_cell(out, true, p->picture.delta_e_mean);
    put_cell(out, true, p->picture.delta_e_p99);
}

static int put_head(FILE *out, const cli_study *s, cli_family family)
{
    fputs("<thead><tr><th>#</th><th class=\"w\">setting</th>", out);
    if (family == CLI_RENDERING) {
        fputs("<th>ms</th><th>RMSE<br/>of 255</th><th>max<br/>of 255</th><th>\xce\x94"
              "E<br/>mean</th><th>\xce\x94"
              "E<br/>99 %</th></tr></thead>\n",
              out);
        return 7;
    }
    fprintf(out, "<th>time</th><th>memory</th><th>triangles</th><th>%s</th>", s->suffix);
    if (s->is_field)
        fputs("<th>true<br/>RMS</th><th>true<br/>max</th>", out);
    fputs("<th>field<br/>RMS</th><th>field<br/>99 %</th><th>field<br/>max</th>"
          "<th>back<br/>RMS</th><th>back<br/>max</th></tr></thead>\n",
          out);
    return s->is_field ? 13 : 11;
}

static void put_row(FILE *out, const cli_study *s, const cli_point *p, int columns)
{
    fprintf(out, "<tbody%s><tr><td>%zu</td><td class=\"w\">", p->front ? " class=\"best\"" : "",
            cli_point_number(s, p));
    cli_put_html(out, p->name);
    fprintf(out, "%s%s</td>", p->front ? " \xe2\x97\x8f" : "", p->aside ? " *" : "");
    if (p->family == CLI_RENDERING)
        put_picture_cells(out, p);
    else
        put_mesh_cells(out, s, p);
    fprintf(out, "</tr><tr><td></td><td class=\"c\" colspan=\"%d\"><code data-copy=\"\">",
            columns - 1);
    cli_put_html(out, p->command);
    fputs("</code></td></tr></tbody>\n", out);
}

static void put_table(FILE *out, const cli_study *s, cli_family family)
{
    fputs("<div class=\"wide\"><table>", out);
    const int columns = put_head(out, s, family);
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].family == family && s->points[n].done && ++count)
            put_row(out, s, &s->points[n], columns);
    if (!count)
        fprintf(out,
                "<tbody><tr><td></td><td class=\"w\" colspan=\"%d\">nothing</td></tr></tbody>",
                columns - 1);
    fputs("</table></div>\n", out);
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].family == family && s->points[n].done && s->points[n].aside)
            fprintf(out, "<p class=\"quiet\">* %s: %s.</p>\n", s->points[n].name,
                    s->points[n].aside);
}

static void put_left_out(FILE *out, const cli_study *s, cli_family family)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family != family || p->done)
            continue;
        fputs(count++ ? "<li>" : "<h3>Left out</h3>\n<ul class=\"quiet\"><li>", out);
        cli_put_html(out, p->name);
        fputs(": ", out);
        cli_put_html(out, p->why);
        fputs("</li>", out);
    }
    if (count)
        fputs("</ul>\n", out);
}

static void put_about(FILE *out, const cli_study *s, cli_family family)
{
    static const char *const about[CLI_FAMILY_COUNT] = {
        "From voxels to triangles. Memory is what the work took beside the voxels. The "
        "distance to the field is measured from points all over the mesh to the isosurface of "
        "the field. Back is measured from the vertices of the plain surface (linear, all "
        "voxels) to the mesh; it shows what a mesh has lost. Distances to the field beyond 4 "
        "voxels count as 4.",
        "Fewer triangles, made while extracting; the time includes both. An error limit holds "
        "both ways, to the plain surface. The plot shows the distance that remains between the "
        "mesh and the field.",
        "The plain surface is written to a file, read back and measured. The error is the "
        "distance to the plain surface (back); exact results are drawn at the bottom. The "
        "distance to the field, in the table, shows how many bits are enough. The time is that "
        "of writing, with the verification by decoding.",
        "Pictures of the volume, unlit, from the front, compared with the rendering integral "
        "itself. The time is that of a picture after the first: the median of three, or of one "
        "if it is slow."};
    fprintf(out, "<p>%s", about[family]);
    if (*s->part_words && (family == CLI_SIMPLIFICATION || family == CLI_COMPRESSION))
        fprintf(out,
                " To save time, a box of the volume is used, whose surface has %s of all %s "
                "triangles. For the whole volume, time and bytes are about %.2g times as "
                "large, and errors are about the same.",
                cli_count(cli_part_mesh(s)->triangle_count), cli_count(s->full.triangle_count),
                (double)s->full.triangle_count / (double)cli_part_mesh(s)->triangle_count);
    if (family == CLI_EXTRACTION)
        fprintf(out,
                " Surfaces larger than %s faces of voxels are measured at a sample of about "
                "that many triangles, here and below. The sample is random but always the "
                "same. RMS and 99 %% are accurate to about a percent; maxima may be missed.",
                cli_count(CLI_STUDY_SAMPLE));
    if (family == CLI_RENDERING) {
        fprintf(out, " They are %d \xc3\x97 %d pixels", CLI_STUDY_WIDTH, CLI_STUDY_HEIGHT);
        if (*s->backend) {
            fputs(", by ", out);
            cli_put_html(out, s->backend);
        }
        if (s->reference_seconds > 0)
            fprintf(out, "; the integral itself took %s", seconds_text(s->reference_seconds));
        fputs(".", out);
    } else if (s->is_field && family != CLI_COMPRESSION) {
        fputs(" The error in the plot is the distance to the exact surface, along the field's "
              "gradient. The distance to the field is that to the field between the samples.",
              out);
    }
    fputs("</p>\n", out);
}

static void put_family(FILE *out, const cli_study *s, cli_family family)
{
    static const char *const titles[CLI_FAMILY_COUNT] = {"Extraction", "Simplification",
                                                         "Compression", "Rendering"};
    fprintf(out, "<section id=\"%s\">\n<h2>%s</h2>\n", cli_family_names[family],
            titles[family]);
    put_about(out, s, family);
    put_picks(out, s, family);
    cli_put_plot(out, s, family);
    put_key(out, s, family);
    put_table(out, s, family);
    put_left_out(out, s, family);
    fputs("</section>\n", out);
}

static void put_quality(FILE *out, const cli_study *s)
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

static void put_print(FILE *out, const cli_study *s)
{
    const cli_print_study *p = &s->print;
    fputs("<section id=\"print\">\n<h2>As a print</h2>\n", out);
    if (*p->why) {
        fputs("<p class=\"quiet\">Left out: ", out);
        cli_put_html(out, p->why);
        fputs(".</p>\n</section>\n", out);
        return;
    }
    fputs(
        "<p>The plain surface as <code>check --profile print</code> sees it, which takes the "
        "limits of a printer as well.</p>\n<div class=\"wide\"><table><thead><tr><th>grade</th>"
        "<th class=\"w\">of</th><th class=\"w\">measured</th></tr></thead><tbody>",
        out);
    for (size_t n = 0; n < p->seen.count; n++)
        put_verdict(out, &p->seen.verdicts[n]);
    fputs("</tbody></table></div>\n</section>\n", out);
}

void cli_put_page(FILE *out, const void *study)
{
    const cli_study *s = study;
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
          "data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\"/><title>",
          out);
    cli_put_html(out, s->title);
    fputs("</title>\n<style>\n", out);
    for (const char *const *piece = cli_page_style; *piece; piece++)
        fputs(*piece, out);
    fputs("</style></head>\n<body><main>\n", out);
    put_intro(out, s);
    put_pictures(out, s);
    for (int f = 0; f < CLI_FAMILY_COUNT; f++)
        put_family(out, s, (cli_family)f);
    put_quality(out, s);
    put_print(out, s);
    fprintf(out, "</main>\n<script>\n%s</script></body></html>\n", cli_page_script);
}
