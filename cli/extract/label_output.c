/* Writes the surfaces of labels: all into one file, a file a label, or the interfaces once. */
#include "cli/extract/label_run.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool cli_has_file_a_label(const char *output)
{
    return strstr(output, "{label}") || strstr(output, "{label:") || strstr(output, "{name}");
}

/* Makes the record of how the surfaces were made, for the files. */
static size_t make_provenance(const cli_label_run *r, char smoothing[48], char simplified[64],
                              cw_provenance lines[3])
{
    const char *how = r->args->per_label ? ", each label by itself" : ", together";
    if (r->max_move > 0)
        snprintf(smoothing, 48, "within %.9g voxels", r->max_move);
    else
        snprintf(smoothing, 48, "off");
    lines[0] = (cw_provenance){"labels", r->args->labels};
    lines[1] = (cw_provenance){"smoothing", smoothing};
    if (r->args->probabilities)
        lines[1] = (cw_provenance){"probabilities", r->args->probabilities};
    if (r->error_mm > 0)
        snprintf(simplified, 64, "to %.9g mm%s", r->error_mm, how);
    else
        snprintf(simplified, 64, "to %zu triangles%s", r->args->simplify.triangles, how);
    lines[2] = (cw_provenance){"simplified", simplified};
    return r->extracted ? 3 : 2;
}

/* Sums what was measured of items, for the line and the report. */
static void sum_quality(const cli_label_run *r, size_t first, size_t count, cli_made *made)
{
    made->measured = r->args->check && !r->args->shared_faces; /* three may meet at an edge */
    made->quality = r->items[first].facts.quality;
    for (size_t n = first + 1; n < first + count; n++)
        cli_add_quality(&made->quality, &r->items[n].facts.quality);
}

/* Delivers parts, which are the surfaces of items, as a file. */
static cw_status deliver_file(cli_label_run *r, size_t file, const cw_part *parts, size_t count,
                              size_t first, size_t items, const cw_write_desc *more,
                              const char *found, cw_error *err)
{
    char smoothing[48], simplified[64];
    cw_provenance lines[3];
    cli_made *made = file ? cli_report_next(&r->report, NULL, 0) : r->report.made;
    made->path = r->files.path[file];
    made->name = items == 1 ? r->items[first].name : "labels";
    sum_quality(r, first, items, made);
    cli_delivery how = {.input = r->volume.path,
                        .write = cli_extract_write_desc(r->args),
                        .compress = &r->args->compress,
                        .voxel_mm = cli_volume_voxel_mm(&r->volume),
                        .unchecked = true, /* each label was by itself */
                        .open = r->args->open,
                        .parts = r->args->shared_faces ? "interfaces"
                                 : count > items       ? "levels"
                                                       : "labels",
                        .found = found,
                        .preview = cli_is_preview(&r->volume)};
    how.write.sides = more ? more->sides : NULL;
    how.write.labels = more ? more->labels : NULL;
    how.write.provenance = lines;
    how.write.provenance_count = make_provenance(r, smoothing, simplified, lines);
    cw_status st = cli_deliver(&r->report, &how, parts, count, 0, r->start, err);
    if (st != CW_OK)
        r->report.made[r->report.made_count - 1].error = *err;
    r->start = cli_seconds();
    return st;
}

static cw_part *make_parts(const cli_label_run *r)
{
    cw_part *parts = calloc(r->item_count, sizeof *parts);
    for (size_t n = 0; parts && n < r->item_count; n++)
        parts[n] = (cw_part){
            .mesh = &r->items[n].mesh, .name = r->items[n].name, .label = &r->items[n].label};
    return parts;
}

/* Checks that no file is an input, another output or in the way. */
static cw_status check_files(const cli_label_run *r, cw_error *err)
{
    const cli_extract_args *args = r->args;
    const cw_write_desc desc = cli_extract_write_desc(args);
    cw_status st = CW_OK;
    for (size_t n = 0; n < r->files.count && st == CW_OK; n++) {
        const char *path = r->files.path[n];
        if (args->json)
            st = cli_check_apart(path, args->json, err);
        if (st == CW_OK && args->table)
            st = cli_check_apart(path, args->table, err);
        if (st == CW_OK && args->names)
            st = cli_check_apart(path, args->names, err);
    }
    return st == CW_OK ? cli_check_outputs(&r->files, args->common.inputs,
                                           args->common.input_count, &desc, err)
                       : st;
}

