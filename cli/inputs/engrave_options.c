/* Fills in and tells about text for solids. */
#include "cli/inputs/engrave_options.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Strokes below this are finer than what most nozzles print. */
static const double NOZZLE_MM = 0.4;

/* Surfaces that lean more within the text are told to be curved. */
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

size_t cli_print_engraved(const char *text, bool is_raised, const cw_engrave_facts *f,
                          char *out, size_t size)
{
    const int length = snprintf(
        out, size, "; '%.60s' %.3g mm high, %.3g mm %s, at %.4g, %.4g, %.4g facing %.2g, %.2g, %.2g",
        text, f->size_mm, f->depth_mm, is_raised ? "raised" : "deep", f->center[0], f->center[1],
        f->center[2], f->normal[0] + 0.0, f->normal[1] + 0.0, f->normal[2] + 0.0);
    return length < 0 ? 0 : (size_t)length < size ? (size_t)length : size - 1;
}

void cli_tell_engraved(const char *path, const cw_engrave_facts *f)
{
    if (f->lean_deg > CURVED_DEG)
        cli_say("%s: the text follows the surface, which is up to %.3g mm off a plane and leans by up "
                "to %.0f degrees",
                path, f->deviation_mm, f->lean_deg);
    if (f->stroke_mm < NOZZLE_MM)
        cli_say("%s: strokes are %.2g mm wide; nozzles of %g mm need --size %.3gmm or more", path,
                f->stroke_mm, NOZZLE_MM, ceil(10 * NOZZLE_MM * f->size_mm / f->stroke_mm) / 10);
}

void cli_json_engraved(cli_json *j, const char *text, const cw_engrave_facts *f)
{
    cli_json_text(j, "text", text);
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
