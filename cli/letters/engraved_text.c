/* Fills in and tells about text for solids. */
#include "cli/letters/engraved_text.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Strokes below this are finer than what most nozzles print. */
static const double NOZZLE_MM = 0.4;

/* A note follows where the surface leans more than this within the text. */
static const double CURVED_DEG = 10;

cw_status cli_fill_engraved_text(const char *text, const char *input, const char *name,
                                 const cw_label *label, char **out, cw_error *err)
{
    char *stem = cli_stem(input), *parent = cli_parent(input), number[24] = "";
    cli_part parts[] = {
        {.name = "stem", .value = stem},
        {.name = "parent", .value = parent},
        {.name = "name", .value = name ? name : stem},
        {.name = "label", .value = number, .number = true},
    };
    if (label)
        snprintf(number, sizeof number, "%u", label->value);
    *out = NULL;
    cw_status st = stem && parent ? cli_fill_template(text, parts, label ? 4 : 3, out, err)
                                  : cwi_fail_memory(err);
    free(stem);
    free(parent);
    return st;
}

/* Returns a number without the digits that rounding left: a thousandth of a unit is nothing. */
static double round_off(double x, double unit)
{
    return fabs(x) < 1e-3 * unit ? 0 : x;
}

void cli_tell_engraved(const char *path, const cw_engrave_facts *f)
{
    cli_say(
        "%s: letters %.3g mm high, %.3g mm deep, at %.4g, %.4g, %.4g, facing %.3g, %.3g, %.3g",
        path, f->size_mm, f->depth_mm, round_off(f->center[0], f->size_mm),
        round_off(f->center[1], f->size_mm), round_off(f->center[2], f->size_mm),
        round_off(f->normal[0], 1), round_off(f->normal[1], 1), round_off(f->normal[2], 1));
    if (f->lean_deg > CURVED_DEG)
        cli_say(
            "%s: the text follows the surface, which is up to %.3g mm off a plane and leans by up "
            "to %.0f degrees",
            path, f->deviation_mm, f->lean_deg);
    if (f->stroke_mm < NOZZLE_MM)
        cli_say("%s: strokes are %.2g mm wide; nozzles of %g mm need --size %.3gmm or more",
                path, f->stroke_mm, NOZZLE_MM,
                ceil(10 * NOZZLE_MM * f->size_mm / f->stroke_mm) / 10);
}

void cli_json_engraved(cli_json *j, const cw_engrave_facts *f)
{
    cli_json_numbers(j, "center", f->center, 3);
    cli_json_numbers(j, "normal", f->normal, 3);
    cli_json_numbers(j, "right", f->right, 3);
    cli_json_number(j, "size_mm", f->size_mm);
    cli_json_number(j, "stroke_mm", f->stroke_mm);
    cli_json_number(j, "depth_mm", f->depth_mm);
    cli_json_number(j, "wall_mm", f->wall_mm);
    cli_json_number(j, "width_mm", f->width_mm);
    cli_json_number(j, "height_mm", f->height_mm);
    cli_json_number(j, "deviation_mm", f->deviation_mm);
    cli_json_number(j, "lean_deg", f->lean_deg);
    if (isfinite(f->thickness_mm))
        cli_json_number(j, "thickness_mm", f->thickness_mm);
    cli_json_number(j, "volume_mm3", f->volume_mm3);
}
