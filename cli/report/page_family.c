/* A family of points on the page: what it is about, its picks, plots, pictures and table. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

#include <math.h>
#include <string.h>

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
        fprintf(out, "</strong>, %s", cli_seconds_text(p->seconds));
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
    double min = INFINITY;
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
        if (p->family != family || !p->front || p == cheap || p == close || cost + error >= min)
            continue;
        min = cost + error;
        middle = p;
    }
    if (!cheap || family == CLI_PROJECTIONS) /* these are not compared with each other */
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

/* A number: as it is read, and whole for sorting. */
static void put_cell(FILE *out, bool known, double value)
{
    if (known && isfinite(value))
        fprintf(out,
                value >= 1000 ? "<td data-v=\"%.9g\">%.0f</td>"
                              : "<td data-v=\"%.9g\">%.3g</td>",
                value, value);
    else
        fputs("<td data-v=\"nan\">\xe2\x80\x93</td>", out);
}

static void put_text_cell(FILE *out, double value, const char *text, const char *note)
{
    fprintf(out, "<td data-v=\"%.9g\">%s", value, text);
    if (note)
        fprintf(out, "<br/><small>%s</small>", note);
    fputs("</td>", out);
}

static void put_mesh_cells(FILE *out, const cli_study *s, const cli_point *p)
{
    put_text_cell(out, p->seconds, cli_seconds_text(p->seconds), cli_runs_text(p));
    put_text_cell(out, p->peak_bytes ? (double)p->peak_bytes : NAN,
                  p->peak_bytes ? cli_bytes((double)p->peak_bytes) : "\xe2\x80\x93", NULL);
    put_text_cell(out, (double)p->triangles, cli_count(p->triangles), NULL);
    put_text_cell(out, (double)p->file_bytes, cli_bytes((double)p->file_bytes), NULL);
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
    put_text_cell(out, p->seconds, cli_seconds_text(p->seconds), cli_runs_text(p));
    put_cell(out, true, p->picture.rmse);
    put_cell(out, true, p->picture.max);
    put_cell(out, true, p->picture.delta_e_mean);
    put_cell(out, true, p->picture.delta_e_p99);
}

static int put_head(FILE *out, const cli_study *s, cli_family family)
{
    fputs(
        "<thead><tr><th aria-sort=\"ascending\">#</th><th class=\"w\">setting</th><th>time</th>",
        out);
    if (cli_is_drawn(family)) {
        fputs("<th>RMSE<br/>of 255</th><th>max<br/>of 255</th><th>\xce\x94"
              "E<br/>mean</th><th>\xce\x94"
              "E<br/>99 %</th></tr></thead>\n",
              out);
        return 7;
    }
    fprintf(out, "<th>memory</th><th>triangles</th><th>%s</th>", s->suffix);
    if (s->is_field)
        fputs("<th>true<br/>RMS, mm</th><th>true<br/>max</th>", out);
    fputs("<th>field<br/>RMS, mm</th><th>field<br/>99 %</th><th>field<br/>max</th>"
          "<th>back<br/>RMS, mm</th><th>back<br/>max</th></tr></thead>\n",
          out);
    return s->is_field ? 13 : 11;
}

static void put_row(FILE *out, const cli_study *s, const cli_point *p, int columns)
{
    fprintf(out,
            "<tbody data-point=\"%s-%zu\"%s><tr><td data-v=\"%zu\">%zu</td><td class=\"w\">",
            cli_family_names[p->family], p->number, p->front ? " class=\"best\"" : "",
            p->number, p->number);
    cli_put_html(out, p->name);
    fprintf(out, "%s%s</td>", p->front ? " \xe2\x97\x8f" : "", p->aside ? " *" : "");
    if (cli_is_drawn(p->family))
        put_picture_cells(out, p);
    else
        put_mesh_cells(out, s, p);
    fprintf(out, "</tr><tr><td></td><td class=\"c\" colspan=\"%d\">", columns - 1);
    cli_put_code(out, p->command);
    fputs("</td></tr></tbody>\n", out);
}

static void put_table(FILE *out, const cli_study *s, cli_family family)
{
    const cli_point *points[CLI_MAX_POINTS];
    const size_t count = cli_points_of(s, family, points);
    fputs("<div class=\"wide\"><table class=\"sorts\">", out);
    const int columns = put_head(out, s, family);
    for (size_t n = 0; n < count; n++)
        put_row(out, s, points[n], columns);
    if (!count)
        fprintf(out,
                "<tbody><tr><td></td><td class=\"w\" colspan=\"%d\">nothing</td></tr></tbody>",
                columns - 1);
    fputs("</table></div>\n", out);
    for (size_t n = 0; n < count; n++)
        if (points[n]->aside)
            fprintf(out, "<p class=\"quiet\">* %s: %s.</p>\n", points[n]->name,
                    points[n]->aside);
}

static const char *const reference_names[CLI_REFERENCES] = {
    "the rendering integral", "the lit integral",  "the exact mip",
    "the exact minip",        "the exact average", "the exact local-mip"};

