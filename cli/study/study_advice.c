/* Advice for print, the web, analysis and pictures: settings chosen by the measurements, with
 * the numbers that were the reason. */
#include "cli/framework/quantity.h"
#include "cli/study/point_command.h"
#include "cli/study/study.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* Printers resolve about this; a scan resolves no more than a fraction of its voxels. */
static const double PRINT_MM = 0.1, PRINT_VOXELS = 0.25;

/* As near as the plain surface, or nearly so. */
static const double BESIDE_PLAIN = 1.2;

/* A distance that is not seen on a screen at usual sizes. */
static const double WEB_VOXELS = 0.5;

/* Of that, compression may take this much at most. */
static const double COMPRESSED_VOXELS = 0.1;

/* A difference of pictures that nobody sees. */
static const double UNSEEN_RMSE = 2;

/* Whether a point is a mesh of all voxels that can be compared with others. */
static bool is_candidate(const cli_study *s, const cli_point *p)
{
    return (p->family == CLI_EXTRACTION || p->family == CLI_SIMPLIFICATION) && p->done &&
           !p->aside && cli_main_gap(s, p);
}

/* Triangles that a setting has on the whole object: those of a part are scaled. */
static double count_whole(const cli_study *s, const cli_point *p)
{
    const double part = (double)cli_part_mesh(s)->triangle_count;
    return p->family == CLI_SIMPLIFICATION && part > 0
               ? (double)p->triangles * (double)s->full.triangle_count / part
               : (double)p->triangles;
}

/* Finds the row with the fewest triangles whose 99 % distance is within a limit; else NULL. */
static const cli_point *find_lightest(const cli_study *s, double limit_mm)
{
    const cli_point *best = NULL;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (is_candidate(s, p) && cli_main_gap(s, p)->p99_mm <= limit_mm &&
            (!best || count_whole(s, p) < count_whole(s, best)))
            best = p;
    }
    return best;
}

/* Without simplification: differences of less than a percent may be those of samples. */
static const cli_point *find_closest(const cli_study *s)
{
    const cli_point *best = NULL;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family == CLI_EXTRACTION && is_candidate(s, p) &&
            (!best || cli_point_error(s, p) < cli_point_error(s, best)))
            best = p;
    }
    return best;
}

/* The bytes of what is compressed; 0: not measured. */
static size_t find_plain_bytes(const cli_study *s)
{
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].family == CLI_COMPRESSION && s->points[n].done &&
            !s->points[n].tried.compression)
            return s->points[n].file_bytes;
    return 0;
}

/* The smallest file whose vertices are where they were, nearly. */
static const cli_point *find_compression(const cli_study *s)
{
    const cli_point *best = NULL;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family == CLI_COMPRESSION && p->done && p->tried.compression && p->back.known &&
            cli_part_ratio(s) * p->back.max_mm <= COMPRESSED_VOXELS * s->voxel_mm &&
            (!best || p->file_bytes < best->file_bytes))
            best = p;
    }
    return best;
}

/* The fastest of the lit pictures whose error is not seen, else the closest. */
static const cli_point *find_picture(const cli_study *s)
{
    const cli_point *best = NULL;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family != CLI_SHADING || !p->done || !p->picture.pixels)
            continue;
        const bool unseen = p->picture.rmse <= UNSEEN_RMSE,
                   best_unseen = best && best->picture.rmse <= UNSEEN_RMSE;
        if (!best || (unseen && (!best_unseen || p->seconds < best->seconds)) ||
            (!best_unseen && p->picture.rmse < best->picture.rmse))
            best = p;
    }
    return best;
}

static void add_text(cli_advice *a, const char *format, ...) CW_PRINTF(2, 3);
static void add_text(cli_advice *a, const char *format, ...)
{
    const size_t end = strlen(a->why);
    va_list args;
    va_start(args, format);
    vsnprintf(a->why + end, sizeof a->why - end, format, args);
    va_end(args);
}

static void tell_triangles(const cli_study *s, cli_advice *a)
{
    const double whole = count_whole(s, a->point);
    const bool scaled = *s->part_words && a->point->family == CLI_SIMPLIFICATION;
    if (a->point == &s->points[0])
        add_text(a, "all %s triangles", cli_count(s->full.triangle_count));
    else
        add_text(a, "%s%s triangles in place of %s", scaled ? "about " : "",
                 cli_count((size_t)(whole + 0.5)), cli_count(s->full.triangle_count));
    add_text(a, ", 99 %% of the surface within %.3g mm", cli_main_gap(s, a->point)->p99_mm);
}

