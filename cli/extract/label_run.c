/* Runs `extract --labels`: reads a label map, finds names, extracts the interfaces, makes a mesh
 * a label, checks and writes. */
#define _GNU_SOURCE /* asprintf */
#include "cli/extract/label_run.h"

#include "cli/framework/console.h"
#include "cli/framework/standard_streams.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/label_scene.h"
#include "cli/inputs/volume_prepare.h"
#include "cli/results/stage_facts.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/simplify.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns the error of --simplify in millimetres; 0: none was stated. */
static double find_error_mm(const cli_label_run *r)
{
    const cli_length *error = &r->args->simplify.error;
    return error->given ? cli_volume_length_mm(&r->volume, error) : 0;
}

/* Refuses all values of a scan as labels, but with --force, or where something names labels. */
static cw_status expect_labels(const cli_label_run *r, cw_error *err)
{
    cw_labels l;
    if (r->args->probabilities || !r->choice.all || r->args->common.force ||
        r->names.table.count || r->volume.streams)
        return CW_OK;
    cw_status st = cw_volume_labels(&r->volume.view, &l, err);
    if (st != CW_OK || !l.scattered)
        return st;
    return cwi_fail(
        err, CW_ERR_ARGUMENT,
        "%s: it looks like a scan, whose values are amounts and no labels: fewer than "
        "half of neighbouring voxels are equal. --iso V makes a surface; --force "
        "takes each value as a label",
        r->volume.path);
}

static cw_status read_map(cli_label_run *r, cw_error *err)
{
    const cli_extract_args *args = r->args;
    cli_input input = args->input;
    input.array.component.given = true; /* all are taken, unless one was stated */
    input.stream = args->stream;
    input.may_stream = !cli_cleans_labels(args) && !args->input.resample.given;
    input.resample.given = input.resample.of_labels = false; /* of labels it comes later */
    input.of_labels = true;
    cw_status st = cli_read_volume(args->common.inputs[0], &input, false, &r->volume, err);
    if (st == CW_OK && r->volume.streams && args->stream == CLI_STREAM_AUTO)
        cli_say("%s: voxels exceed half of --memory: read and extracted slice by slice",
                r->volume.path);
    return st;
}

/* Finds the names of labels: those of files, where each of several holds one. */
static cw_status find_names(cli_label_run *r, cw_error *err)
{
    return r->fields.more_count > 0 && !r->args->names
               ? cli_name_label_fields(&r->fields, &r->names.table, err)
               : cli_find_label_names(r->args->names, &r->volume, &r->names, err);
}

static cw_status read_input(cli_label_run *r, cw_error *err)
{
    const cli_extract_args *args = r->args;
    cli_report_begin(&r->report);
    cw_status st = args->probabilities
                       ? cli_read_label_fields(args->probabilities, &args->common, &args->input,
                                               &r->volume, &r->fields, err)
                       : read_map(r, err);
    if (st != CW_OK)
        return st;
    const cw_volume *v = &r->volume.view;
    r->report.input = &r->volume;
    cli_report_read(&r->report, &r->volume);
    if (v->cells || v->sparse)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s: --labels is for dense grids of voxels; this is %s", r->volume.path,
                        v->cells ? "an irregular grid" : "a sparse one");
    r->error_mm = find_error_mm(r);
    r->target = args->simplify.triangles;
    st = cli_extract_check_error(args, &r->volume, err);
    if (st == CW_OK)
        st = find_names(r, err);
    if (st == CW_OK)
        st = cli_choose_labels("--labels", args->labels, &r->names.table, &r->volume.ids,
                               &r->choice, err);
    if (st == CW_OK)
        st = expect_labels(r, err);
    double spacing[3], old[3];
    memcpy(spacing, r->volume.spacing, sizeof spacing);
    if (args->input.resample.given)
        cli_resample_spacing(&args->input.resample, v, old, spacing);
    return st == CW_OK ? cli_find_label_move(&args->smooth_labels, spacing, &r->max_move, err)
                       : st;
}

const cw_volume *cli_label_grid(const cli_label_run *r)
{
    return r->grid.dim[0] ? &r->grid : &r->volume.view;
}

/* An extraction of slices. */
typedef struct label_slices {
    const cw_labels_desc *desc;
    cw_label_surfaces *surfaces;
} label_slices;

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    const label_slices *s = user;
    return cw_extract_labels_stream(source, s->desc, s->surfaces, err);
}