static void put_reference(FILE *out, const cli_study *s, size_t number)
{
    const cli_reference *r = &s->references[number];
    char alt[128];
    if (!r->drawn.bytes)
        return;
    snprintf(alt, sizeof alt, "The object in %s, which others are compared with",
             reference_names[number]);
    fputs("<figure>", out);
    cli_put_image(out, &r->drawn, alt);
    fprintf(out,
            "<figcaption><strong>%s</strong>the reference; it took %s</figcaption></figure>\n",
            reference_names[number], cli_seconds_text(r->seconds));
}

/* The picture on the left, its difference on the right. */
static void put_pair(FILE *out, const cli_point *p)
{
    char alt[160];
    fprintf(out, "<figure class=\"pair\" data-point=\"%s-%zu\">", cli_family_names[p->family],
            p->number);
    snprintf(alt, sizeof alt, "The object as %s draws it", p->name);
    cli_put_image(out, &p->drawn, alt);
    snprintf(alt, sizeof alt, "Its difference from %s, times %d",
             reference_names[p->tried.reference], CLI_STUDY_AMPLIFY);
    cli_put_image(out, &p->difference, alt);
    fprintf(out, "<figcaption><strong>%zu. ", p->number);
    cli_put_html(out, p->name);
    fprintf(out,
            "</strong>%s, RMSE %.3g of 255; right: difference from %s \xc3\x97 %d</figcaption>"
            "</figure>\n",
            cli_seconds_text(p->seconds), p->picture.rmse, reference_names[p->tried.reference],
            CLI_STUDY_AMPLIFY);
}

static void put_drawn(FILE *out, const cli_study *s, cli_family family)
{
    const cli_point *points[CLI_MAX_POINTS];
    const size_t count = cli_points_of(s, family, points);
    if (!count || !cli_is_drawn(family))
        return;
    fputs("<div class=\"pairs\">\n", out);
    for (size_t r = 0; r < CLI_REFERENCES; r++) {
        size_t used = 0;
        for (size_t n = 0; n < count; n++) {
            if (points[n]->tried.reference != r || !points[n]->drawn.bytes)
                continue;
            if (used++ == 0)
                put_reference(out, s, r);
            put_pair(out, points[n]);
        }
    }
    fputs("</div>\n", out);
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
        "itself. The time is that of a picture after the first, or of the first if that takes "
        "seconds.",
        "Pictures of the same, lit by a light at the eye, as render draws them by default, "
        "compared with the integral of the lit volume. Gradients are part of the error.",
        "Projections of intensities, each compared with its own exact picture, which has the "
        "extremes or means of the field itself along each ray. Times and errors of different "
        "projections are not compared with each other."};
    char larger[96];
    snprintf(larger, sizeof larger,
             "errors are about %.2g times as large with as many bits, which divide the longest "
             "side",
             cli_part_ratio(s));
    fprintf(out, "<p>%s", about[family]);
    if (*s->part_words && (family == CLI_SIMPLIFICATION || family == CLI_COMPRESSION))
        fprintf(out,
                " To save time, a box of the volume is used, whose surface has %s of all %s "
                "triangles (%s). For the whole volume, time and bytes are about %.2g times as "
                "large; %s. The commands are for the whole volume.",
                cli_count(cli_part_mesh(s)->triangle_count), cli_count(s->full.triangle_count),
                s->part_words + strspn(s->part_words, " -"),
                (double)s->full.triangle_count / (double)cli_part_mesh(s)->triangle_count,
                family == CLI_COMPRESSION ? larger : "errors are about the same");
    if (family == CLI_EXTRACTION)
        fprintf(out,
                " Surfaces larger than %s faces of voxels are measured at a sample of about "
                "that many triangles, here and below. The sample is random but always the "
                "same. RMS and 99 %% are accurate to about a percent; maxima may be missed.",
                cli_count(CLI_STUDY_SAMPLE));
    if (cli_is_drawn(family)) {
        fprintf(out, " They are %d \xc3\x97 %d pixels", CLI_STUDY_WIDTH, CLI_STUDY_HEIGHT);
        if (*s->backend) {
            fputs(", by ", out);
            cli_put_html(out, s->backend);
        }
        fprintf(
            out,
            ". Under each is the setting, beside it the difference from the reference, times "
            "%d. Both are shown at half the size: a pixel is the mean of four, of differences "
            "the largest.",
            CLI_STUDY_AMPLIFY);
    } else if (s->is_field && family != CLI_COMPRESSION) {
        fputs(" The error in the plot is the distance to the exact surface, along the field's "
              "gradient. The distance to the field is that to the field between the samples.",
              out);
    }
    fputs("</p>\n", out);
}

void cli_put_family(FILE *out, const cli_study *s, cli_family family)
{
    static const char *const titles[CLI_FAMILY_COUNT] = {
        "Extraction", "Simplification",       "Compression",
        "Rendering",  "Rendering with light", "Projections"};
    fprintf(out, "<section id=\"%s\">\n<h2>%s</h2>\n", cli_family_names[family],
            titles[family]);
    put_about(out, s, family);
    put_picks(out, s, family);
    cli_put_plots(out, s, family);
    put_key(out, s, family);
    put_drawn(out, s, family);
    put_table(out, s, family);
    put_left_out(out, s, family);
    fputs("</section>\n", out);
}