static bool advise_print(const cli_study *s, cli_advice *a)
{
    const cli_gap *plain = cli_main_gap(s, &s->points[0]);
    const double limit = fmax(fmax(PRINT_MM, PRINT_VOXELS * s->voxel_mm),
                              plain ? BESIDE_PLAIN * plain->p99_mm : 0);
    size_t failed = 0;
    a->purpose = "For print";
    a->point = find_lightest(s, limit);
    if (!a->point)
        return false;
    tell_triangles(s, a);
    add_text(
        a,
        ". The limit is %.3g mm: what printers resolve, a quarter of a voxel, or a fifth more "
        "than the plain surface is off.",
        limit);
    for (size_t n = 0; n < s->print.seen.count; n++)
        failed += s->print.seen.verdicts[n].grade <= CW_GRADE_UNKNOWN;
    if (failed)
        add_text(a,
                 " As it is it cannot be printed: %zu checks of the plain surface fail, see "
                 "'As a print'.",
                 failed);
    else if (s->print.seen.count)
        add_text(a, " The plain surface passes the checks of a print.");
    a->command = cli_settings_command(s, &a->point->tried, "print.stl");
    return true;
}

static bool advise_web(const cli_study *s, cli_advice *a)
{
    const size_t plain = find_plain_bytes(s);
    const cli_point *small = plain ? find_compression(s) : NULL;
    a->purpose = "For the web";
    a->point = find_lightest(s, WEB_VOXELS * s->voxel_mm);
    if (!a->point || strcmp(s->suffix, ".glb") != 0)
        return false;
    cli_tried tried = a->point->tried;
    double bytes =
        (double)a->point->file_bytes / (double)a->point->triangles * count_whole(s, a->point);
    tell_triangles(s, a);
    add_text(a, ", half a voxel at most");
    if (small) {
        tried.compression = small->tried.compression;
        tried.bits = small->tried.bits;
        bytes *= (double)small->file_bytes / (double)plain;
        add_text(a, "; %s moves vertices by %.2g mm at most", small->name,
                 cli_part_ratio(s) * small->back.max_mm);
    }
    add_text(a, ". The file has about %s.", cli_bytes(bytes));
    a->command = cli_settings_command(s, &tried, "web.glb");
    return true;
}

static bool advise_analysis(const cli_study *s, cli_advice *a)
{
    a->purpose = "For analysis";
    a->point = find_closest(s);
    if (!a->point)
        return false;
    const cli_gap *gap = cli_main_gap(s, a->point);
    add_text(a,
             "the closest that extraction comes: RMS %.3g mm, %.3g mm at most%s, from %s. %s "
             "triangles.",
             gap->rms_mm, gap->max_mm, a->point->measured_one_of > 1 ? " in a sample" : "",
             gap == &a->point->truth      ? "the true surface"
             : gap == &a->point->to_field ? "the surface of the field"
                                          : "the plain surface",
             cli_count((size_t)(count_whole(s, a->point) + 0.5)));
    a->command = cli_settings_command(s, &a->point->tried, "analysis.ply");
    return true;
}

static bool advise_pictures(const cli_study *s, cli_advice *a)
{
    a->purpose = "For pictures";
    a->point = find_picture(s);
    if (!a->point)
        return false;
    const double rmse = a->point->picture.rmse;
    add_text(a, "%.3g s for a picture of %d x %d, RMSE %.3g of 255 from the lit integral%s.",
             a->point->seconds, CLI_STUDY_WIDTH, CLI_STUDY_HEIGHT, rmse,
             rmse <= UNSEEN_RMSE ? ": the fastest whose error is not seen"
                                 : ": the closest that was tried");
    a->command = cli_point_command(s, a->point);
    return true;
}

size_t cli_find_advice(const cli_study *s, cli_advice advice[CLI_MAX_ADVICE])
{
    static bool (*const kinds[CLI_MAX_ADVICE])(const cli_study *, cli_advice *) = {
        advise_print, advise_web, advise_analysis, advise_pictures};
    size_t count = 0;
    for (size_t n = 0; n < CLI_MAX_ADVICE; n++) {
        advice[count] = (cli_advice){0};
        if (kinds[n](s, &advice[count]))
            count++;
    }
    return count;
}

void cli_free_advice(cli_advice *advice, size_t count)
{
    for (size_t n = 0; n < count; n++)
        free(advice[n].command);
}