/* Extracts the interfaces of a component whose voxels are in memory. */
static cw_status extract_view(cli_label_run *r, const cw_volume *view, uint32_t number,
                              const cw_labels_desc *desc, cli_label_layer *layer, cw_error *err)
{
    cw_volume sampled = {0};
    cw_status st = CW_OK;
    if (r->args->input.resample.given) {
        st = cli_resample_labels(r, view, number, desc, &sampled, err);
        view = &sampled;
    }
    if (st == CW_OK)
        st = cli_cleans_labels(r->args) ? cli_clean_and_extract(r, view, desc, layer, err)
                                        : cw_extract_labels(view, desc, &layer->surfaces, err);
    cw_volume_free(&sampled);
    return st;
}

/* Extracts the interfaces of one component from its voxels, or from slices. */
static cw_status extract_component(cli_label_run *r, uint32_t number,
                                   const cw_labels_desc *desc, cli_label_layer *layer,
                                   cw_error *err)
{
    cli_input input = r->args->input;
    input.of_labels = true;
    label_slices slices = {desc, &layer->surfaces};
    const cw_slice_visitor visitor = {extract_slices, &slices};
    cw_volume view;
    input.array.component.number = number;
    if (r->args->probabilities)
        return cw_extract_label_scores(&r->fields.scores, desc, &layer->surfaces, err);
    if (r->volume.streams)
        return cli_visit_slices(&r->volume, &input, &visitor, err);
    cw_status st = cw_volume_select(&r->volume.voxels, number, input.step, &view, err);
    const cw_volume all = view;
    if (st == CW_OK && input.coarsen_view)
        st = cw_volume_coarsen(&all, r->volume.coarsen, &view, err);
    return st == CW_OK ? extract_view(r, &view, number, desc, layer, err) : st;
}

/* Extracts the interfaces of one component of the volume. */
static cw_status extract_layer(cli_label_run *r, uint32_t number, cw_error *err)
{
    const cli_extract_args *args = r->args;
    const size_t *dim = r->volume.view.dim;
    uint32_t *values = NULL;
    size_t count = 0;
    cw_status st = CW_OK;
    if (!r->choice.all)
        st = cli_labels_of_layer(&r->choice, number, &values, &count, err);
    if (st != CW_OK || (!r->choice.all && count == 0)) {
        free(values);
        return st;
    }
    cli_label_layer *layer = &r->layers[r->layer_count];
    const cw_labels_desc desc = {
        .labels = values,
        .label_count = count,
        .no_smoothing = r->max_move == 0,
        .max_move = r->max_move,
        .leave_open = args->open,
        .threads = (int)args->input.threads,
        .max_triangles = args->max_triangles,
        .progress =
            cli_progress((double)dim[0] * (double)dim[1] * (double)dim[2] / 1e6, "Mvoxel")};
    layer->number = number;
    st = extract_component(r, number, &desc, layer, err);
    free(values);
    if (st != CW_OK)
        return r->fields.more_count ? st : cwi_fail_in(err, st, r->volume.path);
    r->layer_count++;
    r->triangles += layer->surfaces.mesh.triangle_count;
    for (size_t n = 0; n < layer->surfaces.label_count; n++)
        cli_mark_found(&r->choice, number, layer->surfaces.labels[n].label);
    return CW_OK;
}

static cw_status extract_layers(cli_label_run *r, cw_error *err)
{
    size_t first, end;
    cw_status st = CW_OK;
    cli_label_layers(&r->volume, &r->args->input, &first, &end);
    if (r->args->probabilities)
        end = first + 1;
    r->layers = calloc(end - first, sizeof *r->layers);
    if (!r->layers)
        return cwi_fail_memory(err);
    cli_report_begin(&r->report);
    for (size_t c = first; c < end && st == CW_OK; c++)
        st = extract_layer(r, (uint32_t)c, err);
    const size_t *dim = cli_label_grid(r)->dim;
    if (st == CW_OK)
        cli_report_end(&r->report, "extract", dim[0] * dim[1] * dim[2], r->triangles);
    return st;
}

/* Names the labels that were chosen and have no voxels. They fail the run with
 * --require-labels. */
static cw_status tell_missing(const cli_label_run *r, cw_error *err)
{
    char list[256];
    const size_t missing = cli_list_missing(&r->choice, &r->names.table, list, sizeof list);
    if (!missing)
        return CW_OK;
    if (r->args->require_labels)
        return cwi_fail(err, CW_ERR_EMPTY, "%s: no voxel has label%s %s", r->volume.path,
                        missing == 1 ? "" : "s", list);
    cli_say("%s: no voxel has label%s %s: skipped", r->volume.path, missing == 1 ? "" : "s",
            list);
    return CW_OK;
}