/* Names a file a part, and checks them. */
static cw_status name_files(cli_label_run *r, const cw_part *parts, size_t count, cw_error *err)
{
    const cli_extract_args *args = r->args;
    cw_status st = cli_name_part_outputs(&r->files, args->output, args->common.inputs[0], parts,
                                         count, err);
    return st == CW_OK ? check_files(r, err) : st;
}

/* Names the files of levels of detail, and checks them. */
static cw_status name_levels(cli_label_run *r, cw_error *err)
{
    const cli_extract_args *args = r->args;
    cw_status st =
        cli_name_lod_outputs(&r->files, args->output, args->common.inputs[0], args->lod.count,
                             cli_lod_files_of(args->output, args->format), err);
    return st == CW_OK ? check_files(r, err) : st;
}

cw_status cli_name_label_file(cli_label_run *r, cw_error *err)
{
    const cw_label label = {.name = NULL};
    if (r->args->lod.count)
        return name_levels(r, err);
    return cli_has_file_a_label(r->args->output)
               ? CW_OK
               : name_files(r, &(cw_part){.name = "labels", .label = &label}, 1, err);
}

enum { STEPS_BYTES = 320 };

/* Finds the label whose surface moved the farthest when it was simplified; NULL: none was measured. */
static const cli_label_item *find_worst(const cli_label_run *r)
{
    const cli_label_item *worst = NULL;
    for (size_t n = 0; n < r->item_count; n++)
        if (!isnan(r->items[n].max_error_mm) &&
            (!worst || r->items[n].max_error_mm > worst->max_error_mm))
            worst = &r->items[n];
    return worst;
}

/* Describes smoothing and simplification for the line of a file. */
static void print_steps(const cli_label_run *r, char text[STEPS_BYTES])
{
    int n = r->args->probabilities
                ? snprintf(text, STEPS_BYTES, "; from %zu field%s%s", r->fields.scores.count,
                           r->fields.scores.count == 1 ? "" : "s",
                           r->max_move > 0 ? "" : ", in steps")
            : r->max_move > 0
                ? snprintf(text, STEPS_BYTES,
                           "; smoothed, by at most %.3g voxels along each axis", r->max_move)
                : snprintf(text, STEPS_BYTES, "; not smoothed");
    if (r->extracted && !r->args->per_label)
        n += snprintf(text + n, STEPS_BYTES - (size_t)n,
                      "; interfaces simplified from %s to %s triangles",
                      cli_count(r->extracted), cli_count(r->triangles));
    else if (r->extracted)
        n += snprintf(text + n, STEPS_BYTES - (size_t)n, "; simplified from %s triangles",
                      cli_count(r->extracted));
    if (r->extracted && r->error_mm > 0)
        n += snprintf(text + n, STEPS_BYTES - (size_t)n, ", within %.6g mm", r->error_mm);
    const cli_label_item *worst = find_worst(r);
    if (worst)
        n += snprintf(text + n, STEPS_BYTES - (size_t)n, ", by up to %.3g mm (label %s, %.40s)",
                      worst->max_error_mm,
                      cw_label_number(&worst->label, (char[CW_LABEL_NUMBER]){0}), worst->name);
    if (r->extracted && r->args->per_label && n < STEPS_BYTES)
        snprintf(text + n, STEPS_BYTES - (size_t)n,
                 ", each label by itself: interfaces of neighbours part");
}

/* Tells when a file joins labels that its format cannot tell apart. */
static void tell_joined(const cli_label_run *r)
{
    const cw_format *f = cw_mesh_format(r->files.path[0], r->args->format);
    if (r->item_count > 1 && !(f->keeps & (CW_KEEPS_PARTS | CW_KEEPS_LABELS)))
        cli_say("%s: %s holds no labels, so all are joined; {label} or {name} in the output "
                "gives a file for each",
                r->files.path[0], f->name);
}

static cw_status write_files(cli_label_run *r, const cw_part *parts, cw_error *err)
{
    char found[STEPS_BYTES];
    cw_status st = CW_OK;
    print_steps(r, found);
    if (!cli_has_file_a_label(r->args->output))
        tell_joined(r);
    if (!cli_has_file_a_label(r->args->output))
        return deliver_file(r, 0, parts, r->item_count, 0, r->item_count, NULL, found, err);
    r->report.several = "surfaces";
    st = cli_report_reserve(&r->report, r->item_count + 1, err);
    for (size_t n = 0; n < r->item_count && st == CW_OK; n++)
        st = deliver_file(r, n, parts + n, 1, n, 1, NULL, found, err);
    return st;
}