/* Lists the labels that occur. Those that their table hides are left out of "all". */
static cw_status list_items(cli_label_run *r, cw_error *err)
{
    size_t count = 0, hidden = 0;
    for (size_t n = 0; n < r->layer_count; n++)
        count += r->layers[n].surfaces.label_count;
    r->items = calloc(count ? count : 1, sizeof *r->items);
    if (!r->items)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < r->layer_count; n++)
        for (size_t l = 0; l < r->layers[n].surfaces.label_count; l++) {
            const cw_label_count *found = &r->layers[n].surfaces.labels[l];
            cli_label_item *item = &r->items[r->item_count];
            item->label = cli_complete_label(&r->names.table, r->layers[n].number, found->label,
                                             item->name);
            if (r->choice.all && item->label.hidden) {
                hidden++;
                continue;
            }
            item->layer = &r->layers[n];
            item->voxels = found->voxels;
            item->max_error_mm = item->rms_error_mm = NAN;
            r->item_count++;
        }
    if (hidden)
        cli_say(
            "%s: %zu labels that the table hides in 3D are left out; --labels takes them by "
            "number or name",
            r->volume.path, hidden);
    return r->item_count ? CW_OK
                         : cwi_fail(err, CW_ERR_EMPTY,
                                    "%s: none of the labels has voxels: all values are the "
                                    "background or not chosen",
                                    r->volume.path);
}

/* Fails unless a label's surface is closed (or open at the border alone) and a manifold. */
static cw_status hold_item(const cli_label_run *r, const cli_label_item *item, cw_error *err)
{
    char what[48];
    snprintf(what, sizeof what, "of label %s",
             cw_label_number(&item->label, (char[CW_LABEL_NUMBER]){0}));
    return cli_hold_to_promise(r->volume.path, what, &item->facts.quality, r->args->open, err);
}

static bool needs_quality(const cli_extract_args *args)
{
    return args->check || args->table || args->json;
}

/* Finds the item of a label; NULL: it is left out. */
static cli_label_item *find_item(const cli_label_run *r, size_t layer, uint32_t label)
{
    for (size_t n = 0; n < r->item_count; n++)
        if (r->items[n].layer == &r->layers[layer] && r->items[n].label.value == label)
            return &r->items[n];
    return NULL;
}

static bool wants_label(void *user, size_t layer, uint32_t label)
{
    return find_item(user, layer, label) != NULL;
}

static size_t count_triangles(const cli_label_run *r)
{
    size_t count = 0;
    for (size_t n = 0; n < r->layer_count; n++)
        count += r->layers[n].surfaces.mesh.triangle_count;
    return count;
}

static cw_progress begin_stage(void *user, cw_stage stage, size_t count, const char *unit)
{
    cli_label_run *r = user;
    if (stage == CW_STAGE_SIMPLIFY || stage == CW_STAGE_LOD)
        cli_report_begin(&r->report);
    return cli_stage_progress(NULL, stage, count, unit);
}

static void end_stage(void *user, cw_stage stage, size_t before, size_t after)
{
    cli_label_run *r = user;
    if (stage != CW_STAGE_SIMPLIFY && stage != CW_STAGE_LOD)
        return;
    r->extracted = r->extracted ? r->extracted : before;
    cli_report_end(&r->report, "simplify", before, after);
    cli_report_begin(&r->report);
}

static void tell_stages(cli_label_run *r, const cli_label_item *item)
{
    char *subject = NULL;
    if (asprintf(&subject, "%s: label %s", r->volume.path,
                 cw_label_number(&item->label, (char[CW_LABEL_NUMBER]){0})) < 0)
        return;
    cli_tell_stages(
        &(cli_staged){.subject = subject, .facts = &item->facts, .report = &r->report});
    free(subject);
}

/* Measures how far the surface of a label is from the one before it was simplified, both ways. */
static cw_status measure_item(const cli_label_run *r, cli_label_item *item,
                              const cw_pipeline_surface *surface, cw_error *err)
{
    const cw_mesh_distance_desc desc = {.threads = (int)r->args->input.threads};
    cw_mesh_comparison c = {0};
    item->max_error_mm = item->rms_error_mm = NAN;
    if (!surface->full)
        return CW_OK;
    const cw_status st = cw_mesh_compare(surface->mesh, surface->full, &desc, &c, err);
    if (st != CW_OK)
        return st;
    item->max_error_mm = cw_mesh_comparison_max(&c);
    item->rms_error_mm = cw_mesh_comparison_rms(&c);
    return CW_OK;
}

/* Keeps the mesh of a label, and writes a level of detail that is complete. */
static cw_status take_label(void *user, cw_pipeline_surface *surface,
                            const cw_pipeline_facts *facts, cw_error *err)
{
    cli_label_run *r = user;
    cli_label_item *item = find_item(r, surface->layer, surface->label);
    item->facts = *facts;
    tell_stages(r, item);
    cw_status st = r->args->check ? hold_item(r, item, err) : CW_OK;
    if (st == CW_OK)
        st = measure_item(r, item, surface, err);
    if (st == CW_OK && !r->args->shared_faces)
        st = cwi_mesh_store_keep(&r->store, surface->mesh, &item->mesh, err);
    if (st != CW_OK || item != &r->items[r->item_count - 1])
        return st;
    r->triangles = count_triangles(r);
    cli_report_end(&r->report, "check", r->triangles, r->triangles);
    return r->args->lod.count ? cli_write_label_level(r, surface->level, err) : CW_OK;
}

/* Makes room for the meshes of all levels of detail. */
static cw_status reserve_levels(cli_label_run *r, cw_error *err)
{
    const cli_counts *lod = &r->args->lod;
    cw_status st = cli_report_reserve(&r->report, lod->count + 1, err);
    r->report.several = "surfaces";
    r->levels = calloc(lod->count * r->item_count, sizeof *r->levels);
    r->level_errors = calloc(lod->count * r->item_count, sizeof *r->level_errors);
    return r->levels && r->level_errors ? st : cwi_fail_memory(err);
}

/* Simplifies the interfaces, makes the mesh of each label and checks it. */
static cw_status make_meshes(cli_label_run *r, cw_error *err)
{
    const cli_extract_args *args = r->args;
    cw_label_surfaces **layers = calloc(r->layer_count + 1, sizeof *layers);
    for (size_t n = 0; layers && n < r->layer_count; n++)
        layers[n] = &r->layers[n].surfaces;
    for (size_t n = 0; n < r->item_count; n++)
        r->items[n].label.name = r->items[n].name; /* items stay where they are from now on */
    const cw_pipeline_labels labels = {.layers = layers,
                                       .layer_count = r->layer_count,
                                       .apart = args->per_label,
                                       .interfaces_only =
                                           args->shared_faces && !needs_quality(args),
                                       .wants = wants_label,
                                       .user = r};
    const cw_simplify_desc simplify = {.error_mm = r->error_mm, .triangles = r->target};
    cli_surface_settings set;
    cli_extract_describe_stages(args, &r->volume, &set);
    set.desc.extract = (cw_extract_desc){.no_normals = args->normals || args->shared_faces,
                                         .threads = (int)args->input.threads};
    set.desc.simplify = r->error_mm > 0 || r->target ? &simplify : NULL;
    set.desc.min_volume_mm3 = 0; /* voxels were cleaned */
    set.desc.largest = 0;
    set.desc.fill_voids = false;
    set.desc.check = needs_quality(args);
    set.desc.watch = (cw_pipeline_watch){begin_stage, end_stage, r};
    cw_pipeline_facts facts = {0};
    cli_report_begin(&r->report);
    cw_status st = layers
                       ? cw_pipeline_run_labels(&labels, &set.desc,
                                                (cw_pipeline_sink){take_label, r}, &facts, err)
                       : cwi_fail_memory(err);
    r->triangles = count_triangles(r);
    if (args->per_label)
        r->extracted = facts.extracted.triangles;
    free(layers);
    return st;
}

/* The report and the table are outputs too. */
static cw_status check_side_outputs(cli_label_run *r, cw_error *err)
{
    const cli_extract_args *args = r->args;
    const cli_common *common = &args->common;
    cw_status st = CW_OK;
    if (args->json)
        st = cli_check_output(args->json, common->inputs, common->input_count, err);
    if (st != CW_OK)
        return st;
    r->report.path = args->json;
    if (args->table)
        st = cli_check_output(args->table, common->inputs, common->input_count, err);
    if (st == CW_OK && args->table && args->names)
        st = cli_check_apart(args->table, args->names, err);
    return st == CW_OK && args->table && args->json
               ? cli_check_apart(args->table, args->json, err)
               : st;
}

static void tell_overflow(void *user, size_t bytes)
{
    const cli_label_run *r = user;
    cli_say(
        "%s: label surfaces exceed --memory: kept in temporary files of about %s beside the "
        "output",
        r->args->common.inputs[0], cli_bytes((double)bytes));
}