/* --- interfaces -------------------------------------------------------------------------- */

/* Returns true if a patch is the border of a label that is written. */
static bool has_item(const cli_label_run *r, const cli_label_layer *layer,
                     const cw_label_patch *patch)
{
    for (size_t n = 0; n < r->item_count; n++)
        if (r->items[n].layer == layer && (r->items[n].label.value == patch->labels[0] ||
                                           r->items[n].label.value == patch->labels[1]))
            return true;
    return false;
}

/* Writes the interfaces as one mesh with the labels of both sides of each triangle. */
static cw_status write_sides(cli_label_run *r, const char *found, cw_error *err)
{
    const cw_label_surfaces *s = &r->layers[0].surfaces;
    cw_mesh mesh = s->mesh;
    uint32_t *sides = cwi_alloc_large(s->mesh.triangle_count, 2 * sizeof *sides);
    if (!sides)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < s->patch_count; p++)
        for (size_t t = s->patches[p].first; t < s->patches[p].first + s->patches[p].count;
             t++) {
            memcpy(sides + 2 * t, s->patches[p].labels, 2 * sizeof *sides);
            cwi_memory_trim_at(t);
        }
    cw_label_table labels = {0};
    const cw_part part = {.mesh = &mesh, .name = "labels"};
    const cw_write_desc more = {.sides = sides, .labels = &labels};
    cw_status st = CW_OK;
    for (size_t n = 0; n < r->item_count && st == CW_OK; n++) {
        cw_label label = r->items[n].label;
        label.layer = 0;
        st = cw_label_table_add(&labels, &label, err);
    }
    if (st == CW_OK)
        st = deliver_file(r, 0, &part, 1, 0, r->item_count, &more, found, err);
    cw_label_table_free(&labels);
    cwi_free(sides);
    return st;
}

/* Copies a patch as a part that is named by both of its labels. */
static cw_status add_patch(cli_label_run *r, const cli_label_layer *layer,
                           const cw_label_patch *patch, cw_mesh *mesh, cw_label *label,
                           char name[2 * CLI_LABEL_NAME], cw_part *part, cw_error *err)
{
    char names[2][CLI_LABEL_NAME];
    const bool has_rest = patch->labels[1] == layer->surfaces.background;
    *label = cli_complete_label(&r->names.table, layer->number, patch->labels[0], names[0]);
    cli_complete_label(&r->names.table, layer->number, patch->labels[1], names[1]);
    snprintf(name, 2 * CLI_LABEL_NAME, "%.120s | %.120s", names[0],
             has_rest ? "background" : names[1]);
    label->name = name;
    *part = (cw_part){.mesh = mesh, .name = name, .label = label};
    cw_mesh made;
    cw_status st = cw_label_patch_mesh(&layer->surfaces, patch, &made, err);
    if (st == CW_OK)
        st = cwi_mesh_store_keep(&r->store, &made, mesh, err);
    if (st != CW_OK)
        cw_mesh_free(&made);
    return st;
}

/* Writes a part an interface. */
static cw_status write_patches(cli_label_run *r, const char *found, cw_error *err)
{
    size_t room = 0, count = 0;
    cw_status st = CW_OK;
    for (size_t l = 0; l < r->layer_count; l++)
        room += r->layers[l].surfaces.patch_count;
    cw_part *parts = calloc(room + 1, sizeof *parts);
    cw_mesh *meshes = calloc(room + 1, sizeof *meshes);
    cw_label *labels = calloc(room + 1, sizeof *labels);
    char(*names)[2 * CLI_LABEL_NAME] = calloc(room + 1, sizeof *names);
    if (!parts || !meshes || !labels || !names)
        st = cwi_fail_memory(err);
    for (size_t l = 0; l < r->layer_count && st == CW_OK; l++) {
        const cli_label_layer *layer = &r->layers[l];
        for (size_t p = 0; p < layer->surfaces.patch_count && st == CW_OK; p++) {
            const cw_label_patch *patch = &layer->surfaces.patches[p];
            if (!has_item(r, layer, patch))
                continue;
            st = add_patch(r, layer, patch, &meshes[count], &labels[count], names[count],
                           &parts[count], err);
            count++;
        }
    }
    if (st == CW_OK)
        st = deliver_file(r, 0, parts, count, 0, r->item_count, NULL, found, err);
    for (size_t n = 0; n < count; n++)
        cwi_mesh_store_release(&r->store, &meshes[n]);
    free(parts);
    free(meshes);
    free(labels);
    free(names);
    return st;
}

static cw_status write_interfaces(cli_label_run *r, cw_error *err)
{
    char found[STEPS_BYTES + 96], steps[STEPS_BYTES];
    const cli_extract_args *args = r->args;
    const cw_format *f = cw_mesh_format(args->output, args->format);
    const bool has_sides = !(f->keeps & CW_KEEPS_PARTS);
    print_steps(r, steps);
    snprintf(found, sizeof found, "; interfaces of %zu labels, each written once%s%s",
             r->item_count,
             !args->check ? ""
             : args->open ? "; each label is a manifold"
                          : "; each label is closed, manifold",
             steps);
    if (has_sides && r->layer_count == 1)
        return write_sides(r, found, err);
    if (has_sides)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: its labels overlap in %zu layers; --shared-faces writes one of "
                        "them to %s (--component N), or all to glb and obj",
                        r->volume.path, r->layer_count, f->name);
    return write_patches(r, found, err);
}

cw_status cli_write_labels(cli_label_run *r, cw_error *err)
{
    cw_part *parts = make_parts(r);
    if (!parts)
        return cwi_fail_memory(err);
    cw_status st = cli_has_file_a_label(r->args->output)
                       ? name_files(r, parts, r->item_count, err)
                       : CW_OK;
    if (st == CW_OK)
        st = r->args->shared_faces ? write_interfaces(r, err) : write_files(r, parts, err);
    free(parts);
    return st;
}

/* Returns true if the levels have no files of their own. */
static bool is_together(const cli_label_run *r)
{
    return cli_lod_files_of(r->args->output, r->args->format) == CLI_LOD_TOGETHER;
}

static cw_status deliver_level(cli_label_run *r, size_t n, cw_error *err)
{
    char found[STEPS_BYTES];
    cw_part *parts = make_parts(r);
    if (!parts)
        return cwi_fail_memory(err);
    print_steps(r, found);
    cw_status st = deliver_file(r, n, parts, r->item_count, 0, r->item_count, NULL, found, err);
    free(parts);
    return st;
}

cw_status cli_write_label_level(cli_label_run *r, size_t n, cw_error *err)
{
    cw_status st = is_together(r) ? CW_OK : deliver_level(r, n, err);
    for (size_t i = 0; i < r->item_count; i++) {
        double *errors = r->level_errors[n * r->item_count + i];
        errors[0] = isnan(r->items[i].max_error_mm) ? 0 : r->items[i].max_error_mm;
        errors[1] = isnan(r->items[i].rms_error_mm) ? 0 : r->items[i].rms_error_mm;
        r->levels[n * r->item_count + i] = r->items[i].mesh;
        r->items[i].mesh = (cw_mesh){0};
    }
    r->level_count = n + 1;
    return st;
}

cw_status cli_write_label_levels(cli_label_run *r, cw_error *err)
{
    const size_t count = r->level_count * r->item_count;
    const bool together = is_together(r);
    if (r->files.count == r->level_count && !together)
        return CW_OK;
    cw_part *parts = calloc(count, sizeof *parts);
    if (!parts)
        return cwi_fail_memory(err);
    for (size_t i = 0; i < count; i++) { /* the levels of a label follow each other */
        const cli_label_item *item = &r->items[i / r->level_count];
        const size_t level = i % r->level_count;
        const double *errors = r->level_errors[level * r->item_count + i / r->level_count];
        parts[i] = (cw_part){.mesh = &r->levels[level * r->item_count + i / r->level_count],
                             .name = item->name,
                             .label = &item->label,
                             .level = level,
                             .max_error_mm = errors[0],
                             .rms_error_mm = errors[1]};
    }
    cw_status st = deliver_file(r, together ? 0 : r->level_count, parts, count, 0,
                                r->item_count, NULL, "; all levels of detail", err);
    free(parts);
    return st;
}