/* Lets arrays beyond --memory go to files beside the output. Where none can be made, memory has to do. */
static void begin_overflow(const cli_label_run *r)
{
    char *path = cwi_strdup(cli_temporary_beside(r->args->output));
    char *brace = path ? strchr(path, '{') : NULL; /* of a name that is not known yet */
    if (brace)
        *brace = '\0';
    const cw_overflow_desc desc = {.path = path, .report = tell_overflow, .user = (void *)r};
    if (path && cw_memory_overflow(&desc, NULL) != CW_OK)
        cli_say_v("%s: no temporary files beside it for what exceeds --memory", path);
    cwi_free(path);
}

/* Announces the meshes of all labels, or interfaces. They go to a store if they may exceed the memory that is
 * left. */
static cw_status expect_meshes(cli_label_run *r, cw_error *err)
{
    enum { TRIANGLE = 24 }; /* bytes, with half a vertex and its normal */
    size_t triangles = 0;
    for (size_t n = 0; n < r->layer_count; n++) {
        const cw_label_surfaces *s = &r->layers[n].surfaces;
        for (size_t p = 0; p < s->patch_count; p++)
            triangles +=
                s->patches[p].count *
                (r->args->shared_faces || s->patches[p].labels[1] == s->background ? 1 : 2);
    }
    if (r->error_mm > 0 || r->target || r->args->lod.count) /* it jumps between pages */
        return cw_memory_overflow(NULL, err);
    r->store.is_used = TRIANGLE * triangles > cwi_memory_left() / 2;
    return cwi_memory_expect(TRIANGLE * triangles, err);
}

static cw_status run_labels(void *state, cw_error *err)
{
    cli_label_run *r = state;
    cw_status st = check_side_outputs(r, err);
    if (st == CW_OK)
        st = cli_check_label_args(r->args, err);
    cli_report_next(&r->report, NULL, 0); /* its path is known once the labels are */
    if (st == CW_OK)
        st = cli_name_label_file(r, err);
    if (st == CW_OK && r->args->stream != CLI_STREAM_NEVER)
        begin_overflow(r);
    if (st == CW_OK)
        st = read_input(r, err);
    if (st == CW_OK)
        st = extract_layers(r, err);
    if (st == CW_OK)
        cli_tell_cleaning(r);
    if (st == CW_OK && r->choice.all)
        cli_tell_absent_fields(r);
    if (st == CW_OK)
        st = tell_missing(r, err);
    if (st == CW_OK)
        st = list_items(r, err);
    if (st == CW_OK)
        st = cli_measure_label_volumes(r, err);
    if (st == CW_OK)
        st = cli_tell_label_volumes(r, err);
    if (st == CW_OK && r->args->lod.count)
        st = reserve_levels(r, err);
    if (st == CW_OK)
        st = expect_meshes(r, err);
    if (st == CW_OK)
        st = make_meshes(r, err);
    if (st == CW_OK)
        st = r->args->lod.count ? cli_write_label_levels(r, err) : cli_write_labels(r, err);
    return st == CW_OK ? cli_write_label_table(r, err) : st;
}

static void free_run(cli_label_run *r)
{
    for (size_t n = 0; n < r->item_count; n++)
        cwi_mesh_store_release(&r->store, &r->items[n].mesh);
    for (size_t n = 0; n < r->layer_count; n++)
        cli_free_label_layer(&r->layers[n]);
    for (size_t n = 0; n < r->level_count * r->item_count; n++)
        cwi_mesh_store_release(&r->store, &r->levels[n]);
    cwi_mesh_store_free(&r->store);
    free(r->levels);
    free(r->level_errors);
    free(r->items);
    free(r->layers);
    cli_free_label_choice(&r->choice);
    cli_free_label_names(&r->names);
    cli_free_outputs(&r->files);
    cli_free_label_fields(&r->fields);
    cli_free_volume(&r->volume);
}

cw_status cli_extract_labels(const cli_extract_args *args, cw_error *err)
{
    cli_label_run r = {.args = args,
                       .start = cli_seconds(),
                       .report = {.command = "extract",
                                  .params = cli_put_label_params,
                                  .facts = cli_put_labels,
                                  .args = &r}};
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = run_labels,
                         .state = &r};
    cw_status st = cli_run_reported(&run, &r.report, err);
    free_run(&r);
    const cw_status closed = cw_memory_overflow(NULL, NULL);
    return st == CW_OK ? closed : st;
}
